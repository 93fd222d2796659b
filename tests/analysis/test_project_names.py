"""The two student projects that ptbench began with are `cis565`; `seeds` are random seeds, and nothing else."""

from __future__ import annotations

import json
import os
import re
import subprocess

import pytest
from conftest import ROOT, committed

FOLDERS = ("analysis", "docs", "harness", "kernels", "packaging", "scenes", "stability", "tests", "variants")
SUFFIXES = {".json", ".h", ".cuh", ".cpp", ".cu", ".py", ".md", ".in", ".txt"}
HERE = {"test_project_names.py", "run_command_test.cpp"}  # they name the old name
# The scene's hash is that of its whole file: another description would tear it from the results that are there.
DESCRIPTIONS = {f"scenes/{name}.json" for name in ("cornell_open", "cornell_closed", "cornell_open_45")}

_PROJECTS = re.compile(
    r"both seeds\b|import_seed|suite[ =\":]+seeds\b|bench seeds\b|(?<!with )\bthe seeds' (?!own error|band)"
    r"|\bseeds (?:do|say|sort|find)\b",
    re.IGNORECASE,
)


def meant(text: str) -> list[str]:
    return [match[0] for match in _PROJECTS.finditer(text)]


def test_seeds_are_random_seeds():
    files = [ROOT / "README.md", *(file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*")))]
    found = {}
    for file in files:
        if file.suffix not in SUFFIXES or file.name in HERE:
            continue
        if words := meant(file.read_text(encoding="utf-8", errors="replace")):
            found[str(file.relative_to(ROOT))] = words
    assert {name: words for name, words in found.items() if name not in DESCRIPTIONS} == {}
    assert found.keys() == DESCRIPTIONS, "those that no longer say it need no leave to"


@pytest.mark.parametrize(
    "text", ["as both seeds do", "run --suite seeds", "The seeds' generator", "the seeds say yes", '"suite": "seeds"']
)
def test_the_projects_are_found(text):
    assert meant(text)


@pytest.mark.parametrize(
    "text", ["over 8 seeds", "two seeds, as far apart", "--seed 3", "the same seeds, the seeds are"]
)
def test_random_seeds_are_not(text):
    assert not meant(text)


@pytest.mark.parametrize("scene", ["cornell_open", "cornell_closed"])
def test_the_boxes_are_those_of_the_results(scene, tmp_path):
    """Cells are paired by the hash of their scene's file."""
    binary = ROOT / os.environ.get("PTBENCH_BUILD_DIR", "build") / "ptbench"
    if not binary.is_file():
        pytest.skip(f"{binary} is not built")
    small = ["--resolution", "1x1", "--spp", "1", "--backend", "cpu", "--out", tmp_path / "box.pfm"]
    rendered = subprocess.run(
        [binary, "render", "--scene", scene, *small], capture_output=True, text=True, check=True, timeout=60
    )
    result = committed("nvidia-h200/seeds.json")
    measured = {cell["scene_hash"] for cell in result["ptbench"]["cells"] if cell["scene"] == scene}
    assert measured == {json.loads(rendered.stdout)["scene_hash"]}
