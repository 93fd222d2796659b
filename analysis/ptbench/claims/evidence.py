"""What a result file says of a claim: for each of its conditions one number with its confidence interval."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.claims.claim import Claim, Condition, Experiment
from ptbench.claims.history import Measured
from ptbench.convergence.efficiency import compare as compare_errors
from ptbench.convergence.fit import Curve, fit_of
from ptbench.errors import FindingError
from ptbench.findings.sources.suite import SuiteSource
from ptbench.io.cells import Cell
from ptbench.io.files import stored_file
from ptbench.io.nodes import Node, read_json
from ptbench.io.rays import SCHEMA as RAYS
from ptbench.io.rays import Batch, RayMesh, Rays, Tree, rays_of
from ptbench.stats.estimates import Estimate, geometric_mean_of_ratios, ratio_estimate
from ptbench.stats.intervals import bootstrap_interval, resampled
from ptbench.studies.disturbed import doubt_of
from ptbench.studies.programs import why_not_one
from ptbench.studies.selection import parsed

BOUNCES = 7  # bounce after which the statistic alive_after_7 counts paths that are still alive
# Parts of an acceleration structure whose size the statistic `bytes` takes.
_PARTS = {"nodes": lambda tree: tree.node_bytes, "all": lambda tree: tree.node_bytes + tree.leaf_bytes}


@dataclass(frozen=True)
class Found:
    """The number measured for a condition of a claim; without an estimate, the reason why there is none."""

    condition: Condition
    estimate: Estimate | None
    doubt: str = ""  # why the measured number decides nothing on the claim, or why there is no number


@dataclass(frozen=True)
class Evidence:
    """Everything that one result file says of a claim."""

    files: tuple[str, ...]  # paths of the result files that give evidence, relative to the folder of results
    machine: str  # name of the machine's folder in results/
    device: str
    measured: Measured
    found: tuple[Found, ...]
    refused: str = ""  # why the results of two machines may not be compared; empty where they may

    @property
    def is_own(self) -> bool:
        """Whether the claim's own experiment was run, rather than looked up in the results of other suites."""
        return "/claims/" in self.files[0]


def evidence_of(claim: Claim, results: Path) -> list[Evidence]:
    """The evidence of each machine's results, in the folders' order; empty for a withdrawn claim or one not run."""
    experiment = claim.experiment
    if experiment is None or claim.withdrawn:
        return []
    if experiment.machines:
        return _of_two(experiment, results)
    machines = sorted(path for path in results.iterdir() if path.is_dir()) if results.is_dir() else []
    found = [_evidence(experiment, results, file) for machine in machines for file in _files(experiment, machine)[:1]]
    return [one for one in found if any(number.estimate is not None for number in one.found) or one.is_own]


def _files(experiment: Experiment, machine: Path) -> list[Path]:
    """The result file of a claim's own experiment on a machine, or else those of other suites that may have it."""
    own = machine / "claims" / f"{experiment.result}.json"
    if _is_there(own):
        return [own]
    others = [machine / f"{name}.json" for name in experiment.also]
    return [file for file in others if _is_there(file) and _backend(file) == experiment.backend]


def _is_there(file: Path) -> bool:
    return stored_file(file).is_file()


def _backend(file: Path) -> str | None:
    return read_json(file).need("context").fields().get("ptbench.backend")


def _evidence(experiment: Experiment, results: Path, file: Path) -> Evidence:
    root = read_json(file)
    is_rays = root.value.get("schema") == RAYS if isinstance(root.value, dict) else False
    numbers = _OfRays(root) if is_rays else _OfSuite(results, file.relative_to(results), experiment)
    found = tuple(_found(numbers, condition, experiment.statistic, file) for condition in experiment.conditions)
    machine = file.relative_to(results).parts[0]
    return Evidence((_shown(results, file),), machine, _device(experiment, root) or machine, _measured(root), found)


def _of_two(experiment: Experiment, results: Path) -> list[Evidence]:
    """Evidence from rays traced on two machines: how many times as fast the first traces the same batch."""
    files = [_files(experiment, results / machine)[:1] for machine in experiment.machines]
    if not all(files):
        return []
    roots = [read_json(file) for (file,) in files]
    one, other = (_OfRays(root) for root in roots)
    refused = why_not_one([one.rays, other.rays])
    found = []
    for condition in experiment.conditions:
        if refused:
            found.append(Found(condition, None))
            continue
        try:
            found.append(Found(condition, ratio_estimate(other.times(condition.cell), one.times(condition.cell))))
        except FindingError as error:
            found.append(Found(condition, None, str(error).replace(f"{results}/", "")))
    device = " against ".join(_device(experiment, root) or "?" for root in roots)
    measured = min((_measured(root) for root in roots), key=lambda each: each.on)
    shown = tuple(_shown(results, file) for (file,) in files)
    return [Evidence(shown, experiment.machines[0], device, measured, tuple(found), refused)]


