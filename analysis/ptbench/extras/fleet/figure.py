"""Predicted against measured time ratios of a GPU over the fleet's first, a point per cell, with the target band."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ptbench.errors import NotDrawable
from ptbench.extras.fleet.fleet import NEAR_ENOUGH, Fleet, Other
from ptbench.extras.fleet.model import USED
from ptbench.extras.fleet.text import MODEL
from ptbench.figures import style
from ptbench.figures.saving import save_figure
from ptbench.io.axes import INTEGRATOR

_BAND = "#e4e4e4"


def save_predictions(fleet: Fleet, folder: Path) -> list[Path]:
    """Saves predicted_MARK.png and .svg for every other GPU with predictions; raises NotDrawable if none has any."""
    written: list[Path] = []
    with style.applied():
        for mark, other in zip("BCDEFGHIJKLMNOPQRSTUVWXYZ", fleet.others, strict=False):
            if other.predictions:
                written += save_figure(draw(fleet, other), folder, f"predicted_{mark}")
    if not written:
        raise NotDrawable("no variant has counters")
    return written


def draw(fleet: Fleet, other: Other) -> Figure:
    """Draws one page: filled marks for cells with their own counters, hollow ones for those of a near variant."""
    points = other.predictions
    integrators = list(dict.fromkeys(one.cell.axes[INTEGRATOR] for one in points))
    looks = {name: style.look(index) for index, name in enumerate(integrators)}
    title = f"{other.gpu.name} predicted from counters of {fleet.first.name}"
    page = style.Page(6.6, 4.4, title, _caption(fleet, other))
    axes = page.axes(0.75, 0.6, 3.7, 3.7)
    x = [one.ratios[USED.name] for one in points]
    y = [one.row.ratio.value for one in points]
    ends = np.array([min(x + y) / 1.06, max(x + y) * 1.06])
    axes.fill_between(ends, ends / (1 + NEAR_ENOUGH), ends / (1 - NEAR_ENOUGH), color=_BAND, linewidth=0, zorder=0)
    axes.plot(ends, ends, color="#909090", linewidth=0.8, zorder=1)
    for one, predicted, measured in zip(points, x, y, strict=True):
        look = looks[one.cell.axes[INTEGRATOR]]
        low, high = one.row.ratio.low, one.row.ratio.high
        if low is not None and high is not None:
            axes.plot([predicted] * 2, [low, high], color=look.colour, linewidth=1, zorder=2)
        face = look.colour if one.is_own else "none"
        axes.plot(
            [predicted], [measured], marker=look.marker, linestyle="", color=look.colour, markerfacecolor=face, zorder=3
        )
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)
    axes.set_xlabel("Predicted ratio of times")
    axes.set_ylabel("Measured ratio of times")
    handles = [
        Line2D([], [], color=looks[name].colour, marker=looks[name].marker, linestyle="", label=name)
        for name in integrators
    ]
    axes.legend(handles=handles, loc="center left", bbox_to_anchor=(1.02, 0.5), frameon=False)
    return page.figure


def _caption(fleet: Fleet, other: Other) -> str:
    own = other.scores(own=True)
    told = (
        f"{own[0].within} of {own[0].count} variants that were themselves counted lie within {NEAR_ENOUGH:.0%} (band). "
        if own
        else ""
    )
    return (
        f"Time on {other.gpu.name} over time on {fleet.first.name}, a sample per pixel, suite "
        f"{fleet.compared.results[0].suite}. {told}Filled: counters of the variant itself; hollow: of the nearest that "
        f"was counted. Bars: 95 % intervals of what was measured. {MODEL}"
    )
