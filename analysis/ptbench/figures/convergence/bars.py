"""Bar charts with intervals, one group of bars per scene: time to an error, efficiency, and checkpoint overhead."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from ptbench import numbers
from ptbench.convergence.assessment import PLATEAU
from ptbench.convergence.efficiency import (
    DISTURBED,
    EFFICIENCY_RULE,
    checkpoint_costs,
    compare,
    ends_beside_one,
    target_of,
    time_to,
)
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.convergence.groups import Group, Groups, groups_of, setting_of
from ptbench.figures.declaration import StudyFigure
from ptbench.io.asked import CONVERGENCE
from ptbench.io.cells import Result, Study
from ptbench.stats.estimates import INTERVAL_TEXT, Estimate
from ptbench.studies.notes import Note

_ROW, _HEAD, _GAP, _FOOT = 0.27, 0.34, 0.5, 0.6  # heights in inches: bar, group's heading, gap between groups, foot
_LOG_FROM = 8.0
_EVERY = 10**6  # more cells than any group has, as bar charts are not split into pages


@dataclass(frozen=True)
class Bar:
    """One bar of a figure; where `estimate` is infinite or None, `text` says so."""

    label: str
    estimate: Estimate | None
    text: str


@dataclass(frozen=True)
class Bars:
    """The bars of one scene and setting, under its title."""

    title: str
    bars: tuple[Bar, ...]


@dataclass(frozen=True)
class Data:
    """The contents of a page of bars, whose values all have the unit `unit`."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    order: tuple[str, ...]
    groups: tuple[Bars, ...]
    quantity: str
    heading: str
    unit: str = ""
    line_at: float | None = None
    from_line: bool = False  # whether the axis is logarithmic and bars begin at `line_at`
    zero_based: bool = True  # whether estimates are bars from 0, or from the end of a log axis; False: only intervals


def _data(found: Groups, groups: Sequence[Bars], title: str, caption: str, result: Result, **fields) -> Data:
    text = "\n".join([caption, *found.remarks, setting_of(result, found)])
    return Data(title, text, found.notes, found.order, tuple(groups), **fields)


def time_to_error(result: Result, study: Study) -> Data:
    """The bars of the time to the target error, one per cell; raises NotDrawable."""
    found = groups_of(result, study, _EVERY)
    groups = []
    exact = []
    for group in found.groups:
        target = target_of(group.members)
        if target is None:
            exact.append(group.title)
            continue
        timed = [(group.names[one.cell.name], time_to(one, target)) for one in group.members]
        if all(time is None for _, time in timed):
            raise NotDrawable(f"{group.title}: no time without checkpoints that is more than a few launches")
        bars = [Bar(label, time, _time_text(time)) for label, time in timed]
        groups.append(Bars(f"{group.title}, to an error of {target:g}", tuple(bars)))
    if not groups:
        raise NotDrawable(f"{', '.join(exact)}: no cell has an error above 0")
    caption = (
        "Render wall time until the root mean square error (plateau included) is the one named: the smallest round "
        f"one that every variant not yet at its plateau reached. {EFFICIENCY_RULE}"
    )
    if exact:
        caption += f" Not drawn, since no error is above 0: {', '.join(exact)}."
    title = _title(study, "time to a given error")
    fields = {"quantity": "Render wall time to the error", "unit": "ms", "heading": "ms [95 %]"}
    return _data(found, groups, title, caption, result, **fields)


def efficiency(result: Result, study: Study) -> Data:
    """The bars of efficiency against the baseline, one per cell; raises NotDrawable."""
    found = groups_of(result, study, _EVERY)
    groups = []
    for group in found.groups:
        bars = [_efficiency_bar(one, group) for one in group.members]
        groups.append(Bars(group.title, tuple(bars)))
    caption = f"Noise only, whatever a variant's plateau (marked where one was found). {EFFICIENCY_RULE}"
    title = _title(study, "efficiency relative to the baseline")
    fields = {"quantity": "Efficiency relative to the baseline", "heading": "relative [95 %]", "line_at": 1.0}
    return _data(found, groups, title, caption, result, **fields)