def _shown(results: Path, file: Path) -> str:
    return stored_file(file).relative_to(results).as_posix()


def _device(experiment: Experiment, root: Node) -> str | None:
    key = "ptbench.cuda_device" if experiment.backend == "cuda" else "ptbench.cpu_model"
    return root.need("context").fields().get(key)


def _found(numbers: _OfSuite | _OfRays, condition: Condition, statistic: str, file: Path) -> Found:
    """The number of a condition; where it is missing the reason, without the file's name, as a page links the file."""
    try:
        return numbers.found(condition, statistic)
    except FindingError as error:
        return Found(condition, None, str(error).replace(f"{file}: ", ""))


def _measured(root: Node) -> Measured:
    """When a result was measured: the date of its first session, since a cell's times could be seen from then on."""
    context = root.need("context").fields()
    dates = [context["date"]]
    run = root.maybe("ptbench") and root.need("ptbench").maybe("run")
    if run is not None and (sessions := run.maybe("sessions")) is not None:
        dates += [session.need("date").text() for session in sessions.items()]
    dirty = str(context.get("ptbench.git_dirty", "")).lower() == "true"
    return Measured(context.get("ptbench.git_sha", ""), min(dates), dirty)


class _OfSuite:
    """The numbers of a result file of `ptbench run` that a claim's conditions ask for."""

    def __init__(self, results: Path, file: Path, experiment: Experiment) -> None:
        self._source = SuiteSource(results, str(file))
        self._experiment = experiment

    def found(self, condition: Condition, statistic: str) -> Found:
        numbers = {
            "speed_up": self._speed_up, "time": self._time, "alive_after_7": self._alive, "variance": self._variance,
            "efficiency": self._efficiency, "veach_bound": self._bound, "rmse": self._rmse, "slope": self._slope,
        }  # fmt: skip
        if statistic not in numbers:
            raise FindingError(f"no statistic {statistic} of a suite")
        return numbers[statistic](condition)

    def _speed_up(self, condition: Condition) -> Found:
        pairs = self._pairs(condition)
        sides = [(base.ms_per_spp, cell.ms_per_spp) for cell, base in pairs]
        estimate = ratio_estimate(*sides[0]) if len(sides) == 1 else geometric_mean_of_ratios(sides)
        return Found(condition, estimate, doubt_of(cell for pair in pairs for cell in pair))

    def _time(self, condition: Condition) -> Found:
        ((cell, base),) = pairs = self._pairs(condition)
        return Found(
            condition,
            ratio_estimate(cell.ms_per_spp, base.ms_per_spp),
            doubt_of(cell for pair in pairs for cell in pair),
        )

    def _pairs(self, condition: Condition) -> list[tuple[Cell, Cell]]:
        """A condition's cell and its baseline; with `scene=*`, such a pair for every scene that has both."""
        if "scene=*" not in condition.cell.split():
            return [(self._source.cell(condition.cell), self._source.cell(condition.over))]
        bases = {cell.scene: cell for cell in self._source.cells(condition.over)}
        pairs = [(cell, bases[cell.scene]) for cell in self._source.cells(condition.cell) if cell.scene in bases]
        if not pairs or len({cell.scene for cell, _ in pairs}) != len(pairs):
            raise FindingError(f"{condition.name}: not one pair a scene")
        return pairs

    def _alive(self, condition: Condition) -> Found:
        """The share of live paths: exact for the counting pass's seed, with a binomial interval for other seeds."""
        cell = self._source.cell(condition.cell)
        alive = None if cell.instrumented is None else cell.instrumented.live_paths
        if alive is None or len(alive) <= BOUNCES:
            raise FindingError(f"{cell.name}: no count of paths after {BOUNCES} bounces")
        paths = cell.instrumented.paths
        share = alive[BOUNCES] / paths
        half = 1.96 * float(np.sqrt(share * (1 - share) / paths))
        return Found(condition, Estimate(share, share - half, share + half, paths))

    def _curve(self, selection: str) -> Curve:
        return self._source.assessment(selection).curve

    def _variance(self, condition: Condition) -> Found:
        ours, base = (fit_of(self._curve(text)).sigma2_of_seeds for text in (condition.cell, condition.over))
        return Found(condition, _over_seeds(lambda rows: base[rows].mean(-1) / ours[rows].mean(-1), len(ours)))

    def _efficiency(self, condition: Condition) -> Found:
        compared = compare_errors(*(self._source.assessment(text) for text in (condition.cell, condition.over)))
        if compared is None or compared.efficiency is None:
            raise FindingError(f"{condition.name}: no efficiency")
        return Found(condition, compared.efficiency, compared.doubt)

    def _bound(self, condition: Condition) -> Found:
        """The balance heuristic's variance over the bound of Veach's theorem, with one sample of each technique."""
        curve = self._curve(condition.cell)
        ours = fit_of(curve).sigma2_of_seeds
        singles = [fit_of(self._curve(text)).sigma2_of_seeds for text in condition.over.split(";")]
        room = curve.reference.mean_square / 2

        def ratio(rows: np.ndarray) -> np.ndarray:
            return ours[rows].mean(-1) / (np.minimum(*(one[rows].mean(-1) for one in singles)) + room)

        return Found(condition, _over_seeds(ratio, len(ours)))

    def _rmse(self, condition: Condition) -> Found:
        at = self._experiment.spp_at
        errors = []
        for curve in (self._curve(condition.cell), self._curve(condition.over)):
            columns = [index for index, spp in enumerate(curve.spp) if spp == at]
            if not columns:
                raise FindingError(f"{curve.cell.name}: no checkpoint at {at} spp")
            errors.append(curve.mse[:, columns[0]])
        ours, base = errors
        if len(ours) != len(base):
            raise FindingError(f"{condition.name}: {len(ours)} and {len(base)} seeds")
        with np.errstate(invalid="ignore"):  # a mean of dual squared errors may be negative
            estimate = _over_seeds(lambda rows: np.sqrt(base[rows].mean(-1) / ours[rows].mean(-1)), len(ours))
        return Found(condition, estimate)

    def _slope(self, condition: Condition) -> Found:
        slope = fit_of(self._curve(condition.cell)).slope
        if slope is None:
            raise FindingError(f"{condition.name}: no slope")
        return Found(condition, slope.estimate)


