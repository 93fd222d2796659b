"""The verdicts of a study in words: counts, and each choice's ratio over its baseline with its extremes' places."""

from collections import Counter
from collections.abc import Callable, Sequence

from ptbench.convergence.assessment import NO_VERDICT, Assessment, assess
from ptbench.convergence.efficiency import (
    DISTURBED,
    HIGHER,
    LOWER,
    NOT_TOLD_APART,
    baseline_among,
    by_place,
    compare,
    ends_beside_one,
    names_in,
)
from ptbench.io.cells import Cell, Result, Study
from ptbench.numbers import plural, ratio
from ptbench.stats.estimates import FASTER, SAME, SLOWER, UNSURE, interval_of_ratio
from ptbench.studies.questions import Question, dimension, question_of, swept_by, varying_dimensions
from ptbench.studies.rows import Row, measure
from ptbench.studies.withdrawn import between

WORDS = (FASTER, SLOWER, SAME, UNSURE)
NOT_COMPARED = "—"


def verdict_counts(result: Result) -> Counter[str]:
    """The number of times that each verdict was given, where a cell of two studies counts twice."""
    counts: Counter[str] = Counter()
    for study in result.studies:
        judged = [one for cell in result.cells_of(study) if (one := assess(result).get(cell.name)) is not None]
        # Convergence studies have verdicts on errors, and no ratios of times.
        rows = [] if judged else measure(result, study)
        counts.update(one.verdict.word for one in judged)
        counts.update(row.verdict.word for row in rows if row.verdict is not None)
    return counts


def counts_text(counts: Counter[str]) -> str:
    """Counts of verdicts as "2 FASTER, 1 SLOWER", without those that do not occur."""
    words = [*WORDS, *(word for word in counts if word not in WORDS)]
    named = {NOT_COMPARED: "without a baseline"}
    return ", ".join(f"{counts[word]} {named.get(word, word)}" for word in words if counts[word]) or "none"


def study_verdicts(result: Result, study: Study) -> tuple[str, list[str]]:
    """A sentence on a whole study, and one on each of its choices."""
    if any(cell.convergence is not None for cell in result.cells_of(study)):
        return _convergence(result, study)
    question = question_of(result, study)
    if question is None:
        return "This study compares no choices.", []
    compared = [row for row in measure(result, study) if row.verdict is not None]
    if not compared:
        return f"Nothing to hold against `{question.axis}={question.baseline}`: no other choice has times.", []
    where = where_in(result, study, question)
    counts = Counter(row.verdict.word for row in compared)
    head = (
        f"Held against `{question.axis}={question.baseline}`, all else equal: "
        f"{plural(len(compared), 'comparison')}, {counts_text(counts)}."
    )
    choices = dict.fromkeys(question.choice_of(row.cell) for row in compared)
    return head, [_choice_text(choice, _of(compared, question, choice), where) for choice in choices]


def _of(rows: Sequence[Row], question: Question, choice: str) -> list[Row]:
    return [row for row in rows if question.choice_of(row.cell) == choice]


def where_in(result: Result, study: Study, question: Question) -> Callable[[Cell], str]:
    """A function that tells a study's cells with one choice apart: by scene, depth and whatever else varies."""
    cells = result.cells_of(study)
    swept = swept_by(study)
    names = [name for name in (swept,) if name != "scene" and len({dimension(cell, name) for cell in cells}) > 1]
    names += varying_dimensions(cells, question, swept)
    has_scenes = len({cell.scene for cell in cells}) > 1

    def where(cell: Cell) -> str:
        values = [(name, dimension(cell, name)) for name in names]
        told = [f"{name}={value}" for name, value in values if value is not None]
        return ", ".join([cell.scene, *told] if has_scenes or not told else told)

    return where


def _choice_text(choice: str, rows: Sequence[Row], where: Callable[[Cell], str]) -> str:
    parts = []
    for word in WORDS:
        found = [row for row in rows if row.verdict.word == word]
        if found:
            many = f" in {len(found)} of {len(rows)}" if len(rows) > 1 else ""
            parts.append(f"**{word}**{many}, {range_text(found, where)}")
    alone = [row for row in rows if row.verdict.word not in WORDS]
    if alone:
        reasons = dict.fromkeys(row.verdict.reason for row in alone)
        parts.append(f"no verdict in {len(alone)} of {len(rows)} ({'; '.join(reasons)})")
    said = "".join(f" ({note})" for note in dict.fromkeys(row.verdict.note for row in rows if row.verdict.note))
    return f"`{choice}`: " + "; ".join(parts) + said + "."


def range_text(rows: Sequence[Row], where: Callable[[Cell], str]) -> str:
    """The lowest and the highest of the ratios with their intervals and places."""
    ordered = sorted((row for row in rows if row.ratio is not None), key=lambda row: row.ratio.value)
    ends = ordered if len(ordered) < 2 else [ordered[0], ordered[-1]]
    said = ((ratio(row.ratio.value), interval_of_ratio(row.ratio), f"({where(row.cell)})") for row in ends)
    return " to ".join(" ".join(filter(None, parts)) for parts in said) or "no ratio"


def _convergence(result: Result, study: Study) -> tuple[str, list[str]]:
    assessed = assess(result)
    members = [assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed]
    words = Counter(one.verdict.word for one in members)
    head = f"{plural(len(members), 'variant')} judged: {', '.join(f'{n} {word}' for word, n in words.items())}."
    places = by_place(members)
    items = []
    for place, group in places.items():
        baseline = baseline_among(result, group)
        names = names_in(group, baseline)
        title = place.title(list(places))
        items.append(f"{title}: {_judged(group, names)}.")
        if efficiency := _efficiency(group, names, baseline):
            items.append(f"{title}, efficiency against `{names[baseline.cell.name]}`: {efficiency}.")
    return head, items


def _judged(group: Sequence[Assessment], names: dict[str, str]) -> str:
    found: dict[str, list[str]] = {}
    for one in group:
        why = f" ({one.verdict.reason})" if one.verdict.reason and one.verdict.word in (NO_VERDICT, "invalid") else ""
        found.setdefault(f"**{one.verdict.text}**{why}", []).append(f"`{names[one.cell.name]}`")
    return "; ".join(f"{', '.join(cells)} {text}" for text, cells in found.items())


def _efficiency(group: Sequence[Assessment], names: dict[str, str], baseline: Assessment | None) -> str:
    """Which cells need more or less time than the baseline for equal noise, by their whole intervals."""
    if baseline is None:
        return ""
    sides: dict[str, list[str]] = {word: [] for word in (HIGHER, LOWER, NOT_TOLD_APART, DISTURBED, "not defined")}
    for one in group:
        if one is baseline:
            continue
        compared = compare(one, baseline)
        if compared is None or not compared.word:
            sides["not defined"].append(f"`{names[one.cell.name]}`")
            continue
        estimate = compared.efficiency
        mark = " (withdrawn)" if between(one.cell, baseline.cell) else ""
        sides[compared.word].append(
            f"`{names[one.cell.name]}` {ratio(estimate.value)} {ends_beside_one(estimate)}{mark}"
        )
    return "; ".join(f"{side}: {', '.join(cells)}" for side, cells in sides.items() if cells)
