"""The figure of `explain`: the times of two cells as stacked bars, and the steps from one total to the other."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator, NullLocator

from ptbench import numbers
from ptbench.extras.explain.accounting import OUTSIDE, Account, Step, stage_order
from ptbench.extras.explain.facts import signed
from ptbench.extras.explain.found import Pair
from ptbench.figures import style
from ptbench.figures.caption import setting as setting_of
from ptbench.io.cells import Result
from ptbench.stats.estimates import FASTER, INTERVAL_TEXT, SLOWER, interval_of_ratio
from ptbench.studies.withdrawn import between

_ROW = 0.3
_HEADING = "ms a spp [range]"
_PLOT = 4.6
_HATCHES = ("", "////", "....", "\\\\\\\\", "xxxx", "----", "++++")
_GREY, _MORE, _LESS = "#b5b5b5", "#D55E00", "#0072B2"


def draw(result: Result, pair: Pair) -> Figure:
    """Draws one page on two cells: the finding as title, bars of stages, steps between totals, how to read them."""
    accounting = pair.accounting
    a, b = accounting.a, accounting.b
    names = [f"{side}: {label}" for side, label in zip("AB", pair.labels, strict=True)]
    rows = [f"{names[0]}, timed", *(step.name for step in accounting.steps), f"{names[1]}, timed"]
    texts = [_total(a), *(_step_text(step) for step in accounting.steps), _total(b)]
    label_width = min(max(style.text_width(text, style.LABEL_SIZE) for text in (*rows, *names)), 3.2)
    text_width = max(
        *(style.text_width(text, style.LABEL_SIZE) for text in texts),
        style.text_width(_HEADING, style.LABEL_SIZE, "bold"),
    )
    left = style.MARGIN + label_width + 0.25
    width = left + _PLOT + 0.2 + text_width + style.MARGIN
    wrapped = [style.wrapped(text, style.LABEL_SIZE, label_width) for text in rows]
    pitches = [_ROW + style.text_height(style.LABEL_SIZE, len(lines) - 1) for lines in wrapped]
    bar_pitch = max(0.5, *(0.2 + style.text_height(style.LABEL_SIZE, len(lines)) for lines in wrapped))
    legend = _legend_rows(pair, width - 2 * style.MARGIN)
    legend_height = 0.24 * len(legend) + 0.1
    steps_height = sum(pitches)
    body = legend_height + 2 * bar_pitch + 0.75 + steps_height + 0.55
    page = style.Page(width, body, _title(pair), _caption(result, pair))

    top = body - legend_height
    _draw_legend(page, legend, pair, body)
    bars = page.axes(left, top - 2 * bar_pitch, _PLOT, 2 * bar_pitch)
    ends = [_draw_bar(bars, 1 - index, account, pair) for index, account in enumerate((a, b))]
    bars.set_ylim(-0.5, 1.5)
    bars.set_xlim(0, 1.05 * max(ends))
    for index, (name, account) in enumerate(zip(names, (a, b), strict=True)):
        y = top - bar_pitch * (index + 0.5)
        lines = "\n".join(style.wrapped(name, style.LABEL_SIZE, label_width))
        page.text(left - 0.12, y, lines, size=style.LABEL_SIZE, va="center", ha="right")
        page.text(left + _PLOT + 0.2, y, _total(account), size=style.LABEL_SIZE, va="center")

    steps_top = top - 2 * bar_pitch - 0.75
    steps = page.axes(left, steps_top - steps_height, _PLOT, steps_height)
    _draw_steps(page, steps, pair, wrapped, texts, pitches, left, steps_top)
    for axes in (bars, steps):
        axes.yaxis.set_major_locator(NullLocator())
        axes.xaxis.set_major_locator(MaxNLocator(6))
        axes.grid(axis="x")
    heading = {"size": style.LABEL_SIZE, "weight": "bold", "va": "center"}
    page.text(style.MARGIN, steps_top + 0.18, "From A to B", **heading)
    page.text(left + _PLOT + 0.2, steps_top + 0.18, _HEADING, **heading)
    steps.set_xlabel("Time (ms per spp)")
    return page.figure


def _title(pair: Pair) -> str:
    if pair.verdict.word in (FASTER, SLOWER):
        return f"{pair.verdict.word}: where the time differs, {pair.setting}"
    return f"{pair.verdict.word}: no difference to explain, {pair.setting}"


def _caption(result: Result, pair: Pair) -> str:
    verdict = pair.verdict.word + (f" ({pair.verdict.said})" if pair.verdict.said else "")
    a, b = pair.cells
    return "\n".join(
        [
            f"B over A: {numbers.ratio(pair.ratio.value)} {interval_of_ratio(pair.ratio) or 'no interval'}, {verdict}. "
            f"Diamonds: medians of the timed samples, n = {numbers.span((len(a.samples), len(b.samples)))}; bars on "
            f"them: {INTERVAL_TEXT}. Bars: stages of the instrumented pass, another render; where the file has one "
            "stage, the timed median. Steps: what each adds to A's median on the way to B's (orange: more, blue: less, "
            "hatched: in no stage); thin lines: their range, if from none to all of what the two passes differ by is "
            "in that stage.",
            setting_of(result, pair.cells, told=False),
            *(entry.short for entry in between(a, b)),
            f"A: {a.variant}",
            f"B: {b.variant}",
        ]
    )


def _total(account: Account) -> str:
    return f"{numbers.figures(account.total.value)} {numbers.interval(account.total.low, account.total.high)}"


def _step_text(step: Step) -> str:
    text = signed(step.difference)
    return f"{text} [{signed(step.low)}, {signed(step.high)}]" if step.is_stage else f"{text} (in no stage)"


def _stage_names(pair: Pair) -> list[str]:
    return stage_order([*pair.accounting.a.stages, *pair.accounting.b.stages])


def _look(pair: Pair, name: str) -> tuple[str, str]:
    """The colour and hatch of a stage, either of which suffices to tell stages apart."""
    if name == OUTSIDE:
        return _GREY, ""
    index = _stage_names(pair).index(name)
    colours = style.COLOURS[1:]
    return colours[index % len(colours)], _HATCHES[index % len(_HATCHES)]


def _legend_rows(pair: Pair, width: float) -> list[list[str]]:
    """The names of stages in legend lines that fit the width."""
    outside = [OUTSIDE] if pair.accounting.a.divided or pair.accounting.b.divided else []
    rows: list[list[str]] = [[]]
    used = 0.0
    for name in [*_stage_names(pair), *outside]:
        needed = style.text_width(name, style.LABEL_SIZE) + 0.6
        if rows[-1] and used + needed > width:
            rows.append([])
            used = 0.0
        rows[-1].append(name)
        used += needed
    return rows


def _draw_legend(page: style.Page, rows: list[list[str]], pair: Pair, top: float) -> None:
    for index, row in enumerate(rows):
        x, y = style.MARGIN, top - 0.24 * (index + 0.5)
        for name in row:
            colour, hatch = _look(pair, name)
            corner = (x / page.width, (y - 0.07 + page.bottom) / page.height)
            size = {"width": 0.26 / page.width, "height": 0.14 / page.height}
            page.figure.add_artist(
                Rectangle(corner, **size, facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.6)
            )
            page.text(x + 0.34, y, name, size=style.LABEL_SIZE, va="center")
            x += style.text_width(name, style.LABEL_SIZE) + 0.6


def _draw_bar(axes: Axes, y: float, account: Account, pair: Pair) -> float:
    """Draws the stages of the instrumented pass end to end, marks the timed median; returns the bar's end."""
    x = 0.0
    for name, ms in (*account.stages.items(), (OUTSIDE, max(account.outside, 0.0))):
        colour, hatch = _look(pair, name)
        axes.barh(y, ms, 0.62, x, color=colour, hatch=hatch, edgecolor="white", linewidth=0.6, zorder=2)
        x += ms
    total = account.total
    if total.low is not None and total.high is not None:
        axes.plot([total.low, total.high], [y, y], color="black", linewidth=1.6, zorder=4)
    axes.plot([total.value], [y], marker="D", color="black", markeredgecolor="white", markersize=7, zorder=5)
    return max(x, total.high or total.value)


