"""The cells of a result, looked up by the words of a selection, and facts about the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from ptbench.findings.commits import shown_commit
from ptbench.findings.quantities import Quantity, disturbed_text
from ptbench.findings.source import Source
from ptbench.io.cells import Cell, Result
from ptbench.io.results import load_kept
from ptbench.stats.estimates import Estimate, median_estimate
from ptbench.studies.questions import dimension
from ptbench.studies.selection import cell_of, cells_of, parsed


class Cells(Source):
    """One result file; `where` is added to every selection that the page makes."""

    def __init__(self, results: Path, file: str, where: str = "") -> None:
        super().__init__(results, file)
        self.result: Result = load_kept(results / file)
        self._where = parsed(where)

    @classmethod
    def of(cls, results: Path, about: Mapping) -> Cells:
        """Makes the source of a page's entry; its "where" is added to every selection."""
        return cls(results, about["file"], about.get("where", ""))

    def cell(self, selection: str) -> Cell:
        """The one measured cell of a selection."""
        return cell_of(self.result, self._chosen(selection))

    def cells(self, selection: str) -> list[Cell]:
        """Every measured cell of a selection."""
        return [cell for cell in cells_of(self.result, self._chosen(selection)) if cell.measured]

    @property
    def device(self) -> str:
        """The name of the GPU on which the result was measured."""
        return self.result.about("cuda_device")

    @property
    def commit(self) -> str:
        """The commit of the program that measured, seven digits."""
        return self.result.about("git_sha")[:7]

    @property
    def is_dirty(self) -> bool:
        """Whether the program had changes that were not committed."""
        return self.result.about("git_dirty") == "true"

    @property
    def date(self) -> str:
        """The day of the measurement."""
        return self.result.context["date"][:10]

    @property
    def count(self) -> int:
        """The number of cells in the result file."""
        return len(self.result.cells)

    @property
    def samples(self) -> str:
        """The number of timed samples per cell, "9" or "7 to 9"."""
        counts = sorted({len(cell.samples) for cell in self.result.cells if cell.measured})
        return f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"

    @property
    def failed(self) -> int:
        """The number of cells that failed."""
        return sum(cell.failed for cell in self.result.cells)

    @property
    def timed_seconds(self) -> Quantity:
        """The total time of all timed samples, each from end to end, in seconds."""
        total = sum(sample.end_to_end_ms or sample.wall_ms for cell in self.result.cells for sample in cell.samples)
        return Quantity(Estimate(total / 1e3, None, None, 1), str(self.result.path))

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its contents, commit and date."""
        failed = f"{self.failed} failed" if self.failed else "none failed"
        dirty = " with uncommitted changes" if self.is_dirty else ""
        summary = Path(self._shown).parent / "figures" / Path(self._shown).stem / "summary.md"
        every_row = f" Every row: [summary](../../results/{summary})." if (self._results / summary).exists() else ""
        commit = shown_commit(self._results, self.commit)
        return (
            f"- {self._link}: suite `{self.result.suite}`, {self.count} cells, {failed}"
            f"{disturbed_text(self.result)}; commit {commit}{dirty}, {self.date}.{every_row}"
        )

    def _any(self, selection: str) -> list[Cell]:
        """Every measured cell that has the words of the selection, whatever its other settings."""
        chosen = parsed(selection)
        return [
            cell
            for cell in self.result.cells
            if cell.measured and all(dimension(cell, name) == value for name, value in chosen.items())
        ]

    def _chosen(self, selection: str) -> Mapping[str, str]:
        return {**self._where, **parsed(selection)}

    def _median(self, selection: str, values: Callable[[Cell], np.ndarray]) -> Quantity:
        cell = self.cell(selection)
        return Quantity(median_estimate(values(cell)), cell.name)
