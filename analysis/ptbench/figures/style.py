"""The look of all figures: colours, markers, sizes, numbers, and page layout in inches.

Figures must work in print and for colour-blind readers: a series differs in colour, marker and line style at once, and
its name stands beside it. Everything is placed in inches from measured text, so that nothing overlaps or is cut off,
however many series there are.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, Locator, NullLocator

from ptbench.stats.estimates import Estimate

# Okabe and Ito's colour-blind safe palette without its yellow, which vanishes on white paper.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*")
LINES = ("-", (0, (5, 1.6)), (0, (1.2, 1.4)), (0, (6, 1.5, 1.2, 1.5)), (0, (3, 1.2, 1.2, 1.2, 1.2, 1.2)))

BASE_SIZE = 10.0
LABEL_SIZE = 9.5
CAPTION_SIZE = 8.5
TITLE_SIZE = 12.0
LINE_HEIGHT = 1.35  # line height as a multiple of the font size
LINE_SPACING = LINE_HEIGHT / 1.164  # line height in matplotlib's unit, the line height of the font DejaVu Sans
MARGIN = 0.2  # inches around everything on a page

_SETTINGS = {
    "figure.dpi": 100,
    "font.family": "DejaVu Sans",  # a font that comes with matplotlib, so that figures are the same on every machine
    "font.size": BASE_SIZE,
    "axes.labelsize": BASE_SIZE,
    "axes.titlesize": BASE_SIZE + 0.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.labelsize": LABEL_SIZE,
    "ytick.labelsize": LABEL_SIZE,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "lines.markersize": 6,
    "errorbar.capsize": 2.5,
    "text.parse_math": False,  # a "$" in text is literal and begins no formula, as in a scene named "a$b$c"
    "svg.hashsalt": "ptbench",  # a constant salt for ids in an SVG, which are otherwise random
    "svg.fonttype": "none",  # text stays text in an SVG: a quarter of the size, and searchable
}


@contextmanager
def applied() -> Iterator[None]:
    """Applies ptbench's settings to matplotlib's defaults, so that a user's matplotlibrc cannot change a figure."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        yield


@dataclass(frozen=True)
class Look:
    """The colour, marker and line style of a series."""

    colour: str
    marker: str
    line: object


def look(index: int) -> Look:
    """The look of the index-th series: 7 colours, 12 markers and 5 line styles, so that the first 12 looks differ."""
    return Look(COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)], LINES[index % len(LINES)])


_MEASURING = FigureCanvasAgg(Figure(dpi=100))


def text_width(text: str, size: float, weight: str = "normal") -> float:
    """The width of a line of text in inches."""
    font = FontProperties(family="DejaVu Sans", size=size, weight=weight)
    width, _, _ = _MEASURING.get_renderer().get_text_width_height_descent(text, font, False)
    return width / 100


@cache
def _character_width(character: str, size: float, weight: str) -> float:
    # The width of a character is measured between two x, since matplotlib gives a lone space no width.
    return text_width(f"x{character}x", size, weight) - text_width("xx", size, weight)


def _may_exceed(text: str, size: float, weight: str, width: float) -> bool:
    """Whether a text may be wider than `width`: a fast upper bound from its characters, with a margin for kerning."""
    return 1.1 * sum(_character_width(character, size, weight) for character in text) > width


def ticks(axis: Axis, locator: Locator) -> None:
    """Sets plain numbers as ticks at `locator`'s positions, without minor ticks."""
    axis.set_major_locator(locator)
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def widest(texts: Iterable[str], weight: str = "normal") -> float:
    """The width in inches of the widest label."""
    return max(text_width(text, LABEL_SIZE, weight) for text in texts)


def room(low: float, high: float, share: float) -> float:
    """The margin beyond the ends of an axis: a fraction of its span, or of the value if there is only one."""
    return share * ((high - low) or abs(high) or 1.0)


def text_height(size: float, lines: int = 1) -> float:
    """The height in inches of lines of text; `size` in points."""
    return lines * size * LINE_HEIGHT / 72


