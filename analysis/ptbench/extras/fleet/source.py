"""A suite on several GPUs, as a page asks it: what differs, what turns, and what counters and data sheets explain."""

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
from ptbench.io.results import load_kept
from ptbench.numbers import figures, percent
from ptbench.stats.estimates import Estimate, geometric_mean_of_ratios
from ptbench.studies.disturbed import is_contended
from ptbench.studies.programs import why_not_one


class FleetSource(Source, form=SEVERAL):
    """Result files of GPUs, the first of the one that counters are of; a page speaks of the first two."""

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
        """The file and those "against" it, with files that "inspect" wrote and "models" that nobody has."""
        return cls(results, (about["file"], *about["against"]), about.get("inspect", ()), about.get("models", ()))

    @property
    def _other(self) -> Other:
        return self._fleet.others[0]

    @property
    def first(self) -> str:
        """The first GPU's name."""
        return self._fleet.first.name

    @property
    def other(self) -> str:
        """The second GPU's name."""
        return self._other.gpu.name

    @property
    def mean(self) -> str:
        """Geometric mean of times on the second GPU over times on the first, with its interval.

        Without the cells that other processes disturbed on either: there it would be a host's.
        """
        pairs = self._undisturbed
        if not pairs:
            raise FindingError(f"{self._files}: no geometric mean")
        return estimate_text(
            geometric_mean_of_ratios([(pair.other.ms_per_spp, pair.reference.ms_per_spp) for pair in pairs])
        )

    @property
    def disturbed(self) -> int:
        """Cells that other processes disturbed on either GPU, which no verdict and no mean is of."""
        return self.cells - len(self._undisturbed)

    @property
    def _undisturbed(self) -> list[CellPair]:
        pairs = [row.pair for row in self._other.comparison.rows]
        return [pair for pair in pairs if not is_contended(pair.reference) and not is_contended(pair.other)]

    @property
    def cells(self) -> int:
        """Cells that both files have."""
        return len(self._other.comparison.rows)

    def ratios(self, integrators: str = "") -> list[float]:
        """Second over first, of every cell of these integrators, or of all."""
        chosen = integrators.split()
        return [
            row.ratio.value
            for row in self._other.comparison.rows
            if not chosen or row.pair.reference.axes["integrator"] in chosen
        ]

    @property
    def decided(self) -> int:
        """Verdicts of studies that say something on both GPUs."""
        return sum(pair.is_decided for pair in self._pairs)

    @property
    def changed(self) -> int:
        """Number of verdicts that have another word on the other GPU."""
        return sum(pair.is_changed for pair in self._pairs)

    def decided_about(self, axis: str) -> int:
        """Verdicts about one axis or tunable that say something on both."""
        return sum(pair.is_decided and pair.axis == axis for pair in self._pairs)

    def changed_about(self, axis: str) -> int:
        """Number of verdicts about one axis or tunable that have another word on the other GPU."""
        return sum(pair.is_changed and pair.axis == axis for pair in self._pairs)

    def turned_about(self, axis: str) -> int:
        """Number of verdicts about one axis or tunable that are FASTER on one GPU and SLOWER on the other."""
        return sum(pair.is_turned and pair.axis == axis for pair in self._pairs)

    @property
    def groups(self) -> int:
        """Groups of variants with a ranking on both."""
        return len(self._fleet.compared.rankings)

    @property
    def groups_changed(self) -> int:
        """Number of groups of variants in which verdicts support another order."""
        return sum(bool(group.changes) for group in self._fleet.compared.rankings)

    @property
    def within_noise(self) -> int:
        """Pairs that change places within the noise, which is no change."""
        return sum(group.within_noise for group in self._fleet.compared.rankings)

    @property
    def crossings(self) -> list[float]:
        """The bandwidths, GB/s, at which the order of two variants turns."""
        gpus = (self._fleet.first, self._other.gpu)
        if not ran_one_program(self._fleet.compared.results):
            raise FindingError(f"{self._files}: several programs, so no turn is the bandwidth's alone")
        found = [crossover(group, change, gpus) for group in self._fleet.compared.rankings for change in group.changes]
        return [one.value for one in found if one is not None]

    @property
    def unpredicted(self) -> int:
        """Cells without counters."""
        return len(self._other.unpredicted)

    def score(self, rule: str = USED.name, *, own: bool = True, without: str = "") -> Score:
        """How well a rule predicts; `without`: a scene that does not count."""
        found = [score for score in self._other.scores(own=own, without=without) if score.rule.name == rule]
        if not found:
            raise FindingError(f"{self._inspected}: no counters of a cell of {self._files[0]}")
        return found[0]

    def share(self, rule: str = USED.name, *, own: bool = True) -> Quantity:
        """Per cent of the variants that a rule predicts well enough."""
        score = self.score(rule, own=own)
        return Quantity(Estimate(100 * score.share, None, None, score.count), rule)

    def worst(self, rule: str = USED.name, *, own: bool = True) -> Quantity:
        """Per cent by which a rule is off at most, without its sign."""
        return Quantity(Estimate(100 * abs(self.score(rule, own=own).worst), None, None, 1), rule)

    @property
    def reached(self) -> str:
        """Whether the aim of predictions is reached."""
        return "reached" if self.score().share >= BAR else "missed"

    @property
    def l2_mb(self) -> tuple[str, str]:
        """Both L2 caches, MB."""
        one, other = (figures(gpu.l2_bytes / 1e6, 3) for gpu in (self._fleet.first, self._other.gpu))
        return one, other

    def device_mb(self, variant: str, scene: str) -> str:
        """What a variant's render keeps on the first GPU, MB."""
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
        """What the command tells of the first two GPUs, by the name of its part."""
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
        """The older program's of the two, seven digits: the first file's where they are of one."""
        return self._fleet.compared.results[0].about("git_sha")[:7]

    @property
    def provenance(self) -> str:
        """Lines of a list: the files."""
        lines = [
            f"- {link_to(self._results, file)}: suite `{result.suite}`, {result.about('cuda_device')}, "
            f"{len(result.cells)} cells{disturbed_text(result)}; commit {result.about('git_sha')[:7]}, "
            f"{result.context['date'][:10]}."
            for file, result in zip(self._files, self._fleet.compared.results, strict=True)
        ]
        lines += [f"- {link_to(self._results, file)}: `ptbench inspect`." for file in self._inspected]
        return "\n".join(lines)
