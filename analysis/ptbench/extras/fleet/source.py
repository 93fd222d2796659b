"""A suite on several GPUs as a source of numbers for a page: ratios, changed rankings, predictions from counters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ptbench.compare.match import Pair as CellPair
from ptbench.compare.text import MARKS, estimate_text
from ptbench.document.markdown import table_lines
from ptbench.errors import FindingError
from ptbench.extras.fleet.fleet import BAR, NEAR_ENOUGH, Fleet, Other, Score, fleet_of
from ptbench.extras.fleet.model import USED
from ptbench.extras.fleet.text import (
    changes_section,
    gpus_section,
    prediction_sections,
    ratios_section,
    static_section,
    unowned_section,
    verdicts_section,
)
from ptbench.extras.fleet.verdicts import Pair, crossover, ran_one_program, verdict_pairs
from ptbench.findings.quantities import Quantity, disturbed_text, link_to
from ptbench.findings.source import SEVERAL, Source
from ptbench.io.axes import INTEGRATOR
from ptbench.io.results import load_kept
from ptbench.numbers import figures, percent
from ptbench.stats.estimates import Estimate, geometric_mean_of_ratios
from ptbench.studies.disturbed import is_contended
from ptbench.studies.programs import why_not_one


class FleetSource(Source, form=SEVERAL):
    """Result files of several GPUs, of which pages compare the first two; counters are of the first file's GPU."""

    near_enough = percent(NEAR_ENOUGH)
    bar = percent(BAR)

    def __init__(self, results: Path, files: Sequence[str], inspected: Sequence[str], models: Sequence[str]) -> None:
        super().__init__(results, files[0])
        self._files, self._inspected = files, inspected
        paths = [[results / file for file in some] for some in (files, inspected)]
        if reason := why_not_one([load_kept(path) for path in paths[0]]):
            raise FindingError(f"{' and '.join(files)} cannot be compared as machines: {reason}")
        self._fleet: Fleet = fleet_of(*paths, models)
        self._pairs: list[Pair] = verdict_pairs(self._other.comparison)

    @classmethod
    def of(cls, results: Path, about: Mapping) -> FleetSource:
        """Makes the source of a page's "file" and those "against" it, with "inspect" files and unmeasured "models"."""
        return cls(results, (about["file"], *about["against"]), about.get("inspect", ()), about.get("models", ()))

    @property
    def _other(self) -> Other:
        return self._fleet.others[0]

    @property
    def first(self) -> str:
        """The name of the first GPU."""
        return self._fleet.first.name

    @property
    def other(self) -> str:
        """The name of the second GPU."""
        return self._other.gpu.name

    @property
    def mean(self) -> str:
        """Geometric mean of times on the second GPU over times on the first, with its interval.

        Cells disturbed by other processes on either GPU are left out, because their times are the host's.
        """
        pairs = self._undisturbed
        if not pairs:
            raise FindingError(f"{self._files}: no geometric mean")
        return estimate_text(
            geometric_mean_of_ratios([(pair.other.ms_per_spp, pair.reference.ms_per_spp) for pair in pairs])
        )

    @property
    def disturbed(self) -> int:
        """The number of cells that other processes disturbed on either GPU; no verdict or mean uses them."""
        return self.cells - len(self._undisturbed)

    @property
    def _undisturbed(self) -> list[CellPair]:
        pairs = [row.pair for row in self._other.comparison.rows]
        return [pair for pair in pairs if not is_contended(pair.reference) and not is_contended(pair.other)]

    @property
    def cells(self) -> int:
        """The number of cells that both files contain."""
        return len(self._other.comparison.rows)

    def ratios(self, integrators: str = "") -> list[float]:
        """Time ratios, second GPU over first, of all cells, or those of the named integrators."""
        chosen = integrators.split()
        return [
            row.ratio.value
            for row in self._other.comparison.rows
            if not chosen or row.pair.reference.axes[INTEGRATOR] in chosen
        ]

    @property
    def decided(self) -> int:
        """The number of study verdicts that are decisive on both GPUs."""
        return sum(pair.is_decided for pair in self._pairs)

    @property
    def changed(self) -> int:
        """The number of verdicts that are decisive on both GPUs and differ."""
        return sum(pair.is_changed for pair in self._pairs)

    def decided_about(self, axis: str) -> int:
        """The number of verdicts about one axis or tunable that are decisive on both GPUs."""
        return sum(pair.is_decided and pair.axis == axis for pair in self._pairs)

    def changed_about(self, axis: str) -> int:
        """The number of verdicts about one axis or tunable that differ between the GPUs."""
        return sum(pair.is_changed and pair.axis == axis for pair in self._pairs)

    def turned_about(self, axis: str) -> int:
        """The number of verdicts about one axis or tunable that are FASTER on one GPU and SLOWER on the other."""
        return sum(pair.is_turned and pair.axis == axis for pair in self._pairs)

    @property
    def groups(self) -> int:
        """The number of groups of variants that are ranked on both GPUs."""
        return len(self._fleet.compared.rankings)

    @property
    def groups_changed(self) -> int:
        """The number of groups of variants whose order changes between the GPUs by their verdicts."""
        return sum(bool(group.changes) for group in self._fleet.compared.rankings)

    @property
    def within_noise(self) -> int:
        """The number of pairs of variants that change places within the noise, which counts as no change."""
        return sum(group.within_noise for group in self._fleet.compared.rankings)

    @property
    def crossings(self) -> list[float]:
        """Memory bandwidths, GB/s, at which the order of two variants changes."""
        gpus = (self._fleet.first, self._other.gpu)
        if not ran_one_program(self._fleet.compared.results):
            raise FindingError(f"{self._files}: several programs, so no turn is the bandwidth's alone")
        found = [crossover(group, change, gpus) for group in self._fleet.compared.rankings for change in group.changes]
        return [one.value for one in found if one is not None]

    @property
    def unpredicted(self) -> int:
        """The number of cells without counters, for which there is no prediction."""
        return len(self._other.unpredicted)

    def score(self, rule: str = USED.name, *, own: bool = True, without: str = "") -> Score:
        """How well a rule predicts time ratios; `without` names a scene that is excluded."""
        found = [score for score in self._other.scores(own=own, without=without) if score.rule.name == rule]
        if not found:
            raise FindingError(f"{self._inspected}: no counters of a cell of {self._files[0]}")
        return found[0]

    def share(self, rule: str = USED.name, *, own: bool = True) -> Quantity:
        """The per cent of the variants that a rule predicts well enough."""
        score = self.score(rule, own=own)
        return Quantity(Estimate(100 * score.share, None, None, score.count), rule)

    def worst(self, rule: str = USED.name, *, own: bool = True) -> Quantity:
        """The largest error of a rule's predictions in per cent, unsigned."""
        return Quantity(Estimate(100 * abs(self.score(rule, own=own).worst), None, None, 1), rule)

    @property
    def reached(self) -> str:
        """ "reached" or "missed": whether enough variants are predicted well enough."""
        return "reached" if self.score().share >= BAR else "missed"

    @property
    def l2_mb(self) -> tuple[str, str]:
        """The L2 cache sizes of both GPUs, MB."""
        one, other = (figures(gpu.l2_bytes / 1e6, 3) for gpu in (self._fleet.first, self._other.gpu))
        return one, other

    def device_mb(self, variant: str, scene: str) -> str:
        """The device memory of a variant's render on the first GPU, MB."""
        cells = [row.pair.reference for row in self._other.comparison.rows]
        found = {
            round(cell.cuda.device_bytes / 1e6)
            for cell in cells
            if (cell.variant, cell.scene) == (variant, scene) and cell.cuda is not None and cell.cuda.device_bytes
        }
        if len(found) != 1:
            raise FindingError(f"{self._files[0]}: {len(found)} sizes on the device: {variant} in {scene}")
        return str(found.pop())

    def table(self, name: str) -> str:
        """A table of the command `fleet` for the first two GPUs, by the name of its section."""
        labels = self._fleet.compared.labels
        parts = {
            "gpus": lambda: gpus_section(self._fleet),
            "ratios": lambda: ratios_section(MARKS[1], self._other),
            "verdicts": lambda: verdicts_section(MARKS[1], self._other, labels),
            "changes": lambda: changes_section(self._fleet),
            "scores": lambda: next(iter(prediction_sections(MARKS[1], self._other, labels))),
            "predictions": lambda: list(prediction_sections(MARKS[1], self._other, labels))[-1],
            "unowned": lambda: unowned_section(self._fleet),
            "static": lambda: static_section(self._fleet.static),
        }
        found = parts[name]().table
        return "\n".join(table_lines(found)) if found is not None and found.rows else "None."

    @property
    def commit(self) -> str:
        """The commit of the older of the two results, seven digits; the first file's where they are equal."""
        return self._fleet.compared.results[0].about("git_sha")[:7]

    @property
    def provenance(self) -> str:
        """The list of result files with their GPUs and commits, as Markdown."""
        lines = [
            f"- {link_to(self._results, file)}: suite `{result.suite}`, {result.about('cuda_device')}, "
            f"{len(result.cells)} cells{disturbed_text(result)}; commit {result.about('git_sha')[:7]}, "
            f"{result.context['date'][:10]}."
            for file, result in zip(self._files, self._fleet.compared.results, strict=True)
        ]
        lines += [f"- {link_to(self._results, file)}: `ptbench inspect`." for file in self._inspected]
        return "\n".join(lines)
