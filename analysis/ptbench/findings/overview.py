"""The figure of the README: one row per optimisation studied, with its time ratio in an open and a closed box."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

from ptbench.figures import style
from ptbench.findings.quantities import Ratio
from ptbench.findings.source import source_of
from ptbench.stats.estimates import CONFIDENCE, FASTER, SAME, SLOWER, THRESHOLD, UNSURE

_COLOURS = {FASTER: style.COLOURS[1], SLOWER: style.COLOURS[2], SAME: style.COLOURS[0], UNSURE: "#6e6e6e"}
_WORDS = {FASTER: "pays", SLOWER: "costs", SAME: "same", UNSURE: "unsure"}
_BOXES = (("open box", "none", 0.17), ("closed box", "full", -0.17))  # scene, marker's fill, y offset in its row
_ROW, _HEAD, _GAP = 0.36, 0.3, 0.08
_PLOT = 4.0
_TICKS = (0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3)


@dataclass(frozen=True)
class Line:
    """A row of the overview figure."""

    label: str
    ratios: tuple[Ratio, Ratio]  # time of the variant over the baseline, in the open box and the closed one
    same_films: tuple[bool, bool]  # whether variant and baseline rendered equal films, by scene


@dataclass(frozen=True)
class Area:
    """The rows of the overview under one heading."""

    title: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Overview:
    """The contents of the overview figure."""

    title: str
    areas: tuple[Area, ...]
    device: str


def overview_of(file: Path, results: Path) -> Overview:
    """The rows that `file` names, looked up in the results; raises FindingError where one is missing."""
    head = json.loads(file.read_text(encoding="utf-8"))
    sources = {name: source_of(results, about) for name, about in head["sources"].items()}

    def line(row: Mapping) -> Line:
        scenes = head["scenes"][row.get("scenes", "")]
        source, cells = sources[row["source"]], [f"{row['cell']} scene={scene}" for scene in scenes]
        ratios = [source.ratio(cell, row["over"]) for cell in cells]
        films = [source.same_film(cell, row["over"]) for cell in cells]
        return Line(row["label"], (ratios[0], ratios[1]), (films[0], films[1]))

    areas = tuple(Area(area["title"], tuple(map(line, area["rows"]))) for area in head["areas"])
    device = ", ".join(dict.fromkeys(source.device for source in sources.values()))
    return Overview(head["title"], areas, device)


def draw(overview: Overview) -> Figure:
    """Draws a row per optimisation with two markers: hollow for the open box, filled for the closed one."""
    lines = [line for area in overview.areas for line in area.lines]
    left = style.MARGIN + max(style.text_width(line.label, style.LABEL_SIZE) for line in lines) + 0.3
    texts = {id(line): [_text(*pair) for pair in zip(line.ratios, line.same_films, strict=True)] for line in lines}
    text_width = max(style.text_width(text, style.CAPTION_SIZE) for of in texts.values() for text in of)
    body = sum(_HEAD + _ROW * len(area.lines) + _GAP for area in overview.areas) + 0.75
    caption = (
        f"{overview.device}, 800x800, depth 8. Time with the optimisation over that of what heading or row name, "
        f"medians of nine, and {CONFIDENCE:.0%} intervals (narrower than most markers): left of 1 it pays. Grey band: "
        f"within {THRESHOLD:.0%}, the same. Hollow, first number: open box (scene cornell_open or its sibling), where "
        "paths escape; filled: closed box, where they live to the last bounce. aos: a path is a structure; "
        "soa: an array a number; packed: arrays of 16-byte pieces. Both sides of a ratio left the same film, "
        "bit for bit" + _but(lines) + "."
    )
    page = style.Page(left + _PLOT + 0.2 + text_width + style.MARGIN, body, overview.title, caption)
    axes = page.axes(left, 0.45, _PLOT, body - 0.75)
    height = body - 0.75
    axes.axvspan(1 - THRESHOLD, 1 + THRESHOLD, color="#e9e9e9", linewidth=0, zorder=0)
    axes.axvline(1, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    top = height
    for area in overview.areas:
        page.text(style.MARGIN, top + 0.45 - _HEAD / 2, area.title, size=style.LABEL_SIZE, weight="bold", va="center")
        top -= _HEAD
        for index, line in enumerate(area.lines):
            middle = top - _ROW * (index + 0.5)
            axes.axhline(middle, color="#e4e4e4", linewidth=0.7, zorder=0)
            page.text(left - 0.12, middle + 0.45, line.label, size=style.LABEL_SIZE, va="center", ha="right")
            for ratio, text, (_, fill, offset) in zip(line.ratios, texts[id(line)], _BOXES, strict=True):
                y = middle + offset * _ROW
                _mark(axes, y, ratio, fill)
                page.text(
                    left + _PLOT + 0.2, middle + 0.45 + 1.35 * offset * _ROW, text,
                    size=style.CAPTION_SIZE - 1, va="center", color=_COLOURS[ratio.word],
                )  # fmt: skip
        top -= _ROW * len(area.lines) + _GAP
    _scale(axes, height, lines)
    handles = [
        Line2D([], [], color="black", marker="o", fillstyle=fill, linestyle="", label=name) for name, fill, _ in _BOXES
    ]
    handles += [
        Line2D([], [], color=colour, marker="s", linestyle="", label=_WORDS[word])
        for word, colour in _COLOURS.items()
        if any(ratio.word == word for line in lines for ratio in line.ratios)
    ]
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), ncols=len(handles), frameon=False,
        fontsize=style.CAPTION_SIZE, handletextpad=0.1, columnspacing=1.0, borderaxespad=0.1,
    )  # fmt: skip
    return page.figure


def _mark(axes: Axes, y: float, ratio: Ratio, fill: str) -> None:
    colour, estimate = _COLOURS[ratio.word], ratio.estimate
    axes.plot([estimate.low, estimate.high], [y, y], color=colour, linewidth=1.4, zorder=3)
    axes.plot(
        [estimate.value], [y], color=colour, marker="o", fillstyle=fill, markersize=5, markeredgewidth=1.3, zorder=4,
        markerfacecoloralt="white", markerfacecolor=colour if fill == "full" else "white",
    )  # fmt: skip


def _but(lines: Sequence[Line]) -> str:
    if all(same for line in lines for same in line.same_films):
        return ""
    return "; of *, whose arithmetic may round as it likes, the same mean"


def _text(ratio: Ratio, same_film: bool) -> str:
    return f"{ratio} {_WORDS[ratio.word]}{'' if same_film else ' *'}"


def _scale(axes: Axes, height: float, lines: Sequence[Line]) -> None:
    ends = [end for line in lines for ratio in line.ratios for end in (ratio.estimate.low, ratio.estimate.high)]
    axes.set_xscale("log")
    axes.set_xlim(min(ends) / 1.12, max(ends) * 1.12)
    axes.set_ylim(0, height)
    style.ticks(axes.xaxis, FixedLocator([one for one in _TICKS if min(ends) / 1.12 < one < max(ends) * 1.12]))
    axes.yaxis.set_major_locator(NullLocator())
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("time with over time without, log scale")
    axes.grid(axis="x")
