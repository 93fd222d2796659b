"""The answers of a passport: for each question and scene the best without a choice against the best with it.

The variants that stand for both sides are chosen by the times of one run and compared by the times of the other, so
that a side that was lucky in the run that chose it gains nothing. Both runs take both parts, and an answer counts if
the two words agree.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

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
from ptbench.stats.estimates import FASTER, SLOWER, UNSURE, Estimate
from ptbench.studies.questions import usual_baseline
from ptbench.studies.rows import time_ratio

QUEUES = "wavefront"  # what the names of the integrators with a queue of paths begin with
EFFICIENCY_WORDS = {HIGHER: FASTER, LOWER: SLOWER}


@dataclass(frozen=True)
class Question:
    """One of the seven questions, about the choices on one axis."""

    asked: str
    axis: str
    # Whether a choice on the question's axis belongs to the variants "without", whose time is the numerator of the
    # ratio; the second argument is the axis's baseline in the file.
    is_without: Callable[[str, str | None], bool] = lambda choice, baseline: choice == baseline


QUESTIONS = (
    Question("One kernel rather than a queue?", INTEGRATOR, lambda choice, _: choice.startswith(QUEUES)),
    Question("Compact the queue?", COMPACTION),
    Question("Sort the queue by material?", SORTING),
    Question("Cache the first bounce?", FIRST_BOUNCE),
    Question("Compile the kernel for its scene?", SPECIALISATION, lambda choice, _: choice == "generic"),
    Question("A wide tree rather than a binary one?", ACCELERATOR, lambda choice, _: choice == "bvh2"),
)
LIGHTS = "Connect vertices to lights, at equal error?"


@dataclass(frozen=True)
class Side:
    """What one run says, of variants that the other one chose."""

    without: str  # variant without the asked choice, whose time is the ratio's numerator
    choice: str  # variant with the asked choice, whose time is the ratio's denominator
    ratio: Estimate  # how many times as fast `choice` is as `without`: above 1 it pays
    word: str
    reason: str = ""


@dataclass(frozen=True)
class Answer:
    """The answer to a question in a scene."""

    asked: str
    scene: str
    sides: tuple[Side, Side]

    @property
    def word(self) -> str:
        """The word on which both runs agree; UNSURE if they do not."""
        first, second = (side.word for side in self.sides)
        return first if first == second else UNSURE

    @property
    def reason(self) -> str:
        """Why the word is UNSURE; empty for any other word."""
        first, second = self.sides
        if self.word != UNSURE:
            return ""
        if UNSURE in (first.word, second.word):
            return second.reason if second.word == UNSURE else first.reason
        return f"the runs disagree: {first.word}, {second.word}"


def answers_of(passport: Passport) -> list[Answer]:
    """Every answer of a passport, by question and scene; a question that no cell asks is left out."""
    found = []
    for question in QUESTIONS:
        for scene, pair in _scenes(passport, question.axis).items():
            sides = (_side(question, pair, chosen_by=1), _side(question, pair, chosen_by=0))
            if None not in sides:
                found.append(Answer(question.asked, scene, sides))
    return found + list(_lights(passport))


def _scenes(passport: Passport, axis: str) -> dict[str, list[tuple[Result, list[Cell]]]]:
    """The measured cells of the studies that compare an axis, by scene; for each run in turn."""
    scenes: dict[str, list[tuple[Result, list[Cell]]]] = {}
    for number, run in enumerate(passport.runs):
        for study in _studies(run, axis):
            for cell in run.cells_of(study):
                runs = scenes.setdefault(cell.scene, [(one, []) for one in passport.runs])
                if cell.measured:
                    runs[number][1].append(cell)
    return scenes


def _studies(run: Result, axis: str) -> Iterable[Study]:
    return (study for study in run.studies if study.compares == axis and not study.is_convergence)


def _side(question: Question, runs: Sequence[tuple[Result, list[Cell]]], chosen_by: int) -> Side | None:
    chooser, cells = runs[chosen_by]
    baseline = usual_baseline(chooser, question.axis)
    sides = [[], []]
    for cell in cells:
        sides[question.is_without(cell.axes[question.axis], baseline)].append(cell)
    names = [min(side, key=_median, default=None) for side in sides]
    there = {cell.name: cell for cell in runs[1 - chosen_by][1]}
    if any(one is None or one.name not in there for one in names):
        return None
    choice, without = (there[one.name] for one in names)
    ratio, verdict = time_ratio(choice, without)
    return Side(without.variant, choice.variant, inverse(ratio), verdict.word, verdict.said)


def _median(cell: Cell) -> float:
    return float(sorted(cell.ms_per_spp)[len(cell.samples) // 2])


def inverse(ratio: Estimate) -> Estimate:
    """Times as fast, for a ratio of times."""
    low, high = (None if end is None else 1 / end for end in (ratio.high, ratio.low))
    return Estimate(1 / ratio.value, low, high, ratio.n)


def _lights(passport: Passport) -> Iterable[Answer]:
    """Efficiency, the inverse of variance times time, of connections over plain paths; one variant on each side."""
    by_run = [dict(_efficiencies(run)) for run in passport.runs]
    for scene in by_run[0]:
        if scene in by_run[1]:
            yield Answer(LIGHTS, scene, (by_run[0][scene], by_run[1][scene]))


def _efficiencies(run: Result) -> Iterable[tuple[str, Side]]:
    plain_choice = usual_baseline(run, DIRECT_LIGHT)
    for place, group in by_place(list(assess(run).values())).items():
        plain = next((one for one in group if one.cell.axes[DIRECT_LIGHT] == plain_choice), None)
        for one in group:
            compared = None if plain is None or one is plain else compare(one, plain)
            if compared is not None and compared.efficiency is not None:
                word = EFFICIENCY_WORDS.get(compared.word, UNSURE)
                reason = compared.doubt or ("" if word != UNSURE else compared.word)
                yield place.scene, Side(plain.cell.variant, one.cell.variant, compared.efficiency, word, reason)
