"""tools/film_hashes.py: two builds are held against each other film by film."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from conftest import ROOT

PROGRAM = ROOT / "tools/film_hashes.py"
BINARY = ROOT / "build/ptbench"


def called(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)


def written(path, **films: str):
    path.write_text(json.dumps({"version": "ptbench", "films": films}), encoding="utf-8")
    return path


def test_names_each_film_that_two_builds_do_not_share(tmp_path):
    before = written(tmp_path / "before.json", same="1", other="2", gone="3")
    after = written(tmp_path / "after.json", same="1", other="4", new="5")
    done = called("--compare", before, after)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "gone: 3 before, no film after",
        "new: no film before, 5 after",
        "other: 2 before, 4 after",
    ]
    done = called("--compare", after, after)
    assert (done.returncode, done.stdout) == (0, "the same 3 films\n")


@pytest.mark.skipif(not BINARY.is_file(), reason="build/ptbench is not built")
def test_renders_by_every_way_that_applies(tmp_path):
    """All leave the bits of one path at a time, and what does not apply has no film."""
    out = tmp_path / "films.json"
    done = called(BINARY, "--out", out, "--scene", "cornell_open,ball_diffuse")
    assert done.returncode == 0, done.stderr
    films = json.loads(out.read_text(encoding="utf-8"))["films"]
    for scene in ("cornell_open", "ball_diffuse"):
        by_estimator = {}
        for name, film in films.items():
            if name.startswith(f"{scene} "):
                by_estimator.setdefault(name.partition("direct_light=")[2], set()).add(film)
        assert [len(found) for found in by_estimator.values()] == [1, 1, 1]
    assert len(films) == 36
    assert len(set(films.values())) == 6
    assert list(tmp_path.iterdir()) == [out]


def test_a_scene_that_is_not_there_ends_it(tmp_path):
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not built")
    done = called(BINARY, "--out", tmp_path / "films.json", "--scene", "no_such_scene")
    assert done.returncode != 0
    assert "no_such_scene" in done.stderr
    assert not (tmp_path / "films.json").exists()
