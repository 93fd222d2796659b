"""Samples that were disturbed by other processes or a low clock, and the verdicts that this forbids.

An exhausted quota of CPU time counts like other processes: the system withheld the time. A number that rests on times
(a ratio, a mean, an efficiency, the cost of checkpoints) has no verdict where other processes disturbed more than
MOST_DISTURBED of the samples of a cell that it is computed from (`doubt_of`). A low clock does not withhold a verdict,
but the verdict by cycles must not contradict that by times.

On a GPU a busy host disturbs only renders that took longer than the device worked, or that wait for the host
(Cell.is_disturbed).
"""

from collections.abc import Iterable
from dataclasses import dataclass

from ptbench.io.cells import Cell, Result
from ptbench.io.limits import limit, limit_said

# Share of disturbed samples above which a cell has no verdict, and a run no noise floor.
MOST_DISTURBED = limit("most_disturbed_share")
MOST_DISTURBED_SAID = limit_said("most_disturbed_share")
CONTENDED = f"other processes took CPU time during more than {MOST_DISTURBED_SAID} of the samples"
THROTTLED = f"a CPU quota or {CONTENDED}"


@dataclass(frozen=True)
class Disturbance:
    """The number of disturbed `samples`: contended, at a low clock, or both."""

    samples: int
    disturbed: int
    contended: int
    low_clock: int
    throttled: int = 0  # contended samples that a CPU quota delayed

    @property
    def is_too_much(self) -> bool:
        """Whether so many samples are disturbed that a cell has no verdict, or a file no noise floor."""
        return self.disturbed > MOST_DISTURBED * self.samples

    def __str__(self) -> str:
        quota = f", {self.throttled} of them by a CPU quota" if self.throttled else ""
        kinds = f" (contended {self.contended}{quota}, low clock {self.low_clock})" if self.disturbed else ""
        return f"{self.disturbed} of {self.samples} sample{'' if self.samples == 1 else 's'}{kinds}"


def is_contended(cell: Cell) -> bool:
    """Whether too many of the cell's samples are disturbed for a verdict."""
    return cell.disturbed_samples > MOST_DISTURBED * len(cell.samples)


def doubt_of(cells: Iterable[Cell]) -> str:
    """Why a number computed from the times of these cells has no verdict; empty: it may have one."""
    contended = [cell for cell in cells if is_contended(cell)]
    if not contended:
        return ""
    return THROTTLED if any(cell.throttled_samples for cell in contended) else CONTENDED


def disturbance_in(result: Result) -> str:
    """The disturbed samples of a file in words, with the number that were repeated."""
    again = f"; {result.retaken} disturbed before {'was' if result.retaken == 1 else 'were'} taken again"
    return str(disturbance_of(result.cells)) + (again if result.retaken else "")


def disturbance_of(cells: Iterable[Cell]) -> Disturbance:
    """The disturbed samples over all these cells."""
    cells = list(cells)
    samples = [(cell.is_disturbed(sample), sample.low_clock) for cell in cells for sample in cell.samples]
    return Disturbance(
        len(samples),
        sum(contended or low for contended, low in samples),
        sum(contended for contended, _ in samples),
        sum(low for _, low in samples),
        sum(cell.throttled_samples for cell in cells),
    )
