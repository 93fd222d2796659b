"""The figures that `plots` writes as images for a page: SVG, or PNG where that is smaller."""

from dataclasses import dataclass

from matplotlib.figure import Figure

from ptbench.document.blocks import Image
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.registry import collect_study, draw, has_photographs, parts_of_study, stability_figures
from ptbench.figures.saving import DPI, png_of, svg_of
from ptbench.io.cells import Result, Study
from ptbench.io.files import one_line, safe_name
from ptbench.io.stability import Stability
from ptbench.studies.notes import Note

# Size in bytes of an SVG, with thousands of points, from which on a PNG is tried, which takes seconds.
_LARGE_SVG = 500_000
_PICTURES_DPI = 120  # resolution of pictures of renders, which serve for viewing only
_CSS_PIXELS = 96  # number of CSS pixels in an inch


@dataclass(frozen=True)
class Drawn:
    """The figures of a study or of a stability file, the notes on them, and why others were not drawn.

    Without a figure there are no notes.
    """

    images: tuple[Image, ...]
    notes: tuple[Note, ...] | None = None
    not_drawn: tuple[str, ...] = ()


def draw_study_figures(result: Result, study: Study, prefix: str) -> Drawn:
    """Draws the figures of a study as images whose names begin with `prefix`."""
    images: list[Image] = []
    notes: dict[Note, None] = {}
    not_drawn = []
    for part in parts_of_study(study):
        try:
            data = collect_study(result, study, part)
        except NotDrawable as reason:
            not_drawn.append(f"{part}: {reason}" if part else str(reason))
            continue
        notes |= dict.fromkeys(data.notes)
        name = safe_name(f"{prefix}_{study.name}" + (f"_{part}" if part else ""))
        figure = draw(data)
        images.append(_image(figure, name, _alt(data), is_picture=has_photographs(study, part)))
    return Drawn(tuple(images), tuple(notes) if images else None, tuple(not_drawn))


def draw_stability_figures(stability: Stability, prefix: str) -> Drawn:
    """Draws the pages of a stability file's figures as images whose names begin with `prefix`."""
    images, not_drawn = [], []
    for figure in stability_figures():
        try:
            pages = figure.collect(stability)
        except NotDrawable as reason:
            not_drawn.append(f"{figure.name}: {reason}")
            continue
        for page in pages:
            with style.applied():
                drawn = figure.draw(page)
            images.append(_image(drawn, safe_name(f"{prefix}_{page.name}"), _alt(page)))
    return Drawn(tuple(images), not_drawn=tuple(not_drawn))


def _alt(data) -> str:
    return one_line(f"{data.title}. {data.caption}")


def css_size(figure: Figure) -> tuple[int, int]:
    """The width and height of a figure in CSS pixels."""
    width, height = (round(_CSS_PIXELS * inches) for inches in figure.get_size_inches())
    return width, height


def _image(figure: Figure, name: str, alt: str, *, is_picture: bool = False) -> Image:
    width, height = css_size(figure)

    def image(ending: str, data: bytes) -> Image:
        return Image(f"{name}.{ending}", data, alt, width, height)

    with style.applied():
        if is_picture:
            return image("png", png_of(figure, _PICTURES_DPI, few_colours=False))
        svg = svg_of(figure).encode()
        if len(svg) < _LARGE_SVG:
            return image("svg", svg)
        png = png_of(figure, DPI, few_colours=True)
    return image("png", png) if len(png) < len(svg) else image("svg", svg)
