"""How many samples were disturbed: taken while other processes had the CPU, or at a low clock.

On a GPU a busy host disturbs only a render that took longer than the device worked, or that waits for the host
(Cell.is_disturbed).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ptbench.io.cells import Cell

# A larger part of the samples, and what they say is what befell the machine: no verdict, no noise floor.
MOST_DISTURBED = 0.1


@dataclass(frozen=True)
class Disturbance:
    """Of `samples`, `disturbed` were contended, at a low clock, or both."""

    samples: int
    disturbed: int
    contended: int
    low_clock: int

    @property
    def is_too_much(self) -> bool:
        """The rule for a cell's verdict and for a noise floor."""
        return self.disturbed > MOST_DISTURBED * self.samples

    def __str__(self) -> str:
        kinds = f" (contended {self.contended}, low clock {self.low_clock})" if self.disturbed else ""
        return f"{self.disturbed} of {self.samples} sample{'' if self.samples == 1 else 's'}{kinds}"


def disturbance_of(cells: Iterable[Cell]) -> Disturbance:
    """Over the samples of all these cells."""
    samples = [(cell.is_disturbed(sample), sample.low_clock) for cell in cells for sample in cell.samples]
    return Disturbance(
        len(samples),
        sum(contended or low for contended, low in samples),
        sum(contended for contended, _ in samples),
        sum(low for _, low in samples),
    )
