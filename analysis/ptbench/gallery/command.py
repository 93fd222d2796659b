"""`python3 -m ptbench gallery`: renders pairs of pictures with `ptbench render` onto one labelled sheet."""

import io
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib.image
import numpy as np
from matplotlib.figure import Figure

from ptbench.errors import InputError, bad_value
from ptbench.figures import style
from ptbench.figures.saving import DPI, save_pictures
from ptbench.io.files import (
    LARGEST_IMAGE,
    LARGEST_INPUT,
    make_folder,
    move_whole,
    one_line,
    read_whole,
    safe_name,
    scratch_folder,
)
from ptbench.io.nodes import Node, read_json
from ptbench.program import Program, said_by
from ptbench.terminal import say, visible

_COLUMNS = 4
_PICTURE = 2.0  # width of a picture in inches
_GAP = 0.18
_LEAST_DPI = 128.0
# Fault counters of a render that are shown below its picture unless zero.
_COUNTERS = ("nonfinite", "negative", "unfinished_walks")


@dataclass(frozen=True)
class Picture:
    """A scene rendered in a variant; `axes` are those that differ from the program's defaults."""

    label: str
    scene: str
    axes: dict[str, str]

    @property
    def file_name(self) -> str:
        """Name of the picture's PNG file."""
        return safe_name("-".join([self.scene, *(f"{axis}_{choice}" for axis, choice in self.axes.items())])) + ".png"


@dataclass(frozen=True)
class Row:
    """One row of a gallery: pictures that are to be compared."""

    title: str
    pictures: tuple[Picture, ...]
    resolution: tuple[int, int] | None  # width and height of each picture in pixels; None: as the gallery's sheet
    pixels: bool  # whether a row's pictures are shown without interpolation, as it is about single pixels


@dataclass(frozen=True)
class Rendered:
    """The outcome of a render: `image` and `remarks`, or `failure`."""

    image: np.ndarray | None
    remarks: tuple[str, ...]
    failure: str = ""
    scene_hash: str = ""  # hash of the scene that was rendered


def load_spec(path: Path) -> tuple[str, tuple[Row, ...]]:
    """Reads the title and the rows of a gallery file; raises InputError."""
    root = read_json(path, LARGEST_INPUT)
    _only(root, "title", "rows")
    rows = tuple(_row(node) for node in root.need("rows").items())
    if not rows:
        raise root.need("rows").wrong("at least one row")
    return root.optional_text("title", "ptbench gallery"), rows


def _only(node: Node, *keys: str) -> None:
    for key in node.fields():
        if key not in keys:
            raise bad_value(node.file, f"{node.place}.{key}", "an unknown key", ", ".join(keys))


def _row(node: Node) -> Row:
    _only(node, "title", "pictures", "resolution", "pixels")
    pictures = tuple(_picture(item) for item in node.need("pictures").items())
    if not 1 <= len(pictures) <= _COLUMNS:
        raise node.need("pictures").wrong(f"1 to {_COLUMNS} pictures")
    resolution, pixels = node.maybe("resolution"), node.maybe("pixels")
    size = None if resolution is None else [item.integer(minimum=1) for item in resolution.items()]
    if size is not None and len(size) != 2:
        raise resolution.wrong("[width, height]")
    if pixels is not None and not isinstance(pixels.value, bool):
        raise pixels.wrong("true or false")
    return Row(
        title=node.need("title").name(),
        pictures=pictures,
        resolution=None if size is None else (size[0], size[1]),
        pixels=pixels is not None and pixels.value,
    )


def _picture(node: Node) -> Picture:
    _only(node, "label", "scene", "axes")
    axes = node.maybe("axes")
    return Picture(node.need("label").name(), node.need("scene").name(), {} if axes is None else axes.texts())


def render(binary: Path, picture: Picture, spp: int, resolution: tuple[int, int], folder: Path) -> Rendered:
    """Renders a picture with `ptbench render`; its file appears in `folder` only when complete."""
    with scratch_folder(folder) as scratch:
        target = scratch / "picture.png"
        axes = [word for axis, choice in picture.axes.items() for word in ("--axis", f"{axis}={choice}")]
        size = f"{resolution[0]}x{resolution[1]}"
        done = Program(binary).called(
            "render", "--scene", picture.scene, *axes, "--spp", spp, "--resolution", size, "--out", target
        )
        if done.returncode != 0:
            return Rendered(None, (), said_by(done)[-1])
        try:
            report = json.loads(done.stdout)
            remarks, scene_hash = _remarks(report), str(report.get("scene_hash", ""))
        except (ValueError, TypeError) as error:
            return Rendered(None, (), f"no JSON summary on stdout ({error})")
        try:
            image = matplotlib.image.imread(io.BytesIO(read_whole(target, LARGEST_IMAGE)), format="png")
        except (InputError, OSError, ValueError, SyntaxError) as error:
            return Rendered(None, (), f"no picture that can be read ({type(error).__name__})")
        move_whole(target, folder / picture.file_name)
        return Rendered(image, remarks, scene_hash=scene_hash)


def _remarks(report: dict) -> tuple[str, ...]:
    if not isinstance(report, dict):
        raise TypeError("not an object")
    return tuple(f"{counter.replace('_', ' ')} {report[counter]:g}" for counter in _COUNTERS if report.get(counter))


