"""Time per sample per pixel over a parameter: one line per choice, a panel per scene or family, ratios below."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import (
    FixedLocator,
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    MultipleLocator,
    NullFormatter,
)

from ptbench.figures import style
from ptbench.stats.estimates import Estimate
from ptbench.studies.crossover import Crossover, crossover_of
from ptbench.studies.groups import Parts
from ptbench.studies.notes import Note
from ptbench.studies.rows import Row

# Ratio of the largest to the least time or ratio from which on an axis is logarithmic, to tell fast choices apart.
_LOG_FROM = 5.0
_RATIO_HEIGHT, _LOG_RATIO_HEIGHT = 1.35, 2.0  # inches: height of the ratio panel, linear or logarithmic
_RATIO_TICKS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.3, 1.5, 2, 3, 4, 5, 7, 10)
# Ticks of a logarithmic axis, as (ratio of its ends up to which to use them, mantissas); beyond all, powers of ten.
_LOG_STEPS = ((3, (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8)), (6, (1, 2, 3, 5, 7)), (20, (1, 2, 3, 5)), (200, (1, 2, 5)))
_LEGEND_WIDTH, _WIDEST_LEGEND = 1.9, 2.6  # legend's width in inches: to wrap at, and most for one word


@dataclass(frozen=True)
class Line:
    """The line of one choice in one panel."""

    label: str
    is_baseline: bool
    xs: tuple[int, ...]
    times: tuple[Estimate, ...]
    ratios: tuple[Estimate | None, ...]
    crossover: Crossover | None = None


@dataclass(frozen=True)
class Panel:
    """A panel's lines of times over a parameter, in one scene or family."""

    title: str
    lines: tuple[Line, ...]

    @property
    def xs(self) -> list[int]:
        """All parameter values in a panel, in ascending order."""
        return sorted({x for line in self.lines for x in line.xs})


@dataclass(frozen=True)
class Abscissa:
    """The parameter along a page's x axis; `ticks` names values that are not shown as numbers."""

    quantity: str
    unit: str
    ticks: dict[int, str]
    log: bool = False  # whether x is logarithmic however its values are spaced; x = 0 then stands left of all others

    def tick(self, x: float) -> str:
        """The label of a tick at a value."""
        return self.ticks.get(int(x), f"{x:g}")


