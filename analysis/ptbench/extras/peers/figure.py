"""The figure of a `peers` run: variance over time per sample, one panel per scene, with grey lines of equal efficiency.

Peers whose picture does not agree with the reference are not drawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from ptbench.errors import NotDrawable
from ptbench.extras.peers.document import Scene, scenes_of
from ptbench.figures import style
from ptbench.figures.series import ticks_between
from ptbench.stats.estimates import INTERVAL_TEXT, Estimate

_LEGEND_WIDTH = 1.8  # inches of width in the legend beyond which a peer's name is wrapped
_EQUAL = "#c8c8c8"


@dataclass(frozen=True)
class Point:
    """The point of one renderer in a scene, time against variance."""

    label: str
    time: Estimate
    variance: Estimate


@dataclass(frozen=True)
class Data:
    """The contents of the figure of variance against time per sample."""

    caption: str
    order: tuple[str, ...]  # labels of the peers; each keeps its marker and colour in all panels
    panels: tuple[tuple[str, tuple[Point, ...]], ...]


def collect(document: dict) -> Data:
    """The comparable peers whose images have noise; raises NotDrawable."""
    panels = tuple((scene.name.rpartition("/")[2], _points(scene)) for scene in scenes_of(document))
    panels = tuple((name, points) for name, points in panels if points)
    if not panels:
        raise NotDrawable("no peer has times and a picture that agrees, with a variance above 0")
    context, settings = document["context"], document["settings"]
    width, height = settings["resolution"]
    caption = (
        f"{context['device']}; {width}×{height} pixels, backend {settings['backend']}. Left and down is better; along "
        "a grey line the efficiency is the same, and each is twice as efficient as the one above it. Times: medians of "
        f"{settings['rounds']} rounds, of ptbench render wall time, of Mitsuba's compiled variants the execution of "
        f"kernels alone. Bars: {INTERVAL_TEXT}; of variances over {settings['seeds']} seeds; mostly hidden by the "
        f"marker. {context['ptbench.version']}, {context['date'][:10]}."
    )
    order = dict.fromkeys(point.label for _, points in panels for point in points)
    return Data(caption, tuple(order), panels)


def _points(scene: Scene) -> tuple[Point, ...]:
    points = (Point(peer.name, peer.measured.time, peer.measured.noise) for peer in scene.peers if peer.compares)
    return tuple(point for point in points if point.variance.value > 0)


def draw(data: Data) -> Figure:
    """Draws the page of variance against time per sample, in which each panel has its own scales."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    labels = {label: "\n".join(style.wrapped(label, style.LABEL_SIZE, _LEGEND_WIDTH)) for label in data.order}
    label_width = max(style.text_width(part, style.LABEL_SIZE) for text in labels.values() for part in text.split("\n"))
    page, panels = style.panel_grid(
        "Variance and time of a sample: ptbench and other renderers",
        data.caption,
        [name for name, _ in data.panels],
        [[labels[point.label] for point in points] for _, points in data.panels],
        label_width=label_width,
        left=0.95,
        gap=0.35,
        plot_widths=(4.6, 2.75),
        least_height=2.6,
        y_label="Variance of a sample a pixel (log scale)",
    )
    for axes, (_, points) in zip(panels, data.panels, strict=True):
        _scale(axes, points)
        for point in points:
            _mark(axes, point, looks[point.label])
        style.label_lines(
            page,
            axes,
            [(point.time.value, point.variance.value) for point in points],
            [labels[point.label] for point in points],
            [looks[point.label] for point in points],
            above=0.0,
        )
    return page.figure


def _mark(axes: Axes, point: Point, look: style.Look) -> None:
    x, y = point.time, point.variance
    for estimate, along_x in ((x, True), (y, False)):
        if estimate.low is not None and estimate.high is not None:
            ends = [estimate.low, estimate.high]
            axes.plot(ends if along_x else [x.value] * 2, [y.value] * 2 if along_x else ends, color=look.colour, lw=1.2)
    axes.plot([x.value], [y.value], color=look.colour, marker=look.marker, linestyle="", zorder=3)


def _scale(axes: Axes, points: Sequence[Point]) -> None:
    xs, ys = ([getattr(point, name) for point in points] for name in ("time", "variance"))
    x_ends, y_ends = _limits(xs), _limits(ys)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*x_ends)
    axes.set_ylim(*y_ends)
    for axis, ends in ((axes.xaxis, x_ends), (axes.yaxis, y_ends)):
        style.ticks(axis, FixedLocator(ticks_between(*ends)))
    axes.set_xlabel("Time of a sample a pixel, ms (log scale)")
    # Each diagonal guide line joins points of equal variance times time, half that of the next line.
    line = np.array(x_ends)
    low, high = (float(np.log2(x * y)) for x, y in zip(x_ends, y_ends, strict=True))
    for power in range(round(low), round(high) + 1):
        axes.plot(line, 2.0**power / line, color=_EQUAL, linewidth=0.6, zorder=0)


def _limits(estimates: Sequence[Estimate]) -> tuple[float, float]:
    ends = [end for one in estimates for end in (one.value, one.low, one.high) if end is not None and end > 0]
    margin = max((max(ends) / min(ends)) ** 0.08, 1.2)
    return min(ends) / margin, max(ends) * margin
