"""The opening of a report: a run's findings in sentences made from its rows."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from ptbench.convergence.assessment import assess
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
from ptbench.io.stability import BROKEN, FAILED, KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Stability
from ptbench.numbers import plural, ratio
from ptbench.report.verdicts import WORDS, counts_text, range_text, where_in
from ptbench.stability.layout import count
from ptbench.stats.estimates import (
    CLOCK_UNKNOWN,
    FASTER,
    SAME,
    SLOWER,
    THRESHOLD,
    UNSURE,
    Estimate,
    Verdict,
)
from ptbench.studies.questions import Question, question_of
from ptbench.studies.rows import Row, measure
from ptbench.studies.withdrawn import between

_NAMED = 3  # most choices with one outcome that a finding names; of more, only the two extremes


@dataclass(frozen=True)
class Findings:
    """The findings of a file: a sentence on the whole, and one or more on each study."""

    head: str
    items: tuple[str, ...] = ()


def is_convergence(result: Result, study: Study) -> bool:
    """Whether a study measures errors, so that it has no ratios of times."""
    return any(cell.convergence is not None for cell in result.cells_of(study))


def compared_rows(result: Result, study: Study) -> list[Row]:
    """The rows of a study that have a ratio over a baseline."""
    return [row for row in measure(result, study) if row.verdict is not None and row.ratio is not None]


def findings_of(result: Result) -> Findings:
    """The findings of a result of `ptbench run`."""
    verdicts: list[Verdict] = []
    items = []
    efficiencies = 0
    for study in result.studies:
        if is_convergence(result, study):
            found = efficiencies_of(result, study)
            efficiencies += len(found)
            items.append(_errors(result, study, found))
            continue
        question = question_of(result, study)
        rows = [] if question is None else compared_rows(result, study)
        verdicts += [row.verdict for row in rows]
        if rows:
            items.append(_times(result, study, question, rows))
    if not items:
        return Findings("This file compares nothing: no study has a choice and its baseline with times.")
    heads = []
    if verdicts:
        counts = Counter(verdict.word for verdict in verdicts)
        heads.append(f"{plural(len(verdicts), 'comparison')} of times, all else equal: {counts_text(counts)}.")
        heads += _unsure(verdicts)
    if efficiencies:
        told = "how much less time than the baseline the same noise takes"
        heads.append(f"{plural(efficiencies, 'comparison')} of efficiency, {told}.")
    return Findings(" ".join(heads), tuple(items))


def _unsure(verdicts: Sequence[Verdict]) -> list[str]:
    """Sentences on why verdicts are UNSURE, which must not be read as SAME."""
    reasons = Counter(_reason(verdict) for verdict in verdicts if verdict.word == UNSURE)
    said = []
    if reasons:
        told = "; ".join(f"{number} for {reason}" for reason, number in reasons.items())
        said.append(f"UNSURE is not SAME; these data do not decide: {told}.")
    if alone := sum(CLOCK_UNKNOWN in verdict.note for verdict in verdicts):
        said.append(f"{alone} of the verdicts are in time alone, the clock being unknown.")
    return said


def _reason(verdict: Verdict) -> str:
    if verdict.needs_samples:
        return "too few samples"
    if verdict.withheld or "cycles" in verdict.reason:
        return verdict.reason
    return f"an interval that reaches both sides of the {THRESHOLD:.0%} limit".replace("%", " %")


# The functions that follow word the findings of studies of times.


def _times(result: Result, study: Study, question: Question, rows: Sequence[Row]) -> str:
    """The answer of a study of times, then its choices by outcome, best first, with extremes' intervals and places."""
    outcomes: dict[tuple[str, ...], list[str]] = {}
    for choice in dict.fromkeys(question.choice_of(row.cell) for row in rows):
        words = {row.verdict.word for row in rows if question.choice_of(row.cell) == choice}
        kept = (FASTER, SLOWER) if {FASTER, SLOWER} <= words else tuple(word for word in WORDS if word in words)
        outcomes.setdefault(kept, []).append(choice)
    where = where_in(result, study, question)
    parts = []
    for words in sorted(outcomes, key=lambda words: [WORDS.index(word) for word in words]):
        of = [row for row in rows if question.choice_of(row.cell) in outcomes[words]]
        places = len(of) > len(outcomes[words])
        parts.append(f"{_outcome(words, places)}: {_ends(outcomes[words], of, question, where)}.")
    notes = (note for row in rows for note in row.verdict.note.split("; ") if note not in ("", CLOCK_UNKNOWN))
    counts = counts_text(Counter(row.verdict.word for row in rows))
    against = f"against `{question.axis}={question.baseline}`: {counts}"
    head = f"**{study.title or study.name}**: {_answer(outcomes)} ({against})."
    return " ".join([head, *parts, *(f"Note: {mark}." for mark in dict.fromkeys(notes))])


def _answer(outcomes: Mapping[tuple[str, ...], Sequence[str]]) -> str:
    """A sentence on whether any choice pays, no firmer than the verdicts."""
    words = {word for outcome in outcomes for word in outcome}
    if sure := outcomes.get((FASTER,)):
        return _pays(sure)
    if FASTER in words and SLOWER in words:
        return "it depends on the place what pays"
    if FASTER in words:
        found = [choice for outcome, choices in outcomes.items() if FASTER in outcome for choice in choices]
        return f"{_pays(found)} in some places"
    if words == {UNSURE}:
        return "these data do not decide"
    if words == {SAME}:
        return "no difference"
    return "nothing pays" if UNSURE not in words else "nothing is shown to pay"


