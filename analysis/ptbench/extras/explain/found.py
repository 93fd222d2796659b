"""What an explanation finds: pairs of cells with all facts about them."""

from dataclasses import dataclass, field

from ptbench.extras.explain.accounting import Accounting
from ptbench.extras.explain.facts import Fact
from ptbench.io.cells import Cell
from ptbench.io.inspection import Inspected
from ptbench.stats.estimates import FASTER, SLOWER, Estimate, Verdict


@dataclass(frozen=True)
class Setting:
    """A setting in which both variants ran: the fields that a pair of cells has in common."""

    scene: str
    backend: str
    resolution: tuple[int, int]
    depth: int
    is_convergence: bool = False

    def __str__(self) -> str:
        size = f"{self.resolution[0]}x{self.resolution[1]}"
        kind = ", with checkpoints" if self.is_convergence else ""
        return f"{self.scene}, {self.backend}, {size}, depth {self.depth}{kind}"


@dataclass(frozen=True)
class Pair:
    """Two measured cells of one setting and all facts about them; B is compared with A."""

    setting: Setting
    labels: tuple[str, str]
    ratio: Estimate
    verdict: Verdict
    accounting: Accounting
    facts: tuple[Fact, ...]
    inspected: tuple[Inspected, Inspected] | None = None

    @property
    def has_difference(self) -> bool:
        """Whether the verdict is FASTER or SLOWER, so that there is a difference to explain."""
        return self.verdict.word in (FASTER, SLOWER)

    @property
    def cells(self) -> tuple[Cell, Cell]:
        """The cells of A and B."""
        return self.accounting.a.cell, self.accounting.b.cell


@dataclass(frozen=True)
class Choice:
    """Which part of the result file is explained."""

    scene: str = ""
    depth: int | None = None
    resolution: tuple[int, int] | None = None


@dataclass
class Found:
    """The pairs of cells, and in words the cells that have no partner."""

    pairs: list[Pair] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
