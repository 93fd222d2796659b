"""What two runs of one program on one machine differ by: the noise floor of a machine, from A/A runs.

The spread of samples within a run does not hold what changes from run to run (where memory lies, how warm the device
is, who else is there), so an interval from one run each is too narrow for what a comparison claims. Two result files of
one machine and one program show it: each cell that both hold gives one ratio whose true value is 1.

The floor is the smallest t such that a further such ratio lies within a factor of 1 + t of 1 in 95 % of cases: of m
values of |log ratio| in ascending order, the k-th, k = ceil(0.95 (m + 1)), holds a further one with probability
k / (m + 1) whatever the distribution: all ranks of that one are equally likely. Below m = 19 that is out of reach: the
largest is taken, and its chance, m / (m + 1), is told. It takes the cells of a machine as alike in their noise. Cells
of one run share what befell that run, so two files know little of it: their geometric mean is told, and more runs make
a better floor.

A verdict then counts differences within max(1 %, floor) as none: SAME widens, FASTER and SLOWER need more.

A floor that says something else than what two runs of one program differ by is refused. Where more than a tenth of the
samples were disturbed, it is what befell the machine: such a run tells no floor. Where it is above 25 %, nobody knows
what it is, and by it a program that takes a fourth more time would be the SAME: then no verdict on that machine holds.
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
    """Two files of one machine and program; `ratios` are the second's medians over the first's, a cell each."""

    one: Result
    other: Result
    ratios: tuple[float, ...]
    geometric_mean: Estimate
    disturbed: tuple[Disturbance, Disturbance]  # of the cells that both have

    @property
    def refusal(self) -> str:
        """Why it tells no noise floor; empty where it does."""
        sides = zip((self.one, self.other), self.disturbed, strict=True)
        return "; ".join(f"{file.path}: {of} disturbed" for file, of in sides if of.is_too_much)


@dataclass(frozen=True)
class Floor:
    """The noise floor of one machine: `value` is a part of 1; `chance` that a further ratio lies within it."""

    machine: str
    value: float
    chance: float
    ratios: tuple[float, ...]
    repeats: tuple[Repeat, ...]

    @property
    def threshold(self) -> float:
        """Differences up to here count as none."""
        return max(THRESHOLD, self.value) if self.is_plausible else math.inf

    @property
    def is_plausible(self) -> bool:
        """Whether the floor is low enough for verdicts to mean something."""
        return self.value <= MOST_PLAUSIBLE

    @property
    def text(self) -> str:
        """In per cent, in digits that show whether it is plausible."""
        digits = telling_digits([100 * self.value], [100 * MOST_PLAUSIBLE], lambda value, count: f"{value:.{count}g}")
        return f"{100 * self.value:.{digits}g} %"

    @property
    def refusal(self) -> str:
        """Why no verdict on its machine holds; empty where it is a floor."""
        if self.is_plausible:
            return ""
        return (
            f"two runs of one program on {self.machine} differ by {self.text}, above {100 * MOST_PLAUSIBLE:g} %: "
            "no difference can be told from that"
        )


def repeats_of(results: Sequence[Result]) -> list[Repeat]:
    """Every two of the files that are an A/A run and have a cell in common that each of them rendered."""
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
    """Raises InputError for a file of --noise that is given already, or no repetition of any of the files given."""
    repeats = repeats_of([*results, *others])
    given = list(others)
    for result in results:
        # Given twice, a run would be its own evidence: its ratios would count again, and judge themselves.
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
    """The floor of the machine of `result`; None: no A/A run of it is known.

    A run between two of the files `without` is left out: it cannot be judged by a floor that comes from itself. So is a
    disturbed one, whose files say why (Repeat.refusal).
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
