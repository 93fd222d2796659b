"""The name that `./run bench` gives a result: no finished result's place is taken, compressed or not."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FUNCTION = 'eval "$(sed -n \'/^free_name()/,/^}/p\' run)"; free_name "$@"'


@pytest.mark.parametrize(
    ("there", "name"),
    [
        ([], "quick"),
        (["quick.json"], "quick.2"),
        (["quick.json.gz"], "quick.2"),
        (["quick.json.gz", "quick.2.json"], "quick.3"),
        (["quick.json", "quick.json.journal.jsonl"], "quick"),
        (["quick.json.journal.jsonl"], "quick"),
        (["quicker.json", "quick.csv"], "quick"),
    ],
)
def test_a_result_takes_a_free_name(tmp_path, there, name):
    """An unfinished run, which has a journal, keeps its name."""
    for file in there:
        (tmp_path / file).touch()
    call = ["bash", "-euc", FUNCTION, "bash", str(tmp_path), "quick"]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"{name}\n"), done.stderr
