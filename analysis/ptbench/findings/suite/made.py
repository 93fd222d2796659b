"""What cells of a result consist of, as a source for a page: trees, kernels, paths and films."""

from dataclasses import dataclass

from ptbench.errors import FindingError
from ptbench.figures.time_to_image import Way, sibling_meshes, ways
from ptbench.findings.quantities import Quantity
from ptbench.findings.suite.builders import Built, Crossed, built, crossed
from ptbench.findings.suite.cells import Cells
from ptbench.io.cells import Kernel, MeshFacts
from ptbench.stats.estimates import Estimate
from ptbench.studies.selection import cell_of, parsed


@dataclass(frozen=True)
class Bound:
    """A stage per sample: its time, the least that memory allows it, and the megabytes that it moves at least."""

    ms: float
    least_ms: float
    megabytes: float

    @property
    def percent(self) -> float:
        """How much of memory's speed the stage reaches, in per cent."""
        return 100 * self.least_ms / self.ms


class Made(Cells):
    """The trees, kernels, path counts and films of a result's cells."""

    def built(self, selection: str) -> list[Built]:
        """The cost and benefit of each builder's tree, for every cell of a selection with a mesh."""
        return built(self._ways(selection))

    def crossings(self, selection: str) -> list[Crossed]:
        """The samples per pixel at which one builder overtakes another, for the cells of a selection."""
        return crossed(self._ways(selection))

    def meshes(self, selection: str) -> MeshFacts:
        """Facts about the meshes and trees of a cell."""
        facts = self.cell(selection).meshes
        if facts is None:
            raise FindingError(f"{self.result.path}: {selection} has no mesh")
        return facts

    def sah(self, selection: str) -> Quantity:
        """The SAH cost of a cell's largest tree."""
        return Quantity(Estimate(self.meshes(selection).sah_cost, None, None, 1), selection)

    def alive_percent(self, selection: str) -> float:
        """The per cent of queue slots, over all bounces, that hold live paths if ended ones stay."""
        cell = self.cell(selection)
        alive = None if cell.instrumented is None else cell.instrumented.live_share(cell.depth)
        if alive is None:
            raise FindingError(f"{self.result.path}: {selection} has no counts of live paths")
        return 100 * alive

    def same_film(self, selection: str, over: str) -> bool:
        """Whether a cell and its baseline left the same film, bit for bit."""
        base = cell_of(self.result, {**self._chosen(selection), **parsed(over)})
        return self.cell(selection).film_hash == base.film_hash

    def films_of(self, older: Cells) -> tuple[int, int]:
        """The number of cells whose film equals that of the same cell in an older result, and of all that both have."""
        theirs = {cell.shown: cell.film_hash for cell in older.result.cells if cell.measured}
        same = [theirs[cell.shown] == cell.film_hash for cell in self.result.cells if cell.shown in theirs]
        if not same:
            raise FindingError(f"{self.result.path}: no cell in common with {older.result.path}")
        return sum(same), len(same)

    def registers(self, selection: str, kernel: str) -> int:
        """Registers per thread of a kernel."""
        return self._kernel(selection, kernel).registers

    def local_bytes(self, selection: str, kernel: str) -> int:
        """Local memory per thread of a kernel, in bytes."""
        return self._kernel(selection, kernel).local_bytes

    def bound(self, selection: str, stage: str) -> Bound:
        """A stage of a cell beside what memory allows it, in the cell's instrumented pass."""
        done = self.cell(selection).instrumented
        if done is None or stage not in done.memory_bounds or not done.stage_ms.get(stage):
            raise FindingError(f"{self.result.path}: {selection} has no bound of the stage {stage}")
        bound = done.memory_bounds[stage]
        return Bound(self.stage_ms(selection, stage), bound.ms / done.spp, bound.bytes / done.spp / 1e6)

    def stage_ms(self, selection: str, stage: str) -> float:
        """Milliseconds of a stage per sample per pixel, in the cell's instrumented pass."""
        done = self.cell(selection).instrumented
        if done is None or stage not in done.stage_ms:
            raise FindingError(f"{self.result.path}: {selection} has no stage {stage}")
        return done.stage_ms[stage] / done.spp

    def path_state_bytes(self, selection: str) -> int:
        """Bytes of one path's state in the queue."""
        cuda = self.cell(selection).cuda
        if cuda is None or cuda.path_state_bytes is None:
            raise FindingError(f"{self.result.path}: {selection} tells no bytes of a path")
        return cuda.path_state_bytes

    def _ways(self, selection: str) -> list[Way]:
        return ways(self.cells(selection), sibling_meshes(self.result.path))

    def _kernel(self, selection: str, kernel: str) -> Kernel:
        cuda = self.cell(selection).cuda
        if cuda is None or kernel not in cuda.kernels:
            raise FindingError(f"{self.result.path}: {selection} has no kernel {kernel}")
        return cuda.kernels[kernel]
