"""A result file as a page asks it: times, ratios, rates, counters, by the words of a selection."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.convergence.assessment import Assessment, assess
from ptbench.convergence.efficiency import baseline_among, by_place, time_to
from ptbench.convergence.efficiency import compare as compare_errors
from ptbench.convergence.fit import Fit
from ptbench.errors import FindingError
from ptbench.figures.time_to_image import Way, sibling_meshes, ways
from ptbench.findings.builders import Built, Crossed, built, crossed
from ptbench.findings.commits import shown_commit
from ptbench.findings.quantities import Quantity, Ratio, Ratios, disturbed_text, link_to
from ptbench.io.cells import Cell, MeshFacts, Result
from ptbench.io.results import load_kept
from ptbench.stats.estimates import (
    CLOCK_UNKNOWN,
    UNSURE,
    Estimate,
    Verdict,
    geometric_mean_of_ratios,
    median_estimate,
    withheld,
    word_of,
)
from ptbench.studies.devices import Scaled, strong, weak
from ptbench.studies.disturbed import doubt_of
from ptbench.studies.programs import devices_of, why_not_one
from ptbench.studies.questions import dimension
from ptbench.studies.rows import Row, measure, time_ratio
from ptbench.studies.selection import cell_of, cells_of, parsed
from ptbench.studies.withdrawn import between


@dataclass(frozen=True)
class Told:
    """A row of a study's table; no ratio: it is the baseline, or has none."""

    scene: str
    label: str
    ms: Quantity
    ratio: Ratio | None


