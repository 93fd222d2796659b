"""Writes drawn pages: PNG with the few colours that a figure has, SVG with its text as text.

Figures are committed beside the results that they show, so their size counts: as matplotlib writes them, a PNG has four
bytes a pixel and an SVG spells every letter as a curve, which makes both about four times as large. The same data give
the same bytes: no dates, no versions, no random ids.
"""

import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.io.files import write_text, write_whole
from ptbench.terminal import say

DPI = 200
# How far a colour may be moved, of 255, so that few are left; of two, the more frequent one stays where it is.
_TOLERANCE = 12
_MOST_COLOURS = 256
_WEBP_QUALITY = 75
# Who lacks the first has, on most systems, the second, which is as wide; others are narrower, so that nothing overlaps.
_FONTS = "'DejaVu Sans', Verdana, sans-serif"


def save_figure(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Writes a figure as NAME.png and NAME.svg."""
    return [
        write_whole(
            folder / f"{name}.png", lambda path: path.write_bytes(png_of(figure, DPI, few_colours=True)) and None
        ),
        write_text(folder / f"{name}.svg", svg_of(figure)),
    ]


def save_if_drawable(make: Callable[[], Figure], folder: Path, name: str) -> str:
    """Writes the one figure of a file, and says what was written; why there is none, or empty."""
    try:
        with style.applied():
            figure = make()
    except NotDrawable as reason:
        say(f"not drawn: {reason}")
        return str(reason)
    with style.applied():
        for written in save_figure(figure, folder, name):
            say(written)
    return ""


def save_pictures(figure: Figure, target: Path, dpi: float) -> Path:
    """A page of photographs in all its colours, as PNG or, by the target's ending, as WebP, a tenth as large."""
    png = png_of(figure, dpi, few_colours=False)
    page = webp_of(png) if target.suffix == ".webp" else png
    return write_whole(target, lambda path: path.write_bytes(page) and None)


def webp_of(png: bytes) -> bytes:
    """A page as WebP, which is lossy: text stays sharp, and the grain of a render is nobody's number."""
    with io.BytesIO() as written, Image.open(io.BytesIO(png)) as image:
        image.convert("RGB").save(written, "WEBP", quality=_WEBP_QUALITY, method=6)
        return written.getvalue()


def png_of(figure: Figure, dpi: float, *, few_colours: bool) -> bytes:
    """The page as a PNG file; photographs need all their colours."""
    with io.BytesIO() as drawn:
        figure.savefig(drawn, format="rgba", dpi=dpi)
        # As matplotlib's own canvas: parts of a pixel are cut off.
        size = int(figure.bbox_inches.width * dpi), int(figure.bbox_inches.height * dpi)
        # Nothing on a page is transparent: its paper is white.
        image = Image.frombytes("RGBA", size, drawn.getvalue()).convert("RGB")
    with io.BytesIO() as written:
        (_in_few_colours(image) if few_colours else image).save(written, "PNG", optimize=True, dpi=(dpi, dpi))
        return written.getvalue()


def _in_few_colours(image: Image.Image) -> Image.Image:
    """The most frequent colours as they are, every other as the nearest of those."""
    pixels = np.asarray(image, dtype=np.int32)
    codes = ((pixels[..., 0] << 16) + (pixels[..., 1] << 8) + pixels[..., 2]).ravel()
    # A page is mostly long runs of one colour: there are far fewer runs than pixels, or than colours there could be.
    begins = np.concatenate([[0], np.flatnonzero(codes[1:] != codes[:-1]) + 1])
    lengths = np.diff(begins, append=len(codes))
    there, of_run = np.unique(codes[begins], return_inverse=True)
    counts = np.bincount(of_run, weights=lengths).astype(np.int64)
    colours = np.stack([there >> 16, there >> 8 & 255, there & 255], axis=1)
    by_frequency = colours[np.argsort(-counts, kind="stable")]
    tolerance = _TOLERANCE
    while (palette := _palette(by_frequency, tolerance)) is None:
        tolerance *= 2
    index_of = np.abs(colours[:, None] - palette[None]).max(axis=2).argmin(axis=1).astype(np.uint8)
    reduced = Image.frombytes("P", image.size, np.repeat(index_of[of_run], lengths).tobytes())
    reduced.putpalette(palette.astype(np.uint8).tobytes())
    return reduced


def _palette(by_frequency: np.ndarray, tolerance: int) -> np.ndarray | None:
    """A palette of colours of which no two are within `tolerance`; None: there are too many."""
    kept = by_frequency[:1]
    for colour in by_frequency[1:]:
        if np.abs(kept - colour).max(axis=1).min() > tolerance:
            if len(kept) == _MOST_COLOURS:
                return None
            kept = np.concatenate([kept, colour[None]])
    return kept


def svg_of(figure: Figure) -> str:
    """The page as an SVG document."""
    with io.StringIO() as drawn:
        figure.savefig(drawn, format="svg", metadata={"Date": None, "Creator": None, "Type": None, "Format": None})
        text = drawn.getvalue()
    # Only in what matplotlib writes, never in what the page says: tags have no text of ours in them.
    return re.sub(r"<[^<>]*>", lambda tag: _shorter(tag[0]), text)


def _shorter(tag: str) -> str:
    """A tag with a hundredth of a point as its finest step, and with the fonts that may stand in for ours."""
    tag = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", tag)
    tag = re.sub(r"font: ([^;\"]*)'DejaVu Sans'", lambda font: f"font: {font[1]}{_FONTS}", tag)
    tag = tag.replace("font-family: 'DejaVu Sans'", f"font-family: {_FONTS}")
    return re.sub(r"(?<![\w#.])-?\d+\.\d{3,}", lambda number: _rounded(number[0]), tag)


def _rounded(number: str) -> str:
    text = f"{float(number):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
