"""Heat map of cases x variants: the error over the allowed error, blue where it is within, red where it is beyond."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.declaration import StabilityFigure
from ptbench.figures.stability.caption import caption
from ptbench.io.stability import Stability
from ptbench.stability.layout import HeatCell, Layout, Place, heat_cell, short_power

MOST_ROWS = 45  # largest number of rows (stability cases) on a page of the heat map
DECADES = 4.0  # decades between 1 and the value at which the heat map's colour is darkest
GREY, BLANK = "#d0d0d0", "#ffffff"

_ROW, _CELL, _HEAD, _APART, _SPLIT = 0.205, 0.46, 0.31, 0.1, 0.12  # inches of the heat map's layout
_NUMBER_SIZE, _COLUMN_SIZE = 7.5, 9.0
_LEGEND = 0.95
_CAPTION = (
    "Number and colour: error over the error that is allowed, of the worst quantity of the case; up to 1 is good "
    "(tolerance for rounding plus four standard errors for estimates). ∞: an error where none is allowed, or a number "
    "that is not finite. Columns left of the gap must pass; the others are there to compare. Parameters that a row "
    "does not name are at their standards."
)


@dataclass(frozen=True)
class HeatRow:
    """A row of the heat map: a case at a point, with one cell per column."""

    label: str
    cells: tuple[HeatCell, ...]


@dataclass(frozen=True)
class HeatGroup:
    """The heat map's rows for one family of stability cases."""

    family: str
    rows: tuple[HeatRow, ...]


@dataclass(frozen=True)
class HeatPage:
    """One page of the heat map of stability errors."""

    name: str  # file name of the heat map's page, without extension
    title: str
    caption: str
    columns: tuple[str, ...]
    must_pass: int  # number of the leading columns whose variants must pass every check
    groups: tuple[HeatGroup, ...]


def colour(over_allowed: float) -> str:
    """The colour of an error over the allowed one: blue up to 1, red above, the darker the farther from 1."""
    decades = -DECADES if over_allowed == 0 else DECADES if math.isinf(over_allowed) else math.log10(over_allowed)
    # The pale middle of the colour scale is skipped, so that errors of 0.9 and 1.1 times the allowed one look
    # different. Steps of half a decade keep the number of colours low; the number in the cell tells the rest.
    share = min(math.floor(2 * abs(decades)) / (2 * DECADES), 1.0)
    offset = 0.1 + 0.4 * share
    return to_hex(colormaps["RdBu_r"](0.5 - offset if over_allowed <= 1 else 0.5 + offset))


def number(over_allowed: float) -> str:
    """An error over the allowed one, in few characters."""
    if over_allowed == 0:
        return "0"
    if math.isinf(over_allowed):
        return "∞"
    if 0.01 <= over_allowed < 1000:
        text = f"{over_allowed:.2g}" if over_allowed < 100 else f"{over_allowed:.0f}"
        return ">1" if text == "1" and over_allowed > 1 else text
    return short_power(f"{over_allowed:.0e}")


def collect(stability: Stability) -> list[HeatPage]:
    """Collects the heat map in one page, or one per family where one would have too many rows."""
    if not stability.rows:
        raise NotDrawable("the file has no rows")
    layout = Layout(stability)
    grid = {
        place: [heat_cell(layout.by_cell.get((place, column.label), ())) for column in layout.columns]
        for place in layout.places
    }
    shown = [
        i for i in range(len(layout.columns)) if any(cells[i].kind not in ("n/a", "missing") for cells in grid.values())
    ]
    shown = shown or list(range(len(layout.columns)))
    idle = [column.label for i, column in enumerate(layout.columns) if i not in shown]
    remarks = [f"Applicable to no case, left out: {', '.join(idle)}."] if idle else []
    pages = []
    for name, part, places in _pages(layout.places):
        groups = []
        for family, members in groupby(places, key=lambda place: place.case.family):
            rows = [HeatRow(place.label, tuple(grid[place][i] for i in shown)) for place in members]
            groups.append(HeatGroup(family, tuple(rows)))
        page = HeatPage(
            name=name,
            title=f"Error over allowed{part}",
            caption=caption(stability, _CAPTION, remarks),
            columns=tuple(layout.columns[i].label for i in shown),
            must_pass=sum(layout.columns[i].must_pass for i in shown),
            groups=tuple(groups),
        )
        pages.append(page)
    return pages


def _pages(places: Sequence[Place]) -> list[tuple[str, str, Sequence[Place]]]:
    """(file name, title suffix, places) of each page of the heat map; a case is split only if it exceeds a page."""
    if len(places) <= MOST_ROWS:
        return [("heatmap", "", places)]
    pages = []
    for family, of_family in groupby(places, key=lambda place: place.case.family):
        parts: list[list[Place]] = [[]]
        for _, of_case in groupby(of_family, key=lambda place: place.case.name):
            members = list(of_case)
            if parts[-1] and len(parts[-1]) + len(members) > MOST_ROWS:
                parts.append([])
            for place in members:
                if len(parts[-1]) == MOST_ROWS:
                    parts.append([])
                parts[-1].append(place)
        for index, part in enumerate(parts):
            several = len(parts) > 1
            name = f"heatmap_{family}" + (f"_{index + 1}" if several else "")
            title = f": {family}" + (f" ({index + 1} of {len(parts)})" if several else "")
            pages.append((name, title, part))
    return pages


def _widest(texts: Sequence[str], size: float, weight: str = "normal") -> float:
    return max(style.text_width(text, size, weight) for text in texts)


