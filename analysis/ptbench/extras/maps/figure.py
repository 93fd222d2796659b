"""The figure of a crossover map: the ratio as colour, cells as marks, the line of ratio 1 and its uncertainty band."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator
from scipy.interpolate import LinearNDInterpolator

from ptbench.extras.maps.measuring import Sheet
from ptbench.extras.maps.refining import ABOVE, BELOW, OPEN, spans_of, verdict_of
from ptbench.figures import style
from ptbench.numbers import figures
from ptbench.stats.estimates import CONFIDENCE

_PLOT, _LEFT, _FOOT, _BAR = 4.2, 0.85, 0.6, 1.1
_FINE = 240  # points along each axis of the grid on which the ratio is interpolated
_LEAST = math.log(1.05)  # least half-width of the colour range in ln(ratio), so that noise does not look like structure
_FIELD = LinearSegmentedColormap.from_list("ratio", ["#009E73", "#ffffff", "#D55E00"])
_MARKS = {BELOW: "v", OPEN: "o", ABOVE: "^"}


def draw(sheet: Sheet) -> Figure:
    """Draws a map with at least three cells with a ratio that are not collinear."""
    definition = sheet.definition
    caption = (
        f"{sheet.device}. Colours: {definition['statistic']} of {words_of(definition['choice'])} over that of "
        f"{words_of(definition['over'])}, between measured cells on straight lines of the logarithms. Black: where the "
        f"ratio is 1; hatched: where its {CONFIDENCE:.0%} interval has 1 in it. Bars: between which cells that is."
    )
    page = style.Page(_LEFT + _PLOT + _BAR + 0.3, _FOOT + _PLOT + 0.4, definition["title"], caption)
    axes = page.axes(_LEFT, _FOOT, _PLOT, _PLOT)
    known = {place: one for place, one in sheet.known.items() if one is not None}
    xs, ys = (np.linspace(*(math.log(end) for end in (axis.low, axis.high)), _FINE) for axis in definition.axes)
    field = _interpolated(known, [math.log(one.value) for one in known.values()], xs, ys)
    most = max(_LEAST, float(np.nanmax(np.abs(field))))
    mesh = axes.pcolormesh(np.exp(xs), np.exp(ys), field, cmap=_FIELD, vmin=-most, vmax=most, shading="nearest",
                           rasterized=True, zorder=0)  # fmt: skip
    _draw_band(axes, known, xs, ys)
    if np.nanmin(field) < 0 < np.nanmax(field):
        axes.contour(np.exp(xs), np.exp(ys), field, levels=[0], colors="black", linewidths=1.6, zorder=3)
    for verdict, marker in _MARKS.items():
        places = [place for place, one in known.items() if verdict_of(one) == verdict]
        axes.plot([x for x, _ in places], [y for _, y in places], linestyle="", marker=marker, markersize=5,
                  markerfacecolor="white" if verdict == OPEN else "#333333", markeredgecolor="#333333", zorder=5,
                  clip_on=False)  # fmt: skip
    for one in spans_of(definition.axes, sheet.known):
        ends = [one.low, one.high], [one.at, one.at]
        axes.plot(*(ends if one.along == 0 else ends[::-1]), color="#333333", linewidth=2.4, alpha=0.55, zorder=4)
    _scale(axes, definition.axes)
    _colour_bar(page, mesh, most)
    _legend(axes)
    return page.figure


def words_of(variant: dict) -> str:
    """A variant as "integrator=wavefront sorting=bucket"."""
    return " ".join(f"{name}={value}" for name, value in {**variant["axes"], **variant.get("tunables", {})}.items())


def can_be_drawn(sheet: Sheet) -> bool:
    """Whether a map has enough cells with a ratio to span an area."""
    places = [place for place, one in sheet.known.items() if one is not None]
    return len({x for x, _ in places}) > 1 and len({y for _, y in places}) > 1 and len(places) > 3


def _interpolated(known: dict, values: Sequence[float], xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    points = np.log(np.array(list(known), dtype=float))
    # Points on the map are scaled to the unit square before triangulation, which avoids sliver triangles.
    low, span = np.array([xs[0], ys[0]]), np.array([xs[-1] - xs[0], ys[-1] - ys[0]])
    grid = np.stack(np.meshgrid((xs - low[0]) / span[0], (ys - low[1]) / span[1]), axis=-1)
    return LinearNDInterpolator((points - low) / span, np.array(values))(grid)


def _draw_band(axes: Axes, known: dict, xs: np.ndarray, ys: np.ndarray) -> None:
    """Draws the band where the ratio's interval contains 1, as it does for cells without an interval."""
    lows = [-1.0 if one.low is None else math.log(one.low) for one in known.values()]
    highs = [1.0 if one.high is None else math.log(one.high) for one in known.values()]
    low, high = (_interpolated(known, ends, xs, ys) for ends in (lows, highs))
    inside = np.minimum(-low, high)
    if np.nanmax(inside) > 0:
        axes.contourf(np.exp(xs), np.exp(ys), inside, levels=[0, np.inf], colors="none", hatches=["////"], zorder=1)


def _scale(axes: Axes, limits: Sequence) -> None:
    for name, axis, ticks in zip("xy", limits, (axes.xaxis, axes.yaxis), strict=True):
        getattr(axes, f"set_{name}scale")("log")
        getattr(axes, f"set_{name}lim")(axis.low, axis.high)
        getattr(axes, f"set_{name}label")(axis.name)
        style.ticks(ticks, LogLocator(subs=(1, 2, 5) if axis.high / axis.low < 100 else (1,)))


def _colour_bar(page: style.Page, mesh, most: float) -> None:
    bar = page.axes(_LEFT + _PLOT + 0.25, _FOOT, 0.16, _PLOT)
    page.figure.colorbar(mesh, cax=bar)
    bar.set_yticks([-most, -most / 2, 0, most / 2, most])
    bar.yaxis.set_major_formatter(FuncFormatter(lambda value, _: figures(math.exp(value), 3)))


def _legend(axes: Axes) -> None:
    marks = [
        Line2D([], [], linestyle="", marker=marker, markersize=5, color="#333333", label=verdict,
               markerfacecolor="white" if verdict == OPEN else "#333333")
        for verdict, marker in _MARKS.items()
    ]  # fmt: skip
    axes.legend(
        handles=[*marks, Patch(facecolor="none", edgecolor="black", hatch="////", linewidth=0, label="1 in it")],
        loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=4, frameon=False, fontsize=style.CAPTION_SIZE,
        handletextpad=0.4, columnspacing=1.0, borderaxespad=0.1,
    )  # fmt: skip
