"""The figure of error over the swept parameter: a panel per case and quantity, a line per formula, allowed errors."""

import math
from collections.abc import Iterable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from ptbench.figures import style
from ptbench.figures.declaration import StabilityFigure
from ptbench.figures.stability.panels import BOUNDS, LINES, Line, Panel, SweepPage, collect
from ptbench.stability.layout import number, short_power

__all__ = ["collect", "draw"]

_PLOT_WIDTH, _PLOT_HEIGHT, _LEFT, _GAP = 3.75, 2.25, 0.95, 0.85  # layout of a page's panels in inches
_BOUND_LINES = {"robust float": (0, (5, 2)), "robust double": (0, (1, 1.6))}


def looks() -> dict[str, style.Look]:
    """The colour and marker of each formula's line, the same in every panel."""
    return {label: style.look(index) for index, (label, _) in enumerate(LINES)}


def draw(data: SweepPage) -> Figure:
    """Draws a page of panels with errors over swept parameters, from the data of `collect`."""
    columns = 1 if len(data.panels) == 1 else 2
    rows = math.ceil(len(data.panels) / columns)
    block_width = _LEFT + _PLOT_WIDTH
    titles = [_title(panel, _PLOT_WIDTH + 0.5 * _GAP) for panel in data.panels]
    x_labels = [style.wrapped(panel.x_label, style.LABEL_SIZE, _PLOT_WIDTH + 0.3) for panel in data.panels]
    legend = list(_legend(data))
    width = max(columns * block_width + (columns - 1) * (_GAP - 0.35) + style.MARGIN + 0.3, 6.6)
    legend_rows = _legend_rows(legend, width - 2 * style.MARGIN)
    legend_height = 0.24 * len(legend_rows) + 0.1
    heights = []
    for row in range(rows):
        of_row = slice(row * columns, (row + 1) * columns)
        over = style.text_height(style.BASE_SIZE, max(map(len, titles[of_row]))) + 0.22
        under = 0.38 + style.text_height(style.LABEL_SIZE, max(map(len, x_labels[of_row])))
        heights.append((over, under))
    body = legend_height + sum(over + _PLOT_HEIGHT + under + 0.12 for over, under in heights)
    page = style.Page(width, body, data.title, data.caption)
    _draw_legend(page, legend_rows, body)
    top = body - legend_height
    for index, panel in enumerate(data.panels):
        over, under = heights[index // columns]
        x = _LEFT + (index % columns) * (block_width + _GAP - 0.35)
        axes = page.axes(x, top - over - _PLOT_HEIGHT, _PLOT_WIDTH, _PLOT_HEIGHT)
        for number_of_line, line in enumerate(titles[index]):
            y = top - over + 0.1 + style.text_height(style.BASE_SIZE, len(titles[index]) - number_of_line - 1)
            weight = "bold" if line in _head(panel, _PLOT_WIDTH + 0.5 * _GAP) else "normal"
            page.text(x - 0.3, y, line, size=style.BASE_SIZE, weight=weight, va="bottom")
        _draw_panel(axes, panel)
        axes.set_xlabel("\n".join(x_labels[index]), size=style.LABEL_SIZE, linespacing=style.LINE_SPACING)
        axes.set_ylabel(panel.y_label, size=style.LABEL_SIZE)
        if index % columns == columns - 1:
            top -= over + _PLOT_HEIGHT + under + 0.12
    return page.figure


def _head(panel: Panel, width: float) -> list[str]:
    return style.wrapped(panel.title.partition("\n")[0], style.BASE_SIZE, width, "bold")


def _title(panel: Panel, width: float) -> list[str]:
    return [*_head(panel, width), *style.wrapped(panel.title.partition("\n")[2], style.BASE_SIZE, width)]


def _legend(data: SweepPage) -> Iterable[tuple[str, dict]]:
    for label, look in looks().items():
        if any(line.label == label for panel in data.panels for line in panel.lines):
            yield label, {"color": look.colour, "marker": look.marker, "linestyle": look.line}
    for label in BOUNDS:
        if any(line.label == label for panel in data.panels for line in panel.bounds):
            yield BOUNDS[label], {"color": "#777777", "linestyle": _BOUND_LINES[label]}


def _legend_rows(legend: Sequence[tuple[str, dict]], width: float) -> list[list[tuple[float, str, dict]]]:
    rows, x = [[]], 0.0
    for label, properties in legend:
        needed = 0.5 + style.text_width(label, style.LABEL_SIZE) + 0.25
        if rows[-1] and x + needed > width:
            rows.append([])
            x = 0.0
        rows[-1].append((x, label, properties))
        x += needed
    return rows


def _draw_legend(page: style.Page, rows: Sequence[Sequence[tuple[float, str, dict]]], body: float) -> None:
    for index, row in enumerate(rows):
        y = body - 0.24 * (index + 0.5)
        for x, label, properties in row:
            axes = page.axes(style.MARGIN + x, y - 0.08, 0.42, 0.16, xlim=(0, 2), ylim=(-1, 1))
            axes.set_axis_off()
            axes.plot([0, 1, 2], [0, 0, 0], markevery=[1], **properties)
            page.text(style.MARGIN + x + 0.5, y, label, size=style.LABEL_SIZE, va="center")


class _Abscissa:
    """The x axis of a sweep: positive values by logarithm with 0 a step to the left; linear if any is negative."""

    def __init__(self, values: Sequence[float]):
        self.values = sorted(set(values))
        positive = [value for value in self.values if value > 0]
        self.is_log = self.values[0] >= 0 and len(positive) > 1 and max(positive) > 2 * min(positive)
        self._zero = 0.0
        if self.is_log and len(positive) < len(self.values):
            span = math.log10(max(positive) / min(positive))
            self._zero = math.log10(min(positive)) - max(0.15 * span, 0.2)

    def at(self, value: float) -> float:
        return value if not self.is_log else self._zero if value == 0 else math.log10(value)

    def set(self, axes: Axes) -> None:
        places = [self.at(value) for value in self.values]
        margin = 0.05 * (places[-1] - places[0])
        axes.set_xlim(places[0] - margin, places[-1] + margin)
        shown: list[tuple[float, str]] = []
        scale = _PLOT_WIDTH / (places[-1] - places[0] + 2 * margin)
        reach = -math.inf
        for place, value in zip(places, self.values, strict=True):
            half = 0.5 * style.text_width(number(value), style.LABEL_SIZE) + 0.06
            if place * scale - half >= reach:
                shown.append((place, number(value)))
                reach = place * scale + half
        axes.xaxis.set_major_locator(FixedLocator([place for place, _ in shown]))
        names = dict(shown)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda place, _: names.get(place, "")))
        axes.xaxis.set_minor_locator(FixedLocator([place for place in places if place not in names]))
        axes.xaxis.set_minor_formatter(NullFormatter())