class Source:
    """One result file; `where` is what every selection of the page means besides what it says."""

    def __init__(self, results: Path, file: str, where: str = "") -> None:
        self.result: Result = load_kept(results / file)
        self._shown = file
        self._results = results
        self._where = parsed(where)

    def cell(self, selection: str) -> Cell:
        """The one measured cell of a selection."""
        return cell_of(self.result, self._chosen(selection))

    def cells(self, selection: str) -> list[Cell]:
        """Every measured cell of a selection."""
        return [cell for cell in cells_of(self.result, self._chosen(selection)) if cell.measured]

    def ms(self, selection: str) -> Quantity:
        """Render wall time of a sample a pixel, ms."""
        return self._median(selection, lambda cell: cell.ms_per_spp)

    def rays(self, selection: str) -> Quantity:
        """Rays traced over render wall time, 1e9 a second."""
        return self.rate(selection).over(1e3)

    def rate(self, selection: str) -> Quantity:
        """Rays traced over render wall time, 1e6 a second."""
        return self._median(selection, lambda cell: np.array([one.mega_rays_per_second for one in cell.samples]))

    def ratio(self, selection: str, over: str) -> Ratio:
        """Quantity of one cell over that of the cell that differs from it by the words of `over`."""
        cell = self.cell(selection)
        base = cell_of(self.result, {**self._chosen(selection), **parsed(over)})
        return _ratio(cell, base)

    def ratio_if(self, selection: str, over: str) -> Ratio | None:
        """The same, or None where one of the two was not measured."""
        for side in (parsed(selection), {**parsed(selection), **parsed(over)}):
            try:
                cell_of(self.result, {**self._where, **side})
            except FindingError:
                return None
        return self.ratio(selection, over)

    def ratios(self, selection: str, over: str) -> Ratios:
        """The same for every measured cell of a selection with `*`, each over its own baseline."""
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
        """Every measured cell of a study with its ratio to the study's baseline; none, where the file lacks it."""
        found = [one for one in self.result.studies if one.name == study]
        return [_told(row) for one in found for row in measure(self.result, one) if row.estimate is not None]

    def strong(self) -> list[Scaled]:
        """Every cell on several GPUs beside the same image on one."""
        return strong(self.result.cells)

    def weak(self) -> list[Scaled]:
        """The same beside as many times fewer samples on one."""
        return weak(self.result.cells)

    def built(self, selection: str) -> list[Built]:
        """What each builder's tree costs and is worth, in every cell of a selection with a mesh."""
        return built(self._ways(selection))

    def crossings(self, selection: str) -> list[Crossed]:
        """From how many samples a pixel on one builder's image is there before another's."""
        return crossed(self._ways(selection))

    def meshes(self, selection: str) -> MeshFacts:
        """What the cell's meshes and trees are made of."""
        facts = self.cell(selection).meshes
        if facts is None:
            raise FindingError(f"{self.result.path}: {selection} has no mesh")
        return facts

    def alive_percent(self, selection: str) -> float:
        """Per cent of the slots of all rounds, where ended paths stay, that are alive."""
        cell = self.cell(selection)
        alive = None if cell.instrumented is None else cell.instrumented.live_share(cell.depth)
        if alive is None:
            raise FindingError(f"{self.result.path}: {selection} has no counts of live paths")
        return 100 * alive

    def sah(self, selection: str) -> Quantity:
        """SAH cost of the cell's largest tree."""
        return Quantity(Estimate(self.meshes(selection).sah_cost, None, None, 1), selection)

    def common(self, other: Source, selection: str = "") -> Ratios:
        """Time of every cell of a selection here over that of the same cell in another file, of another machine."""
        self._must_be_comparable(other)
        theirs = {cell.name: cell for cell in other.result.cells if cell.measured}
        found = [(cell, theirs[cell.name]) for cell in self._any(selection) if cell.name in theirs]
        if not found:
            raise FindingError(f"{self.result.path}: no cell in common with {other.result.path}")
        return Ratios(tuple(_ratio(cell, base, one_clock=False) for cell, base in found))

    def mean_over(self, other: Source, selection: str = "") -> Quantity:
        """The geometric mean of the same ratios, with its interval, without cells that were disturbed on either."""
        self._must_be_comparable(other)
        theirs = {cell.name: cell for cell in other.result.cells if cell.measured}
        pairs = [(cell, theirs[cell.name]) for cell in self._any(selection) if cell.name in theirs]
        sides = [(cell.ms_per_spp, base.ms_per_spp) for cell, base in pairs if not doubt_of((cell, base))]
        if not sides:
            raise FindingError(f"{self.result.path}: no undisturbed cell in common with {other.result.path}")
        return Quantity(geometric_mean_of_ratios(sides), f"{self.result.path} over {other.result.path}")

    def same_film(self, selection: str, over: str) -> bool:
        """Whether both sides of that ratio left the same film, bit for bit."""
        base = cell_of(self.result, {**self._chosen(selection), **parsed(over)})
        return self.cell(selection).film_hash == base.film_hash

    def films_of(self, older: Source) -> tuple[int, int]:
        """Of an older program's cells that are here too, by what they render: how many left the same film, and all."""
        theirs = {cell.shown: cell.film_hash for cell in older.result.cells if cell.measured}
        same = [theirs[cell.shown] == cell.film_hash for cell in self.result.cells if cell.shown in theirs]
        if not same:
            raise FindingError(f"{self.result.path}: no cell in common with {older.result.path}")
        return sum(same), len(same)

    def registers(self, selection: str, kernel: str) -> int:
        """Registers a thread of a kernel."""
        return self._kernel(selection, kernel).registers

    def local_bytes(self, selection: str, kernel: str) -> int:
        """Local memory a thread of a kernel, bytes."""
        return self._kernel(selection, kernel).local_bytes

    def path_state_bytes(self, selection: str) -> int:
        """One copy of a path in the queue, bytes."""
        cuda = self.cell(selection).cuda
        if cuda is None or cuda.path_state_bytes is None:
            raise FindingError(f"{self.result.path}: {selection} tells no bytes of a path")
        return cuda.path_state_bytes

    # --- error against time ---

    def bias2(self, selection: str) -> Quantity:
        """Squared bias of the image, of the error curve's fit."""
        return self._fitted(selection, lambda fit: fit.bias2)

    def sigma2(self, selection: str) -> Quantity:
        """Variance of one sample, the mean over pixels and channels."""
        return self._fitted(selection, lambda fit: fit.sigma2)

    def slope(self, selection: str) -> Quantity:
        """Of the squared error over spp, both logarithmic: -1 for independent samples without a bias."""
        return self._fitted(selection, lambda fit: fit.slope.estimate)

    def mean_error(self, selection: str) -> Quantity:
        """How far the image's mean (green) is off in the longest renders, the median over seeds."""
        cell = self.assessment(selection).cell
        last = [sample.checkpoints[-1].mean_error for sample in cell.samples]
        if not all(last):
            raise FindingError(f"{self.result.path}: no mean error: {selection}")
        return Quantity(median_estimate(np.abs([error[1] for error in last if error])), cell.name)

    def wall(self, selection: str) -> Quantity:
        """Render wall time a sample per pixel, ms, with checkpoints."""
        one = self.assessment(selection)
        return Quantity(one.ms_per_spp["wall_ms"], one.cell.name)

    def wall_alone(self, selection: str) -> Quantity:
        """The same of the companion cell, without checkpoints."""
        one = self.assessment(selection)
        if one.ms_alone is None:
            raise FindingError(f"{self.result.path}: not run without checkpoints: {selection}")
        return Quantity(median_estimate(one.ms_alone), one.cell.name)

    def verdicts(self) -> Counter:
        """How many cells of the studies of error converge, have a plateau, ..., by the first words of the verdict."""
        return Counter(one.verdict.word for one in assess(self.result).values())

    def efficiency(self, selection: str) -> Ratio:
        """Against the baseline of the cell's scene in the study that the selection names; FASTER: above 1."""
        one = self.assessment(selection)
        study = self._chosen(selection)["study"]
        members = [other for other in assess(self.result).values() if study in other.cell.studies]
        base = baseline_among(self.result, next(group for group in by_place(members).values() if one in group))
        compared = compare_errors(one, base)
        if compared is None or compared.efficiency is None or base is None:
            raise FindingError(f"{self.result.path}: no efficiency: {selection}")
        if between(one.cell, base.cell):
            raise FindingError(f"{one.cell.name}: its efficiency is withdrawn (analysis/withdrawn.json)")
        value = compared.efficiency
        # More efficient is faster at equal error: the rule for times, on the reciprocal.
        word = UNSURE if value.low is None or value.high is None else word_of(1 / value.high, 1 / value.low)
        verdict = withheld(Verdict(word), compared.doubt) if compared.doubt else Verdict(word)
        return Ratio(value, verdict, one.cell.name)

    def must_stop_above(self, selection: str, error: float) -> str:
        """Nothing, if a plateau above that error was found; FindingError where a page says it and none was."""
        plateau = self.assessment(selection).verdict.plateau
        if plateau is None or plateau <= error:
            raise FindingError(f"{self.result.path}: no plateau above {error}, as the page says: {selection}")
        return ""

    def ms_to(self, selection: str, error: float) -> Quantity:
        """Wall time of a render in one piece to a root mean square error, ms (convergence/efficiency.py)."""
        one = self.assessment(selection)
        time = time_to(one, error)
        if time is None:
            raise FindingError(f"{self.result.path}: no time to {error}: {selection}")
        return Quantity(time, one.cell.name)

    def assessment(self, selection: str, over: str = "") -> Assessment:
        """The error curve of the one cell of a selection, changed by the words of `over`."""
        found = cells_of(self.result, {**self._chosen(selection), **parsed(over)})
        assessed = assess(self.result)
        named = [assessed[cell.name] for cell in found if cell.name in assessed]
        if len(named) != 1:
            raise FindingError(f"{self.result.path}: {len(named)} error curves: {selection} {over}")
        return named[0]

    # --- the file as a whole ---

    @property
    def device(self) -> str:
        """The GPU."""
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
        """Cells in the file."""
        return len(self.result.cells)

    @property
    def samples(self) -> str:
        """Timed samples of a cell, "9" or "7 to 9"."""
        counts = sorted({len(cell.samples) for cell in self.result.cells if cell.measured})
        return f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"

    @property
    def failed(self) -> int:
        """Cells that failed."""
        return sum(cell.failed for cell in self.result.cells)

    @property
    def timed_seconds(self) -> Quantity:
        """What its timed samples took, each from end to end, s."""
        total = sum(sample.end_to_end_ms or sample.wall_ms for cell in self.result.cells for sample in cell.samples)
        return Quantity(Estimate(total / 1e3, None, None, 1), str(self.result.path))

    @property
    def provenance(self) -> str:
        """A line of a list: the file, what it holds, the commit and the day."""
        failed = f"{self.failed} failed" if self.failed else "none failed"
        dirty = " with uncommitted changes" if self.is_dirty else ""
        summary = Path(self._shown).parent / "figures" / Path(self._shown).stem / "summary.md"
        every_row = f" Every row: [summary](../../results/{summary})." if (self._results / summary).exists() else ""
        commit = shown_commit(self._results, self.commit)
        return (
            f"- {link_to(self._results, self._shown)}: suite `{self.result.suite}`, {self.count} cells, {failed}"
            f"{disturbed_text(self.result)}; commit {commit}{dirty}, {self.date}.{every_row}"
        )

    def _must_be_comparable(self, other: Source) -> None:
        """Raises FindingError for machines that differ where the programs do as well."""
        files = self.result, other.result
        if len({devices_of(file) for file in files}) > 1 and (reason := why_not_one(files)):
            raise FindingError(f"{self.result.path} and {other.result.path} cannot be compared as machines: {reason}")

    def _ways(self, selection: str) -> list[Way]:
        return ways(self.cells(selection), sibling_meshes(self.result.path))

    def _any(self, selection: str) -> list[Cell]:
        """Every measured cell; of a selection, those with these words, whatever the rest is."""
        chosen = parsed(selection)
        return [
            cell
            for cell in self.result.cells
            if cell.measured and all(dimension(cell, name) == value for name, value in chosen.items())
        ]

    def _fitted(self, selection: str, value: Callable[[Fit], Estimate]) -> Quantity:
        one = self.assessment(selection)
        if one.fit is None:
            raise FindingError(f"{self.result.path}: no fit: {selection}")
        return Quantity(value(one.fit), one.cell.name)

    def _kernel(self, selection: str, kernel: str):
        cuda = self.cell(selection).cuda
        if cuda is None or kernel not in cuda.kernels:
            raise FindingError(f"{self.result.path}: {selection} has no kernel {kernel}")
        return cuda.kernels[kernel]

    def _chosen(self, selection: str) -> Mapping[str, str]:
        return {**self._where, **parsed(selection)}

    def _median(self, selection: str, values: Callable[[Cell], np.ndarray]) -> Quantity:
        cell = self.cell(selection)
        return Quantity(median_estimate(values(cell)), cell.name)


def _told(row: Row) -> Told:
    # What else stands there is a withdrawn verdict's mark.
    is_told = row.ratio is not None and row.verdict.note in ("", CLOCK_UNKNOWN)
    ratio = Ratio(row.ratio, row.verdict, row.cell.name) if is_told else None
    return Told(row.cell.scene, row.label, Quantity(row.estimate, row.cell.name), ratio)


def _ratio(cell: Cell, base: Cell, *, one_clock: bool = True) -> Ratio:
    if withdrawn := between(cell, base):
        raise FindingError(f"{cell.name}: {withdrawn[0].mark}; no page may give this ratio as a verdict")
    estimate, verdict = time_ratio(cell, base, one_clock=one_clock)
    return Ratio(estimate, verdict, f"{cell.name} over {base.variant}")
