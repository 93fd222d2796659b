"""What a reader that leaves early sees, as `python3 -m ptbench claims | head` does: no complaint."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ptbench.terminal import READER_LEFT

ANALYSIS = Path(__file__).resolve().parents[2] / "analysis"


@pytest.mark.parametrize("call", [["--help"], ["claims", "cycles_2021_specialisation"]])
def test_a_reader_may_leave_before_the_end(call):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "ptbench", *call], stdout=writing, stderr=subprocess.PIPE, cwd=ANALYSIS.parent,
            env={**os.environ, "PYTHONPATH": str(ANALYSIS)}, check=False,
        )  # fmt: skip
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (READER_LEFT, b"")


def run_with(streams: str, *call: str) -> subprocess.CompletedProcess:
    """Runs ptbench from a shell with these redirections."""
    return subprocess.run(
        ["/bin/sh", "-c", f'exec "$0" -m ptbench "$@" {streams}', sys.executable, *call], capture_output=True,
        text=True, cwd=ANALYSIS.parent, env={**os.environ, "PYTHONPATH": str(ANALYSIS)}, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("streams", ["2>&-", "2>/dev/full"])
def test_standard_error_takes_a_line_and_not_the_exit_code(streams):
    assert run_with(streams, "plots", "nosuch.json").returncode == 2
    assert run_with(streams, "--nosuch").returncode == 2


@pytest.mark.parametrize("streams", [">&-", ">/dev/full"])
def test_standard_output_is_the_machines_fault(streams):
    done = run_with(streams, "--version")
    assert done.returncode == 3
    assert done.stderr.startswith("python3 -m ptbench: standard output: cannot be written: ")
    assert done.stderr.count("\n") == 1
