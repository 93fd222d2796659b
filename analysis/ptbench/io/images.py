"""PFM images as arrays, and their display values, signed errors and FLIP."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.errors import InputError, NotDrawable, bad_value
from ptbench.io.files import LARGEST_IMAGE, read_whole

_HEADER = re.compile(rb"(PF|Pf)\s+(\d{1,6})\s+(\d{1,6})\s+(-?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)\s")
# FLIP's viewing condition, fixed so that numbers are comparable: 0.7 m from a 0.7 m wide display of 3840 pixels.
PIXELS_PER_DEGREE = 67.02064514160156
_EXPOSURES = 2


def read_pfm(path: Path) -> np.ndarray:
    """Reads a .pfm file: linear radiance, rows from the top, three channels, single precision."""
    data = read_whole(path, LARGEST_IMAGE)
    header = _HEADER.match(data)
    if not header or header[1] != b"PF":
        raise bad_value(path, "the header", repr(data[:16])[1:], 'a PFM image of three channels: "PF", size, scale')
    width, height, scale = int(header[2]), int(header[3]), float(header[4])
    values = data[header.end() :]
    if width == 0 or height == 0 or scale == 0 or len(values) != 12 * width * height:
        needed = f"{12 * width * height} bytes for {width}x{height} pixels, none of them 0"
        raise bad_value(path, "the pixels", f"{len(values)} bytes, scale {scale:g}", needed)
    order = "<f4" if scale < 0 else ">f4"
    return np.frombuffer(values, dtype=order).reshape(height, width, 3)[::-1].astype(np.float32)


def faulty_pixels(image: np.ndarray) -> int:
    """The number of pixels with an infinite or NaN channel, which every comparison treats as false."""
    return int((~np.isfinite(image)).any(axis=-1).sum())


def exposure_of(reference: np.ndarray) -> float:
    """The exposure that maps the 99th percentile of the reference's brightest channels to white."""
    white = float(np.percentile(reference.max(axis=2), 99))
    return 1 / white if white > 0 else 1.0


def displayed(image: np.ndarray, exposure: float) -> np.ndarray:
    """An image for display: exposed, clamped to [0, 1] and sRGB encoded."""
    linear = np.clip(np.nan_to_num(image * exposure, nan=0.0, posinf=1.0), 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


TONE_MAPPING = (
    "Images: linear radiance over the 99th percentile of the reference's brightest channel, cut to [0, 1], sRGB."
)


@dataclass(frozen=True)
class Flip:
    """HDR-FLIP of an image, averaged over pixels, with the settings used."""

    mean: float
    start_exposure: float
    stop_exposure: float

    @property
    def settings(self) -> str:
        """The settings of FLIP, in words."""
        return (
            f"HDR-FLIP (flip-evaluator), tone-mapped by ACES at {_EXPOSURES} exposures from {self.start_exposure:.3f} "
            f"to "
            f"{self.stop_exposure:.3f} (log2, of the reference), {PIXELS_PER_DEGREE:.2f} pixels a degree"
        )


def flip(reference: np.ndarray, image: np.ndarray) -> Flip:
    """Computes FLIP with exposures from the reference, so that all images of one reference are comparable."""
    evaluator = _evaluator()
    if reference.shape != image.shape:
        raise InputError(
            f"FLIP: found images of {image.shape[1::-1]} and {reference.shape[1::-1]}, allowed: equal sizes"
        )
    if not (np.isfinite(reference).all() and np.isfinite(image).all()):
        raise NotDrawable("FLIP: a pixel is not finite")
    if not np.array_equal(reference, np.zeros_like(reference)):
        settings = {"ppd": PIXELS_PER_DEGREE, "numExposures": _EXPOSURES, "tonemapper": "aces"}
    else:
        # FLIP cannot derive exposures from a black reference, so fixed ones are set.
        settings = {"ppd": PIXELS_PER_DEGREE, "numExposures": _EXPOSURES, "startExposure": 0.0, "stopExposure": 1.0}
    arrays = (np.ascontiguousarray(array, dtype=np.float32) for array in (reference, image))
    _, mean, used = evaluator.evaluate(*arrays, "HDR", True, False, True, settings)
    return Flip(float(mean), float(used["startExposure"]), float(used["stopExposure"]))


def _evaluator():
    try:
        import flip_evaluator
    except ImportError as error:
        raise NotDrawable(
            "FLIP needs the Python package flip-evaluator: python3 -m pip install -r analysis/requirements.txt"
        ) from error
    return flip_evaluator
