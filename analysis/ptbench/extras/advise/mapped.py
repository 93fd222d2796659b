"""Cells of crossover maps as measurements for advice: a choice over its decision's reference, in a generated scene."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ptbench.convergence.costs import VARIANCE
from ptbench.extras.advise.evidence import DECISIONS, INJECTED, Book, Decision, Point, read_book
from ptbench.extras.advise.features import Features, content_in
from ptbench.extras.maps.definition import Definition, definition_of
from ptbench.extras.maps.measuring import sheet_of
from ptbench.extras.maps.refining import Place
from ptbench.io.nodes import Node, read_json
from ptbench.stats.estimates import Estimate


def decision_of(choice: Mapping[str, str], over: Mapping[str, str], statistic: str) -> Decision | None:
    """The decision whose reference equals a map's second choice in all that differs between the two; None: none."""
    differing = [axis for axis in {**choice, **over} if choice.get(axis) != over.get(axis)]
    for decision in DECISIONS:
        is_reference = set(differing) <= decision.reference.keys() and all(
            over.get(axis, usual) == usual for axis, usual in decision.reference.items()
        )
        as_asked = all(over.get(axis, wanted) == wanted for axis, wanted in decision.only.items())
        if decision.statistic == statistic and is_reference and as_asked:
            return decision
    return None


def points_of_maps(results: Path, machine: str, backend: str) -> Iterator[tuple[str, Point]]:
    """Every cell with an interval in the machine's maps on a backend, with the name of its decision.

    Variances are taken from every machine's maps, as equal bits have equal errors.
    """
    for file in sorted(results.glob("*/maps/*.json")):
        definition = definition_of(file, read_json(file).fields()["map"])
        choice, over = (definition[side]["axes"] for side in ("choice", "over"))
        decision = decision_of(choice, over, definition["statistic"])
        is_here = file.parts[-3] == machine and definition["backend"] == backend
        if decision is None or _injects(definition) or not (is_here or decision.statistic == VARIANCE):
            continue
        sheet = sheet_of(definition, file)
        shown = file.relative_to(results).as_posix()
        for place, ratio in sheet.known.items():
            run = sheet.runs[sheet.cells[place]]
            if ratio is not None and ratio.low is not None and ratio.value > 0 and "segments" in run:
                yield decision.name, _point(definition, decision, place, ratio, run, shown)


def _point(
    definition: Definition, decision: Decision, place: Place, ratio: Estimate, run: Mapping, shown: str
) -> Point:
    choice, over = (definition[side]["axes"] for side in ("choice", "over"))
    features = _features(definition, place, run)
    scene, resolution = definition.scene(place)["name"], definition["setting"]["resolution"]
    differing = tuple((axis, choice[axis]) for axis in decision.reference if choice.get(axis) != over.get(axis))
    rest = (scene, features.depth, tuple(resolution), _others(over, decision), ())
    setting = f"depth {features.depth}, {resolution[0]}x{resolution[1]}"
    return Point(differing, ratio, features, scene, setting, shown, rest)


def whole_book(root: Path, results: Path, machine: str, backend: str) -> Book:
    """All ratios of a machine's results and maps on one backend; raises InputError where there are none."""
    book = read_book(root, results, machine, backend)
    points = dict(book.points)
    for name, point in points_of_maps(results, machine, backend):
        points[name] = (*points[name], point)
    return replace(book, points=points)


def _injects(definition: Definition) -> bool:
    return any(one == f"tunable.{INJECTED}" for one in definition.sets)


def _others(over: Mapping[str, str], decision: Decision) -> Sequence[tuple[str, str]]:
    return tuple(sorted((axis, choice) for axis, choice in over.items() if axis not in decision.reference))


def _features(definition: Definition, place: Place, run: Mapping) -> Features:
    scene = Node(Path("a map's scene"), definition.scene(place))
    depth = run["depth"]
    return Features(content_in(scene), run["triangles"], depth, run["segments"] / depth, run["pixels"])
