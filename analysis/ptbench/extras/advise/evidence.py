"""What committed results say of each choice: its time, or its error, relative to a reference choice, by scene."""

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from ptbench.convergence.assessment import Assessment, assess
from ptbench.convergence.costs import TIME, VARIANCE, cost_ratio
from ptbench.convergence.efficiency import place_of
from ptbench.errors import InputError
from ptbench.extras.advise.features import OF_ERROR, OF_TIME, Content, Features, content_of, features_of, scene_files
from ptbench.io.cells import Cell, Result
from ptbench.io.files import package_file
from ptbench.io.nodes import read_json
from ptbench.io.results import result_of
from ptbench.stats.estimates import Estimate, ratio_estimate
from ptbench.studies.disturbed import is_contended
from ptbench.studies.withdrawn import between

# A choice of a decision, as (axis or tunable, value) pairs: the settings that differ from the decision's reference.
Choice = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Decision:
    """One thing to decide: the axes that it sets, and the reference that every other choice is compared with."""

    name: str
    reference: Mapping[str, str]
    only: Mapping[str, str]  # axis choices that a cell must have to be evidence for the decision; empty: every cell is
    statistic: str
    of_meshes: bool = False  # whether to choose an acceleration structure, which needs a scene with triangles

    @property
    def of_error(self) -> bool:
        """Whether the decision rests on error curves, not on times."""
        return self.statistic != TIME

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the scene features that the decision is expected to depend on."""
        return OF_ERROR if self.of_error else OF_TIME


SCHEDULE = "scheduler"
FILE = package_file("extras", "advise", "decisions.json")
DECISIONS = tuple(
    Decision(one["name"], one["reference"], one.get("only", {}), one["statistic"], one.get("of_meshes", False))
    for one in json.loads(FILE.read_text(encoding="utf-8"))["decisions"]
)
# A tunable that adds artificial shading cost; cells with it are no evidence for advice, as if their scene were another.
INJECTED = "shading_fmas"
_OF_A_COMMIT = re.compile(r"_[0-9a-f]{7}\.json(\.gz)?$")


def choice_text(choice: Choice, decision: Decision) -> str:
    """A choice such as "integrator=persistent block=64", as `--axis` and `--tune` take it, less reference settings."""
    named = dict(choice)
    first = next(iter(decision.reference))
    shown = {first: named.get(first, decision.reference[first]), **named}
    return " ".join(f"{name}={value}" for name, value in shown.items())


@dataclass(frozen=True)
class Point:
    """One measured ratio: a choice over its decision's reference, all else equal."""

    choice: Choice
    ratio: Estimate
    features: Features
    scene: str
    setting: str  # depth and image size of the measured cells that gave the ratio
    file: str
    rest: tuple  # settings that the measured choice and its reference share
    by_way_of: str = ""  # choice through which this one was compared, where the reference itself was not run

    @property
    def log_ratio(self) -> float:
        """The natural logarithm of the ratio."""
        return math.log(self.ratio.value)

    @cached_property
    def context(self) -> dict[str, str]:
        """The choices of the axes that the decision does not set."""
        return dict(self.rest[3])

    @property
    def family(self) -> str:
        """The name that variants of a scene share: scenes that differ only in pixel jitter are left out together."""
        return self.scene.removesuffix("_unjittered")


@dataclass(frozen=True)
class Book:
    """All ratios measured on one machine."""

    machine: str
    device: str
    backend: str
    points: Mapping[str, tuple[Point, ...]]  # measured ratios of choices to their reference, by name of the decision
    baselines: Mapping[str, str]  # baseline choice by axis, from the newest file that names one
    without: tuple[str, ...]  # measured scenes whose files do not exist in the checkout


def result_files(machine: Path) -> list[Path]:
    """The result files in a machine's folder, without those whose name ends with a commit: they are history."""
    found = [*machine.glob("*.json"), *machine.glob("*.json.gz"), *machine.glob("claims/*.json*")]
    return sorted(path for path in found if not _OF_A_COMMIT.search(path.name))


def results_of(machine: Path) -> Iterator[tuple[str, Result]]:
    """Every result of `ptbench run` in a machine's folder, with its path relative to the folder of results."""
    for path in result_files(machine):
        root = read_json(path)
        if isinstance(root.value, dict) and {"benchmarks", "ptbench"} <= root.value.keys():
            yield path.relative_to(machine.parent).as_posix(), result_of(root)


