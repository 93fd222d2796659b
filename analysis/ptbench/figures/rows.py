"""Choices as rows: a dot with its interval on a common axis, the numbers beside it, one group per scene and depth."""

from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from ptbench import numbers
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.caption import timing_caption
from ptbench.io.cells import NotApplicable, Result, Study
from ptbench.stats.estimates import Estimate, Verdict, interval_of_ratio
from ptbench.studies.groups import in_file_order, parts_of
from ptbench.studies.notes import Note, missed, notes_of
from ptbench.studies.questions import Question, question_of, swept_by
from ptbench.studies.rows import Row, measure, scenes_of

_LOG_FROM = 8.0
_ROW, _TIGHT_ROW = 0.27, 0.22
_TIGHT_FROM = 40  # number of rows in a figure from which on they are closer together
_HEAD = 0.34
_GAP = 0.22
_TITLE = 3.0  # inches up to which a group's title widens the labels' column; longer ones reach over the plot


@dataclass(frozen=True)
class Item:
    """A choice's row in the figure; where `time` is None, `instead` tells why."""

    label: str
    is_baseline: bool
    time: Estimate | None
    ratio: Estimate | None
    verdict: Verdict | None
    instead: str = ""


@dataclass(frozen=True)
class Group:
    """A figure's rows of choices in one scene and setting."""

    title: str
    items: tuple[Item, ...]


