"""The measurements of a study, computed once for its figure and its table: medians, ratios, and verdicts."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from ptbench.io.axes import SORT_KEY, SORTING
from ptbench.io.cells import Cell, Comparison, Result, Study
from ptbench.stats.estimates import (
    CLOCK_UNKNOWN,
    THRESHOLD,
    UNSURE,
    Estimate,
    Verdict,
    confirmed,
    median_estimate,
    ratio_estimate,
    verdict_of_ratio,
    withheld,
)
from ptbench.studies.disturbed import CONTENDED, THROTTLED, doubt_of
from ptbench.studies.questions import Question, dimension, label_of, question_of, swept_by, varying_dimensions
from ptbench.studies.withdrawn import between


@dataclass(frozen=True)
class Row:
    """One cell of a study with its ratio to the baseline and its verdict."""

    cell: Cell
    label: str
    is_baseline: bool
    estimate: Estimate | None
    mega_rays_per_second: Estimate | None
    ratio: Estimate | None
    verdict: Verdict | None


_LAST: list[tuple[Result, dict[str | None, list[Row]]]] = []


def measure(result: Result, study: Study | None) -> list[Row]:
    """The rows of all cells of a study (None: the cells of no study), measured or not, in the file's order.

    The last file's rows are cached, as figure and table of a study ask for the same.
    """
    if not _LAST or _LAST[0][0] is not result:
        _LAST[:] = [(result, {})]
    measured = _LAST[0][1]
    name = None if study is None else study.name
    if name not in measured:
        measured[name] = _measure(result, study)
    return list(measured[name])


def _measure(result: Result, study: Study | None) -> list[Row]:
    cells = result.cells_of(study) if study is not None else tuple(cell for cell in result.cells if not cell.studies)
    question = question_of(result, study)
    dimensions = varying_dimensions(cells, question, swept_by(study))
    rows = []
    for cell in cells:
        estimate = rays = ratio = verdict = None
        is_baseline = question is not None and dimension(cell, question.axis) == question.baseline
        if cell.measured:
            estimate = median_estimate(cell.ms_per_spp)
            rays = median_estimate([sample.mega_rays_per_second for sample in cell.samples])
            if question is not None and not is_baseline:
                ratio, verdict = _judged(result, study, cell, cells, question)
        compared = question is not None or (study is not None and study.along != "")
        label = label_of(cell, question, dimensions) if compared else cell.variant
        rows.append(Row(cell, label, is_baseline, estimate, rays, ratio, verdict))
    return rows


def _judged(
    result: Result, study: Study | None, cell: Cell, cells: Sequence[Cell], question: Question
) -> tuple[Estimate | None, Verdict]:
    """The ratio and verdict of a cell as the run stated them; for files without comparisons, by the same rule."""
    if result.comparisons is None or study is None:
        return _against_baseline(cell, cells, question)
    said = result.comparisons.get((study.name, cell.name))
    baseline = next((one for one in cells if said is not None and one.name == said.baseline), None)
    if said is None or said.ratio is None or baseline is None:
        return None, _without_ratio(question, baseline)
    low, high = said.interval or (None, None)
    ratio = Estimate(said.ratio, low, high, min(len(cell.samples), len(baseline.samples)))
    return ratio, _verdict_of(said, ratio, cell, baseline)


def _verdict_of(said: Comparison, ratio: Estimate, cell: Cell, baseline: Cell) -> Verdict:
    """The run's verdict with its reason in words; withdrawals, of which the run could not know, are not applied."""
    by_time = verdict_of_ratio(ratio) if said.in_time == UNSURE else Verdict(said.in_time)
    verdict = confirmed(by_time, Verdict(said.in_cycles) if said.in_cycles else None)
    verdict = replace(verdict, note=_note(cell, baseline, is_clock_unknown=not said.in_cycles))
    if said.reason_code in ("contended", "throttled"):
        return withheld(verdict, THROTTLED if said.reason_code == "throttled" else CONTENDED)
    return replace(verdict, word=said.word)


