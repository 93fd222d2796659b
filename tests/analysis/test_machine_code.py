"""tools/machine_code.py: two builds are held against each other program by program and object by object."""

from __future__ import annotations

import json
import subprocess
import sys

from conftest import ROOT

PROGRAM = ROOT / "tools/machine_code.py"


def called(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)


def written(path, programs: list[str], **objects: str):
    document = {"scenes": {"box": programs, "ball": ["same"]}, "objects": objects}
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def test_names_each_scene_and_object_whose_code_changed(tmp_path):
    before = written(tmp_path / "before.json", ["1", "1", "2"], cub="3", clock="4", gone="5")
    after = written(tmp_path / "after.json", ["1", "2", "6"], cub="7", clock="4", new="8")
    done = called("--compare", before, after)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "box: of 3 programs 1 are gone, of 3 1 are new",
        "cub: another machine code",
        "gone: another machine code",
        "new: another machine code",
    ]
    done = called("--compare", after, after)
    assert (done.returncode, done.stdout) == (0, "the same machine code\n")
