"""The features by which the advice knows a scene, and the distance between two scenes.

The distance is Euclidean over a few features, each scaled by a unit: a step that is expected to matter.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.io.cells import Cell
from ptbench.io.nodes import Node, read_json

# Scene features, with the difference that makes a distance of 1: DOUBLINGS count powers of two, STEPS plain units.
DOUBLINGS = {"objects": 3.0, "triangles": 4.0, "materials": 2.0, "depth": 1.0, "pixels": 2.0, "lamps": 2.0,
             "lamp_share": 2.0}  # fmt: skip
STEPS = {"kinds": 2.0, "length": 0.15}
OF_TIME = ("objects", "triangles", "materials", "kinds", "depth", "length", "pixels")
OF_ERROR = ("kinds", "depth", "length", "lamps", "lamp_share")
# Addend of lamp shares that keeps their logarithm finite at 0: half the smallest share that is told from 0.
_LEAST_SHARE = 2.0**-16


@dataclass(frozen=True)
class Content:
    """The content of a scene file in numbers."""

    objects: int
    materials: int
    kinds: int  # number of kinds of materials in the scene, emitters not counted
    lamps: int
    lamp_share: float  # lamps' share of all surface area, in which a mesh counts by its scaled bounding box


@dataclass(frozen=True)
class Features:
    """The features of a scene as rendered; `length` is the mean number of path segments over the possible maximum."""

    content: Content
    triangles: int
    depth: int
    length: float
    pixels: int

    def value(self, name: str) -> float:
        """The value of a feature in its unit."""
        number = getattr(self.content, name) if hasattr(self.content, name) else getattr(self, name)
        if name in STEPS:
            return number / STEPS[name]
        least = _LEAST_SHARE if name == "lamp_share" else 1.0
        return math.log2(number + least) / DOUBLINGS[name]

    def text(self) -> str:
        """The features in one line of text."""
        content = self.content
        return (
            f"{_counted(content.objects, 'object')}, {_counted(self.triangles, 'triangle')}, "
            f"{_counted(content.materials, 'material')} of {_counted(content.kinds, 'kind')}, "
            f"{_counted(content.lamps, 'lamp')}, depth {self.depth}, "
            f"paths of {self.length * self.depth:.3g} segments on average, {self.pixels} pixels"
        )


def _counted(number: int, word: str) -> str:
    return f"{number} {word}{'' if number == 1 else 's'}"


def distance(one: Features, other: Features, names: Sequence[str]) -> float:
    """The distance of two scenes over the named features; 1 is a step of one feature that matters."""
    return math.sqrt(sum((one.value(name) - other.value(name)) ** 2 for name in names))


def farthest(one: Features, other: Features, names: Sequence[str]) -> str:
    """The feature that contributes most to the distance of two scenes."""
    return max(names, key=lambda name: abs(one.value(name) - other.value(name)))


def content_of(path: Path) -> Content:
    """Reads the content of a scene file, which ptbench itself validates; raises InputError for what is no scene."""
    return content_in(read_json(path))


def content_in(root: Node) -> Content:
    """The content of a scene, from its JSON document."""
    materials = root.need("materials").fields()
    objects = [node.fields() for node in root.need("objects").items()]
    types = {name: _type(about) for name, about in materials.items()}
    used = {one.get("material", "") for one in objects}
    areas = [(_is_lamp(materials.get(one.get("material", ""), {})), _copies(one), _area(one)) for one in objects]
    lamp = sum(copies * area for is_lamp, copies, area in areas if is_lamp)
    whole = sum(copies * area for _, copies, area in areas)
    return Content(
        objects=sum(copies for _, copies, _ in areas),
        materials=len(used & types.keys()),
        kinds=len({types[name] for name in used & types.keys()} - {"emitter"}),
        lamps=sum(copies for is_lamp, copies, _ in areas if is_lamp),
        lamp_share=lamp / whole if whole > 0 else 0.0,
    )


def _type(about: object) -> str:
    return str(about.get("type", "")) if isinstance(about, dict) else ""


def _is_lamp(about: object) -> bool:
    if not isinstance(about, dict):
        return False
    emission = about.get("emission", [])
    return about.get("type") == "emitter" or (isinstance(emission, list) and any(emission))


def _copies(one: Mapping) -> int:
    """The number of objects that an instancing rule stands for (docs/scene_format.md, "Instances")."""
    rule = one.get("instances")
    if not isinstance(rule, dict):
        return 1
    if rule.get("generate") == "sphereflake":
        return sum(9**level for level in range(int(rule.get("levels", 0)) + 1))
    return int(rule.get("side", 1)) ** 2


def _area(one: Mapping) -> float:
    scale = one.get("scale", 1.0)
    x, y, z = (float(side) for side in scale) if isinstance(scale, list) and len(scale) == 3 else [float(scale)] * 3
    if one.get("shape") == "quad":
        return x * z
    sides = x * y + y * z + z * x
    return math.pi * sides / 3 if one.get("shape") == "sphere" else 2 * sides


def scene_files(scenes: Path) -> dict[str, Path]:
    """The scene files of a checkout, by scene name."""
    found = {}
    for path in _json_files(scenes):
        value = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(value, dict) and "objects" in value and "name" in value:
            found[value["name"]] = path
    return found


def _json_files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*.json")):
        if "suites" not in path.relative_to(folder).parts and path.is_file():
            yield path


def features_of(cell: Cell, content: Content) -> Features | None:
    """The features of a measured cell; None where the cell has no path counts."""
    if cell.instrumented is None or not cell.instrumented.paths or not cell.instrumented.live_paths:
        return None
    segments = sum(cell.instrumented.live_paths) / cell.instrumented.paths
    triangles = 0 if cell.meshes is None else cell.meshes.triangles
    return Features(content, triangles, cell.depth, segments / cell.depth, cell.pixels)