def _efficiency_bar(one, group: Group) -> Bar:
    label = group.names[one.cell.name]
    bound = "≥ " if one.verdict.is_bound else ""
    plateau = f", plateau {bound}{numbers.figures(one.verdict.plateau, 3)}" if one.verdict.word == PLATEAU else ""
    compared = compare(one, group.baseline)
    if compared is None:
        return Bar(label, None, "no noise to compare" + plateau)
    efficiency = compared.efficiency
    if efficiency is None:
        return Bar(label, Estimate(1.0, None, None, one.curve.count), "baseline" + plateau)
    ends = ends_beside_one(efficiency)
    mark = f", {DISTURBED}" if compared.doubt else ""
    text = f"{numbers.figures(efficiency.value, 3)}×{f' {ends}' if ends else ''}{mark}{plateau}"
    return Bar(label, efficiency, text)


def checkpoint_cost(result: Result, study: Study) -> Data:
    """The bars of time with checkpoints over time without, one per cell; raises NotDrawable."""
    found = groups_of(result, study, _EVERY)
    groups = []
    for group in found.groups:
        costs = checkpoint_costs(group.members)
        bars = [
            Bar(
                group.names[cost.cell.name],
                cost.ratio,
                " ".join(filter(None, (f"{numbers.ratio(cost.ratio.value)}×", cost.interval, cost.word))),
            )
            for cost in costs
        ]
        if bars:
            groups.append(Bars(group.title, tuple(bars)))
    if not groups:
        raise NotDrawable("no cell was also run without checkpoints")
    caption = (
        "The same variant, scene and spp, rendered with and without checkpoints: render wall time per spp of the "
        f"former over that of the latter. Intervals: {INTERVAL_TEXT}, both sides resampled. Within noise: the "
        "interval holds 1."
    )
    title = _title(study, "time with checkpoints against without")
    fields = {"quantity": "Time with checkpoints over time without", "heading": "ratio [95 %]", "line_at": 1.0}
    return _data(found, groups, title, caption, result, **fields, zero_based=False)


def _title(study: Study, what: str) -> str:
    return f"{study.title}: {what}" if study.title else what[0].upper() + what[1:]


def _time_text(time: Estimate | None) -> str:
    if time is None:
        return "not told"
    if not math.isfinite(time.value):
        sooner = time.low is not None and math.isfinite(time.low)
        return "never: plateau" + (f" (interval from {numbers.figures(time.low)})" if sooner else "")
    high = "never" if time.high is not None and not math.isfinite(time.high) else None
    if high:
        return f"{numbers.figures(time.value)} [{numbers.figures(time.low)}, {high}]"
    return f"{numbers.figures(time.value)} {numbers.interval(time.low, time.high)}"