def wrapped(text: str, size: float, width: float, weight: str = "normal") -> list[str]:
    """Wraps `text` to lines of `width` inches; a word too long for a line is broken."""
    lines: list[str] = []
    for paragraph in text.split("\n"):
        line = ""
        for word in paragraph.split():
            while _may_exceed(word, size, weight, width) and text_width(word, size, weight) > width:
                fits = max(n for n in range(1, len(word) + 1) if n == 1 or text_width(word[:n], size, weight) <= width)
                if line:
                    lines.append(line)
                    line = ""
                lines.append(word[:fits])
                word = word[fits:]
            longer = f"{line} {word}" if line else word
            # Measuring text dominates the time of a page, so words are measured only near the end of a line.
            if line and _may_exceed(longer, size, weight, width) and text_width(longer, size, weight) > width:
                lines.append(line)
                longer = word
            line = longer
        lines.append(line)
    return lines


class Page:
    """A page with a title above, a caption below and a body between, in which axes are placed in inches."""

    def __init__(self, width: float, body_height: float, title: str, caption: str):
        inner = width - 2 * MARGIN
        titles = wrapped(title, TITLE_SIZE, inner, "bold")
        captions = wrapped(caption, CAPTION_SIZE, inner)
        self.width, self.body_height = width, body_height
        self.caption_height = text_height(CAPTION_SIZE, len(captions))
        title_height = text_height(TITLE_SIZE, len(titles))
        self.bottom = MARGIN + self.caption_height + 0.12
        self.height = self.bottom + body_height + 0.1 + title_height + MARGIN
        self.figure = Figure(figsize=(width, self.height))
        FigureCanvasAgg(self.figure)
        self.text(
            MARGIN, self.height - MARGIN - self.bottom, "\n".join(titles), size=TITLE_SIZE, weight="bold", va="top"
        )
        self.text(MARGIN, -0.12, "\n".join(captions), size=CAPTION_SIZE, va="top")

    def text(self, x: float, y: float, text: str, **properties) -> None:
        """Draws text at a position in inches from the body's lower left corner."""
        properties.setdefault("linespacing", LINE_SPACING)
        self.figure.text(x / self.width, (y + self.bottom) / self.height, text, **properties)

    def axes(self, left: float, bottom: float, width: float, height: float, **options) -> Axes:
        """Makes axes whose lower left corner is given in inches from the body's."""
        return self.figure.add_axes(
            (left / self.width, (bottom + self.bottom) / self.height, width / self.width, height / self.height),
            **options,
        )


def panel_grid(
    page_title: str,
    caption: str,
    titles: Sequence[str],
    labels: Sequence[Sequence[str]],
    *,
    label_width: float,
    left: float,
    gap: float,
    plot_widths: tuple[float, float],
    least_height: float,
    y_label: str,
) -> tuple[Page, list[Axes]]:
    """Makes a page of panels, in two columns if there are several, with room for labels at the right of each.

    `labels` are wrapped label lines by panel; `plot_widths` are the widths with one and with two columns.
    """
    columns = 1 if len(titles) == 1 else 2
    rows = math.ceil(len(titles) / columns)
    right = LABEL_GAP + label_width + 0.1
    plot_width = plot_widths[columns - 1]
    label_height = max(sum(text_height(LABEL_SIZE, text.count("\n") + 1) for text in texts) for texts in labels)
    height = max(least_height, 1.12 * label_height)
    width = left + columns * (plot_width + right) + (columns - 1) * gap + MARGIN
    wrapped_titles = [wrapped(title, BASE_SIZE + 0.5, plot_width + right - 0.1, "bold") for title in titles]
    block = 0.3 + text_height(BASE_SIZE + 0.5, max(map(len, wrapped_titles)) - 1) + height + 0.62
    page = Page(width, rows * block, page_title, caption)
    panels = []
    for index, title in enumerate(wrapped_titles):
        column, row = index % columns, index // columns
        x = left + column * (plot_width + right + gap)
        axes = page.axes(x, (rows - 1 - row) * block + 0.58, plot_width, height)
        axes.set_title("\n".join(title), linespacing=LINE_SPACING)
        if column == 0:
            axes.set_ylabel(y_label)
        panels.append(axes)
    return page, panels