@dataclass(frozen=True)
class Data:
    """The contents of a page of choices as rows."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    baseline: str
    order: tuple[str, ...]
    groups: tuple[Group, ...]


def collect(result: Result, study: Study, default_title: str) -> Data:
    """Collects one row per cell of a study; raises NotDrawable."""
    question = question_of(result, study)
    measured = measure(result, study)
    notes = notes_of(result, study, measured)
    drawn = [row for row in measured if row.estimate is not None]
    if not drawn:
        raise NotDrawable("no cell has times: " + ("; ".join(note.full for note in notes) or "no samples"))
    parts = parts_of(
        measured, question, swept_by(study), lambda row: (row.cell.scene, row.cell.depth), measured, split_grids=True
    )

    def key(row: Row) -> tuple:
        return (row.cell.scene, row.cell.depth, *parts.values(row.cell))

    scenes = scenes_of(measured)
    keys = in_file_order(key(row) for row in measured)
    groups = []
    for scene, depth, *values in sorted(keys, key=lambda key: (scenes.index(key[0]), key[1])):
        items = []
        of_group = [row for row in measured if key(row) == (scene, depth, *values)]
        for row in sorted(of_group, key=lambda row: _place(row, question)):
            instead = "" if row.estimate else "failed" if row.cell.failed else "no samples"
            label = parts.labels[row.cell.name]
            items.append(Item(label, row.is_baseline, row.estimate, row.ratio, row.verdict, instead))
        shown = {item.label for item in items}
        if result.baselines:
            # Choices that were not run with some settings are told in a note; figures of older files show them as rows.
            shown |= {question.choice_of(row.cell) for row in of_group}
        group_of = dict(zip(parts.split, values, strict=True))
        for absent in missed(result, study):
            label = _absent_label(absent, question)
            if absent.scene == scene and label not in shown and _is_of(absent, group_of):
                shown.add(label)
                items.append(Item(label, False, None, None, None, "n/a"))
        groups.append(Group(f"{scene}, depth {depth}{parts.suffix(values)}", tuple(items)))
    order = dict.fromkeys([*parts.order, *(item.label for group in groups for item in group.items)])
    caption = timing_caption(result, study, [row.cell for row in drawn], question, notes)
    return Data(
        study.title or default_title, caption, tuple(notes), question.shown_baseline, tuple(order), tuple(groups)
    )


def _place(row: Row, question: Question) -> tuple:
    """Sort key: baselines first, then by time, rows without a time last; values of a tunable by their size."""
    by_time = (row.estimate is None, row.estimate.value if row.estimate else 0)
    if not question.is_tunable:
        return not row.is_baseline, *by_time
    value = row.cell.tunables.get(question.axis)
    return value is None, value or 0, *by_time


def _absent_label(absent: NotApplicable, question: Question) -> str:
    if question.is_tunable and question.axis in absent.tuned:
        return f"{question.axis}={absent.tuned[question.axis]}"
    return absent.axes.get(question.axis, absent.variant)


def _is_of(absent: NotApplicable, group_of: dict[str, str]) -> bool:
    """Whether an inapplicable cell belongs to a group of rows; cells of another backend belong to none."""
    if absent.elsewhere:
        return False
    known = {**absent.tuned, **absent.axes}
    return all(known.get(name, value) == value for name, value in group_of.items())


def draw(data: Data) -> Figure:
    """Draws a page of choices as rows, from the data of `collect`."""
    looks = {label: style.look(index) for index, label in enumerate(data.order)}
    times = [["" if i.time is None else _time_text(i.time) for i in group.items] for group in data.groups]
    ratios = [[_ratio_text(i, data.baseline) for i in group.items] for group in data.groups]
    headings = ("ms per spp [95 %]", f"relative to {data.baseline} [95 %]")

    title_width = style.widest((group.title for group in data.groups), "bold")
    label_width = max(
        style.widest(item.label for group in data.groups for item in group.items), min(title_width, _TITLE) - 0.2
    )
    time_width = max(style.widest(text for group in times for text in group), style.widest(headings[:1], "bold"))
    ratio_width = max(style.widest(text for group in ratios for text in group), style.widest(headings[1:], "bold"))
    left = style.MARGIN + label_width + 0.3
    right = 0.2 + time_width + 0.25 + ratio_width + style.MARGIN
    plot_width = max(9.2 - left - right, 2.6, style.MARGIN + title_width - left)
    pitch = _TIGHT_ROW if sum(len(group.items) for group in data.groups) >= _TIGHT_FROM else _ROW
    heights = [_HEAD + pitch * len(group.items) for group in data.groups]
    body = sum(heights) + _GAP * (len(heights) - 1) + 0.58
    page = style.Page(left + plot_width + right, body, data.title, data.caption)

    bounds = [
        bound
        for group in data.groups
        for item in group.items
        if item.time is not None
        for bound in (item.time.value, item.time.low, item.time.high)
        if bound is not None
    ]
    log = max(bounds) > _LOG_FROM * min(bounds)
    time_x = left + plot_width + 0.2
    ratio_x = time_x + time_width + 0.25
    top = body
    for group, group_times, group_ratios, height in zip(data.groups, times, ratios, heights, strict=True):
        rows_height = height - _HEAD
        axes = page.axes(left, top - height, plot_width, rows_height)
        count = len(group.items)
        for index, item in enumerate(group.items):
            y = count - 1 - index
            axes.axhline(y, color="#e4e4e4", linewidth=0.7, zorder=0)
            centre = top - _HEAD - pitch * (index + 0.5)
            page.text(left - 0.12, centre, item.label, size=style.LABEL_SIZE, va="center", ha="right")
            if item.time is None:
                grey = {"size": style.LABEL_SIZE, "va": "center", "style": "italic", "color": "#444444"}
                page.text(time_x, centre, item.instead, **grey)
                continue
            style.draw_row(axes, y, item.time, looks[item.label])
            page.text(time_x, centre, group_times[index], size=style.LABEL_SIZE, va="center")
            page.text(ratio_x, centre, group_ratios[index], size=style.LABEL_SIZE, va="center")
        heading = {"size": style.LABEL_SIZE, "weight": "bold", "va": "center"}
        head_y = top - _HEAD / 2
        page.text(style.MARGIN, head_y, group.title, **heading)
        page.text(time_x, head_y, headings[0], **heading)
        page.text(ratio_x, head_y, headings[1], **heading)
        baselines = [item.time.value for item in group.items if item.is_baseline and item.time is not None]
        # A line marks the baseline's time if the group has one baseline; with several it would not fit most rows.
        if len(baselines) == 1:
            axes.axvline(baselines[0], color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        axes.set_ylim(-0.5, count - 0.5)
        axes.yaxis.set_major_locator(NullLocator())
        axes.spines["left"].set_visible(not log)
        _scale(axes, bounds, log)
        axes.grid(axis="x")
        if group is data.groups[-1]:
            axes.set_xlabel("Time (ms per spp" + (", log scale)" if log else ")"))
        else:
            axes.tick_params(labelbottom=False)
        top -= height + _GAP
    return page.figure


def _scale(axes, bounds: list[float], log: bool) -> None:
    if log:
        axes.set_xscale("log")
        axes.set_xlim(min(bounds) / 1.3, max(bounds) * 1.3)
        style.ticks(axes.xaxis, LogLocator(subs=(1, 2, 5) if max(bounds) / min(bounds) < 100 else (1,)))
    else:
        axes.set_xlim(0, 1.05 * max(bounds))
        style.ticks(axes.xaxis, MaxNLocator(5))


def _time_text(time: Estimate) -> str:
    return f"{numbers.figures(time.value)} {numbers.interval(time.low, time.high)}"


def _ratio_text(item: Item, baseline: str) -> str:
    if item.is_baseline:
        return "baseline"
    if item.ratio is None:
        return "" if item.time is None else f"no {baseline} to compare"
    ends = interval_of_ratio(item.ratio)
    return f"{numbers.ratio(item.ratio.value)}×{f' {ends}' if ends else ''} {item.verdict.word}"