def draw(data: Data) -> Figure:
    """Draws a page of bars with intervals."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}

    label_width = style.widest(bar.label for group in data.groups for bar in group.bars)
    title_width = style.widest((group.title for group in data.groups), "bold")
    text_width = max(
        style.widest(bar.text for group in data.groups for bar in group.bars), style.widest([data.heading], "bold")
    )
    left = style.MARGIN + label_width + 0.3
    right = 0.2 + text_width + style.MARGIN
    plot_width = max(9.2 - left - right, 3.0, style.MARGIN + title_width - left + 0.2)
    heights = [_HEAD + _ROW * len(group.bars) for group in data.groups]
    body = sum(heights) + _GAP * (len(heights) - 1) + _FOOT
    page = style.Page(left + plot_width + right, body, data.title, data.caption)
    top = body
    for group, height in zip(data.groups, heights, strict=True):
        axes = page.axes(left, top - height, plot_width, height - _HEAD)
        bounds = _bounds(group, data.line_at)
        log = data.from_line or (data.zero_based and max(bounds) > _LOG_FROM * min(bounds))
        start = _scale(axes, bounds, log, data.zero_based)
        start = data.line_at if data.from_line else start
        for index, bar in enumerate(group.bars):
            y = len(group.bars) - 1 - index
            centre = top - _HEAD - _ROW * (index + 0.5)
            page.text(left - 0.12, centre, bar.label, size=style.LABEL_SIZE, va="center", ha="right")
            page.text(left + plot_width + 0.2, centre, bar.text, size=style.LABEL_SIZE, va="center")
            if bar.estimate is not None:
                _draw_bar(axes, y, bar.estimate, start if data.zero_based else None, looks[bar.label])
        head = {"size": style.LABEL_SIZE, "weight": "bold", "va": "center"}
        page.text(style.MARGIN, top - _HEAD / 2, group.title, **head)
        page.text(left + plot_width + 0.2, top - _HEAD / 2, data.heading, **head)
        if data.line_at is not None:
            axes.axvline(data.line_at, color="#888888", linewidth=0.9, linestyle=(0, (4, 2)), zorder=1)
        axes.set_ylim(-0.5, len(group.bars) - 0.5)
        axes.yaxis.set_major_locator(NullLocator())
        axes.grid(axis="x")
        if group is data.groups[-1]:
            units = ", ".join(part for part in (data.unit, "log scale" if log else "") if part)
            axes.set_xlabel(data.quantity + (f" ({units})" if units else ""))
        top -= height + _GAP
    return page.figure


def _bounds(group: Bars, line_at: float | None) -> list[float]:
    known = [
        bound
        for bar in group.bars
        if bar.estimate is not None
        for bound in (bar.estimate.value, bar.estimate.low, bar.estimate.high)
        if bound is not None and math.isfinite(bound) and bound > 0
    ]
    return [*known, *([line_at] if line_at is not None else [])] or [1.0]


def _scale(axes: Axes, bounds: list[float], log: bool, zero_based: bool) -> float:
    """Sets the value axis, and returns where bars begin."""
    low, high = min(bounds), max(bounds)
    if log:
        axes.set_xscale("log")
        axes.set_xlim(low / 1.5, high * 1.4)
        fine = (1, 1.2, 1.5, 2, 3, 5, 7, 9) if high / low < 4 else (1, 2, 5)
        style.ticks(axes.xaxis, LogLocator(subs=fine if high / low < 100 else (1,)))
    elif zero_based:
        axes.set_xlim(0, 1.06 * high)
        style.ticks(axes.xaxis, MaxNLocator(5))
    else:
        margin = max(0.15 * (high - low), 0.01)
        axes.set_xlim(low - margin, high + margin)
        style.ticks(axes.xaxis, MaxNLocator(5))
    return axes.get_xlim()[0]


def _draw_bar(axes: Axes, y: float, estimate: Estimate, start: float | None, look: style.Look) -> None:
    """Draws a bar from `start`, or just its interval: a bar that does not begin at 0 would exaggerate differences."""
    end = axes.get_xlim()[1]
    if not math.isfinite(estimate.value):
        axes.barh(
            y, end - start, left=start, height=0.62, facecolor="none", edgecolor=look.colour, hatch="///", alpha=0.35
        )
        return
    if start is not None:
        length = estimate.value - start
        axes.barh(y, length, left=start, height=0.62, color=look.colour, alpha=0.3, linewidth=0, zorder=2)
    low, high = estimate.low, estimate.high
    if low is not None and high is not None:
        drawn = Estimate(estimate.value, low, high if math.isfinite(high) else end, estimate.n)
        style.draw_row(axes, y, drawn, look)
    else:
        style.draw_row(axes, y, estimate, look)


FIGURES = (
    StudyFigure(CONVERGENCE, time_to_error, part="time_to_error", place=2),
    StudyFigure(CONVERGENCE, efficiency, part="efficiency", place=3),
    StudyFigure(CONVERGENCE, checkpoint_cost, part="checkpoint_cost", place=5),
)
