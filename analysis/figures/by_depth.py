"""Time per spp against path depth, one line a choice and one panel a scene, with the ratio to the baseline below.

Two figures ask this of two axes; what they share is here. Where a file has one depth only, lines would be lonely points
on top of each other, so the rows of the compaction figure are drawn instead.
"""

from __future__ import annotations

import math
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
    NullLocator,
)

from analysis import style
from analysis.errors import NotDrawable
from analysis.figures import rows as row_figure
from analysis.figures.caption import timing_caption
from analysis.results import Result, Study
from analysis.statistics import Estimate
from analysis.studies import QUESTIONS, Note, measure, notes_of, scenes_of, series_order

# Where one choice takes this many times another's time, a linear axis would press the fast ones flat.
_LOG_FROM = 5.0


@dataclass(frozen=True)
class Line:
    """One choice in one scene."""

    label: str
    is_baseline: bool
    depths: tuple[int, ...]
    times: tuple[Estimate, ...]
    ratios: tuple[Estimate | None, ...]


@dataclass(frozen=True)
class Panel:
    scene: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Data:
    title: str
    caption: str
    notes: tuple[Note, ...]
    baseline: str
    order: tuple[str, ...]
    panels: tuple[Panel, ...]


def collect(result: Result, study: Study, figure: str, default_title: str) -> Data | row_figure.Data:
    question = QUESTIONS[figure]
    rows = measure(result, study)
    notes = notes_of(result, study, rows)
    drawn = [row for row in rows if row.estimate is not None]
    if not drawn:
        raise NotDrawable("no cell has times: " + ("; ".join(note.full for note in notes) or "no samples"))
    title = study.title or default_title
    if all(len({row.cell.depth for row in drawn if row.cell.scene == scene}) == 1 for scene in scenes_of(drawn)):
        return row_figure.collect(result, study, figure, title)
    panels = []
    for scene in scenes_of(drawn):
        lines = []
        for label in series_order(drawn):
            of_line = sorted(
                (row for row in drawn if row.cell.scene == scene and row.label == label), key=lambda row: row.cell.depth
            )
            if of_line:
                lines.append(
                    Line(
                        label=label,
                        is_baseline=of_line[0].is_baseline,
                        depths=tuple(row.cell.depth for row in of_line),
                        times=tuple(row.estimate for row in of_line),
                        ratios=tuple(row.ratio for row in of_line),
                    )
                )
        panels.append(Panel(scene, tuple(lines)))
    caption = timing_caption(result, [row.cell for row in drawn], question, notes)
    return Data(
        title, caption, tuple(notes), f"{question.axis}={question.baseline}", tuple(series_order(drawn)), tuple(panels)
    )


def draw(data: Data | row_figure.Data) -> Figure:
    if isinstance(data, row_figure.Data):
        return row_figure.draw(data)
    labels = {label: "\n".join(style.wrapped(label, style.LABEL_SIZE, 1.9)) for label in data.order}
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    label_width = max(style.text_width(part, style.LABEL_SIZE) for text in labels.values() for part in text.split("\n"))
    label_height = sum(style.text_height(style.LABEL_SIZE, text.count("\n") + 1) for text in labels.values())
    columns = 1 if len(data.panels) == 1 else 2
    panel_rows = math.ceil(len(data.panels) / columns)
    with_ratios = any(ratio is not None for panel in data.panels for line in panel.lines for ratio in line.ratios)

    left, gap = 1.0, 0.55
    right = style.LABEL_GAP + label_width + 0.1
    plot_width = max((9.2 - 2 * style.MARGIN - left - columns * right - (columns - 1) * gap) / columns, 2.3)
    if columns == 1:
        plot_width = min(plot_width, 5.6)
    width = left + columns * (plot_width + right) + (columns - 1) * gap + style.MARGIN
    time_height, ratio_height, between = max(2.6, 1.15 * label_height), 1.35 if with_ratios else 0.0, 0.2
    block = 0.3 + time_height + (between + ratio_height if with_ratios else 0) + 0.58
    page = style.Page(width, panel_rows * block, data.title, data.caption)

    log_time = _needs_log(data)
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
        _scale_x(time_axes, panel, plot_width)
        _scale_times(time_axes, all_times, log_time)
        time_axes.set_title(panel.scene)
        lowest = time_axes
        if with_ratios:
            time_axes.tick_params(labelbottom=False)
            lowest = page.axes(x, base, plot_width, ratio_height)
            _draw_ratios(lowest, panel, looks)
            _scale_x(lowest, panel, plot_width)
            _scale_ratios(lowest, all_ratios)
        scale = ", log scale" if lowest.get_xscale() == "log" else ""
        lowest.set_xlabel(f"Path depth (ray segments{scale})")
        if column == 0:
            time_axes.set_ylabel("Time (ms per spp" + (", log scale)" if log_time else ")"))
            if with_ratios:
                lowest.set_ylabel(f"Time relative\nto {data.baseline.split('=')[1]}")
            for axes in (time_axes, lowest):
                axes.yaxis.set_label_coords(-0.53 / plot_width, 0.5)
        ends = [(line.depths[-1], line.times[-1].value) for line in panel.lines]
        style.label_lines(
            page,
            time_axes,
            ends,
            [labels[line.label] for line in panel.lines],
            [looks[line.label] for line in panel.lines],
        )
    return page.figure


