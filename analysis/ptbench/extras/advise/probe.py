"""The features of a user's scene: from its file, and from a small render that counts paths and is not timed."""

import json
import math
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.extras.advise.evidence import FILE
from ptbench.extras.advise.features import Features, content_of, features_of, scene_files
from ptbench.io.axes import DIRECT_LIGHT, INTEGRATOR, RUSSIAN_ROULETTE, SAMPLER
from ptbench.program import Program

_PIXELS = 4096  # pixels of the probe render, enough for path counts within a few per cent
MESH = "mesh"
# Axes with choices that a scene alone may rule out, whatever the variant's other choices are.
_OF_SCENES = (INTEGRATOR, DIRECT_LIGHT, RUSSIAN_ROULETTE, SAMPLER)


@dataclass(frozen=True)
class Probed:
    """A scene's features for the advice, and the choices that do not apply to it."""

    name: str
    scene: str  # path or name of the scene, as given to the ptbench program
    features: Features
    resolution: tuple[int, int]
    barred: frozenset[tuple[str, str]]

    @property
    def has_mesh(self) -> bool:
        """Whether the scene has a mesh, so that an acceleration structure has to be chosen."""
        return self.features.triangles > 0


def file_of(scene: str, root: Path) -> Path:
    """The file of a scene given by path or by its name in the checkout; raises InputError."""
    if scene.endswith(".json"):
        return Path(scene)
    known = scene_files(root / "scenes")
    if Path(scene).name not in known:
        raise bad_value("SCENE", "name", f'"{scene}"', "a file that ends in .json, or a name in scenes/")
    return known[Path(scene).name]


def probe(
    program: Program, scene: Path, backend: str, depth: int | None = None, resolution: tuple[int, int] | None = None
) -> Probed:
    """Probes a scene with the ptbench program; raises InputError where the program refuses it."""
    about = program.scene(str(scene))
    width, height = resolution or tuple(about["resolution"])
    scale = math.sqrt(_PIXELS / (width * height))
    # The probe uses an integrator that supports every scene feature, and trees for meshes, which take minutes without.
    known = json.loads(FILE.read_text(encoding="utf-8"))
    axes = known["probe_of_meshes" if MESH in about["features"] else "probe"]
    study = {
        "name": "probe", "scenes": [str(scene.resolve())], "axes": {axis: [choice] for axis, choice in axes.items()},
        "resolution": [max(1, round(width * scale)), max(1, round(height * scale))],
        "depth": depth or about["max_depth"], "spp": 1,
    }  # fmt: skip
    with tempfile.TemporaryDirectory(prefix="ptbench-probe-") as folder:
        suite = {"name": "probe", "description": "What a scene's paths are like.", "repetitions": 1, "studies": [study]}
        cells = program.measure(suite, Path(folder), "cpu").cells
    features = features_of(cells[0], content_of(scene)) if cells and not cells[0].failed else None
    if features is None:
        reason = cells[0].failure if cells else "it does not apply"
        raise InputError(f"{scene}: the probe found no paths: {reason}")
    refused = about["not_applicable_on"].get(backend, {})
    barred = frozenset(tuple(named.split("=", 1)) for named in refused if named.partition("=")[0] in _OF_SCENES)
    whole = replace(features, pixels=width * height)
    return Probed(about["name"], str(scene.resolve()), whole, (width, height), barred)
