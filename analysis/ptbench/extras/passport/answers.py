"""The answers of a passport: for each question and scene the best without a choice against the best with it.

The variants that stand for both sides are chosen by the times of one run and compared by the times of the other, so
that a side that was lucky in the run that chose it gains nothing. Both runs take both parts, and an answer counts if
the two words agree.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ptbench.convergence.assessment import assess
from ptbench.convergence.efficiency import HIGHER, LOWER, by_place, compare
from ptbench.extras.passport.passport import Passport
from ptbench.io.axes import (
    ACCELERATOR,
    COMPACTION,
    DIRECT_LIGHT,
    FIRST_BOUNCE,
    INTEGRATOR,
    SORTING,
    SPECIALISATION,
)
from ptbench.io.cells import Cell, Result, Study
from ptbench.io.limits import limit
from ptbench.stats.estimates import FASTER, SLOWER, UNSURE, Estimate, Verdict, interval_of_ratio, inverse
from ptbench.studies.questions import usual_baseline
from ptbench.studies.rows import time_ratio

QUEUES = "wavefront"  # what the names of the integrators with a queue of paths begin with
EFFICIENCY_WORDS = {HIGHER: FASTER, LOWER: SLOWER}


@dataclass(frozen=True)
class Question:
    """One of the seven questions, about the choices on one axis."""

    asked: str
    axis: str
    # Whether a choice on the axis is on the side that the ratio is relative to; the second argument is the axis's
    # baseline in the file.
    is_without: Callable[[str, str | None], bool] = lambda choice, baseline: choice == baseline
    is_asked: Callable[[str], bool] = lambda choice: True  # whether the question is about a choice at all


QUESTIONS = (
    Question("One kernel rather than a queue?", INTEGRATOR, lambda choice, _: choice.startswith(QUEUES)),
    Question("Compact the queue?", COMPACTION),
    Question("Sort the queue by material?", SORTING),
    Question("Cache the first bounce?", FIRST_BOUNCE),
    Question("Compile the kernel for its scene?", SPECIALISATION, lambda choice, _: choice == "generic"),
    Question(
        "A wide tree of ptbench's rather than a binary one?",
        ACCELERATOR,
        lambda choice, _: choice == "bvh2",
        lambda choice: not choice.startswith("embree"),
    ),
)
LIGHTS = "Connect vertices to lights, at equal error?"
NO_PAIR = "no variant of each side was measured in both runs"


@dataclass(frozen=True)
class Side:
    """What one run says about the variants that the other one chose."""

    without: str  # variant on the side that the ratio is relative to
    choice: str  # variant on the other side
    ratio: Estimate  # times as fast: above 1 the choice pays
    word: str
    reason: str = ""  # why the word is UNSURE, and notes that belong to the verdict


@dataclass(frozen=True)
class Answer:
    """The answer to a question in a scene; without sides it has none."""

    asked: str
    scene: str
    sides: tuple[Side, Side] | None

    @property
    def word(self) -> str:
        """The word on which both runs agree; UNSURE if they do not."""
        if self.sides is None:
            return "\N{EM DASH}"
        first, second = (side.word for side in self.sides)
        return first if first == second else UNSURE

    @property
    def reason(self) -> str:
        """Why there is no word, or no firmer one, and the notes on the verdicts."""
        if self.sides is None:
            return NO_PAIR
        first, second = self.sides
        if first.word != second.word and UNSURE not in (first.word, second.word):
            return f"the runs disagree: {first.word}, {second.word}"
        unsure = [side.reason for side in (second, first) if side.word == UNSURE]
        return unsure[0] if unsure else second.reason


def answers_of(passport: Passport) -> list[Answer]:
    """Every answer of a passport, by question and scene; a question that no study asks is left out."""
    found = []
    for question in QUESTIONS:
        for scene, runs in _scenes(passport, question).items():
            sides = (_side(question, passport, runs, judge=0), _side(question, passport, runs, judge=1))
            found.append(Answer(question.asked, scene, None if None in sides else sides))
    return found + list(_lights(passport))


def _scenes(passport: Passport, question: Question) -> dict[str, tuple[dict[str, Cell], ...]]:
    """By scene the cells that bear on a question by name, for each run in turn; cells without times are left out."""
    scenes: dict[str, tuple[dict[str, Cell], ...]] = {}
    for number, run in enumerate(passport.runs):
        for study in _studies(run, question.axis):
            for cell in run.cells_of(study):
                runs = scenes.setdefault(cell.scene, tuple({} for _ in passport.runs))
                if cell.measured and question.is_asked(cell.axes[question.axis]):
                    runs[number][cell.name] = cell
    return scenes


def _studies(run: Result, axis: str) -> Iterable[Study]:
    return (study for study in run.studies if study.compares == axis and not study.is_convergence)


def _side(question: Question, passport: Passport, runs: tuple[dict[str, Cell], ...], judge: int) -> Side | None:
    """What run `judge` says about the best variants of the other run, among those that both runs measured."""
    chooser = runs[1 - judge]
    baseline = usual_baseline(passport.runs[0], question.axis)
    sides = {True: [], False: []}
    for name, cell in chooser.items():
        if name in runs[judge]:
            sides[question.is_without(cell.axes[question.axis], baseline)].append(cell)
    if not all(sides.values()):
        return None
    without, choice = (runs[judge][min(sides[is_without], key=_median).name] for is_without in (True, False))
    time, verdict = time_ratio(choice, without)
    times_as_fast = inverse(time)
    return Side(without.variant, choice.variant, times_as_fast, verdict.word, _said(times_as_fast, verdict))


def _said(ratio: Estimate, verdict: Verdict) -> str:
    """The verdict's reason and note, with the interval of times as fast in place of that of times."""
    reason = verdict.reason
    if reason.startswith("interval "):
        reason = f"the interval {interval_of_ratio(ratio)} reaches both sides of a limit"
    return "; ".join(text for text in (reason, verdict.note) if text)


