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
