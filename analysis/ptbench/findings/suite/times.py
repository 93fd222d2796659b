"""Times of a result as a source for a page: milliseconds, rates, and ratios with their verdicts."""

from dataclasses import dataclass

import numpy as np

from ptbench.errors import FindingError
from ptbench.findings.quantities import Quantity, Ratio, Ratios
from ptbench.findings.suite.cells import Cells
from ptbench.io.cells import Cell
from ptbench.stats.estimates import CLOCK_UNKNOWN, geometric_mean_of_ratios
from ptbench.studies.devices import Scaled, strong, weak
from ptbench.studies.disturbed import doubt_of
from ptbench.studies.programs import devices_of, why_not_one
from ptbench.studies.questions import dimension
from ptbench.studies.rows import Row, measure, time_ratio
from ptbench.studies.selection import cell_of, parsed
from ptbench.studies.withdrawn import between


@dataclass(frozen=True)
class Told:
    """A row of a study's table; without a ratio, it is the baseline or its ratio is withheld."""

    scene: str
    label: str
    ms: Quantity
    ratio: Ratio | None


class Times(Cells):
    """Times, rates and ratios of a result's cells."""

    def ms(self, selection: str) -> Quantity:
        """Milliseconds of render wall time per sample per pixel."""
        return self._median(selection, lambda cell: cell.ms_per_spp)

    def rays(self, selection: str) -> Quantity:
        """The rate of rays over render wall time, 1e9 per second."""
        return self.rate(selection).over(1e3)

    def rate(self, selection: str) -> Quantity:
        """The rate of rays over render wall time, 1e6 per second."""
        return self._median(selection, lambda cell: np.array([one.mega_rays_per_second for one in cell.samples]))

    def ratio(self, selection: str, over: str) -> Ratio:
        """The time ratio of a cell over the cell that differs from it by the words of `over`."""
        cell = self.cell(selection)
        base = cell_of(self.result, {**self._chosen(selection), **parsed(over)})
        return _ratio(cell, base)

    def ratio_if(self, selection: str, over: str) -> Ratio | None:
        """The ratio as by `ratio`, or None where either cell was not measured."""
        for side in (parsed(selection), {**parsed(selection), **parsed(over)}):
            try:
                cell_of(self.result, {**self._where, **side})
            except FindingError:
                return None
        return self.ratio(selection, over)

    def ratios(self, selection: str, over: str) -> Ratios:
        """Ratios of all measured cells of a selection with `*`, each over its own baseline."""
        chosen = self._chosen(selection)
        open_names = [name for name, value in chosen.items() if value == "*"]
        others = parsed(over)
        found = []
        for cell in self.cells(selection):
            own = {name: dimension(cell, name) for name in open_names}
            wanted = {**chosen, **own, **others}
            if any(dimension(cell, name) != value for name, value in others.items()):
                found.append(_ratio(cell, cell_of(self.result, wanted)))
        if not found:
            raise FindingError(f"{self.result.path}: nothing to hold against {over}: {selection}")
        return Ratios(tuple(found))

    def rows(self, study: str) -> list[Told]:
        """Every measured cell of a study with its ratio to the baseline; empty where the file lacks the study."""
        found = [one for one in self.result.studies if one.name == study]
        return [_told(row) for one in found for row in measure(self.result, one) if row.estimate is not None]

    def strong(self) -> list[Scaled]:
        """Strong scaling: every cell on several GPUs beside the same image on one GPU."""
        return strong(self.result.cells)

    def weak(self) -> list[Scaled]:
        """Weak scaling: every cell on several GPUs beside one GPU with a fraction of the samples."""
        return weak(self.result.cells)

    def common(self, other: Cells, selection: str = "") -> Ratios:
        """Times of a selection's cells over the same cells of another machine's file."""
        self._must_be_comparable(other)
        theirs = {cell.name: cell for cell in other.result.cells if cell.measured}
        found = [(cell, theirs[cell.name]) for cell in self._any(selection) if cell.name in theirs]
        if not found:
            raise FindingError(f"{self.result.path}: no cell in common with {other.result.path}")
        return Ratios(tuple(_ratio(cell, base, one_clock=False) for cell, base in found))

    def mean_over(self, other: Cells, selection: str = "") -> Quantity:
        """The geometric mean of time ratios over another file, with its interval, without cells disturbed in either."""
        self._must_be_comparable(other)
        theirs = {cell.name: cell for cell in other.result.cells if cell.measured}
        pairs = [(cell, theirs[cell.name]) for cell in self._any(selection) if cell.name in theirs]
        sides = [(cell.ms_per_spp, base.ms_per_spp) for cell, base in pairs if not doubt_of((cell, base))]
        if not sides:
            raise FindingError(f"{self.result.path}: no undisturbed cell in common with {other.result.path}")
        return Quantity(geometric_mean_of_ratios(sides), f"{self.result.path} over {other.result.path}")

    def _must_be_comparable(self, other: Cells) -> None:
        """Raises FindingError if two results differ in both machine and program, as the difference has no one cause."""
        files = self.result, other.result
        if len({devices_of(file) for file in files}) > 1 and (reason := why_not_one(files)):
            raise FindingError(f"{self.result.path} and {other.result.path} cannot be compared as machines: {reason}")


def _told(row: Row) -> Told:
    # A ratio of times is shown only if its verdict has no note or CLOCK_UNKNOWN; any other note withdraws it.
    is_told = row.ratio is not None and row.verdict.note in ("", CLOCK_UNKNOWN)
    ratio = Ratio(row.ratio, row.verdict, row.cell.name) if is_told else None
    return Told(row.cell.scene, row.label, Quantity(row.estimate, row.cell.name), ratio)


def _ratio(cell: Cell, base: Cell, *, one_clock: bool = True) -> Ratio:
    if withdrawn := between(cell, base):
        raise FindingError(f"{cell.name}: {withdrawn[0].mark}; no page may give this ratio as a verdict")
    estimate, verdict = time_ratio(cell, base, one_clock=one_clock)
    return Ratio(estimate, verdict, f"{cell.name} over {base.variant}")
