"""The overview figure of a run: one row per comparison, its ratio with its interval, grouped by scene."""

from collections.abc import Sequence
from dataclasses import replace

from ptbench.document.blocks import Image
from ptbench.figures import forest, style
from ptbench.figures.caption import setting
from ptbench.figures.forest import Data, Group, Item
from ptbench.figures.saving import svg_of
from ptbench.io.cells import Cell, Result, Study
from ptbench.io.files import one_line, safe_name
from ptbench.report.drawing import css_size
from ptbench.report.findings import Efficiency, compared_rows, efficiencies_of, is_convergence
from ptbench.stats.estimates import (
    INTERVAL_TEXT,
    THRESHOLD,
    Verdict,
    confirmed,
    geometric_mean_of_ratios,
    verdict_of_ratio,
    withheld,
)
from ptbench.studies.questions import Question, dimension, label_of, question_of, swept_by, varying_dimensions
from ptbench.studies.rows import Row, baseline_of
from ptbench.studies.withdrawn import between

MOST_ROWS = 44  # largest number of rows on an overview page; more are averaged by choice and scene


def draw_overview(result: Result, title: str, prefix: str) -> tuple[Image, ...]:
    """Draws the overview figure as pages; empty where nothing is compared. `prefix` begins the images' names."""
    found = [data for data in (_times(result, title), _efficiencies(result, title)) if data is not None]
    return tuple(image for data in found for image in _images(data, prefix))


def _images(data: Data, prefix: str) -> list[Image]:
    parts = forest.pages(data.groups, MOST_ROWS)
    images = []
    for number, groups in enumerate(parts, 1):
        page = replace(data, groups=groups)
        if len(parts) > 1:
            page = replace(page, title=f"{data.title}, page {number} of {len(parts)}")
        name = safe_name(f"{prefix}_overview_{data.kind}" + (f"_{number}" if len(parts) > 1 else ""))
        alt = one_line(f"{page.title}. {page.caption}")
        with style.applied():
            wide, narrow = forest.draw(page), forest.draw_narrow(page)
            images.append(replace(_image(wide, name, alt), narrow=_image(narrow, f"{name}_narrow", alt)))
    return images


def _image(figure, name: str, alt: str) -> Image:
    return Image(f"{name}.svg", svg_of(figure).encode(), alt, *css_size(figure))


# The functions that follow draw ratios of times in a report's overview figure.

Compared = tuple[Study, Question, Row]


def _times(result: Result, title: str) -> Data | None:
    compared: list[Compared] = []
    for study in result.studies:
        question = None if is_convergence(result, study) else question_of(result, study)
        if question is not None:
            compared += [(study, question, row) for row in compared_rows(result, study)]
    if not compared:
        return None
    many = len(compared) > MOST_ROWS
    studies = {study.name: (study, question) for study, question, _ in compared}
    groups = []
    for scene in dict.fromkeys(row.cell.scene for _, _, row in compared):
        items: list[Item] = []
        for study, question in studies.values():
            of = [row for other, _, row in compared if other is study and row.cell.scene == scene]
            told = study.name if len(studies) > 1 and study.name != question.axis else ""
            items += _means(result, study, question, of, told) if many else _each(result, study, question, of, told)
        groups.append(Group(scene, tuple(items)))
    baselines = "; ".join(
        dict.fromkeys(
            f"{study.name}: {question.axis}={question.baseline}"
            if len(studies) > 1
            else f"{question.axis}={question.baseline}"
            for study, question in studies.values()
        )
    )
    rows = "Rows: a choice and scene, where a study has several comparisons of them (×n) their geometric mean. "
    caption = (
        f"{rows if many else ''}Time over the baseline's, all else equal; left of 1 the choice pays. Bars: "
        f"{INTERVAL_TEXT}, both sides resampled. Grey: within {100 * THRESHOLD:.0f} % of 1, which counts as no "
        f"difference. "
        f"Baselines: {baselines}.\n{setting(result, [row.cell for _, _, row in compared], told=False)}"
    )
    return Data(
        f"{title}: {'every choice by scene' if many else 'every comparison'}",
        "Time / baseline's",
        caption,
        tuple(groups),
        THRESHOLD,
        "times",
    )