def _note(cell: Cell, baseline: Cell, *, is_clock_unknown: bool) -> str:
    return "; ".join([entry.mark for entry in between(cell, baseline)] + [CLOCK_UNKNOWN] * is_clock_unknown)


def _without_ratio(question: Question, baseline: Cell | None) -> Verdict:
    name = f"{question.axis}={question.baseline}"
    if baseline is None:
        return Verdict("—", f"no cell with {name} and all else equal")
    return Verdict("—", f"the baseline {name} has no times ({baseline.status})")


def _against_baseline(cell: Cell, cells: Sequence[Cell], question: Question) -> tuple[Estimate | None, Verdict]:
    baseline = baseline_of(cell, cells, question)
    if baseline is None or not baseline.measured:
        return None, _without_ratio(question, baseline)
    return time_ratio(cell, baseline)


def time_ratio(
    cell: Cell, baseline: Cell, threshold: float = THRESHOLD, *, one_clock: bool = True
) -> tuple[Estimate, Verdict]:
    """The time ratio of two measured cells, per sample per pixel, and its verdict.

    `one_clock`: both ran on one machine, so that a different ratio in cycles means that the clock changed.
    """
    ratio = ratio_estimate(cell.ms_per_spp, baseline.ms_per_spp)
    cycles = cycles_ratio(cell, baseline) if one_clock else None
    in_cycles = None if cycles is None else verdict_of_ratio(cycles, threshold)
    note = _note(cell, baseline, is_clock_unknown=one_clock and cycles is None)
    verdict = replace(confirmed(verdict_of_ratio(ratio, threshold), in_cycles), note=note)
    doubt = doubt_of((cell, baseline))
    return ratio, withheld(verdict, doubt) if doubt else verdict


def cycles_ratio(cell: Cell, baseline: Cell) -> Estimate | None:
    """The ratio of two cells in clock cycles; None where a clock was not measured."""
    cycles, baseline_cycles = cell.mega_cycles_per_spp, baseline.mega_cycles_per_spp
    return None if cycles is None or baseline_cycles is None else ratio_estimate(cycles, baseline_cycles)


# Axes that only refine another axis, as name: (refined axis, its choice with which the refinement has no effect).
_QUALIFIES = {SORT_KEY: (SORTING, "none")}


def baseline_of(cell: Cell, cells: Iterable[Cell], question: Question) -> Cell | None:
    """The baseline cell of `cell`, which differs only in what the question is about.

    Equal samples per pixel are preferred, not required: times are per sample. Tunables of both cells must be equal, or
    both at their choice's standard (which may differ); those of the baseline alone should be at theirs.
    """
    moot = [name for name, idle in _QUALIFIES.items() if idle == (question.axis, question.baseline)]

    def setting(other: Cell) -> tuple:
        axes = {name: choice for name, choice in other.axes.items() if name not in (question.axis, *moot)}
        return other.scene, other.backend, other.depth, other.resolution, axes

    def shared(other: Cell) -> list[str]:
        return [name for name in cell.tunables if name in other.tunables and name != question.axis]

    def equally_tuned(other: Cell) -> bool:
        return all(
            cell.tunables[name] == other.tunables[name] or (name not in cell.tuned and name not in other.tuned)
            for name in shared(other)
        )

    def unlikeness(other: Cell) -> tuple:
        axes = sum(cell.axes.get(name) != other.axes.get(name) for name in moot)
        values = sum(cell.tunables[name] != other.tunables[name] for name in shared(other))
        return axes, values, other.spp != cell.spp, len(other.tuned.keys() - cell.tunables.keys())

    matches = [
        other
        for other in cells
        if dimension(other, question.axis) == question.baseline
        and setting(other) == setting(cell)
        and equally_tuned(other)
    ]
    return min(matches, key=unlikeness, default=None)


def scenes_of(rows: Sequence[Row]) -> list[str]:
    """The distinct scenes of a study's rows, in order."""
    return list(dict.fromkeys(row.cell.scene for row in rows))
