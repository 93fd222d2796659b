"""Error against render time: one line per variant, one panel per scene, with the seeds' band and plateaus.

Both axes are logarithmic, so that noise that averages out is a straight line of slope -1/2, as the grey lines are. The
horizontal distance of two lines is how many times as long one variant takes.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from ptbench import numbers
from ptbench.convergence.assessment import Assessment
from ptbench.convergence.efficiency import render_times
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.convergence.groups import Group, groups_of, setting_of
from ptbench.figures.declaration import StudyFigure
from ptbench.io.asked import CONVERGENCE
from ptbench.io.cells import Result, Study
from ptbench.studies.notes import Note

_LEGEND_WIDTH = 2.0  # inches of width in the legend beyond which a line's name is wrapped
_SECONDS_FROM = 2e4  # milliseconds from which on the time axis is in seconds
_LOWEST_FLOOR = 100.0  # the reference's noise is left out of the plot if this many times below the lowest error
_GUIDE = "#dadada"


@dataclass(frozen=True)
class Line:
    """The error of one cell at each checkpoint."""

    label: str
    times: np.ndarray  # render time at each checkpoint in milliseconds
    errors: np.ndarray  # root of the mean over seeds of the dual squared error; NaN where that mean is negative
    low: np.ndarray  # lower end of the band over seeds that is drawn around the error, by checkpoint
    high: np.ndarray
    plateau: float | None
    plateau_is_bound: bool  # whether `plateau` is only a lower bound, which is told in words and not drawn as a line
    crossing_ms: float | None

    @property
    def has_drawn_plateau(self) -> bool:
        """Whether the plateau is drawn where the error stops falling."""
        return self.plateau is not None and not self.plateau_is_bound

    @property
    def drawn(self) -> np.ndarray:
        """The errors that a logarithmic axis can show; if all means are negative, the upper ends of the seeds' band."""
        errors, high = (values[~np.isnan(values)] for values in (self.errors, self.high))
        return errors if len(errors) else high


@dataclass(frozen=True)
class Panel:
    """The lines of error against time in one scene and setting."""

    title: str
    lines: tuple[Line, ...]
    floor: float | None  # root of the reference's variance, its noise; None: the reference is exact


@dataclass(frozen=True)
class Data:
    """The contents of the figure of error against time."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    order: tuple[str, ...]
    panels: tuple[Panel, ...]

    @property
    def in_seconds(self) -> bool:
        """Whether the time axis is in seconds instead of milliseconds."""
        return max(float(line.times[-1]) for panel in self.panels for line in panel.lines) >= _SECONDS_FROM


def collect(result: Result, study: Study) -> Data:
    """Collects the lines of error against time, a panel per scene and setting; raises NotDrawable."""
    found = groups_of(result, study)
    members = [one for group in found.groups for one in group.members]
    times, how = render_times(members)
    by_cell = {one.cell.name: ms for one, ms in zip(members, times, strict=True)}
    collected = [_panel(group, by_cell) for group in found.groups]
    panels = tuple(panel for panel in collected if any(len(line.drawn) for line in panel.lines))
    exact = [panel.title for panel in collected if panel not in panels]
    if not panels:
        raise NotDrawable(f"{', '.join(exact)}: no error is above 0, and the axis is logarithmic")
    seeds = numbers.span(one.curve.count for group in found.groups for one in group.members)
    caption = (
        f"Lines: root of the mean dual-reference squared error over {seeds} seeds, at checkpoints of 1, 2, 4, ... spp, "
        f"against {how}. Bands: lowest to highest seed. "
        "Grey lines: error falling as 1/√time. Dashed: plateaus that were found, from the time on at which noise is as "
        "large. Dotted: noise of the reference, which the dual error does not contain."
    )
    invisible = [panel.title for panel in panels if panel.floor is not None and panel.floor < _floor_limit(panel)]
    if invisible:
        caption += f" Below the axes: the reference's noise of {', '.join(dict.fromkeys(invisible))}."
    if exact:
        caption += f" Not drawn, since no error is above 0: {', '.join(exact)}."
    lines = [caption, *found.remarks, setting_of(result, found)]
    return Data(study.title or "Error against render time", "\n".join(lines), found.notes, found.order, panels)


def _panel(group: Group, times: Mapping[str, np.ndarray]) -> Panel:
    lines = tuple(_line(one, group.names[one.cell.name], times[one.cell.name]) for one in group.members)
    references = [one.curve.reference for one in group.members]
    variances = [reference.variance for reference in references if not reference.is_exact]
    floor = math.sqrt(max(variances)) if variances and max(variances) > 0 else None
    return Panel(group.title, lines, floor)


def _line(one: Assessment, label: str, times: np.ndarray) -> Line:
    curve = one.curve
    mean = curve.mean

    def root(squares: np.ndarray) -> np.ndarray:
        return np.sqrt(np.where(squares > 0, squares, np.nan))

    lowest = np.where(curve.mse.min(axis=0) > 0, curve.mse.min(axis=0), 1e-4 * np.abs(mean))
    crossing = one.crossing_spp
    return Line(
        label=label,
        times=times,
        errors=root(mean),
        low=root(lowest),
        high=root(curve.mse.max(axis=0)),
        plateau=one.verdict.plateau,
        plateau_is_bound=one.verdict.is_bound,
        crossing_ms=None if crossing is None else float(np.interp(crossing, curve.spp, times)),
    )


def _lowest(panel: Panel) -> float:
    errors = [float(line.drawn.min()) for line in panel.lines if len(line.drawn)]
    return min([*errors, *(line.plateau for line in panel.lines if line.has_drawn_plateau)])


def _floor_limit(panel: Panel) -> float:
    return _lowest(panel) / _LOWEST_FLOOR


def draw(data: Data) -> Figure:
    """Draws the page of error against time, from the data of `collect`."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    names = {
        (panel.title, line.label): "\n".join(style.wrapped(_name(line), style.LABEL_SIZE, _LEGEND_WIDTH))
        for panel in data.panels
        for line in panel.lines
    }
    label_width = max(style.text_width(part, style.LABEL_SIZE) for text in names.values() for part in text.split("\n"))
    page, panels = style.panel_grid(
        data.title,
        data.caption,
        [panel.title for panel in data.panels],
        [[names[panel.title, line.label] for line in panel.lines] for panel in data.panels],
        label_width=label_width,
        left=0.85,
        gap=0.7,
        plot_widths=(5.4, 3.6),
        least_height=3.6,
        y_label="Root mean square error (log scale)",
    )
    for panel, axes in zip(data.panels, panels, strict=True):
        _draw_panel(page, axes, panel, data, looks, names)
    return page.figure


