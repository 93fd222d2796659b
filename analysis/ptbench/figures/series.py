"""Any quantity as lines over a number, in panels of one scale, logarithmic except where y begins at 0.

`lines` draws times and their ratios to a baseline; this module draws other quantities: rates, ratios, totals.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from ptbench.figures import style
from ptbench.stats.estimates import Estimate
from ptbench.studies.notes import Note

_LEGEND_WIDTH = 1.7  # inches of width in the legend beyond which a line's name is wrapped
_TICKS = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class Series:
    """One line of a panel; `rings` are points that the caption mentions."""

    label: str
    xs: tuple[float, ...]
    values: tuple[Estimate, ...]
    rings: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Panel:
    """One panel's lines, which share axes."""

    title: str
    series: tuple[Series, ...]


@dataclass(frozen=True)
class Data:
    """The contents of a page of series."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    order: tuple[str, ...]  # labels of the lines; each keeps its colour and marker in all panels
    panels: tuple[Panel, ...]
    x_label: str
    y_label: str
    x_ticks: dict[float, str]
    one: bool = False  # whether to draw a line at y = 1
    linear: bool = False  # whether the y axis is linear and begins at 0


def draw(data: Data) -> Figure:
    """Draws the page of series, whose panels share both scales."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    words = [style.text_width(word, style.LABEL_SIZE) for label in data.order for word in label.split()]
    width = max(_LEGEND_WIDTH, *words) + 0.01
    labels = {label: "\n".join(style.wrapped(label, style.LABEL_SIZE, width)) for label in data.order}
    label_width = max(style.text_width(part, style.LABEL_SIZE) for text in labels.values() for part in text.split("\n"))
    page, panels = style.panel_grid(
        data.title,
        data.caption,
        [panel.title for panel in data.panels],
        [[labels[one.label] for one in panel.series] for panel in data.panels],
        label_width=label_width,
        left=0.95,
        gap=0.35,
        plot_widths=(4.6, 2.75),
        least_height=2.5,
        y_label=data.y_label,
    )
    values = [end for panel in data.panels for one in panel.series for e in one.values for end in _ends(e)]
    for axes, panel in zip(panels, data.panels, strict=True):
        for one in panel.series:
            style.draw_line(axes, one.xs, one.values, looks[one.label])
            for x, y in one.rings:
                style.draw_ring(axes, x, y, looks[one.label])
        if data.one:
            axes.axhline(1, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        _scale_x(axes, data, panel)
        _scale_y(axes, [*values, 1.0] if data.one else values, data.linear)
        axes.grid(axis="y")
        axes.set_xlabel(data.x_label)
        style.label_lines(
            page,
            axes,
            [(one.xs[-1], one.values[-1].value) for one in panel.series],
            [labels[one.label] for one in panel.series],
            [looks[one.label] for one in panel.series],
            above=0.0,
        )
    return page.figure


def _ends(estimate: Estimate) -> list[float]:
    return [end for end in (estimate.value, estimate.low, estimate.high) if end is not None]


def _scale_x(axes: Axes, data: Data, panel: Panel) -> None:
    own = {x for one in panel.series for x in one.xs}
    xs = sorted({x for panel in data.panels for one in panel.series for x in one.xs})
    if xs[0] == 0 and len(xs) > 1:
        axes.set_xscale("symlog", base=2, linthresh=xs[1], linscale=1)
        axes.set_xlim(-0.2 * xs[1], xs[-1] * 1.15)
    else:
        axes.set_xscale("log")
        margin = max((xs[-1] / xs[0]) ** 0.06, 1.1)
        axes.set_xlim(xs[0] / margin, xs[-1] * margin)
    axes.xaxis.set_major_locator(FixedLocator([x for x in data.x_ticks if x in own]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: data.x_ticks.get(x, f"{x:g}")))


def _scale_y(axes: Axes, values: Sequence[float], linear: bool) -> None:
    if linear:
        axes.set_ylim(0, 1.06 * max(values))
        axes.yaxis.set_major_locator(MaxNLocator(6))
        return
    low, high = min(values) / 1.15, max(values) * 1.15
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    style.ticks(axes.yaxis, FixedLocator(ticks_between(low, high)))


def ticks_between(low: float, high: float) -> list[float]:
    """Round ticks of a logarithmic axis: 1, 2, 5 of each decade; powers of ten on a long axis, tenths on a short."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    if high / low < 4:
        step = 0.1 if high - low < 1 else 0.25 if high - low < 2 else 0.5
        return [round(step * n, 10) for n in range(math.ceil(low / step), math.floor(high / step) + 1)]
    multiples = _TICKS if high / low < 2000 else _TICKS[:1]
    ticks = [float(f"{multiple}e{decade}") for decade in decades for multiple in multiples]
    return [tick for tick in ticks if low <= tick <= high]


def crossing(build: tuple[float, float], slope: tuple[float, float]) -> float | None:
    """The n > 0 at which build[0] + slope[0] n equals build[1] + slope[1] n; None where the two do not cross."""
    if slope[0] == slope[1]:
        return None
    n = (build[1] - build[0]) / (slope[0] - slope[1])
    return n if n > 0 else None


def count_text(count: float) -> str:
    """A number of triangles in short: 262k, 2.1M."""
    if count >= 1e6:
        return f"{count / 1e6:.2g}M"
    return f"{count / 1e3:.3g}k" if count >= 1e4 else f"{count:g}"
