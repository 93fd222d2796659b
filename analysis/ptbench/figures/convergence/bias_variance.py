"""The figure of squared bias against the variance of one sample, one point per variant, both axes logarithmic.

Where no bias was found, an arrow points down from its upper limit: the true bias is below. A grey diagonal joins points
whose bias equals their noise at one number of samples.
"""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from ptbench.convergence.assessment import PLATEAU, Assessment
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.convergence.groups import groups_of, setting_of
from ptbench.figures.declaration import StudyFigure
from ptbench.io.asked import CONVERGENCE
from ptbench.io.cells import Result, Study
from ptbench.stats.estimates import Estimate
from ptbench.studies.notes import Note

_LEGEND_WIDTH = 2.0


@dataclass(frozen=True)
class Point:
    """The variance per sample and squared bias of a cell."""

    label: str
    sigma2: Estimate
    bias2: Estimate
    found: bool  # whether bias^2 is that of a plateau that was found; else it is only an upper limit
    limit: float


@dataclass(frozen=True)
class Panel:
    """The points of bias against variance in one scene and setting."""

    title: str
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Data:
    """The contents of the figure of bias against variance."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    order: tuple[str, ...]
    panels: tuple[Panel, ...]


def collect(result: Result, study: Study) -> Data:
    """Collects the points of bias against variance, a panel per scene and setting; raises NotDrawable."""
    found = groups_of(result, study)
    panels, dependent, noiseless = [], [], []
    for group in found.groups:
        points = []
        for one in group.members:
            if not one.curve.independent:
                dependent.append(group.names[one.cell.name])
            elif one.has_noise:
                points.append(_point(one, group.names[one.cell.name]))
            else:
                noiseless.append(group.names[one.cell.name])
        if points:
            panels.append(Panel(group.title, tuple(points)))
    if not panels:
        raise NotDrawable("no cell has both a bias² and a σ²")
    caption = (
        "Bars: 95 % t-intervals over seeds. Filled: a plateau was found. Hollow, with an arrow: none was found, the "
        "point is "
        "the upper end of the interval of bias² that the verdict rests on. Grey diagonals: bias² as large as the "
        "noise left "
        "after so many samples per pixel."
    )
    if dependent:
        caption += f" Without σ², samples not being independent: {', '.join(dict.fromkeys(dependent))}."
    if noiseless:
        caption += f" Without σ², more samples changing nothing: {', '.join(dict.fromkeys(noiseless))}."
    title = f"{study.title}: bias against variance" if study.title else "Bias against variance"
    text = "\n".join([caption, *found.remarks, setting_of(result, found)])
    return Data(title, text, found.notes, found.order, tuple(panels))


def _point(one: Assessment, label: str) -> Point:
    is_plateau = one.verdict.word == PLATEAU
    bias2 = one.fit.bias2
    # A plateau detected through the mean error may exceed the fitted bias^2.
    value = max(bias2.value, one.plateau_bias2)
    limit = max(one.bias2_family[1], 1e-30)
    return Point(label, one.fit.sigma2, Estimate(value, bias2.low, bias2.high, bias2.n), is_plateau, limit)


def draw(data: Data) -> Figure:
    """Draws the page of bias against variance, from the data of `collect`."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    wrapped = {label: "\n".join(style.wrapped(label, style.LABEL_SIZE, _LEGEND_WIDTH)) for label in data.order}
    label_width = max(
        style.text_width(part, style.LABEL_SIZE) for text in wrapped.values() for part in text.split("\n")
    )
    page, panels = style.panel_grid(
        data.title,
        data.caption,
        [panel.title for panel in data.panels],
        [[wrapped[point.label] for point in panel.points] for panel in data.panels],
        label_width=label_width,
        left=0.95,
        gap=0.75,
        plot_widths=(4.6, 3.3),
        least_height=3.3,
        y_label="bias² (log scale)",
    )
    for panel, axes in zip(data.panels, panels, strict=True):
        _draw_panel(page, axes, panel, looks, wrapped)
    return page.figure


def _height(point: Point) -> float:
    return point.bias2.value if point.found else point.limit


def _draw_panel(page: style.Page, axes, panel: Panel, looks: dict, wrapped: dict) -> None:
    xs = [bound for p in panel.points for bound in (p.sigma2.value, p.sigma2.low, p.sigma2.high) if bound and bound > 0]
    ys = [_height(point) for point in panel.points]
    axes.set_xscale("log")
    axes.set_yscale("log")
    margin = max((max(xs) / min(xs)) ** 0.12, 1.3)
    axes.set_xlim(min(xs) / margin, max(xs) * margin)
    axes.set_ylim(min(ys) / 4, max(ys) * 2.5)
    _draw_diagonals(axes, panel)
    for point in panel.points:
        look, y = looks[point.label], _height(point)
        axes.plot([point.sigma2.low, point.sigma2.high], [y, y], color=look.colour, linewidth=1.2, zorder=3)
        if point.found:
            low, high = point.bias2.low, point.bias2.high
            if low is not None and low > 0:
                axes.plot([point.sigma2.value] * 2, [low, high], color=look.colour, linewidth=1.2, zorder=3)
        else:
            arrow = {"arrowstyle": "->", "color": look.colour, "linewidth": 1.1}
            axes.annotate("", (point.sigma2.value, y / 2.6), (point.sigma2.value, y), arrowprops=arrow, zorder=3)
        face = look.colour if point.found else "white"
        axes.plot(
            [point.sigma2.value],
            [y],
            color=look.colour,
            marker=look.marker,
            markerfacecolor=face,
            linestyle="",
            zorder=4,
        )
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        steps = (1,) if high / low > 300 else (1, 2, 5) if high / low > 5 else (1, 1.5, 2, 3, 4, 5, 7)
        style.ticks(axis, LogLocator(subs=steps))
    axes.set_xlabel("σ² a sample (log scale)")
    ends = [(point.sigma2.value, _height(point)) for point in panel.points]
    labels = [wrapped[point.label] for point in panel.points]
    style.label_lines(page, axes, ends, labels, [looks[point.label] for point in panel.points], above=0.0)


def _draw_diagonals(axes, panel: Panel) -> None:
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    lowest, highest = math.log10(left / high), math.log10(right / low)
    powers = [power for power in range(12) if lowest < power < highest]
    for power in powers[:: max(1, math.ceil(len(powers) / 5))]:
        spp = 10.0**power
        axes.plot([left, right], [left / spp, right / spp], color="#dadada", linewidth=0.8, zorder=0)
        if low < left / spp < high / 1.3:
            height = np.log(left / spp * 1.08 / low) / np.log(high / low)
            small = {"size": style.CAPTION_SIZE - 1, "color": "#777777", "va": "bottom"}
            axes.text(0.01, height, f"{_count(spp)} spp", transform=axes.transAxes, **small)


def _count(spp: float) -> str:
    return f"{spp:g}" if spp < 1e6 else f"10^{round(math.log10(spp))}"


FIGURES = (StudyFigure(CONVERGENCE, collect, part="bias_variance", place=4),)