def _prefixed(told: str, label: str, cells: Sequence[Cell], baselines: Sequence[Cell | None]) -> str:
    marks = [between(cell, base) for cell, base in zip(cells, baselines, strict=True) if base is not None]
    return (f"{told}: " if told else "") + label + (" (withdrawn)" if any(marks) else "")


def _each(result: Result, study: Study, question: Question, rows: Sequence[Row], told: str) -> list[Item]:
    cells = result.cells_of(study)
    swept = swept_by(study)
    # The scene is omitted from rows' labels because it is their group's title.
    names = [swept] if swept != "scene" and len({dimension(cell, swept) for cell in cells}) > 1 else []
    names += varying_dimensions(cells, question, swept)
    items = []
    for row in rows:
        label = label_of(row.cell, question, names)
        base = baseline_of(row.cell, cells, question)
        items.append(Item(_prefixed(told, label, [row.cell], [base]), row.ratio, row.verdict.word))
    return items


def _means(result: Result, study: Study, question: Question, rows: Sequence[Row], told: str) -> list[Item]:
    """Rows of geometric means, one per choice, over its ratios in a scene; verdicts follow the rule for cells."""
    cells = result.cells_of(study)
    items = []
    for choice in dict.fromkeys(question.choice_of(row.cell) for row in rows):
        of = [row for row in rows if question.choice_of(row.cell) == choice]
        bases = [baseline_of(row.cell, cells, question) for row in of]
        label = choice + (f" ×{len(of)}" if len(of) > 1 else "")
        if len(of) == 1:
            ratio, word = of[0].ratio, of[0].verdict.word
        else:
            pairs = [(row.cell, base) for row, base in zip(of, bases, strict=True)]
            ratio = geometric_mean_of_ratios([(cell.ms_per_spp, base.ms_per_spp) for cell, base in pairs])
            word = _mean_verdict(ratio, of, pairs).word
        items.append(Item(_prefixed(told, label, [row.cell for row in of], bases), ratio, word))
    return items


def _mean_verdict(ratio, rows: Sequence[Row], pairs: Sequence[tuple[Cell, Cell]]) -> Verdict:
    clocked = [(cell.mega_cycles_per_spp, base.mega_cycles_per_spp) for cell, base in pairs]
    in_cycles = None
    if all(side is not None for sides in clocked for side in sides):
        in_cycles = verdict_of_ratio(geometric_mean_of_ratios(clocked))
    verdict = confirmed(verdict_of_ratio(ratio), in_cycles)
    reasons = [row.verdict.reason for row in rows if row.verdict.withheld]
    return withheld(verdict, reasons[0]) if reasons else verdict


# The functions that follow draw efficiencies in a report's overview figure.


def _efficiencies(result: Result, title: str) -> Data | None:
    places: dict[str, dict[tuple, Item]] = {}
    for study in result.studies:
        if is_convergence(result, study):
            for one in efficiencies_of(result, study):
                places.setdefault(one.place, {}).setdefault((one.name, one.baseline), _item(one))
    if not places:
        return None
    cells = [cell for cell in result.cells if cell.convergence is not None]
    caption = (
        "Efficiency over the baseline's: how much less time the same noise takes; right of 1 the variant pays. A "
        "plateau is not in it. Bars: 95 %, bootstrap over seeds.\n" + setting(result, cells, told=False)
    )
    groups = tuple(Group(place, tuple(items.values())) for place, items in places.items())
    return Data(f"{title}: efficiency at equal error", "Efficiency / baseline's", caption, groups, 0, "efficiency")


def _item(one: Efficiency) -> Item:
    against = "" if one.baseline == "baseline" else f" over {one.baseline}"
    return Item(one.name + against + (" (withdrawn)" if one.is_withdrawn else ""), one.estimate, one.word)