@dataclass(frozen=True)
class Data:
    """The contents of a page of lines of times over a parameter."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    baseline: str  # baseline as "axis=choice"; empty where no choices are compared
    order: tuple[str, ...]
    panels: tuple[Panel, ...]
    abscissa: Abscissa
    log_times: bool = False  # whether times and ratios are logarithmic even over a small range


def panel_of(title: str, points: Sequence[tuple[int, Row]], parts: Parts, with_crossovers: bool = False) -> Panel:
    """Makes a panel of lines out of measured pairs (x, row)."""
    drawn = []
    for label in parts.order:
        of_line = sorted((p for p in points if parts.labels[p[1].cell.name] == label), key=lambda point: point[0])
        if of_line:
            is_baseline = of_line[0][1].is_baseline
            crossover = None
            if with_crossovers and not is_baseline:
                crossover = crossover_of(of_line, [x for x, _ in points])
            drawn.append(
                Line(
                    label=label,
                    is_baseline=is_baseline,
                    xs=tuple(x for x, _ in of_line),
                    times=tuple(row.estimate for _, row in of_line),
                    ratios=tuple(row.ratio for _, row in of_line),
                    crossover=crossover,
                )
            )
    return Panel(title, tuple(drawn))


def draw(data: Data) -> Figure:
    """Draws the page of lines, with times above and ratios below."""
    words = [style.text_width(word, style.LABEL_SIZE) for label in data.order for word in label.split()]
    legend_width = min(max(_LEGEND_WIDTH, *words), _WIDEST_LEGEND) + 0.01
    labels = {label: "\n".join(style.wrapped(label, style.LABEL_SIZE, legend_width)) for label in data.order}
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    label_width = max(style.text_width(part, style.LABEL_SIZE) for text in labels.values() for part in text.split("\n"))
    label_height = sum(style.text_height(style.LABEL_SIZE, text.count("\n") + 1) for text in labels.values())
    columns = 1 if len(data.panels) == 1 else 2
    panel_rows = math.ceil(len(data.panels) / columns)
    with_ratios = any(ratio is not None for panel in data.panels for line in panel.lines for ratio in line.ratios)

    left, gap = 1.0, 0.55
    right = style.LABEL_GAP + label_width + 0.1
    narrowest = 2.8 if data.log_times else 2.3
    plot_width = max((9.2 - 2 * style.MARGIN - left - columns * right - (columns - 1) * gap) / columns, narrowest)
    if columns == 1:
        plot_width = min(plot_width, 5.6)
    width = left + columns * (plot_width + right) + (columns - 1) * gap + style.MARGIN
    time_height, ratio_height, between = max(2.6, 1.15 * label_height), 0.0, 0.2
    if with_ratios:
        ratio_height = _LOG_RATIO_HEIGHT if data.log_times else _RATIO_HEIGHT
    titles = [
        style.wrapped(panel.title, style.BASE_SIZE + 0.5, plot_width + right - 0.1, "bold") for panel in data.panels
    ]
    more_title = style.text_height(style.BASE_SIZE + 0.5, max(map(len, titles)) - 1)
    block = 0.3 + more_title + time_height + (between + ratio_height if with_ratios else 0) + 0.58
    page = style.Page(width, panel_rows * block, data.title, data.caption)

    log_time = data.log_times or _needs_log(data)
    all_times = [bound for panel in data.panels for line in panel.lines for e in line.times for bound in _bounds(e)]
    all_ratios = [
        bound
        for panel in data.panels
        for line in panel.lines
        for e in line.ratios
        if e is not None
        for bound in _bounds(e)
    ]
    for index, panel in enumerate(data.panels):
        column, row = index % columns, index // columns
        x = left + column * (plot_width + right + gap)
        base = (panel_rows - 1 - row) * block + 0.58
        time_axes = page.axes(x, base + (ratio_height + between if with_ratios else 0), plot_width, time_height)
        _draw_times(time_axes, panel, looks)
        scale = _scale_x(time_axes, panel, data.abscissa, plot_width)
        _scale_times(time_axes, all_times, log_time)
        time_axes.set_title("\n".join(titles[index]), linespacing=style.LINE_SPACING)
        lowest = time_axes
        if with_ratios:
            time_axes.tick_params(labelbottom=False)
            lowest = page.axes(x, base, plot_width, ratio_height)
            _draw_ratios(lowest, panel, looks)
            _scale_x(lowest, panel, data.abscissa, plot_width)
            _scale_ratios(lowest, all_ratios, data.log_times)
        units = ", ".join(part for part in (data.abscissa.unit, scale) if part)
        lowest.set_xlabel(data.abscissa.quantity + (f" ({units})" if units else ""))
        if column == 0:
            time_axes.set_ylabel("Time (ms per spp" + (", log scale)" if log_time else ")"))
            if with_ratios:
                log_ratio = " (log)" if data.log_times else ""
                lowest.set_ylabel(f"Time relative\nto {data.baseline.split('=')[1]}{log_ratio}")
            for axes in (time_axes, lowest):
                axes.yaxis.set_label_coords(-0.53 / plot_width, 0.5)
        ends = [(line.xs[-1], line.times[-1].value) for line in panel.lines]
        style.label_lines(
            page,
            time_axes,
            ends,
            [labels[line.label] for line in panel.lines],
            [looks[line.label] for line in panel.lines],
            # Labels of lines start below the panel's title where the title is wide enough to reach them.
            above=0.1 if style.text_width(titles[index][-1], style.BASE_SIZE + 0.5, "bold") < plot_width else 0.0,
        )
    return page.figure


def _bounds(estimate: Estimate) -> tuple[float, ...]:
    return tuple(value for value in (estimate.value, estimate.low, estimate.high) if value is not None)


def _needs_log(data: Data) -> bool:
    for panel in data.panels:
        by_x: dict[int, list[float]] = {}
        for line in panel.lines:
            for x, time in zip(line.xs, line.times, strict=True):
                by_x.setdefault(x, []).append(time.value)
        if any(max(times) > _LOG_FROM * min(times) for times in by_x.values()):
            return True
    return False


def _draw_times(axes: Axes, panel: Panel, looks: dict[str, style.Look]) -> None:
    for line in panel.lines:
        style.draw_line(axes, line.xs, line.times, looks[line.label])
    axes.grid(axis="y")


def _draw_ratios(axes: Axes, panel: Panel, looks: dict[str, style.Look]) -> None:
    axes.axhline(1, color=looks_of_baseline(panel, looks).colour, linewidth=1.0)
    for line in panel.lines:
        known = [(x, ratio) for x, ratio in zip(line.xs, line.ratios, strict=True) if ratio is not None]
        if known:
            style.draw_line(axes, [x for x, _ in known], [r for _, r in known], looks[line.label])
        ringed = line.crossover.x if line.crossover and not line.crossover.is_first else None
        for x, ratio in known:
            if x == ringed:
                style.draw_ring(axes, x, ratio.value, looks[line.label])
    axes.grid(axis="y")


def looks_of_baseline(panel: Panel, looks: dict[str, style.Look]) -> style.Look:
    """The look of a panel's baseline; an arbitrary one where the panel has no baseline."""
    return next((looks[line.label] for line in panel.lines if line.is_baseline), style.look(0))


