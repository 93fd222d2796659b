"""An .exr of `ptbench render` in the libraries of others: the same floats as the .pfm, grouped layers, Mitsuba's first
hits. Each library where it is there: OpenEXR's own and OpenCV here, Mitsuba's in the Python that
PTBENCH_MITSUBA_PYTHON names."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT

from ptbench.io.images import read_pfm

BINARY = ROOT / "build/ptbench"
SIDE, SPP = 64, 64
LAYERS = {"albedo": "RGB", "coverage": "Y", "depth": "Z", "normal": "XYZ", "samples": "Y", "variance": "RGB"}
# Means of Mitsuba's own first hits, by pixel: depth, then the normal.
_MITSUBA = """
import sys
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
scene = mi.load_file(sys.argv[1])
integrator = mi.load_dict({"type": "aov", "aovs": "d:depth,n:sh_normal"})
first_hits = np.array(mi.render(scene, integrator=integrator, spp=int(sys.argv[3]), seed=1))[:, :, -4:]
layers = {name: np.array(layer) for name, layer in mi.Bitmap(sys.argv[2]).split()}
np.savez(sys.argv[4], mitsuba=first_hits, **layers)
"""


def ptbench(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True, check=False)


def render(out, *more) -> dict:
    call = ("render", "--scene", "cornell_open", "--backend", "cpu", "--resolution", f"{SIDE}x{SIDE}", "--spp", SPP)
    done = ptbench(*call, "--out", out, *more)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def images(tmp_path_factory):
    """(colour of the .pfm, the .exr's path)"""
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    folder = tmp_path_factory.mktemp("images")
    done = ptbench("render", "--scene", "cornell_open", "--backend", "cpu", "--resolution", "2x2", "--spp", 2,
                   "--out", folder / "small.exr")  # fmt: skip
    if "built without OpenEXR" in done.stderr:
        pytest.skip("this build has no OpenEXR")
    exr, pfm = render(folder / "image.exr", "--aovs", "all"), render(folder / "image.pfm")
    assert exr["film_hash"] == pfm["film_hash"]
    return read_pfm(folder / "image.pfm"), folder / "image.exr"


def test_openexrs_own_reader(images):
    reader = pytest.importorskip("OpenEXR", reason="no Python package OpenEXR")
    colour, path = images
    file = reader.File(str(path), separate_channels=True)
    channels = {name: channel.pixels for name, channel in file.channels().items()}
    assert set(channels) == {*"RGB", *(f"{layer}.{letter}" for layer, letters in LAYERS.items() for letter in letters)}
    for i, letter in enumerate("RGB"):
        assert channels[letter].dtype == np.float32
        assert (channels[letter] == colour[:, :, i]).all()
    assert (channels["samples.Y"] == SPP).all()
    assert file.header()["ptbench.scene"] == "cornell_open"


def test_opencv(images, monkeypatch):
    monkeypatch.setenv("OPENCV_IO_ENABLE_OPENEXR", "1")  # read when the package is loaded
    cv2 = pytest.importorskip("cv2", reason="no Python package opencv-python-headless")
    colour, path = images
    read = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert read.dtype == np.float32
    assert (read[:, :, ::-1] == colour).all()


@pytest.fixture(scope="module")
def in_mitsuba(images, tmp_path_factory) -> dict:
    """The layers as Mitsuba's reader has them, and its own first hits as `mitsuba`."""
    python = os.environ.get("PTBENCH_MITSUBA_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"no Mitsuba 3 in {python}")
    folder = tmp_path_factory.mktemp("mitsuba")
    scene = folder / "scene.xml"
    assert ptbench("export", "cornell_open", "--format", "mitsuba", "--out", scene).returncode == 0
    text = scene.read_text(encoding="utf-8")
    for side in ("width", "height"):
        text = text.replace(f'name="{side}" value="800"', f'name="{side}" value="{SIDE}"')
    scene.write_text(text, encoding="utf-8")
    layers = folder / "layers.npz"
    subprocess.run([python, "-c", _MITSUBA, scene, images[1], str(SPP), layers], check=True)
    return dict(np.load(layers))


def test_mitsuba_reads_and_groups_the_layers(images, in_mitsuba):
    colour, _ = images
    assert set(in_mitsuba) == {"<root>", "mitsuba", *LAYERS}
    assert (in_mitsuba["<root>"] == colour).all()
    assert in_mitsuba["normal"].shape == (SIDE, SIDE, 3)


def test_first_hits_are_mitsubas(in_mitsuba):
    """Depths and normals differ from Mitsuba's by jitter alone, but at edges: the median pixel and the mean agree."""
    depth, normal = in_mitsuba["mitsuba"][:, :, 0], in_mitsuba["mitsuba"][:, :, 1:]
    ours = np.squeeze(in_mitsuba["depth"])
    assert np.median(np.abs(ours - depth)) < 0.01
    assert abs(ours.mean() / depth.mean() - 1) < 1e-3
    # Mitsuba's point outwards whichever side is met: in this room of boxes and balls that is towards the camera too.
    assert np.median(np.abs(in_mitsuba["normal"] - normal)) == 0
    assert np.abs(in_mitsuba["normal"] - normal).mean() < 0.01
