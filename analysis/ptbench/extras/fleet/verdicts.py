"""Verdicts that differ between two GPUs, and the memory bandwidth at which two variants take equal time.

Verdicts are those of a study's own table: a cell over its study's baseline, each file by itself. The crossover models a
variant's time as a + b / B with bandwidth B: two GPUs that differ in memory alone determine a and b for each variant.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.compare.ranking import Change, Ranking
from ptbench.compare.verdicts import Comparison
from ptbench.extras.fleet.gpus import Gpu
from ptbench.io.cells import Cell, Result, Study
from ptbench.stats.estimates import CONFIDENCE, FASTER, RESAMPLES, SAME, SEED, SLOWER, Estimate
from ptbench.studies.questions import question_of
from ptbench.studies.rows import Row, measure
from ptbench.studies.withdrawn import is_marked

_DECISIVE = (FASTER, SLOWER, SAME)
# Relative difference of multiprocessors x clock up to which two GPUs differ in their memory alone.
_SAME_CORE = 0.01


@dataclass(frozen=True)
class Pair:
    """The verdict on a cell against its study's baseline, on both GPUs."""

    study: Study
    axis: str
    baseline: str
    first: Row
    other: Row

    @property
    def is_decided(self) -> bool:
        """Whether the verdicts on both GPUs are decisive."""
        return self.first.verdict.word in _DECISIVE and self.other.verdict.word in _DECISIVE

    @property
    def is_changed(self) -> bool:
        """Whether the verdicts on both GPUs are decisive and differ."""
        return self.is_decided and self.first.verdict.word != self.other.verdict.word

    @property
    def is_turned(self) -> bool:
        """Whether the cell is FASTER on one GPU and SLOWER on the other."""
        return {self.first.verdict.word, self.other.verdict.word} == {FASTER, SLOWER}


def verdict_pairs(comparison: Comparison) -> list[Pair]:
    """The verdicts of every study that both files have, for paired cells in the reference's order.

    Cells whose verdicts are withdrawn are left out.
    """
    partner = {row.pair.reference.name: row.pair.other.name for row in comparison.rows}
    theirs = {study.name: study for study in comparison.other.studies}
    found = []
    for study in comparison.reference.studies:
        if study.name not in theirs:
            continue
        question, other_question = (
            question_of(comparison.reference, study),
            question_of(comparison.other, theirs[study.name]),
        )
        if question is None or other_question is None or question != other_question:
            continue
        by_cell = {row.cell.name: row for row in measure(comparison.other, theirs[study.name])}
        for row in measure(comparison.reference, study):
            other = by_cell.get(partner.get(row.cell.name, ""))
            if row.ratio is None or other is None or other.ratio is None:
                continue
            if not is_marked(row.verdict.note) and not is_marked(other.verdict.note):
                found.append(Pair(study, question.axis, question.baseline, row, other))
    return found


def have_one_core(one: Gpu, other: Gpu) -> bool:
    """Whether two GPUs differ in their memory alone, as far as data sheets tell."""
    rates = one.rate("issue") / other.rate("issue")
    return one.capability == other.capability and abs(rates - 1) <= _SAME_CORE


def ran_one_program(results: Sequence[Result]) -> bool:
    """Whether all results come from one commit's kernels, so that only the GPUs differ."""
    commits = {result.about("git_sha") for result in results}
    return len(commits) == 1 and "unknown" not in commits


def crossover(group: Ranking, change: Change, gpus: tuple[Gpu, ...]) -> Estimate | None:
    """The bandwidth, GB/s, at which both variants of a ranking change take equal time; None where the GPUs do not fit.

    The interval resamples all four sets of times.
    """
    one, two = gpus[change.at], gpus[change.turned_at]
    if not have_one_core(one, two):
        return None
    files = (change.at, change.turned_at)
    cells = [group.cells[variant][file] for variant in (change.ahead, change.behind) for file in files]
    value = _crossing(*(float(np.median(cell.ms_per_spp)) for cell in cells), one=one, two=two)
    random = np.random.default_rng(SEED)
    drawn = _crossing(*(_medians(cell, random) for cell in cells), one=one, two=two)
    tail = 50 * (1 - CONFIDENCE)
    low, high = np.percentile(drawn, [tail, 100 - tail])
    return Estimate(float(value), float(low), float(high), min(len(cell.samples) for cell in cells))


def _medians(cell: Cell, random: np.random.Generator) -> np.ndarray:
    times = cell.ms_per_spp
    return np.median(times[random.integers(0, times.size, size=(RESAMPLES, times.size))], axis=1)


def _crossing(ahead_one, ahead_two, behind_one, behind_two, *, one: Gpu, two: Gpu):
    """The bandwidth where the two variants' times, linear in 1 / bandwidth, are equal."""
    x_one, x_two = 1 / one.gb_per_second, 1 / two.gb_per_second
    gap_one, gap_two = ahead_one - behind_one, ahead_two - behind_two
    return 1 / (x_one + (x_two - x_one) * gap_one / (gap_one - gap_two))
