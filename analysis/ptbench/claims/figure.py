"""The figure of a claim: one row per condition, with the claimed, the predicted and the measured interval."""

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from ptbench.claims.claim import THEIRS, Claim, Span, span_of
from ptbench.claims.judging import HOLDS_WHERE, LESS, MISSING, MORE, OPEN, WITHIN, Judged, Verdict
from ptbench.figures import style
from ptbench.stats.estimates import CONFIDENCE

_COLOURS = {
    WITHIN: style.COLOURS[3], LESS: style.COLOURS[2], MORE: style.COLOURS[1], OPEN: "#6e6e6e", MISSING: "#6e6e6e",
}  # fmt: skip
_BAND, _PREDICTED = "#e3efe9", "#8a8a8a"
_ROW, _PLOT, _FOOT, _HEAD = 0.3, 4.2, 0.5, 0.3


def draw(claim: Claim, verdict: Verdict, device: str) -> Figure:
    """Draws the figure of a measured claim; `verdict` must have a number for at least one condition."""
    rows = [one for one in verdict.judged if one.found.estimate is not None]
    labels = [one.found.condition.name for one in rows]
    left = style.MARGIN + max(style.text_width(label, style.LABEL_SIZE) for label in labels) + 0.3
    height = _ROW * len(rows)
    caption = (
        f"{device}. {claim['number']['of'][0].upper()}{claim['number']['of'][1:]}, with its {CONFIDENCE:.0%} interval. "
        "Green: where the claim holds. Grey line: what was predicted. Of a claim that "
        f"{HOLDS_WHERE} the green rows are the map."
    )
    page = style.Page(left + _PLOT + style.MARGIN + 0.2, _FOOT + height + _HEAD, claim["title"], caption)
    axes = page.axes(left, _FOOT, _PLOT, height)
    low, high, is_log = _limits(rows)
    for index, one in enumerate(rows):
        y = len(rows) - index - 0.5
        _draw_row(axes, y, one, low, high)
        page.text(
            left - 0.12, _FOOT + _ROW * y, one.found.condition.name, size=style.LABEL_SIZE, va="center", ha="right"
        )
    _scale(axes, low, high, len(rows), is_log=is_log)
    _legend(axes, rows)
    return page.figure


def _scale(axes: Axes, low: float, high: float, rows: int, *, is_log: bool = True) -> None:
    if is_log:
        axes.set_xscale("log")
        style.ticks(axes.xaxis, LogLocator(subs=(1, 2, 5) if high / low < 200 else (1,)))
        axes.axvline(1, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    else:
        style.ticks(axes.xaxis, MaxNLocator(6))
    axes.set_xlim(low, high)
    axes.set_ylim(0, rows)
    axes.yaxis.set_major_locator(NullLocator())
    axes.spines["left"].set_visible(False)
    axes.grid(axis="x")


def _draw_row(axes: Axes, y: float, one: Judged, low: float, high: float) -> None:
    condition, estimate = one.found.condition, one.found.estimate
    start, end = _inside(condition.claimed, low, high)
    axes.fill_between([start, end], y - 0.43, y + 0.43, color=_BAND, linewidth=0, zorder=0)
    axes.plot(
        _inside(condition.predicted, low, high),
        [y - 0.24] * 2,
        color=_PREDICTED,
        linewidth=3,
        solid_capstyle="butt",
        zorder=2,
    )
    colour = _COLOURS[one.word]
    if estimate.low is not None and estimate.high is not None:
        axes.plot([estimate.low, estimate.high], [y + 0.06] * 2, color=colour, linewidth=1.4, zorder=3)
    axes.plot([estimate.value], [y + 0.06], color=colour, marker="o", markersize=5, zorder=4)


def _inside(span: Span, low: float, high: float) -> tuple[float, float]:
    """The part of a span that the figure's axes show."""
    return max(span.low, low), max(min(span.high, high), max(span.low, low))


def _limits(rows: Sequence[Judged]) -> tuple[float, float, bool]:
    """The limits of a claim figure's axis, and whether the axis is logarithmic: it is for ratios, not for slopes."""
    ends = [end for one in rows for end in _ends(one) if math.isfinite(end)]
    if min(ends) > 0:
        return min([*ends, 0.95]) / 1.12, max([*ends, 1.05]) * 1.12, True
    room = style.room(min(ends), max(ends), 0.06)
    return min(ends) - room, max(ends) + room, False


def _ends(one: Judged) -> tuple[float, ...]:
    estimate, condition = one.found.estimate, one.found.condition
    known = (estimate.low, estimate.high) if estimate.low is not None and estimate.high is not None else ()
    spans = (condition.predicted.low, condition.predicted.high, condition.claimed.low, condition.claimed.high)
    return (estimate.value, *known, *spans)


def _legend(axes: Axes, rows: Sequence[Judged], *, published: bool = False) -> None:
    there = {one.word for one in rows}
    handles = [
        Line2D([], [], color=colour, marker="o", linestyle="-", markersize=5, label=word)
        for word, colour in _COLOURS.items()
        if word in there
    ]
    if published:
        handles += [Patch(color="#d6d6d6", label="published")]
    else:
        handles += [Patch(color=_BAND, label="claim"), Line2D([], [], color=_PREDICTED, linewidth=3, label="predicted")]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=len(handles), frameon=False,
        fontsize=style.CAPTION_SIZE, handletextpad=0.4, columnspacing=1.0, borderaxespad=0.1,
    )  # fmt: skip


