"""The noise floor of a machine: how much two runs of one program on it differ, from A/A runs.

The spread of samples within a run misses what changes from run to run (memory placement, device temperature, other
users), so an interval from one run each is too narrow for what a comparison claims. Two result files of one machine and
one program show that variation: each cell that is in both files gives a ratio whose true value is 1.

The floor is the smallest t such that a further such ratio lies within a factor of 1 + t of 1 in 95 % of cases. Of m
values of |log ratio| in ascending order, the k-th, with k = ceil(0.95 (m + 1)), is not exceeded by a further one with
probability k / (m + 1), whatever the distribution, as all ranks are equally likely. Below m = 19 the largest value is
taken and its probability m / (m + 1) is told. The cells of a machine are assumed to be alike in their noise. Cells of
one run share that run's disturbances, so two files alone say little: their geometric mean is told, and more runs make a
better floor.

A verdict then counts differences within max(1 %, floor) as none: SAME widens, FASTER and SLOWER need more.

A floor that does not measure run-to-run noise is refused. A run in which more than a tenth of the samples were
disturbed tells no floor, as it measures the disturbance. A floor above 25 % is implausible, since it would call a
program that takes a quarter more time the SAME: then no verdict on that machine holds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ptbench.compare.match import Pair, is_repeated, machine_of, match
from ptbench.errors import InputError
from ptbench.io.cells import Result
from ptbench.stats.estimates import CONFIDENCE, THRESHOLD, Estimate, geometric_mean_of_ratios, telling_digits
from ptbench.studies.disturbed import MOST_DISTURBED, MOST_DISTURBED_SAID, Disturbance, disturbance_of

MOST_PLAUSIBLE = 0.25


@dataclass(frozen=True)
class Repeat:
    """Two result files of one machine and program; `ratios` are medians of the second over the first, one per cell."""

    one: Result
    other: Result
    ratios: tuple[float, ...]
    geometric_mean: Estimate
    disturbed: tuple[Disturbance, Disturbance]  # counts of disturbed samples in either file, over the cells in both

    @property
    def refusal(self) -> str:
        """Why an A/A run gives no noise floor; empty where it gives one."""
        sides = zip((self.one, self.other), self.disturbed, strict=True)
        return "; ".join(f"{file.path}: {of} disturbed" for file, of in sides if of.is_too_much)


@dataclass(frozen=True)
class Floor:
    """The noise floor of a machine: `value` as a fraction; `chance` that a further ratio lies within it."""

    machine: str
    value: float
    chance: float
    ratios: tuple[float, ...]
    repeats: tuple[Repeat, ...]

    @property
    def threshold(self) -> float:
        """The relative difference up to which a verdict is SAME."""
        return max(THRESHOLD, self.value) if self.is_plausible else math.inf

    @property
    def is_plausible(self) -> bool:
        """Whether the floor is low enough for verdicts to mean something."""
        return self.value <= MOST_PLAUSIBLE

    @property
    def text(self) -> str:
        """The noise floor in per cent, with enough digits to show whether it is plausible."""
        digits = telling_digits([100 * self.value], [100 * MOST_PLAUSIBLE], lambda value, count: f"{value:.{count}g}")
        return f"{100 * self.value:.{digits}g} %"

    @property
    def refusal(self) -> str:
        """Why the noise floor permits no verdict on its machine; empty where it is plausible."""
        if self.is_plausible:
            return ""
        return (
            f"two runs of one program on {self.machine} differ by {self.text}, above {100 * MOST_PLAUSIBLE:g} %: "
            "no difference can be told from that"
        )


def repeats_of(results: Sequence[Result]) -> list[Repeat]:
    """All pairs of the files that form an A/A run, with at least one cell that both files rendered."""
    found = []
    for one, other in combinations(results, 2):
        if not is_repeated(one, other):
            continue
        if pairs := match(one, other).pairs:
            sides = [(pair.other.ms_per_spp, pair.reference.ms_per_spp) for pair in pairs]
            ratios = tuple(float(np.median(values) / np.median(baseline)) for values, baseline in sides)
            disturbed = _disturbed(pairs)
            found.append(Repeat(one, other, ratios, geometric_mean_of_ratios(sides), disturbed))
    return found


def _disturbed(pairs: Sequence[Pair]) -> tuple[Disturbance, Disturbance]:
    return disturbance_of(pair.reference for pair in pairs), disturbance_of(pair.other for pair in pairs)


def check_noise_files(results: Sequence[Result], others: Sequence[Result]) -> None:
    """Raises InputError for a --noise file that was given before, or that repeats none of the compared files."""
    repeats = repeats_of([*results, *others])
    given = list(others)
    for result in results:
        # A run given twice would be evidence for itself: its ratios would be part of the noise floor that judges them.
        if (twin := next((other for other in given if _samples_of(other) == _samples_of(result)), None)) is not None:
            raise InputError(
                f"{result.path}: --noise: found the very samples of {twin.path}, allowed: a run of its own"
            )
        given.append(result)
        if not any(result is side for repeat in repeats for side in (repeat.one, repeat.other)):
            raise InputError(
                f"{result.path}: --noise: found no other file of machine {result.about('machine')} and program "
                f"{result.about('program_hash')} with a cell of its own run in common, allowed: two runs of one program"
            )
        _refuse_disturbed(result)
        if (floor := floor_of(result, repeats)) is not None and not floor.is_plausible:
            raise InputError(
                f"{result.path}: --noise: found runs of one program that differ by {floor.text}, allowed: at most "
                f"{100 * MOST_PLAUSIBLE:g} %; by such a floor a program that takes a fourth more time would be the SAME"
            )


def _refuse_disturbed(result: Result) -> None:
    disturbed = disturbance_of(cell for cell in result.cells if cell.measured)
    if disturbed.is_too_much:
        raise InputError(
            f"{result.path}: --noise: found {disturbed.disturbed} of {disturbed.samples} samples disturbed (other "
            f"processes took the CPU: {disturbed.contended}, a low clock: {disturbed.low_clock}), allowed: at most "
            f"{math.floor(MOST_DISTURBED * disturbed.samples)}, {MOST_DISTURBED_SAID}; what befell the "
            "machine is no noise of the program's runs"
        )


def _samples_of(result: Result) -> tuple:
    cells = [(cell.name, [(sample.timestamp, sample.wall_ms) for sample in cell.samples]) for cell in result.cells]
    return machine_of(result), sorted(cells)


def floor_of(result: Result, repeats: Sequence[Repeat], without: Sequence[Result] = ()) -> Floor | None:
    """The noise floor of the machine of `result`; None: no A/A run of it is known.

    A run between two of the files in `without` is left out, as a floor must not judge the run that it comes from. A
    disturbed run is left out as well; its files say why (Repeat.refusal).
    """
    own = tuple(
        repeat
        for repeat in repeats
        if machine_of(repeat.one) == machine_of(result)
        and not repeat.refusal
        and not all(any(side is file for file in without) for side in (repeat.one, repeat.other))
    )
    ratios = tuple(ratio for repeat in own for ratio in repeat.ratios)
    if not ratios:
        return None
    distances = np.sort(np.abs(np.log(ratios)))
    count = len(distances)
    rank = min(math.ceil(CONFIDENCE * (count + 1)), count)
    return Floor(result.about("machine"), float(np.expm1(distances[rank - 1])), rank / (count + 1), ratios, own)