class _Reader:
    """Collects the measured ratios of one backend, file by file."""

    def __init__(self, scenes: Path) -> None:
        self._files = scene_files(scenes)
        self._contents: dict[str, Content] = {}
        self._kept: dict[str, dict[tuple, tuple[str, Point]]] = {decision.name: {} for decision in DECISIONS}
        self._orphans: list[tuple[list[Cell], str]] = []
        self._baselines: tuple[str, Mapping[str, str]] = ("", {})
        self.without: set[str] = set()
        self.device = ""

    def read(self, file: str, result: Result, backend: str) -> None:
        """Takes in the cells of a file that ran on the backend."""
        cells = [cell for cell in result.cells if cell.backend == backend and cell.measured]
        if not cells:
            return
        self.device = result.about("cuda_device" if backend == "cuda" else "cpu_model")
        if result.baselines and result.context["date"] >= self._baselines[0]:
            self._baselines = (result.context["date"], result.baselines)
        for scene in {cell.scene for cell in cells} - self._contents.keys():
            if scene in self._files:
                self._contents[scene] = content_of(self._files[scene])
            else:
                self.without.add(scene)
        known = [cell for cell in cells if cell.scene in self._contents]
        assessed = assess(result) if any(cell.convergence is not None for cell in known) else {}
        for decision in DECISIONS:
            for group in _groups(decision, known):
                if decision.name == SCHEDULE and all(_choice(cell, decision) for cell in group):
                    self._orphans.append((group, file))
                for point in _points(decision, assessed, group, self._contents, file):
                    self._keep(decision, point, result.context["date"])

    def _keep(self, decision: Decision, point: Point, date: str) -> None:
        """Keeps the newest of measurements with equal settings."""
        kept, key = self._kept[decision.name], (point.choice, *point.rest)
        if key not in kept or kept[key][0] <= date:
            kept[key] = (date, point)

    def book(self, machine: str, backend: str) -> Book:
        """All measured ratios that were collected."""
        points = {name: tuple(point for _, point in kept.values()) for name, kept in self._kept.items()}
        known = points[SCHEDULE]
        points[SCHEDULE] += tuple(
            point for group, file in self._orphans for point in _chained(group, known, self._contents, file)
        )
        without = tuple(sorted(self.without))
        return Book(machine, self.device or machine, backend, points, self._baselines[1], without)


def read_book(root: Path, results: Path, machine: str, backend: str) -> Book:
    """Reads all ratios measured on a machine with one backend; raises InputError where there are none."""
    reader = _Reader(root / "scenes")
    for file, result in results_of(results / machine):
        reader.read(file, result, backend)
    book = reader.book(machine, backend)
    if not any(book.points.values()):
        raise InputError(f"{results / machine}: found no ratio of two choices on {backend}, allowed: a folder with one")
    return book


def _groups(decision: Decision, cells: Iterable[Cell]) -> list[list[Cell]]:
    """Groups of cells that differ only in what the decision sets."""
    groups: dict[tuple, list[Cell]] = {}
    for cell in cells:
        if (cell.convergence is not None) == decision.of_error and _may_be_asked(cell, decision):
            groups.setdefault(_rest(cell, decision), []).append(cell)
    return list(groups.values())


def _points(
    decision: Decision,
    assessed: Mapping[str, Assessment],
    group: Sequence[Cell],
    contents: Mapping[str, Content],
    file: str,
) -> Iterator[Point]:
    bases = [cell for cell in group if not _choice(cell, decision)]
    for cell in group if bases else ():
        choice = _choice(cell, decision)
        base = min(bases, key=lambda one: one.spp != cell.spp)
        if not choice or (decision.statistic != VARIANCE and between(cell, base)):
            continue
        ratio = cost_ratio(decision.statistic, assessed, cell, base)
        features = features_of(base, contents[cell.scene])
        if ratio is not None and ratio.value > 0 and features is not None:
            yield Point(choice, ratio, features, cell.scene, _setting(base), file, _rest(cell, decision))


def _chained(
    group: Sequence[Cell], points: Sequence[Point], contents: Mapping[str, Content], file: str
) -> Iterator[Point]:
    """Ratios for a group without the reference, by a choice that was compared with it in the same scene and depth."""
    decision = DECISIONS[0]
    against: dict[Choice, list[float]] = {}
    for point in points:
        if (point.scene, point.features.depth) == (group[0].scene, group[0].depth):
            against.setdefault(point.choice, []).append(point.log_ratio)
    anchors = [cell for cell in group if _choice(cell, decision) in against]
    if not anchors:
        return
    anchor = min(anchors, key=lambda cell: len(_choice(cell, decision)))
    logs = against[_choice(anchor, decision)]
    factor = math.exp(sum(logs) / len(logs))
    for cell in group:
        features = features_of(cell, contents[cell.scene])
        if cell is anchor or features is None or between(cell, anchor):
            continue
        ratio = ratio_estimate(cell.ms_per_spp, anchor.ms_per_spp)
        low, high = (None if end is None else factor * end for end in (ratio.low, ratio.high))
        scaled = Estimate(factor * ratio.value, low, high, ratio.n)
        way = choice_text(_choice(anchor, decision), decision)
        rest = _rest(cell, decision)
        yield Point(_choice(cell, decision), scaled, features, cell.scene, _setting(cell), file, rest, way)


def _setting(cell: Cell) -> str:
    return f"depth {cell.depth}, {cell.resolution_text}"


def _may_be_asked(cell: Cell, decision: Decision) -> bool:
    if is_contended(cell) or INJECTED in cell.tuned or (decision.of_meshes and cell.meshes is None):
        return False
    return all(cell.axes.get(axis) == choice for axis, choice in decision.only.items())


def _rest(cell: Cell, decision: Decision) -> tuple:
    """The settings that a choice and its reference share; tunables count except for the scheduler."""
    axes = tuple(sorted((axis, choice) for axis, choice in cell.axes.items() if axis not in decision.reference))
    tuned = () if decision.name == SCHEDULE else tuple(sorted(cell.tuned.items()))
    depth = cell.depth if cell.convergence is None else place_of(cell).depth
    return cell.scene, depth, cell.resolution, axes, tuned


def _choice(cell: Cell, decision: Decision) -> Choice:
    axes = [(axis, cell.axes.get(axis, usual)) for axis, usual in decision.reference.items()]
    differing = [(axis, choice) for axis, choice in axes if choice != decision.reference[axis]]
    return tuple(differing) + (tuple(sorted(cell.tuned.items())) if decision.name == SCHEDULE else ())
