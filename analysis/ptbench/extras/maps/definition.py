"""A map is a file, maps/NAME.json: two choices, two axes, the generator of each cell's scene, and a time budget."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ptbench.convergence.costs import TIME, VARIANCE
from ptbench.errors import InputError, bad_value
from ptbench.extras.maps.refining import Axis, Place
from ptbench.extras.maps.scenes import RULES
from ptbench.io.files import named_files
from ptbench.io.nodes import read_json, shown
from ptbench.io.validate import complaints

# Name of the statistic "time to an image": build times plus the time for a map's number of samples per pixel.
TO_IMAGE = "time to an image"
STATISTICS = (TIME, VARIANCE, TO_IMAGE)
# What a map's axis may set, besides a parameter of the scene generator ("scene.NAME") and a tunable ("tunable.NAME").
# "side" is the width and height of a square image in pixels.
_INTEGERS = ("depth", "side", "spp")
_SETTINGS = (*_INTEGERS, "samples")


@dataclass(frozen=True)
class Definition:
    """A validated file of a map."""

    name: str
    document: dict
    axes: tuple[Axis, Axis]
    sets: tuple[str, str]

    def __getitem__(self, key: str):
        return self.document[key]

    @property
    def of_error(self) -> bool:
        """Whether the map's statistic needs error curves."""
        return self["statistic"] == VARIANCE

    def values(self, place: Place, prefix: str) -> dict[str, float]:
        """The values that the axes set at a place, of names with the prefix "scene." or "tunable."."""
        pairs = zip(self.sets, place, strict=True)
        return {name.removeprefix(prefix): value for name, value in pairs if name.startswith(prefix)}

    def scene(self, place: Place) -> dict:
        """The generated scene of a cell of the map."""
        about = self["scene"]
        fixed = {key: value for key, value in about.items() if key != "rule"}
        return RULES[about["rule"]](**{**fixed, **self.values(place, "scene.")})

    def study(self, place: Place, scene: str) -> dict:
        """The study that measures a cell: both choices of the map in one scene."""
        setting, tuned = self["setting"], self.values(place, "tunable.")
        variants = [
            {"axes": {axis: [value] for axis, value in one["axes"].items()},
             "tunables": {name: [int(value)] for name, value in {**one.get("tunables", {}), **tuned}.items()}}
            for one in (self["choice"], self["over"])
        ]  # fmt: skip
        study = {
            "name": "cell", "scenes": [scene], "variants": [_bare(one) for one in variants],
            "resolution": self._resolution(place), "spp": int(self.values(place, "spp").get("", setting["spp"])),
            "depth": int(self.values(place, "depth").get("", setting["depth"])),
        }  # fmt: skip
        if self.of_error:
            study |= {"type": "convergence", "without_checkpoints": False,
                      "reference": setting["reference"]}  # fmt: skip
        return study

    def _resolution(self, place: Place) -> list[int]:
        side = self.values(place, "side").get("")
        return self["setting"]["resolution"] if side is None else [int(side), int(side)]

    def samples(self, place: Place) -> float:
        """Samples per pixel for which the time to an image is computed."""
        return self.values(place, "samples").get("", float(self["setting"]["spp"]))

    def measured_alike(self, document: Mapping) -> bool:
        """Whether cells measured for another version of the map's file are valid for this one."""
        free = ("title", "question", "budget_s", "bracket", "description")
        return all(document.get(key) == value for key, value in self.document.items() if key not in free)


def _bare(variant: Mapping) -> dict:
    return {key: value for key, value in variant.items() if value}


def read_map(path: Path) -> Definition:
    """Reads and validates the file of a map; raises InputError."""
    root = read_json(path)
    if found := list(complaints(root.value, "map")):
        raise InputError(f"{path}: {found[0]}")
    return definition_of(path, root.value)


def definition_of(path: Path, document: dict) -> Definition:
    """Checks a map's document beyond what its schema can express; raises InputError."""
    if document["scene"]["rule"] not in RULES:
        raise bad_value(path, "$.scene.rule", shown(document["scene"]["rule"]), ", ".join(RULES))
    axes = tuple(_axis(path, document, key) for key in ("x", "y"))
    definition = Definition(path.stem, document, axes, (document["x"]["sets"], document["y"]["sets"]))
    try:
        definition.scene((axes[0].low, axes[1].low))
    except TypeError as error:
        raise bad_value(path, "$.scene", str(error), "the parameters of its rule, from the file or an axis") from error
    if definition.of_error and "reference" not in document["setting"]:
        raise bad_value(path, "$.setting.reference", "nothing", "a reference, as studies of type convergence have it")
    return definition


def _axis(path: Path, document: Mapping, key: str) -> Axis:
    about = document[key]
    sets = about["sets"]
    if sets not in _SETTINGS and not sets.startswith(("scene.", "tunable.")):
        allowed = f"scene.NAME, tunable.NAME, {', '.join(_SETTINGS)}"
        raise bad_value(path, f"$.{key}.sets", shown(sets), allowed)
    if sets == "samples" and document["statistic"] != TO_IMAGE:
        raise bad_value(path, f"$.{key}.sets", shown(sets), f'with "statistic": "{TO_IMAGE}" only')
    if sets == "spp" and document["statistic"] == TO_IMAGE:
        raise bad_value(path, f"$.{key}.sets", shown(sets), f'"samples" with "statistic": "{TO_IMAGE}"')
    if sets in _INTEGERS and not (about.get("integer", False) and about["from"] >= 1):
        raise bad_value(path, f"$.{key}", f'{sets} without "integer": true or from below 1', "integers from 1")
    low, high = about["from"], about["to"]
    if not low < high:
        raise bad_value(path, f"$.{key}", f"from {low:g} to {high:g}", "a first value below the last")
    return Axis(about["label"], float(low), float(high), about["cells"], about.get("integer", False))


def maps_in(folder: Path, names: tuple[str, ...] = ()) -> list[Definition]:
    """Reads every map, or those named; raises InputError for one that is missing or malformed."""
    return [read_map(path) for path in named_files(folder, names, "map")]
