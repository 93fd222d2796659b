"""Withdrawn verdicts: withdrawn.json lists which, why, a bound of the number, and what would reinstate them.

A verdict on two cells that differ in a withdrawn choice is still computed, and never shown without its withdrawal. An
entry with scenes applies to any two variants in such a scene of which either has the choice.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations

from ptbench.io.cells import Cell
from ptbench.io.files import package_file
from ptbench.io.nodes import Node, read_json

FILE = package_file("withdrawn.json")
_MARK = "withdrawn: "


@dataclass(frozen=True)
class Withdrawal:
    """One entry of withdrawn.json: a choice on which verdicts do not count."""

    axis: str
    choices: tuple[str, ...]
    backends: tuple[str, ...]
    spares: dict[str, tuple[str, ...]]  # by axis, choices with which a cell's verdicts are not withdrawn
    scenes: tuple[str, ...]  # scenes to which the withdrawal is limited; empty: all scenes
    withdrawn: str  # which verdicts on the choice are withdrawn, in words
    gist: str  # reason for the withdrawal in a few words
    reason: str
    bound: dict[str, float]  # bounds of the withdrawn ratio by choice, which `bound_is` explains in words; may be empty
    bound_is: str
    source: str  # path in the repository of the file that shows the bounds on the withdrawn ratio
    stays: str  # verdicts that stay valid despite the withdrawal
    until: str

    @property
    def named(self) -> str:
        """The withdrawn choices as text, "axis=choice,choice"."""
        return f"{self.axis}={','.join(self.choices)}"

    @property
    def mark(self) -> str:
        """The text of a withdrawal for the line of a verdict."""
        return f"{_MARK}{self.gist}"

    @property
    def short(self) -> str:
        """The text of a withdrawal for a caption."""
        limits = ", ".join(f"{value:.2f} ({choice})" for choice, value in self.bound.items())
        bound = f"; bound: {limits} {self.bound_is}" if limits else ""
        spared = f", except with {self._spared}" if self.spares else ""
        where = f" in {', '.join(self.scenes)}" if self.scenes else ""
        return f"Withdrawn: {self.withdrawn} of {self.named}{where}{spared}: {self.reason}{bound}."

    @property
    def full(self) -> str:
        """The full text of a withdrawal for a summary."""
        where = f" ({self.source})" if self.source else ""
        body = self.short.removeprefix("Withdrawn: ").removesuffix(".")
        return f"{body}{where}. What stays valid: {self.stays}. Withdrawn until {self.until}."

    @property
    def _spared(self) -> str:
        return "; ".join(f"{axis}={','.join(choices)}" for axis, choices in self.spares.items())

    def concerns(self, cell: Cell) -> bool:
        """Whether a cell has the withdrawn choice."""
        is_spared = any(cell.axes.get(axis) in choices for axis, choices in self.spares.items())
        is_there = cell.backend in self.backends and (not self.scenes or cell.scene in self.scenes)
        return is_there and cell.axes.get(self.axis) in self.choices and not is_spared

    def is_between(self, one: Cell, other: Cell) -> bool:
        """Whether the withdrawal concerns a verdict on these two cells."""
        if self.scenes:
            differ = one.scene == other.scene and (one.variant, one.tuned) != (other.variant, other.tuned)
        else:
            differ = one.axes.get(self.axis) != other.axes.get(self.axis)
        return differ and (self.concerns(one) or self.concerns(other))


def withdrawals_of(root: Node) -> tuple[Withdrawal, ...]:
    """Reads and checks the entries of a file of withdrawals; raises InputError."""
    return tuple(
        Withdrawal(
            axis=node.need("axis").name(),
            choices=tuple(item.name() for item in node.need("choices").items()),
            backends=tuple(item.name() for item in node.need("backends").items()),
            spares={
                axis: tuple(item.name() for item in node.need("spares").need(axis).items())
                for axis in node.need("spares").fields()
            },
            scenes=tuple(item.name() for item in node.need("scenes").items()),
            withdrawn=node.need("withdrawn").name(),
            gist=node.need("gist").name(),
            reason=node.need("reason").name(),
            bound={key: node.need("bound").need(key).number() for key in node.need("bound").fields()},
            bound_is=node.need("bound_is").text(),
            source=node.need("source").text(),
            stays=node.need("stays").name(),
            until=node.need("until").name(),
        )
        for node in root.items()
    )


def is_marked(note: str) -> bool:
    """Whether the note of a verdict has the mark of a withdrawal."""
    return _MARK in note


@cache
def withdrawals() -> tuple[Withdrawal, ...]:
    """The withdrawals in the package's own withdrawn.json."""
    return withdrawals_of(read_json(FILE))


def between(one: Cell, other: Cell) -> tuple[Withdrawal, ...]:
    """The withdrawals that concern a verdict on these two cells."""
    return tuple(entry for entry in withdrawals() if entry.is_between(one, other))


def among(cells: Sequence[Cell]) -> tuple[Withdrawal, ...]:
    """The withdrawals that concern a verdict on any two of these cells."""
    return tuple(
        entry
        for entry in withdrawals()
        if any(entry.concerns(cell) for cell in cells)
        and any(entry.is_between(one, other) for one, other in combinations(_one_a_choice(entry, cells), 2))
    )


def _one_a_choice(entry: Withdrawal, cells: Iterable[Cell]) -> list[Cell]:
    """A subset of cells that suffices to find the withdrawals between any two, instead of testing every pair."""
    if entry.scenes:
        return [cell for cell in cells if cell.scene in entry.scenes]
    return list({(cell.backend, cell.axes.get(entry.axis), entry.concerns(cell)): cell for cell in cells}.values())


def concerning(cells: Sequence[Cell]) -> tuple[Withdrawal, ...]:
    """The withdrawals that concern any of these cells, whatever the cell is compared with."""
    return tuple(entry for entry in withdrawals() if any(entry.concerns(cell) for cell in cells))
