"""Forest plots of a comparison: which ratios go on which page, and the caption that makes each page self-contained."""

from collections import Counter
from pathlib import Path

from ptbench.compare.compared import Compared
from ptbench.compare.text import Labels
from ptbench.compare.verdicts import Comparison, Row
from ptbench.figures import style
from ptbench.figures.caption import setting
from ptbench.figures.forest import Data, Group, Item, draw, pages
from ptbench.figures.saving import save_figure
from ptbench.stats.estimates import INTERVAL_TEXT
from ptbench.terminal import visible

MOST_ROWS = 60  # rows in one forest plot; more rows are split over pages


def save_forest(compared: Compared, index: int, folder: Path) -> list[Path]:
    """Saves a comparison as forest_MARK.png and .svg, or as forest_MARK_1, ... if it needs several pages."""
    comparison = compared.comparisons[index]
    mark = compared.marks_of(comparison)[1]
    parts = collect(compared, comparison)
    written = []
    for number, data in enumerate(parts, 1):
        name = f"forest_{mark}" + (f"_{number}" if len(parts) > 1 else "")
        with style.applied():
            written += save_figure(draw(data), folder, name)
    return written


def collect(compared: Compared, comparison: Comparison) -> list[Data]:
    """The data of each page of a forest plot, with the geometric means on every page."""
    one, two = compared.marks_of(comparison)
    rows: dict[tuple, list[Row]] = {}
    for row in comparison.rows:
        cell, spp = row.pair.reference, (row.pair.reference.spp, row.pair.other.spp)
        rows.setdefault((cell.scene, cell.resolution_text, cell.depth, spp), []).append(row)
    order = list(dict.fromkeys(cell.scene for cell in comparison.reference.cells))
    keys = sorted(rows, key=lambda key: (order.index(key[0]), *key[1:]))
    groups = [Group(_title(*key), tuple(_item(row, compared.labels) for row in rows[key])) for key in keys]
    means = _means(comparison)
    parts = pages(groups, MOST_ROWS - len(means.items))
    caption = _caption(compared, comparison)
    title = f"{comparison.other.about('machine')} against {comparison.reference.about('machine')}"
    if comparison.one_machine:
        gits = [result.git[:12] for result in (comparison.other, comparison.reference)]
        repeated = ", an A/A run" if comparison.repeated else ""
        title = f"{comparison.reference.about('machine')}: {gits[0]} against {gits[1]}{repeated}"
    return [
        Data(
            title + (f", page {number} of {len(parts)}" if len(parts) > 1 else ""),
            f"Time of {two} / time of {one}",
            caption,
            (means, *part),
            comparison.threshold,
        )
        for number, part in enumerate(parts, 1)
    ]


def _title(scene: str, resolution: str, depth: int, spp: tuple[int, int]) -> str:
    told = f"{spp[0]} spp" if spp[0] == spp[1] else f"{spp[0]} against {spp[1]} spp"
    return f"{scene}, {resolution.replace('x', '×')}, depth {depth}, {told}"


def _item(row: Row, label: Labels) -> Item:
    return Item(label(row.pair.reference), row.ratio, row.verdict.word)


def _means(comparison: Comparison) -> Group:
    items = [Item("in time", comparison.time.estimate, comparison.time.verdict.word)]
    if comparison.cycles.estimate is not None:
        items.append(Item("in cycles", comparison.cycles.estimate, comparison.cycles.verdict.word))
    return Group(f"Geometric mean of {comparison.time.used} pairs", tuple(items))


def _caption(compared: Compared, comparison: Comparison) -> str:
    one, two = compared.marks_of(comparison)
    label = compared.labels
    alone = Counter(item.in_reference for item in comparison.matching.alone)
    lines = [
        f"Points: median render wall time per sample per pixel of {two} over that of {one}. Bars: {INTERVAL_TEXT}, "
        f"both sides resampled. Grey: within {100 * comparison.threshold:.3g} % of 1, which counts as no difference"
        + (" (noise floor of A/A runs)." if comparison.floors else "."),
        f"Variants: {'.'.join(label.axes)}" + (f"; all: {', '.join(label.fixed)}." if label.fixed else "."),
        f"Left out: {alone[True]} cells of {one} and {alone[False]} of {two} (compare.md says why).",
    ]
    for mark, result, cells in (
        (one, comparison.reference, [row.pair.reference for row in comparison.rows]),
        (two, comparison.other, [row.pair.other for row in comparison.rows]),
    ):
        lines.append(f"{mark}: {visible(result.path.name)}. {setting(result, cells, told=False)}")
    return "\n".join(lines)