def gallery(binary: Path, spec: Path, out: Path, spp: int, resolution: tuple[int, int]) -> int:
    """Renders the pictures and writes the sheet; returns 0, or 1 where a render failed. Raises InputError."""
    title, rows = load_spec(spec)
    Program(binary).check()
    make_folder(out)
    failures = 0
    shown: list[list[Rendered]] = []
    for row in rows:
        shown.append([])
        for picture in row.pictures:
            rendered = render(binary, picture, spp, row.resolution or resolution, out)
            shown[-1].append(rendered)
            if rendered.failure:
                failures += 1
                where = f"{picture.scene} ({row.title}, {picture.label})"
                print(visible(f"{where}: {one_line(rendered.failure)}"), file=sys.stderr)
            else:
                say(out / picture.file_name)
    with style.applied():
        sheet = draw_sheet(title, rows, shown, spp, resolution)
        say(save_pictures(sheet, out / "gallery.webp", sheet_dpi(resolution)))
    return 1 if failures else 0


def sheet_dpi(resolution: tuple[int, int]) -> float:
    """A resolution at which a picture's pixel is one of the sheet's, but at least what text needs."""
    return min(max(resolution[0] / _PICTURE, _LEAST_DPI), DPI)


def packed(widths: Sequence[int]) -> list[list[int]]:
    """Distributes gallery rows over lines of the sheet: neighbours share a line while they fit."""
    lines: list[list[int]] = []
    room = 0
    for index, width in enumerate(widths):
        if not lines or width > room:
            lines.append([])
            room = _COLUMNS
        lines[-1].append(index)
        room -= width
    return lines


def draw_sheet(
    title: str, rows: Sequence[Row], shown: Sequence[Sequence[Rendered]], spp: int, resolution: tuple[int, int]
) -> Figure:
    """Draws the sheet; `shown` are the pictures of each row, `resolution` is width and height in pixels."""
    lines = packed([len(row.pictures) for row in rows])
    captions = [
        [_caption(picture, rendered, spp) for picture, rendered in zip(row.pictures, of_row, strict=True)]
        for row, of_row in zip(rows, shown, strict=True)
    ]
    head = style.text_height(style.BASE_SIZE + 0.5) + 0.06
    # Each line of the gallery's sheet is as high as its tallest picture and longest caption.
    picture_heights = [max(_PICTURE * min(_aspect(rows[index], resolution), 2.0) for index in line) for line in lines]
    caption_lines = [max(len(caption) for index in line for caption in captions[index]) for line in lines]
    heights = [
        head + picture + 0.05 + style.text_height(style.CAPTION_SIZE + 0.5, count) + 0.2
        for picture, count in zip(picture_heights, caption_lines, strict=True)
    ]
    width = 2 * style.MARGIN + _COLUMNS * _PICTURE + (_COLUMNS - 1) * _GAP
    sizes = f"{resolution[0]}×{resolution[1]}"
    about = f"{spp} samples per pixel, {sizes} pixels" + "".join(
        f"; {row.title}: {row.resolution[0]}×{row.resolution[1]}, each pixel shown" if row.pixels else ""
        for row in rows
        if row.resolution
    )
    page = style.Page(width, sum(heights), title, about + ".")
    top = sum(heights)
    for line, picture_height, height in zip(lines, picture_heights, heights, strict=True):
        column = 0
        for index in line:
            row = rows[index]
            left = style.MARGIN + column * (_PICTURE + _GAP)
            page.text(left, top, row.title, size=style.BASE_SIZE + 0.5, weight="bold", va="top")
            for rendered, caption in zip(shown[index], captions[index], strict=True):
                left = style.MARGIN + column * (_PICTURE + _GAP)
                axes = page.axes(left, top - head - picture_height, _PICTURE, picture_height)
                axes.set_xticks([])
                axes.set_yticks([])
                axes.set_anchor("N")
                if rendered.image is None:
                    _draw_failure(axes, rendered.failure)
                else:
                    axes.imshow(rendered.image, interpolation="nearest" if row.pixels else "antialiased", cmap="gray")
                    axes.axis("off")
                page.text(
                    left,
                    top - head - picture_height - 0.05,
                    "\n".join(caption),
                    size=style.CAPTION_SIZE + 0.5,
                    va="top",
                    weight="bold" if rendered.remarks else "normal",
                )
                column += 1
        top -= height
    return page.figure


def _aspect(row: Row, resolution: tuple[int, int]) -> float:
    width, height = row.resolution or resolution
    return height / width


def _caption(picture: Picture, rendered: Rendered, spp: int) -> list[str]:
    text = f"{picture.label} ({spp} spp)" if not rendered.failure else f"{picture.label}: failed"
    return style.wrapped("; ".join([text, *rendered.remarks]), style.CAPTION_SIZE + 0.5, _PICTURE, "bold")


def _draw_failure(axes, failure: str) -> None:
    most = math.floor(0.8 * _PICTURE / style.text_height(style.CAPTION_SIZE))
    lines = style.wrapped(failure, style.CAPTION_SIZE, 0.9 * _PICTURE)
    if len(lines) > most:
        lines = [*lines[: most - 1], "..."]
    for spine in axes.spines.values():
        spine.set_visible(True)
    text = "\n".join(["Render failed:", *lines])
    axes.text(0.5, 0.5, text, size=style.CAPTION_SIZE, ha="center", va="center", transform=axes.transAxes)
