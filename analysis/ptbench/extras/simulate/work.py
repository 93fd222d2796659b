"""Measures the rays per path of a scene, by block of pixels: `python3 -m ptbench simulate --work SCENE`.

The scene is rendered once with all colours replaced: every surface reflects all light and emits 1, and lights and the
environment emit 1. Directions do not depend on colours, so each path stays the same, and its radiance is the number of
its rays.
"""

import json
import tempfile
from pathlib import Path

import numpy as np

from ptbench.errors import InputError
from ptbench.extras.simulate.parts import WORK
from ptbench.io.files import write_text
from ptbench.io.images import read_pfm
from ptbench.io.nodes import read_json
from ptbench.program import Program

BLOCK = 16
_ONE = [1, 1, 1]
# Keys of a material that hold its reflectance or transmittance colours.
_COLOURS = ("albedo", "reflectance", "tint")
_COUNTED = ("diffuse", "mirror", "mix", "emitter", "rough_conductor")


def counting(scene: dict) -> dict:
    """A copy of the scene whose radiance counts rays; raises InputError for a material that this cannot be done for."""
    counted = json.loads(json.dumps(scene))
    for name, material in counted["materials"].items():
        if material["type"] not in _COUNTED:
            raise InputError(f"--work: found the material {name} ({material['type']}), allowed: {', '.join(_COUNTED)}")
        if material["type"] == "emitter":
            material["radiance"] = _ONE
            continue
        material |= {colour: _ONE for colour in _COLOURS if colour in material}
        material["emission"] = _ONE
    return counted | {"environment": _ONE}


def measure_work(binary: Path, scene_file: Path, spp: int, out: Path) -> dict:
    """Renders the counting scene, writes the map of rays per path and returns it. Raises InputError."""
    scene = read_json(scene_file).fields()
    with tempfile.TemporaryDirectory() as folder:
        made, film = Path(folder) / "counting.json", Path(folder) / "counting.pfm"
        made.write_text(json.dumps(counting(scene)), encoding="utf-8")
        Program(binary).output("render", "--scene", made, "--backend", "cpu", "--spp", spp, "--out", film)
        image = read_pfm(film)[..., 0].astype(float)
    document = {
        "schema": WORK, "scene": scene["name"], "resolution": [image.shape[1], image.shape[0]], "spp": spp,
        "block": BLOCK, "rays_per_path": np.round(blocks_of(image, BLOCK), 5).tolist(),
    }  # fmt: skip
    write_text(out, json.dumps(document) + "\n")
    return document


def blocks_of(image: np.ndarray, side: int) -> np.ndarray:
    """Means over square blocks of pixels; raises InputError unless the image is a multiple of the block."""
    height, width = image.shape
    if height % side or width % side:
        raise InputError(f"--work: found {width}x{height} pixels, allowed: multiples of {side}")
    return image.reshape(height // side, side, width // side, side).mean(axis=(1, 3))
