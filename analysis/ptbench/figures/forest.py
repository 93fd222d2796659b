"""Ratios as a forest plot: a dot with interval per row on a common axis, grouped by scene, geometric means first."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from ptbench import numbers
from ptbench.figures import style
from ptbench.stats.estimates import FASTER, SAME, SLOWER, UNSURE, Estimate, interval_of_ratio

# A verdict is told by marker and word as well as by colour; UNSURE is grey.
LOOKS = {
    SLOWER: style.Look(style.COLOURS[2], "^", "-"),
    FASTER: style.Look(style.COLOURS[1], "s", "-"),
    SAME: style.Look(style.COLOURS[0], "o", "-"),
    UNSURE: style.Look("#6e6e6e", "D", "-"),
    # Markers and colours for verdicts on efficiencies, of which higher ones are better.
    "lower": style.Look(style.COLOURS[2], "^", "-"),
    "higher": style.Look(style.COLOURS[1], "s", "-"),
    "not told apart from 1": style.Look("#6e6e6e", "D", "-"),
    "disturbed": style.Look("#6e6e6e", "D", "-"),
}
_LOG_FROM = 4.0
_ROW, _TIGHT_ROW = 0.27, 0.22
_TIGHT_FROM = 40
_HEAD, _GAP = 0.34, 0.2
_PLOT = 4.2


@dataclass(frozen=True)
class Item:
    """A row of a forest plot: a ratio with its interval and its verdict."""

    label: str
    ratio: Estimate
    word: str  # verdict on the ratio, as a key of LOOKS


@dataclass(frozen=True)
class Group:
    """The rows of a forest plot under one title."""

    title: str
    items: tuple[Item, ...]


@dataclass(frozen=True)
class Data:
    """A page of a forest plot; differences up to `threshold` count as none, `axis` names the ratio, `kind` the file."""

    title: str
    axis: str
    caption: str
    groups: tuple[Group, ...]
    threshold: float
    kind: str = ""


def pages(groups: Sequence[Group], most: int) -> list[tuple[Group, ...]]:
    """Distributes groups over pages of at most `most` rows, and splits groups that are longer."""
    parts: list[list[Group]] = [[]]
    room = most
    for group in groups:
        items = group.items
        while items:
            if not room or (len(items) > room and room < most and len(items) <= most):
                parts.append([])
                room = most
            title = group.title if len(items) == len(group.items) else f"{group.title} (continued)"
            parts[-1].append(Group(title, items[:room]))
            taken = min(room, len(items))
            items, room = items[taken:], room - taken
    return [tuple(part) for part in parts if part]


def draw(data: Data) -> Figure:
    """Draws the page of a forest plot."""
    texts = [
        [f"{_ratio_text(item.ratio, data.threshold)} {item.word}" for item in group.items] for group in data.groups
    ]
    heading = f"{data.axis} [95 %]"

    label_width = style.widest(item.label for group in data.groups for item in group.items)
    title_width = style.widest((group.title for group in data.groups), "bold")
    text_width = max(style.widest(text for group in texts for text in group), style.widest([heading], "bold"))
    left = style.MARGIN + label_width + 0.3
    plot_width = max(_PLOT, title_width + style.MARGIN - left)
    pitch = _TIGHT_ROW if sum(len(group.items) for group in data.groups) >= _TIGHT_FROM else _ROW
    heights = [_HEAD + pitch * len(group.items) for group in data.groups]
    body = sum(heights) + _GAP * (len(heights) - 1) + 0.58
    page = style.Page(left + plot_width + 0.2 + text_width + style.MARGIN, body, data.title, data.caption)
    limits, log = _limits(data)
    text_x, top = left + plot_width + 0.2, body
    for group, group_texts, height in zip(data.groups, texts, heights, strict=True):
        axes = page.axes(left, top - height, plot_width, height - _HEAD)
        count = len(group.items)
        axes.axvspan(1 - data.threshold, 1 + data.threshold, color="#e9e9e9", linewidth=0, zorder=0)
        axes.axvline(1, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        for index, item in enumerate(group.items):
            y, centre = count - 1 - index, top - _HEAD - pitch * (index + 0.5)
            axes.axhline(y, color="#e4e4e4", linewidth=0.7, zorder=0)
            style.draw_row(axes, y, item.ratio, LOOKS[item.word])
            page.text(left - 0.12, centre, item.label, size=style.LABEL_SIZE, va="center", ha="right")
            page.text(text_x, centre, group_texts[index], size=style.LABEL_SIZE, va="center")
        bold = {"size": style.LABEL_SIZE, "weight": "bold", "va": "center"}
        page.text(style.MARGIN, top - _HEAD / 2, group.title, **bold)
        page.text(text_x, top - _HEAD / 2, heading, **bold)
        axes.set_ylim(-0.5, count - 0.5)
        axes.yaxis.set_major_locator(NullLocator())
        axes.spines["left"].set_visible(False)
        _scale(axes, limits, log)
        if group is data.groups[-1]:
            axes.set_xlabel(data.axis + (", log scale" if log else ""))
        else:
            axes.tick_params(labelbottom=False)
        top -= height + _GAP
    return page.figure


_NARROW = 3.57  # width in inches of a figure for phones: 375 CSS pixels less the page's margins
_NARROW_SIZE = 8.0
_NARROW_PLOT = 1.5


def draw_narrow(data: Data) -> Figure:
    """Draws the forest plot for a narrow screen: each label above its row, the ratio beside it."""
    inner = _NARROW - 2 * style.MARGIN
    labels = [[style.wrapped(item.label, _NARROW_SIZE, inner) for item in group.items] for group in data.groups]
    titles = [style.wrapped(group.title, style.LABEL_SIZE, inner, "bold") for group in data.groups]
    heads = [style.text_height(style.LABEL_SIZE, len(title)) + 0.1 for title in titles]
    rows = [[style.text_height(_NARROW_SIZE, len(label)) + 0.3 for label in group] for group in labels]
    body = sum(heads) + sum(map(sum, rows)) + 0.5
    page = style.Page(_NARROW, body, data.title, data.caption)
    limits, log = _limits(data)
    # All rows share one axes object, in which y is in inches from the bottom.
    height = body - 0.5
    axes = page.axes(style.MARGIN, 0.5, _NARROW_PLOT, height)
    axes.set_ylim(0, height)
    axes.axvspan(1 - data.threshold, 1 + data.threshold, color="#e9e9e9", linewidth=0, zorder=0)
    axes.axvline(1, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    top = height
    plain = {"size": _NARROW_SIZE, "va": "top", "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 0.5}}
    for group, title, head, group_labels, pitches in zip(data.groups, titles, heads, labels, rows, strict=True):
        bold = {**plain, "size": style.LABEL_SIZE, "weight": "bold"}
        page.text(style.MARGIN, top + 0.5, "\n".join(title), **bold)
        top -= head
        for item, label, pitch in zip(group.items, group_labels, pitches, strict=True):
            page.text(style.MARGIN, top + 0.5, "\n".join(label), **plain)
            y = top - pitch + 0.17
            style.draw_row(axes, y, item.ratio, LOOKS[item.word])
            text = f"{_ratio_text(item.ratio, data.threshold)}\n{item.word}"
            page.text(
                style.MARGIN + _NARROW_PLOT + 0.1, y + 0.5, text, size=_NARROW_SIZE - 0.5, va="center",
                color=LOOKS[item.word].colour, linespacing=1.1,
            )  # fmt: skip
            top -= pitch
    axes.yaxis.set_major_locator(NullLocator())
    axes.spines["left"].set_visible(False)
    _scale(axes, limits, log, most=3)
    axes.tick_params(labelsize=_NARROW_SIZE - 1)
    axes.set_xlabel(data.axis + (", log" if log else ""), size=_NARROW_SIZE)
    return page.figure


def _limits(data: Data) -> tuple[tuple[float, float], bool]:
    """The axis limits, which include all intervals, 1 and the threshold band; and whether the axis is logarithmic."""
    ends = [1 - data.threshold, 1 + data.threshold]
    for group in data.groups:
        for item in group.items:
            ends += [end for end in (item.ratio.value, item.ratio.low, item.ratio.high) if end is not None]
    low, high = min(ends), max(ends)
    if low > 0 and high > _LOG_FROM * low:
        return (low / 1.15, high * 1.15), True
    room = style.room(low, high, 0.06)
    return (low - room, high + room), False


def _scale(axes: Axes, limits: tuple[float, float], log: bool, most: int = 5) -> None:
    """Sets the ticks of a ratio axis: at most `most`, or about that many on a logarithmic one."""
    if log:
        axes.set_xscale("log")
        style.ticks(axes.xaxis, LogLocator(subs=(1, 2, 5) if limits[1] < 12 * most * limits[0] else (1,)))
    else:
        style.ticks(axes.xaxis, MaxNLocator(most))
    axes.set_xlim(limits)
    axes.grid(axis="x")


def _ratio_text(estimate: Estimate, threshold: float) -> str:
    return f"{numbers.ratio(estimate.value)} {interval_of_ratio(estimate, threshold)}".rstrip()
