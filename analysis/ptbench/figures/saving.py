"""Writes drawn pages as PNG with few colours, and as SVG with text as text.

Figures are committed beside their results, so their size matters: matplotlib writes four bytes per pixel into a PNG and
draws letters as curves in an SVG, which makes both about four times as large. Equal data give equal bytes: no dates, no
versions, no random ids.
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
# Largest change of a colour channel, of 255, when rare colours are merged into more frequent ones.
_TOLERANCE = 12
_MOST_COLOURS = 256
_WEBP_QUALITY = 75
# Fonts for text in an SVG. Most systems without DejaVu Sans have Verdana, equally wide; narrower ones do not overlap.
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
    """Writes a file's only figure and prints its name; returns why there is none, or an empty string."""
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
    """Writes a page of renders with all colours, as PNG or, by the target's extension, as WebP, a tenth as large."""
    png = png_of(figure, dpi, few_colours=False)
    page = webp_of(png) if target.suffix == ".webp" else png
    return write_whole(target, lambda path: path.write_bytes(page) and None)


def webp_of(png: bytes) -> bytes:
    """A PNG page as lossy WebP: text stays sharp, and the noise of renders need not be exact."""
    with io.BytesIO() as written, Image.open(io.BytesIO(png)) as image:
        image.convert("RGB").save(written, "WEBP", quality=_WEBP_QUALITY, method=6)
        return written.getvalue()


def png_of(figure: Figure, dpi: float, *, few_colours: bool) -> bytes:
    """The page as a PNG file; pages with renders need all their colours."""
    with io.BytesIO() as drawn:
        figure.savefig(drawn, format="rgba", dpi=dpi)
        # A PNG's width and height in pixels are rounded down, as in matplotlib's own canvas.
        size = int(figure.bbox_inches.width * dpi), int(figure.bbox_inches.height * dpi)
        # Pages have a white background, so the image's transparency can be dropped.
        image = Image.frombytes("RGBA", size, drawn.getvalue()).convert("RGB")
    with io.BytesIO() as written:
        (_in_few_colours(image) if few_colours else image).save(written, "PNG", optimize=True, dpi=(dpi, dpi))
        return written.getvalue()


def _in_few_colours(image: Image.Image) -> Image.Image:
    """Reduces an image to its most frequent colours; every other colour becomes the nearest of those."""
    pixels = np.asarray(image, dtype=np.int32)
    codes = ((pixels[..., 0] << 16) + (pixels[..., 1] << 8) + pixels[..., 2]).ravel()
    # Colours are counted by runs of equal pixels, which is fast, as a page has far fewer runs than pixels.
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
    """A palette in which no two colours are within `tolerance`; None: there are too many colours."""
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
    # Only the SVG's tags are shortened: the text on the page stands between tags, never inside one.
    return re.sub(r"<[^<>]*>", lambda tag: _shorter(tag[0]), text)


def _shorter(tag: str) -> str:
    """Shortens an SVG tag: coordinates to hundredths of a point, and fallback fonts added."""
    tag = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", tag)
    tag = re.sub(r"font: ([^;\"]*)'DejaVu Sans'", lambda font: f"font: {font[1]}{_FONTS}", tag)
    tag = tag.replace("font-family: 'DejaVu Sans'", f"font-family: {_FONTS}")
    return re.sub(r"(?<![\w#.])-?\d+\.\d{3,}", lambda number: _rounded(number[0]), tag)


def _rounded(number: str) -> str:
    text = f"{float(number):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
