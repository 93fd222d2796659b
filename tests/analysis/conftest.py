"""Fixtures: one full command-line run, shared, because drawing eight files takes seconds."""

from __future__ import annotations

import atexit
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from builder import small

from ptbench.cli.main import main
from ptbench.io.files import read_stored

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "analysis" / "ptbench"


def tracked_files() -> list[Path] | None:
    """What git has of this checkout; None where there is no git to ask."""
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    except OSError:
        return None
    if listed.returncode != 0:
        return None
    return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]


def checkout_as_committed() -> Path:
    """The checkout, but for results that a user measured: links to it, in whose results/ is only what git has."""
    tracked = tracked_files()
    if tracked is None:
        return ROOT
    folder = Path(tempfile.mkdtemp(prefix="ptbench_committed_"))
    atexit.register(shutil.rmtree, folder)
    for entry in ROOT.iterdir():
        if entry.name != "results":
            (folder / entry.name).symlink_to(entry)
    for path in tracked:
        if path.is_relative_to(ROOT / "results"):
            link = folder / path.relative_to(ROOT)
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(path)
    return folder


COMMITTED = checkout_as_committed()
# No test reads ROOT / "results" (test_tracked.py): what users measure there is theirs.
RESULTS = COMMITTED / "results"


def run_analysis(*arguments: object, hash_seed: int = 1) -> subprocess.CompletedProcess:
    """`python3 -m ptbench ...` as a user runs it, from another folder's point of view."""
    environment = {**os.environ, "PYTHONHASHSEED": str(hash_seed), "PYTHONPATH": str(PACKAGE.parent)}
    command = [sys.executable, "-W", "error", "-m", "ptbench", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=ROOT.parent)


def stored_text(file: Path) -> str:
    """The text of a committed file, whether it is compressed or not."""
    return read_stored(file, 1 << 30)[1].decode("utf-8")


def committed(name: str):
    """What a committed result file holds, "nvidia-h200/seeds.json", whether it is compressed or not."""
    return json.loads(stored_text(RESULTS / name))


def rows_by_file(files: Sequence[str], rows_of: Callable[[str], list]) -> str:
    """JSON of the rows of each file, a line a row: what C++ and Python are both held to."""
    texts = []
    for file in files:
        rows = ",\n".join("  " + json.dumps(row) for row in rows_of(file))
        texts.append(f' "{file}": [\n{rows}\n ]')
    return "{\n" + ",\n".join(texts) + "\n}\n"


@pytest.fixture(scope="session")
def quick_run(tmp_path_factory):
    """(the process, the folder of its figures) of `plots` on a file in which all is well."""
    folder = tmp_path_factory.mktemp("quick")
    file = small().write(folder / "quick.json")
    return run_analysis("plots", file), folder / "figures" / "quick"


@pytest.fixture
def analysis(capsys):
    """Runs the command line in this process: (exit code, stdout, stderr)."""

    def run(*arguments: object) -> tuple[int, str, str]:
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as leaving:
            code = leaving.code
        said = capsys.readouterr()
        return code, said.out, said.err

    return run