def _pays(choices: Sequence[str]) -> str:
    named = ", ".join(f"`{choice}`" for choice in choices[:_NAMED]) + (" and others" if len(choices) > _NAMED else "")
    return f"{named} {'pays' if len(choices) == 1 else 'pay'}"


def _outcome(words: Sequence[str], has_places: bool) -> str:
    if len(words) == 1:
        return f"**{words[0]}**" + (" everywhere" if has_places else "")
    if tuple(words) == (FASTER, SLOWER):
        return f"**{FASTER}** here and **{SLOWER}** there"
    return " or ".join(f"**{word}**" for word in words)


def _ends(choices: Sequence[str], rows: Sequence[Row], question: Question, where: Callable[[Cell], str]) -> str:
    """The range of each choice that pays somewhere; of several others the lowest and the highest ratio."""
    alone = len(choices) == 1 or (len(choices) <= _NAMED and any(row.verdict.word == FASTER for row in rows))
    if not alone:
        named = ", ".join(f"`{choice}`" for choice in choices) if len(choices) <= _NAMED else f"{len(choices)} choices"
        return f"{named}, {range_text(rows, lambda cell: f'`{question.choice_of(cell)}`, {where(cell)}')}"
    each = ((choice, [row for row in rows if question.choice_of(row.cell) == choice]) for choice in choices)
    return "; ".join(f"`{choice}`{_mixed(of)} {range_text(of, where)}" for choice, of in each)


def _mixed(rows: Sequence[Row]) -> str:
    counts = Counter(row.verdict.word for row in rows)
    return f" ({counts_text(counts)})" if len(counts) > 1 else ""


# The functions that follow word the findings of studies of errors.


@dataclass(frozen=True)
class Efficiency:
    """The efficiency of a variant over its baseline, in one scene and setting."""

    place: str
    name: str
    baseline: str
    estimate: Estimate
    is_withdrawn: bool
    word: str  # side of 1 on which the efficiency's interval lies, or why no verdict is given


def efficiencies_of(result: Result, study: Study) -> list[Efficiency]:
    """The efficiencies of a study that are defined and have an interval, by scene and setting."""
    assessed = assess(result)
    places = by_place([assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed])
    found = []
    for place, group in places.items():
        baseline = baseline_among(result, group)
        names = names_in(group, baseline)
        for one in group:
            compared = None if baseline in (None, one) else compare(one, baseline)
            if compared is not None and compared.word:
                mark = bool(between(one.cell, baseline.cell))
                name, base = names[one.cell.name], names[baseline.cell.name]
                title = place.title(list(places))
                found.append(Efficiency(title, name, base, compared.efficiency, mark, compared.word))
    return found


def _errors(result: Result, study: Study, found: Sequence[Efficiency]) -> str:
    """A sentence on how many variants converge, and which need the least and the most time for equal noise."""
    assessed = assess(result)
    members = [assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed]
    words = Counter(one.verdict.word for one in members)
    judged = ", ".join(f"{number} {word}" for word, number in words.items())
    text = f"**{study.title or study.name}**: {plural(len(members), 'variant')} judged by error: {judged or 'none'}."
    if not found:
        return f"{text} No efficiencies to compare."
    counts = Counter(one.word for one in found)
    told = ", ".join(f"{counts[word]} {word}" for word in (HIGHER, LOWER, NOT_TOLD_APART, DISTURBED) if counts[word])
    text += f" Efficiency against the baseline's: {told}."
    for word, what, end in ((HIGHER, "Highest", max), (LOWER, "Lowest", min)):
        if of := [one for one in found if one.word == word]:
            text += f" {what}: {_said(end(of, key=lambda one: one.estimate.value))}."
    return text


def _said(one: Efficiency) -> str:
    mark = ", withdrawn" if one.is_withdrawn else ""
    against = f"against `{one.baseline}`, " if one.baseline != "baseline" else ""
    return f"`{one.name}` {ratio(one.estimate.value)} {ends_beside_one(one.estimate)} ({against}{one.place}{mark})"


# The functions that follow word the findings of stability results.


def stability_findings(stability: Stability) -> Findings:
    """The findings of a stability result: required checks, checks for comparison, and families with failures."""
    rows = [row for row in stability.rows if row.status != NOT_APPLICABLE]
    required = [row for row in rows if row.must_pass]
    bad = [row for row in required if row.status in (FAILED, BROKEN)]
    head = f"Of {plural(len(required), 'check')} that must pass, {_statuses(required)}."
    if families := dict.fromkeys(row.case.family for row in bad):
        head += f" **Failures in {', '.join(families)}.**"
    items = []
    compared = [row for row in rows if not row.must_pass]
    for family in dict.fromkeys(row.case.family for row in compared):
        items.append(
            f"**{family}**, variants there to compare: {_statuses(r for r in compared if r.case.family == family)}."
        )
    return Findings(head, tuple(items))


def _statuses(rows: Iterable) -> str:
    rows = list(rows)
    named = ((PASSED, "passed"), (FAILED, "failed"), (BROKEN, "broke"), (KNOWN_LIMIT, "at a known limit"))
    return ", ".join(f"{number} {name}" for status, name in named if (number := count(rows, status))) or "none"