def _draw_steps(
    page: style.Page,
    axes: Axes,
    pair: Pair,
    labels: list[list[str]],
    texts: list[str],
    pitches: list[float],
    left: float,
    top: float,
) -> None:
    """Draws a row for A's median, for each step, and for B's median: every bar begins where the one above ends."""
    accounting = pair.accounting
    at = accounting.a.total.value
    spans = [(0.0, at), *((0.0, 0.0) for _ in accounting.steps), (0.0, accounting.b.total.value)]
    reach = [0.0, at, accounting.b.total.value]
    for index, step in enumerate(accounting.steps, 1):
        spans[index] = (at, at + step.difference)
        reach += [*spans[index], *((at + step.low, at + step.high) if step.is_stage else ())]
        at += step.difference
    bottom = 0.0
    centres = []
    for pitch in reversed(pitches):
        centres.append(bottom + pitch / 2)
        bottom += pitch
    centres.reverse()
    for index, ((begin, end), centre) in enumerate(zip(spans, centres, strict=True)):
        is_total = index in (0, len(spans) - 1)
        colour = "#444444" if is_total else _MORE if end > begin else _LESS
        step = None if is_total else accounting.steps[index - 1]
        hatch = "////" if step is not None and not step.is_stage else ""
        axes.barh(
            centre, end - begin, 0.18, begin, color=colour, hatch=hatch, edgecolor="white", linewidth=0.4, zorder=2
        )
        if step is not None and step.is_stage:
            axes.plot([begin + step.low, begin + step.high], [centre, centre], color="black", linewidth=1.0, zorder=4)
        if index + 1 < len(spans):
            axes.plot([end, end], [centre, centres[index + 1]], color="#888888", linewidth=0.7, zorder=1)
        y = top - sum(pitches) + centre
        page.text(left - 0.12, y, "\n".join(labels[index]), size=style.LABEL_SIZE, va="center", ha="right")
        page.text(left + _PLOT + 0.2, y, texts[index], size=style.LABEL_SIZE, va="center")
    axes.set_ylim(0, bottom)
    low, high = min(reach), max(reach)
    axes.set_xlim(low - 0.02 * (high - low) if low < 0 else 0, high + 0.05 * (high - low))
