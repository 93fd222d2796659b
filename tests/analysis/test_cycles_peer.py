"""Cycles as a peer: what it reads of Mitsuba's XML, and what it refuses; where bpy is there, a picture too."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from ptbench.io.images import read_pfm

PROGRAM = ROOT / "tools/peers/cycles_peer.py"

HEAD = """<?xml version="1.0" encoding="utf-8"?>
<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="8"/><integer name="rr_depth" value="9"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="45"/><string name="fov_axis" value="y"/>
    <float name="near_clip" value="0.01"/><float name="far_clip" value="100"/>
    <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
  </sensor>
  <bsdf type="twosided" id="white"><bsdf type="diffuse"><rgb name="reflectance" value="0.5 0.25 0.125"/></bsdf></bsdf>
  <bsdf type="null" id="lamp"/>
"""
LAMP = """  <shape type="cube">
    <transform name="to_world"><matrix value="8 0 0 0 0 8 0 0 0 0 8 0 0 0 0 1"/></transform>
    <ref name="bsdf" id="lamp"/><emitter type="area"><rgb name="radiance" value="2 1 0.5"/></emitter>
  </shape>
"""
SQUARE = """  <shape type="rectangle">
    <transform name="to_world"><matrix value="1 0 0 3 0 1 0 4 0 0 1 5 0 0 0 1"/></transform>
    <ref name="bsdf" id="white"/>
  </shape>
"""


@pytest.fixture(scope="module")
def peer():
    spec = importlib.util.spec_from_file_location("cycles_peer", PROGRAM)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def written(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "scene.xml"
    file.write_text(text + "</scene>\n")
    return file


def test_reads_what_export_writes(peer, tmp_path):
    scene = peer.Scene(written(tmp_path, HEAD + LAMP + SQUARE))
    lamp, square = scene.root.findall("shape")
    assert scene.depth == 8
    assert scene.colours == {"white": [0.5, 0.25, 0.125], "lamp": [0, 0, 0]}
    assert scene.radiance(lamp) == [2, 1, 0.5]
    assert scene.radiance(square) is None
    assert scene.matrix(square) == [[1, 0, 0, 3], [0, 1, 0, 4], [0, 0, 1, 5], [0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEAD.replace('type="path"', 'type="volpath"'), "media"),
        (HEAD.replace('"perspective"', '"thinlens"'), "thinlens"),
        (HEAD + '<emitter type="constant"/>', "environment"),
        (HEAD + '<bsdf type="dielectric" id="glass"/>', "dielectric"),
    ],
)
def test_refuses_what_it_has_no_counterpart_of(peer, tmp_path, text, said):
    with pytest.raises(peer.Refused, match=said):
        peer.Scene(written(tmp_path, text))


def has_bpy() -> bool:
    return importlib.util.find_spec("bpy") is not None


@pytest.mark.skipif(has_bpy(), reason="this Python has bpy")
def test_says_that_bpy_is_missing():
    done = subprocess.run([sys.executable, PROGRAM], input="", capture_output=True, text=True, check=False)
    assert done.returncode == 4
    assert "pip install bpy" in done.stderr
    assert done.stdout == ""


@pytest.mark.skipif(not has_bpy(), reason="this Python has no bpy")
def test_within_a_lamp_every_pixel_is_the_lamps_radiance(tmp_path):
    """And answers are lines of JSON, whatever Blender prints."""
    load = {"do": "load", "scene": "", "xml": str(written(tmp_path, HEAD + LAMP)), "resolution": [16, 8], "depth": 1}
    image = {"do": "image", "spp": 2, "seed": 1, "file": str(tmp_path / "out.pfm")}
    asked = "".join(json.dumps(one) + "\n" for one in ({"do": "about"}, load, image))
    done = subprocess.run([sys.executable, PROGRAM], input=asked, capture_output=True, text=True, check=True)
    about, loaded, rendered = map(json.loads, done.stdout.splitlines())
    assert "version" in about
    assert loaded["load_ms"] > 0
    assert rendered["ms"] > 0
    pixels = read_pfm(tmp_path / "out.pfm")
    assert pixels.shape == (8, 16, 3)
    assert np.allclose(pixels, [2, 1, 0.5], rtol=1e-6)
