"""advise --try: drawn scenes, all variants, and what is counted."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest
from builder import Builder

from ptbench.extras.advise.trying import MOST_LOAD, RANGES, drawn_scenes, everything, fast_accelerators, summary_of
from ptbench.extras.maps.scenes import RULES
from ptbench.io.validate import complaints
from ptbench.program import Program


def test_scenes_are_the_same_for_a_seed_and_within_their_ranges():
    assert list(drawn_scenes(8, 3)) == list(drawn_scenes(8, 3))
    assert list(drawn_scenes(8, 3)) != list(drawn_scenes(8, 4))
    names = [scene["name"] for scene, _ in drawn_scenes(50, 1)]
    assert len(set(names)) == 50
    assert RANGES.keys() <= RULES.keys()


def test_trees_are_measured_in_scenes_with_meshes_only():
    plain, meshes = (everything("cpu", trees) for trees in ([], ["bvh2", "bvh4", "bvh8"]))
    assert len(meshes) == 3 * len(plain)
    assert not [one for one in plain if "accelerator" in one]


def test_all_accelerators_of_the_program_are_tried_but_brute_force(tmp_path):
    program = tmp_path / "ptbench"
    choices = [{"name": name, "baseline": name == "brute_force"} for name in ("brute_force", "bvh2", "mine")]
    listed = json.dumps({"choices": choices})
    program.write_text(f"#!/bin/sh\n[ \"$*\" = 'list accelerator --json' ] && echo '{listed}'\n")
    program.chmod(0o755)
    assert fast_accelerators(Program(program)) == ["bvh2", "mine"]


def fake(folder: Path, times: dict[str, float], noise: float = 0.0) -> Path:
    """A program that knows any scene, and whose renders take these times; more repetitions have no noise."""
    probe, advice, closer = Builder("probe"), Builder("advice"), Builder("closer")
    probe.cell(None, "s", 1.0, n=1, axes={"integrator": "depth_first"}, live_paths=[100, 50, 25])
    for integrator, ms in times.items():
        advice.cell(None, "s", ms, noise=noise, axes={"integrator": integrator})
        closer.cell(None, "s", ms, noise=0.0, axes={"integrator": integrator})
    files = {one.context["ptbench.suite"]: str(one.write(folder / f"{one.context['ptbench.suite']}.json"))
             for one in (probe, advice, closer)}  # fmt: skip
    about = {"name": "s", "max_depth": 8, "resolution": [200, 200], "features": [], "not_applicable_on": {}}
    file = folder / "ptbench"
    file.write_text(
        f"#!{sys.executable}\nimport json, shutil, sys\n"
        f"if sys.argv[1] == 'machine': print('amd-epyc-2-threads')\n"
        f"elif sys.argv[1] == 'list': print(json.dumps({{'scenes': [{about!r}]}}))\n"
        "else:\n    named = dict(zip(sys.argv, sys.argv[1:]))\n"
        "    suite = json.load(open(named['--suite']))\n"
        "    name = 'closer' if suite['repetitions'] > 9 else suite['name']\n"
        f"    open({str(folder / 'runs')!r}, 'a').write(name + '\\n')\n"
        f"    shutil.copy({files!r}[name], named['--out'])\n"
    )
    file.chmod(0o755)
    return file


@pytest.fixture
def house(tmp_path) -> Path:
    """One scene in which packets are fast: the advice is packets, or the reference where one scene is too few."""
    folder = tmp_path / "results" / "amd-epyc-2-threads"
    folder.mkdir(parents=True)
    (tmp_path / "scenes").mkdir()
    builder = Builder("packet")
    for index in range(3):
        about = {"name": f"box_{index}", "max_depth": 8, "materials": {}, "objects": [{"shape": "box", "material": ""}]}
        (tmp_path / "scenes" / f"box_{index}.json").write_text(json.dumps(about))
        for integrator, ms in (("wavefront", 4.0), ("packet", 1.0), ("depth_first", 2.0)):
            builder.cell(None, f"box_{index}", ms, axes={"integrator": integrator}, live_paths=[100, 50, 25])
    builder.write(folder / "packet.json")
    return tmp_path


@pytest.mark.parametrize(
    ("times", "good", "code"),
    [({"packet": 1.0, "wavefront": 2.0}, 3, 0), ({"packet": 1.0, "depth_first": 0.5}, 0, 1)],
)
def test_it_counts_where_the_advice_was_within_five_per_cent(house, analysis, times, good, code):
    program = fake(house, times)
    file = house / "tried.json"
    call = ["advise", "--try", "3", "--cpu", "--root", house, "--binary", program, "--loaded", "--out", file]
    found, out, err = analysis(*call)
    assert (found, err) == (code, "")
    document = json.loads(file.read_text())
    assert (document["good"], document["of"], document["not_good"]) == (good, 3, 3 - good)
    assert {row["advised"] for row in document["scenes"]} == {"packet"}
    assert out.splitlines()[-1] == summary_of(document)


def tried(house: Path, analysis, program: Path, count: int, *more: str) -> tuple[int, str]:
    """Exit code and what the program ran."""
    runs = house / "runs"
    runs.unlink(missing_ok=True)
    call = ["advise", "--try", str(count), "--cpu", "--root", house, "--binary", program, "--loaded", *more]
    code, _, err = analysis(*call, "--out", house / "tried.json")
    return code, err or (" ".join(runs.read_text().split()) if runs.exists() else "")


def test_what_the_interval_does_not_tell_is_measured_more_closely(house, analysis):
    # Noise of 10 % about a true ratio of 1.02.
    program = fake(house, {"packet": 1.02, "depth_first": 1.0}, noise=0.1)
    assert tried(house, analysis, program, 1) == (0, "probe advice closer")
    (row,) = json.loads((house / "tried.json").read_text())["scenes"]
    assert (row["word"], row["ratio"], row["measured"]) == ("within", pytest.approx(1.02), 2)
    # If the usual number of samples decides, nothing more is measured.
    assert tried(house, analysis, fake(house, {"packet": 1.02, "depth_first": 1.0}), 1) == (0, "probe advice")


def test_a_try_that_was_cut_short_goes_on_and_undecided_scenes_are_measured_again(house, analysis):
    file = house / "tried.json"
    program = fake(house, {"packet": 1.0, "wavefront": 2.0})
    tried(house, analysis, program, 3)
    whole = json.loads(file.read_text())
    undecided = {**whole["scenes"][0], "word": "undecided"}
    file.write_text(json.dumps({**whole, "scenes": [undecided, whole["scenes"][1]]}))
    assert tried(house, analysis, program, 3, "--resume") == (0, "probe advice probe advice")
    again = json.loads(file.read_text())
    assert again["scenes"] == whole["scenes"]
    assert list(complaints(again, "advice")) == []
    code, err = tried(house, analysis, program, 3, "--resume", "--seed", "2")
    assert (code, "$.seed: found 1, allowed: 2, to go on with it" in err) == (2, True)


def test_a_loaded_machine_is_refused(house, analysis, monkeypatch):
    monkeypatch.setattr(os, "getloadavg", lambda: (MOST_LOAD, 0.0, 0.0))
    program = fake(house, {"packet": 1.0})
    code, _, err = analysis("advise", "--try", "1", "--cpu", "--root", house, "--binary", program)
    assert (code, "found 0.50, allowed: below 0.5" in err) == (2, True)


def test_a_scene_or_a_try(analysis):
    assert analysis("advise")[0] == 2
    assert analysis("advise", "s", "--try", "3")[0] == 2
