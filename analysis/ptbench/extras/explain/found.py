"""What an explanation finds: pairs of cells and all that is said of them."""

from dataclasses import dataclass, field

from ptbench.extras.explain.accounting import Accounting
from ptbench.extras.explain.facts import Fact
from ptbench.io.cells import Cell
from ptbench.io.inspection import Inspected
from ptbench.stats.estimates import FASTER, SLOWER, Estimate, Verdict


@dataclass(frozen=True)
class Setting:
    """Where both variants ran: the fields that a pair of cells has in common."""

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
    """Two measured cells of one setting and all that is said of them; B is held against A."""

    setting: Setting
    labels: tuple[str, str]
    ratio: Estimate
    verdict: Verdict
    accounting: Accounting
    facts: tuple[Fact, ...]
    inspected: tuple[Inspected, Inspected] | None = None

    @property
    def has_difference(self) -> bool:
        """Whether there is a difference for the parts to be parts of."""
        return self.verdict.word in (FASTER, SLOWER)

    @property
    def cells(self) -> tuple[Cell, Cell]:
        """The cells of A and B."""
        return self.accounting.a.cell, self.accounting.b.cell


@dataclass(frozen=True)
class Choice:
    """What of the file is looked at."""

    scene: str = ""
    depth: int | None = None
    resolution: tuple[int, int] | None = None


@dataclass
class Found:
    """The pairs, and in words what there was besides that has none."""

    pairs: list[Pair] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