def _name(line: Line) -> str:
    if not len(line.drawn):
        return f"{line.label}\nno error above 0"
    if line.plateau is None:
        return line.label
    return f"{line.label}\nplateau {'≥ ' if line.plateau_is_bound else ''}{numbers.figures(line.plateau, 3)}"


def _draw_panel(page: style.Page, axes: Axes, panel: Panel, data: Data, looks: dict, names: dict) -> None:
    unit = 1e-3 if data.in_seconds else 1.0
    axes.set_xscale("log")
    axes.set_yscale("log")
    first = min(float(line.times[0]) for line in panel.lines) * unit
    last = max(float(line.times[-1]) for line in panel.lines) * unit
    highest = max(float(np.nanmax(line.high)) for line in panel.lines if len(line.drawn))
    lowest = _lowest(panel)
    if panel.floor is not None and panel.floor >= _floor_limit(panel):
        lowest = min(lowest, panel.floor)
    axes.set_xlim(first / 1.4, last * 1.4)
    axes.set_ylim(lowest / 1.5, highest * 1.5)
    _draw_guides(axes)
    for line in panel.lines:
        look = looks[line.label]
        xs = line.times * unit
        axes.fill_between(xs, line.low, line.high, color=look.colour, alpha=0.16, linewidth=0, zorder=2)
        axes.plot(xs, line.errors, color=look.colour, marker=look.marker, markersize=4.5, linestyle=look.line, zorder=3)
        if line.has_drawn_plateau:
            start = first if line.crossing_ms is None else min(max(line.crossing_ms * unit, first), last)
            axes.plot(
                [start, last * 1.4],
                [line.plateau] * 2,
                color=look.colour,
                linewidth=1.1,
                linestyle=(0, (4, 3)),
                zorder=1,
            )
    if panel.floor is not None and panel.floor >= _floor_limit(panel):
        axes.axhline(panel.floor, color="#555555", linewidth=1.1, linestyle=(0, (1, 2)), zorder=1)
        axes.text(
            0.015, panel.floor * 1.04, "reference noise", transform=axes.get_yaxis_transform(), size=style.CAPTION_SIZE,
            color="#444444", va="bottom",
        )  # fmt: skip
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_locator(
            LogLocator(subs=(1,) if high / low > 300 else (1, 2, 5) if high / low > 8 else (1, 2, 3, 5, 7))
        )
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(
            LogLocator(subs=range(1, 10)) if high / low > 300 and high / low < 1e7 else NullLocator()
        )
        axis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
    axes.set_xlabel(f"Render wall time ({'s' if data.in_seconds else 'ms'}, log scale)")
    ends = [
        (float(line.times[-1]) * unit, float(line.drawn[-1]) if len(line.drawn) else lowest) for line in panel.lines
    ]
    labels = [names[panel.title, line.label] for line in panel.lines]
    style.label_lines(page, axes, ends, labels, [looks[line.label] for line in panel.lines], above=0.0)


def _draw_guides(axes: Axes) -> None:
    """Draws grey guide lines of slope -1/2, a factor of ten in time apart, below everything else."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    first = math.floor(math.log10(low**2 * left))
    for power in range(first, math.ceil(math.log10(high**2 * right)) + 1):
        ys = [math.sqrt(10.0**power / x) for x in (left, right)]
        axes.plot([left, right], ys, color=_GUIDE, linewidth=0.8, zorder=0, scalex=False, scaley=False)


FIGURES = (StudyFigure(CONVERGENCE, collect),)