def spread(targets: Sequence[float], sizes: Sequence[float], low: float, high: float) -> list[float]:
    """Moves the centres `targets` as little as possible so that items of `sizes` stay apart and within [low, high].

    With each item's offset in a tight stack subtracted, "do not overlap" becomes "do not decrease", which the pool
    adjacent violators algorithm solves exactly.
    """
    order = sorted(range(len(targets)), key=lambda index: targets[index])
    offsets, edge = [], 0.0
    for index in order:
        offsets.append(edge + sizes[index] / 2)
        edge += sizes[index]
    pools: list[list[float]] = []  # stacks of touching labels, each as [sum of wanted bottoms, number of labels]
    for index, offset in zip(order, offsets, strict=True):
        pools.append([targets[index] - offset, 1])
        while len(pools) > 1 and pools[-2][0] / pools[-2][1] >= pools[-1][0] / pools[-1][1]:
            total, members = pools.pop()
            pools[-1][0] += total
            pools[-1][1] += members
    bottoms = [
        min(max(total / members, low), max(high - edge, low)) for total, members in pools for _ in range(members)
    ]
    placed = [0.0] * len(targets)
    for index, bottom, offset in zip(order, bottoms, offsets, strict=True):
        placed[index] = bottom + offset
    return placed


def label_lines(
    page: Page,
    axes: Axes,
    ends: Sequence[tuple[float, float]],
    labels: Sequence[str],
    looks: Sequence[Look],
    above: float = 0.1,
) -> None:
    """Writes each line's name to the right of the axes, with its marker and a leader to the line's last point.

    Names stand at most `above` inches over the axes. The axis limits must be final, as positions are in inches.
    """
    box = axes.get_position()
    right = box.x1 * page.width
    low, high = box.y0 * page.height, box.y1 * page.height
    dpi = page.figure.dpi
    points = [axes.transData.transform(end) / dpi for end in ends]
    sizes = [text_height(LABEL_SIZE, label.count("\n") + 1) * 1.05 for label in labels]
    heights = spread([point[1] for point in points], sizes, low - 0.1, high + above)
    for point, height, label, style in zip(points, heights, labels, looks, strict=True):
        leader_x = np.array([point[0] + 0.05, right + 0.1, right + 0.26]) / page.width
        leader_y = np.array([point[1], height, height]) / page.height
        add = page.figure.add_artist
        add(_line(leader_x, leader_y, style, linewidth=0.7, linestyle=":", alpha=0.8))
        add(_line([(right + 0.32) / page.width], [height / page.height], style, marker=style.marker, linestyle=""))
        page.figure.text(
            (right + 0.42) / page.width,
            height / page.height,
            label,
            size=LABEL_SIZE,
            va="center",
            linespacing=LINE_SPACING,
        )


def marker_at(page: Page, x: float, y: float, style: Look) -> Line2D:
    """A marker in front of a name, at a position in inches from the body's lower left corner."""
    return _line([x / page.width], [(y + page.bottom) / page.height], style, marker=style.marker, linestyle="")


def draw_line(axes: Axes, xs: Sequence[float], estimates: Sequence[Estimate], style: Look) -> None:
    """Draws a line through medians, with their confidence intervals."""
    values = [estimate.value for estimate in estimates]
    axes.plot(xs, values, color=style.colour, marker=style.marker, linestyle=style.line, zorder=3, clip_on=False)
    whiskered = [(x, e) for x, e in zip(xs, estimates, strict=True) if e.low is not None and e.high is not None]
    if whiskered:
        axes.errorbar(
            [x for x, _ in whiskered],
            [e.value for _, e in whiskered],
            # An error bar's length must be at least 0: rounding may put the median outside its percentile interval.
            yerr=[[max(e.value - e.low, 0) for _, e in whiskered], [max(e.high - e.value, 0) for _, e in whiskered]],
            fmt="none",
            ecolor=style.colour,
            elinewidth=1.1,
            zorder=4,
        )


def draw_ring(axes: Axes, x: float, y: float, style: Look) -> None:
    """Draws a ring around a point that the caption mentions."""
    axes.plot([x], [y], marker="o", markersize=13, markerfacecolor="none", markeredgecolor=style.colour, zorder=5)


def draw_row(axes: Axes, y: float, estimate: Estimate, style: Look) -> None:
    """Draws a median with its interval in a horizontal row."""
    if estimate.low is not None and estimate.high is not None:
        axes.plot([estimate.low, estimate.high], [y, y], color=style.colour, linewidth=1.4, zorder=3)
        axes.plot([estimate.low, estimate.high], [y, y], color=style.colour, linestyle="", marker="|", zorder=3)
    axes.plot([estimate.value], [y], color=style.colour, linestyle="", marker=style.marker, zorder=4, clip_on=False)


LABEL_GAP = 0.42  # inches between the axes and the label of a line


def _line(x, y, style: Look, **properties) -> Line2D:
    return Line2D(x, y, color=style.colour, **properties)