def draw_all(told: Sequence[tuple[Claim, Verdict, str]]) -> Figure | None:
    """Draws one row per claim and device: the published number beside the measured ones; None without a ratio."""
    rows = [(claim, device, _numbers(verdict)) for claim, verdict, device in told]
    rows = [row for row in rows if row[2] and all(one.found.estimate.value > 0 for one in row[2])]
    if not rows:
        return None
    labels = [f"{claim['title']} ({device})" for claim, device, _ in rows]
    left = style.MARGIN + max(style.text_width(label, style.LABEL_SIZE) for label in labels) + 0.3
    height = _ROW * len(rows)
    caption = (
        "Each claim's ratio, log scale. Grey: the published range, or its one number; where it has no number, no grey. "
        "Large: conditions near theirs, small: elsewhere; colours by each condition's own rule."
    )
    page = style.Page(left + _PLOT + style.MARGIN + 0.2, _FOOT + height + _HEAD, "Claimed and measured", caption)
    axes = page.axes(left, _FOOT, _PLOT, height)
    ends = [one.found.estimate.value for _, _, numbers in rows for one in numbers]
    low, high = min([*ends, 0.5]) / 1.15, max([*ends, 2.0]) * 1.15
    for index, ((claim, _, numbers), label) in enumerate(zip(rows, labels, strict=True)):
        y = len(rows) - index - 0.5
        page.text(left - 0.12, _FOOT + _ROW * y, label, size=style.LABEL_SIZE, va="center", ha="right")
        _draw_published(axes, y, claim, low, high)
        for one in sorted(numbers, key=lambda one: one.found.condition.side == THEIRS):
            size = 5.5 if one.found.condition.side == THEIRS else 3
            axes.plot([one.found.estimate.value], [y], color=_COLOURS[one.word], marker="o", markersize=size, zorder=3)
    _scale(axes, low, high, len(rows))
    _legend(axes, [one for _, _, numbers in rows for one in numbers], published=True)
    return page.figure


def _numbers(verdict: Verdict) -> list[Judged]:
    return [one for one in verdict.judged if one.found.estimate is not None]


def _draw_published(axes: Axes, y: float, claim: Claim, low: float, high: float) -> None:
    ends = claim["number"]["low"], claim["number"]["high"]
    if ends[0] is not None and ends[0] == ends[1]:
        axes.plot([ends[0]] * 2, [y - 0.36, y + 0.36], color=_PREDICTED, linewidth=2.5, zorder=1)
    elif ends != (1.0, None):  # a claim of just "faster" has no published number to draw
        start, end = _inside(span_of(ends), low, high)
        axes.fill_between([start, end], y - 0.36, y + 0.36, color="#d6d6d6", linewidth=0, zorder=1)