def _bounds(estimate: Estimate) -> tuple[float, ...]:
    return tuple(value for value in (estimate.value, estimate.low, estimate.high) if value is not None)


def _needs_log(data: Data) -> bool:
    for panel in data.panels:
        by_depth: dict[int, list[float]] = {}
        for line in panel.lines:
            for depth, time in zip(line.depths, line.times, strict=True):
                by_depth.setdefault(depth, []).append(time.value)
        if any(max(times) > _LOG_FROM * min(times) for times in by_depth.values()):
            return True
    return False


def _draw_times(axes: Axes, panel: Panel, looks: dict[str, style.Look]) -> None:
    for line in panel.lines:
        style.draw_line(axes, line.depths, line.times, looks[line.label])
    axes.grid(axis="y")


def _draw_ratios(axes: Axes, panel: Panel, looks: dict[str, style.Look]) -> None:
    axes.axhline(1, color=looks_of_baseline(panel, looks).colour, linewidth=1.0)
    for line in panel.lines:
        known = [(depth, ratio) for depth, ratio in zip(line.depths, line.ratios, strict=True) if ratio is not None]
        if known:
            style.draw_line(axes, [d for d, _ in known], [r for _, r in known], looks[line.label])
    axes.grid(axis="y")


def looks_of_baseline(panel: Panel, looks: dict[str, style.Look]) -> style.Look:
    return next((looks[line.label] for line in panel.lines if line.is_baseline), style.look(0))


def _scale_x(axes: Axes, panel: Panel, plot_width: float) -> None:
    """Ticks at the depths that were measured; logarithmic where they are spaced so."""
    depths = sorted({depth for line in panel.lines for depth in line.depths})
    first, last = depths[0], depths[-1]
    if len(depths) == 1:
        axes.set_xlim(first - 1, first + 1)
    elif last >= 8 * first and len({b - a for a, b in pairwise(depths)}) > 1:
        axes.set_xscale("log", base=2)
        margin = (last / first) ** 0.05
        axes.set_xlim(first / margin, last * margin)
    else:
        margin = 0.05 * (last - first)
        axes.set_xlim(first - margin, last + margin)
    axes.xaxis.set_major_locator(FixedLocator(_apart(axes, depths, plot_width)))
    axes.xaxis.set_minor_locator(FixedLocator(depths))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda depth, _: f"{depth:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _apart(axes: Axes, depths: list[int], plot_width: float) -> list[int]:
    """The depths whose tick labels do not touch, the last one always among them."""
    low, high = axes.transData.transform([(axes.get_xlim()[0], 1), (axes.get_xlim()[1], 1)])[:, 0]
    kept: list[int] = []
    edge = math.inf
    for depth in reversed(depths):
        place = (axes.transData.transform((depth, 1))[0] - low) / (high - low) * plot_width
        half = style.text_width(str(depth), style.LABEL_SIZE) / 2
        if place + half + 0.08 <= edge:
            kept.append(depth)
            edge = place - half
    return kept[::-1]


def _scale_times(axes: Axes, values: list[float], log: bool) -> None:
    if log:
        _log_y(axes, values)
    else:
        axes.set_ylim(0, 1.06 * max(values))
        axes.yaxis.set_major_locator(MaxNLocator(6))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _scale_ratios(axes: Axes, values: list[float]) -> None:
    if max(values) > _LOG_FROM * min(values) or max(values) > _LOG_FROM:
        _log_y(axes, [*values, 1.0])
        return
    low, high = min([*values, 1.0]), max([*values, 1.0])
    # Half a per cent of noise should look like noise, not fill the panel.
    margin = max(0.1 * (high - low), 0.02)
    axes.set_ylim(low - margin, high + margin)
    # All these steps divide 1, so the baseline always has its tick.
    steps = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
    step = next((step for step in steps if (high - low + 2 * margin) / step <= 5.5), steps[-1])
    axes.yaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _log_y(axes: Axes, values: list[float]) -> None:
    axes.set_yscale("log")
    low, high = min(values), max(values)
    axes.set_ylim(low / 1.25, high * 1.25)
    steps = (1, 2, 5) if high / low < 200 else (1,)
    axes.yaxis.set_major_locator(LogLocator(subs=steps))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())