def _median(cell: Cell) -> float:
    return float(np.median(cell.ms_per_spp))


def _lights(passport: Passport) -> Iterable[Answer]:
    """The answers about connections: their efficiency, the inverse of variance times time, over that of plain paths."""
    by_run = [dict(_efficiencies(run)) for run in passport.runs]
    for scene in dict.fromkeys(scene for one in by_run for scene in one):
        sides = tuple(one.get(scene) for one in by_run)
        yield Answer(LIGHTS, scene, None if None in sides else sides)


def _efficiencies(run: Result) -> Iterable[tuple[str, Side]]:
    plain_choice = usual_baseline(run, DIRECT_LIGHT)
    for place, group in by_place(list(assess(run).values())).items():
        plain = next((one for one in group if one.cell.axes[DIRECT_LIGHT] == plain_choice), None)
        for one in group:
            compared = None if plain is None or one is plain else compare(one, plain)
            if compared is not None and compared.efficiency is not None:
                doubt = compared.doubt or _too_short((one.cell, plain.cell), run)
                word = UNSURE if doubt else EFFICIENCY_WORDS.get(compared.word, UNSURE)
                reason = doubt or (compared.word if word == UNSURE else "")
                yield place.scene, Side(plain.cell.variant, one.cell.variant, compared.efficiency, word, reason)


def _too_short(cells: Iterable[Cell], run: Result) -> str:
    """Says that renders on a CPU are too short for the counter of other processes' time; empty if they are not."""
    times = [sample.wall_ms for cell in cells if not cell.on_gpu for sample in cell.samples]
    cpu_ms = min(times, default=math.inf) * int(run.context["ptbench.threads"])
    if cpu_ms >= limit("most_foreign_ms"):
        return ""
    return f"renders of {cpu_ms:.0f} ms of CPU time are too short to tell whether other processes disturbed them"