def draw(data: HeatPage) -> Figure:
    """Draws a page of the heat map of stability errors, from the data of `collect`."""
    rows = [row for group in data.groups for row in group.rows]
    label_width = max(
        _widest([row.label for row in rows], style.LABEL_SIZE),
        _widest([group.family for group in data.groups], style.LABEL_SIZE, "bold"),
    )
    left = style.MARGIN + label_width + 0.14
    is_split = 0 < data.must_pass < len(data.columns)
    width = _CELL * len(data.columns) + (_SPLIT if is_split else 0)
    # The column names stand in the first family's heading, and need extra room only if they are taller than that.
    head = max(_widest(data.columns, _COLUMN_SIZE) + 0.16 - _HEAD, 0)
    heights = [_HEAD + _ROW * len(group.rows) for group in data.groups]
    body = head + sum(heights) + _LEGEND
    page = style.Page(max(left + width + style.MARGIN, 8.6), body, data.title, data.caption)
    xs = [_CELL * (i + 0.5) + (_SPLIT if is_split and i >= data.must_pass else 0) for i in range(len(data.columns))]
    top = body - head
    for x, label in zip(xs, data.columns, strict=True):
        page.text(left + x, top - _HEAD + 0.06, label, size=_COLUMN_SIZE, rotation=90, ha="center", va="bottom")
    for group, height in zip(data.groups, heights, strict=True):
        page.text(style.MARGIN, top - 0.55 * _HEAD, group.family, size=style.LABEL_SIZE, weight="bold", va="center")
        axes = page.axes(left, top - height, width, height - _HEAD, xlim=(0, width), ylim=(len(group.rows), 0))
        axes.set_axis_off()
        axes.plot([0, width], [0, 0], color="#555555", linewidth=0.9, clip_on=False, zorder=0)
        for index, row in enumerate(group.rows):
            centre = top - _HEAD - _ROW * (index + 0.5)
            page.text(left - 0.1, centre, row.label, size=style.LABEL_SIZE, ha="right", va="center")
            for x, cell in zip(xs, row.cells, strict=True):
                _draw_cell(axes, x, index + 0.5, cell)
        top -= height
    _draw_legend(page, left)
    return page.figure


def _draw_cell(axes: Axes, x: float, y: float, cell: HeatCell, width: float = _CELL) -> None:
    if cell.kind == "missing":
        return
    face = colour(cell.over_allowed) if cell.kind == "value" else GREY if cell.kind == "n/a" else BLANK
    corner = (x - 0.5 * width + 0.012, y - 0.46)
    size = (width - 0.024, 0.92)
    hatch = {"hatch": "////", "edgecolor": "#000000", "linewidth": 0.0} if cell.kind == "broken" else {"linewidth": 0}
    axes.add_patch(Rectangle(corner, *size, facecolor=face, **hatch, zorder=1))
    if cell.is_limit:
        inner = (corner[0] + 0.015, corner[1] + 0.07), size[0] - 0.03, size[1] - 0.14
        axes.add_patch(Rectangle(*inner, facecolor="none", edgecolor="#000000", linewidth=1.4, zorder=3))
    text = (number(cell.over_allowed) if cell.kind == "value" else "") + (" !" if cell.is_failure else "")
    if text:
        dark = cell.kind == "value" and _luminance(face) < 0.42
        backing = {"backgroundcolor": "#ffffff"} if cell.kind == "broken" else {}
        weight = "bold" if cell.is_failure else "normal"
        axes.text(
            x,
            y,
            text.strip(),
            size=_NUMBER_SIZE,
            color="#ffffff" if dark else "#000000",
            ha="center",
            va="center_baseline",
            weight=weight,
            zorder=4,
            **backing,
        )


def _luminance(face: str) -> float:
    red, green, blue = (int(face[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue


_SWATCHES = (
    (HeatCell("value", 20.0, is_failure=True), "failed, must pass"),
    (HeatCell("value", 20.0, is_limit=True), "known limit"),
    (HeatCell("broken"), "broken"),
    (HeatCell("n/a"), "not applicable"),
)
_SCALE = (0, 1e-3, 1e-2, 0.1, 0.99, 2, 10, 100, 1e3, math.inf)


def _draw_legend(page: style.Page, left: float) -> None:
    """Draws the colour scale with its numbers, and the colours for cells without a number."""
    cells = [HeatCell("value", value) for value in _SCALE]
    width = _CELL * len(cells)
    x0 = min(max(left - 1.2, style.MARGIN + 0.1), page.width - style.MARGIN - width - 0.1)
    axes = page.axes(x0, 0.42, width, _ROW, xlim=(0, width), ylim=(1, 0))
    axes.set_axis_off()
    for index, cell in enumerate(cells):
        _draw_cell(axes, _CELL * (index + 0.5), 0.5, cell)
    small = {"size": style.CAPTION_SIZE, "va": "center"}
    page.text(x0 + 0.25 * width, 0.42 + _ROW + 0.11, "allowed", ha="center", **small)
    page.text(x0 + 0.75 * width, 0.42 + _ROW + 0.11, "too far off", ha="center", **small)
    x = style.MARGIN
    for cell, text in (*_SWATCHES, (HeatCell("missing"), "blank: not run")):
        if cell.kind != "missing":
            axes = page.axes(x, 0.1, _CELL, _ROW, xlim=(0, _CELL), ylim=(1, 0))
            axes.set_axis_off()
            _draw_cell(axes, 0.5 * _CELL, 0.5, cell)
            x += _CELL + 0.07
        page.text(x, 0.1 + 0.5 * _ROW, text, **small)
        x += style.text_width(text, style.CAPTION_SIZE) + 0.3


FIGURES = (StabilityFigure("heatmap", collect, draw),)