def limits(panel: Panel) -> tuple[float, float]:
    """The y limits of a panel: a floor, where errors of 0 are drawn, and a ceiling for infinite ones."""
    drawn = [value for line in panel.lines for value in line.errors] + [
        b for line in panel.bounds for b in line.allowed
    ]
    known = [value for value in drawn if value > 0 and math.isfinite(value)] or [1.0]
    low, high = math.floor(math.log10(min(known))), math.ceil(math.log10(max(known)))
    span = max(high - low, 1)
    return 10.0 ** (low - 0.12 * span), 10.0 ** (high + 0.12 * span)


def _power(value: float) -> str:
    return f"{value:g}" if 0.01 <= value < 1000 else short_power(f"{value:.0e}")


def _draw_panel(axes: Axes, panel: Panel) -> None:
    abscissa = _Abscissa([x for line in panel.lines for x in line.xs])
    floor, ceiling = limits(panel)
    abscissa.set(axes)
    axes.set_yscale("log")
    has_zero = any(0 in line.errors for line in panel.lines)
    has_infinite = any(math.inf in line.errors for line in panel.lines)
    step = (ceiling / floor) ** 0.06
    axes.set_ylim(floor / step if has_zero else floor, ceiling * step if has_infinite else ceiling)
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _power(value)))
    axes.grid(axis="y")
    for line in panel.bounds:
        if any(line.allowed):
            xs = [abscissa.at(x) for x in line.xs]
            shown = [allowed if allowed > 0 else math.nan for allowed in line.allowed]
            axes.plot(xs, shown, color="#777777", linestyle=_BOUND_LINES.get(line.label, "--"), linewidth=1.4, zorder=2)
    for line in panel.lines:
        _draw_errors(axes, line, abscissa, floor, ceiling)
    for value, height, text, away in ((0.0, floor, "0", 6), (math.inf, ceiling, "∞", -6)):
        xs = {x for line in panel.lines for x, error in zip(line.xs, line.errors, strict=True) if error == value}
        for x in sorted(xs):
            axes.annotate(
                text, (abscissa.at(x), height), (8, away), textcoords="offset points", size=style.BASE_SIZE,
                ha="center", va="center",
            )  # fmt: skip


def _draw_errors(axes: Axes, line: Line, abscissa: _Abscissa, floor: float, ceiling: float) -> None:
    look = looks()[line.label]
    xs = [abscissa.at(x) for x in line.xs]
    ys = [min(max(error, floor), ceiling) for error in line.errors]
    axes.plot(
        xs, ys, color=look.colour, marker=look.marker, linestyle=look.line, markersize=5.5, zorder=3, clip_on=False,
        markerfacecolor="none" if line.label == "robust float" else look.colour, label=line.label,
    )  # fmt: skip
    bars = [
        (x, y, e) for x, y, e, error in zip(xs, ys, line.standard_errors, line.errors, strict=True)
        if e > 0 and 0 < error < math.inf and math.isfinite(e)
    ]  # fmt: skip
    if bars:
        axes.errorbar(
            [x for x, _, _ in bars],
            [y for _, y, _ in bars],
            yerr=[[min(e, y - floor) for _, y, e in bars], [e for _, _, e in bars]],
            fmt="none",
            ecolor=look.colour,
            elinewidth=0.8,
            alpha=0.7,
            zorder=3,
        )


FIGURES = (StabilityFigure("sweep", collect, draw),)