def _scale_x(axes: Axes, panel: Panel, abscissa: Abscissa, plot_width: float) -> str:
    """Sets ticks at measured x, on a log scale if asked for or if they are so spaced; returns the scale in words."""
    xs = panel.xs
    first, last = xs[0], xs[-1]
    scale = ""
    if len(xs) == 1:
        axes.set_xlim(first - 1, first + 1)
    elif first == 0 and abscissa.log and len(xs) > 2:
        # The x axis is linear from 0 to the smallest positive value, which is drawn two octaves right of 0.
        smallest = xs[1]
        axes.set_xscale("symlog", base=2, linthresh=smallest, linscale=1)
        axes.set_xlim(-0.15 * smallest, last * (last / smallest) ** 0.05)
        scale = "log scale right of 0"
    elif first > 0 and (abscissa.log or (last >= 8 * first and len({b - a for a, b in pairwise(xs)}) > 1)):
        axes.set_xscale("log", base=2)
        margin = (last / first) ** 0.05
        axes.set_xlim(first / margin, last * margin)
        scale = "log scale"
    else:
        margin = 0.05 * (last - first)
        axes.set_xlim(first - margin, last + margin)
    axes.xaxis.set_major_locator(FixedLocator(_apart(axes, xs, abscissa, plot_width)))
    axes.xaxis.set_minor_locator(FixedLocator(xs))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: abscissa.tick(x)))
    axes.xaxis.set_minor_formatter(NullFormatter())
    return scale


def _apart(axes: Axes, xs: list[int], abscissa: Abscissa, plot_width: float) -> list[int]:
    """The x values whose tick labels do not touch; the last value is always included."""
    low, high = axes.transData.transform([(axes.get_xlim()[0], 1), (axes.get_xlim()[1], 1)])[:, 0]
    kept: list[int] = []
    edge = math.inf
    for x in reversed(xs):
        place = (axes.transData.transform((x, 1))[0] - low) / (high - low) * plot_width
        half = style.text_width(abscissa.tick(x), style.LABEL_SIZE) / 2
        if place + half + 0.08 <= edge:
            kept.append(x)
            edge = place - half
    return kept[::-1]


def _scale_times(axes: Axes, values: list[float], log: bool) -> None:
    if log:
        _log_y(axes, values)
    else:
        axes.set_ylim(0, 1.06 * max(values))
        style.ticks(axes.yaxis, MaxNLocator(6))


def _scale_ratios(axes: Axes, values: list[float], log: bool) -> None:
    if max(values) > _LOG_FROM * min(values) or max(values) > _LOG_FROM:
        _log_y(axes, [*values, 1.0])
        return
    low, high = min([*values, 1.0]), max([*values, 1.0])
    # The axis of ratios spans at least 2 % on each side, so that half a per cent of noise does not fill the panel.
    if log:
        margin = max((high / low) ** 0.1, 1.02)
        axes.set_yscale("log")
        axes.set_ylim(low / margin, high * margin)
        style.ticks(axes.yaxis, FixedLocator(_ratio_ticks(low / margin, high * margin)))
    else:
        margin = max(0.1 * (high - low), 0.02)
        axes.set_ylim(low - margin, high + margin)
        # Each tick step divides 1, so the baseline at 1 always has a tick.
        steps = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
        step = next((step for step in steps if (high - low + 2 * margin) / step <= 5.5), steps[-1])
        style.ticks(axes.yaxis, MultipleLocator(step))


def _ratio_ticks(low: float, high: float) -> list[float]:
    """Round ratios as ticks, spaced for a logarithmic axis from `low` to `high`; 1 is always included."""
    apart = 0.11 * math.log(high / low)
    ticks = [1.0]
    for tick in sorted((tick for tick in _RATIO_TICKS if low <= tick <= high), key=lambda tick: abs(math.log(tick))):
        if all(abs(math.log(tick / other)) >= apart for other in ticks):
            ticks.append(tick)
    return sorted(ticks)


def _log_y(axes: Axes, values: list[float]) -> None:
    axes.set_yscale("log")
    low, high = min(values), max(values)
    axes.set_ylim(low / 1.25, high * 1.25)
    steps = next((steps for most, steps in _LOG_STEPS if high / low < most), (1,))
    style.ticks(axes.yaxis, LogLocator(subs=steps))