def _over_seeds(ratio: Callable[[np.ndarray], np.ndarray], count: int) -> Estimate:
    """A ratio of two means over seeds; both sides share seeds, so the bootstrap draws each seed for both."""
    return bootstrap_interval(float(ratio(np.arange(count))), ratio(resampled(count)), count)


class _OfRays:
    """The numbers of a result file of `ptbench rays` that a claim's conditions ask for."""

    def __init__(self, root: Node) -> None:
        self.rays: Rays = rays_of(root)
        self._wrong = [mesh.name for mesh in self.rays.meshes if not all(mesh.agree.values())]

    def found(self, condition: Condition, statistic: str) -> Found:
        if statistic == "bytes":
            share = self._bytes(condition.cell) / self._bytes(condition.over)
            return Found(condition, Estimate(share, share, share, 1))
        if statistic != "speed_up":
            raise FindingError(f"no statistic {statistic} of rays")
        return Found(condition, ratio_estimate(self.times(condition.over), self.times(condition.cell)))

    def times(self, selection: str) -> np.ndarray:
        """Milliseconds of one batch of rays; raises FindingError where it is missing or trees disagree on its hits."""
        if self._wrong:
            raise FindingError(f"hits differ between trees of {', '.join(self._wrong)}")
        return np.array(self._batch(selection).ms)

    def _tree(self, chosen: Mapping[str, str]) -> tuple[RayMesh, Tree]:
        found = [
            (mesh, tree)
            for mesh in self.rays.meshes
            for tree in mesh.trees
            if (mesh.name, tree.accelerator, tree.builder)
            == (chosen.get("mesh"), chosen.get("accelerator"), chosen.get("builder", "sah_binned"))
        ]
        if len(found) != 1:
            raise FindingError(f"{self.rays.path}: {len(found)} trees are {_words(chosen)}")
        return found[0]

    def _batch(self, selection: str) -> Batch:
        chosen = parsed(selection)
        _, tree = self._tree(chosen)
        wanted = (chosen.get("class"), chosen.get("kernel"))
        found = [batch for batch in tree.batches if (batch.ray_class, batch.kernel) == wanted]
        if len(found) != 1:
            raise FindingError(f"{self.rays.path}: {len(found)} batches are {_words(chosen)}")
        return found[0]

    def _bytes(self, selection: str) -> int:
        chosen = parsed(selection)
        if chosen.get("part") not in _PARTS:
            raise FindingError(f"{selection}: part is {' or '.join(_PARTS)}")
        return _PARTS[chosen["part"]](self._tree(chosen)[1])


def _words(chosen: Mapping[str, str]) -> str:
    return " ".join(f"{name}={value}" for name, value in chosen.items())
