"""Mitsuba's own files, rendered there as they are and here as `ptbench import` reads them."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

from ptbench.cli.main import main
from ptbench.crosscheck.renders import WHEEL

BINARY = ROOT / "build/ptbench"
SCENES = ROOT / "tests/analysis/mitsuba_scenes"


@pytest.fixture(scope="module")
def mitsuba() -> str:
    """A Python that has the wheel: this one, or the one that PTBENCH_MITSUBA_PYTHON names."""
    python = os.environ.get("PTBENCH_MITSUBA_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"no cross-check with Mitsuba 3: {python} -m pip install {WHEEL}")
    return python


def imported(name: str, folder: Path) -> Path:
    """The scene file that `ptbench import` makes of it."""
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    out = folder / f"{name}.json"
    call = [str(BINARY), "import", str(SCENES / f"{name}.xml"), "--out", str(out)]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    if "no reader for XML" in done.stderr:
        pytest.skip("this build has no reader for XML")
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.parametrize("name", ["room", "lens"])
def test_an_imported_scene_has_mitsubas_picture(name, mitsuba, tmp_path, capsys, monkeypatch):
    scene = imported(name, tmp_path)
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    monkeypatch.setattr("ptbench.crosscheck.command.export", lambda *_: SCENES / f"{name}.xml")
    call = ["crosscheck", str(scene), "--binary", str(BINARY), "--python", mitsuba, "--backend", "cpu"]
    small = ["--variant", "scalar_rgb", "--resolution", "48x32", "--spp", "16", "--aim", "100"]
    assert main([*call, *small]) == 0, capsys.readouterr().out


def test_another_reading_has_another_picture(mitsuba, tmp_path, capsys, monkeypatch):
    """The samples at which an import passes tell it from one that takes Mitsuba's angle of view for the height's."""
    scene = imported("room", tmp_path)
    changed = json.loads(scene.read_text(encoding="utf-8"))
    changed["camera"]["vertical_fov_degrees"] = 50
    scene.write_text(json.dumps(changed), encoding="utf-8")
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    monkeypatch.setattr("ptbench.crosscheck.command.export", lambda *_: SCENES / "room.xml")
    call = ["crosscheck", str(scene), "--binary", str(BINARY), "--python", mitsuba, "--backend", "cpu"]
    small = ["--variant", "scalar_rgb", "--resolution", "48x32", "--spp", "16", "--aim", "100"]
    assert main([*call, *small]) == 1
    assert " differs" in capsys.readouterr().out


# In scalar_rgb, as the cross-check has it.
_INDICES = """
import json, sys, mitsuba
mitsuba.set_variant("scalar_rgb")
names, metals = json.load(sys.stdin)
glass, metal = {}, {}
for name in names:
    values = mitsuba.traverse(mitsuba.load_dict({"type": "dielectric", "int_ior": name, "ext_ior": 1.0}))
    glass[name] = float(values["eta"])
for name in metals:
    values = mitsuba.traverse(mitsuba.load_dict({"type": "conductor", "material": name}))
    metal[name] = [float(x) for key in ("eta.value", "k.value") for x in values[key]]
print(json.dumps([glass, metal]))
"""


def test_names_of_indices_are_mitsubas(mitsuba):
    source = (ROOT / "harness/interchange/mitsuba_indices.cpp").read_text(encoding="utf-8")
    number = r"([0-9.]+)"
    here = {name: float(value) for name, value in re.findall(rf'\{{"([a-z0-9 ]+)", {number}\}}', source)}
    three = ", ".join([number] * 3)
    metals = {
        row[0]: [float(value) for value in row[1:]]
        for row in re.findall(rf'\{{"(\w+)", \{{{three}\}}, \{{{three}\}}\}}', source)
    }
    assert len(here) >= 20
    assert len(metals) >= 10
    done = subprocess.run(
        [mitsuba, "-c", _INDICES], input=json.dumps([[*here], [*metals]]), capture_output=True, text=True, check=True
    )
    glass, metal = json.loads(done.stdout.splitlines()[-1])
    for name, value in here.items():
        assert value == pytest.approx(glass[name], rel=1e-6), name
    for name, values in metals.items():
        assert values == pytest.approx(metal[name], rel=1e-6), name
