"""tools/fleet/side_by_side.py: which calls run, where, and what is said of those that did not; calls are bash's own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TOOL = Path(__file__).resolve().parents[2] / "tools/fleet/side_by_side.py"


def run(tmp_path: Path, calls: str, *flags: str) -> subprocess.CompletedProcess:
    file = tmp_path / "calls.txt"
    file.write_text(calls, encoding="utf-8")
    return subprocess.run(
        [sys.executable, TOOL, file, "--out", tmp_path / "out", *flags], capture_output=True, text=True, check=False
    )


def test_each_call_has_one_gpu_and_what_is_alone_has_all_and_comes_first(tmp_path):
    show = "echo ${CUDA_VISIBLE_DEVICES-all} >> $OUT/order"
    # The two that follow meet: each waits for the other's word, so they run at once.
    meet = "touch $OUT/{0}; until [ -e $OUT/{1} ]; do sleep 0.01; done; echo $CUDA_VISIBLE_DEVICES > $OUT/gpu_{0}"
    done = run(
        tmp_path,
        f"# a comment\n\na | 20 | {meet.format('a', 'b')}\nb | 20 | {meet.format('b', 'a')}\n!alone | 20 | {show}\n",
        "--gpus", "2",
    )  # fmt: skip
    out = tmp_path / "out"
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[0].startswith("alone: ended after")
    assert (out / "order").read_text() == "all\n"
    assert {(out / name).read_text() for name in ("gpu_a", "gpu_b")} == {"0\n", "1\n"}


def test_what_fails_hangs_or_does_not_fit_is_said_and_the_others_run(tmp_path):
    done = run(
        tmp_path,
        "fails | 0.1 | echo why; exit 7\nlong | 500 | touch $OUT/long\nhangs | 0.1 | sleep 60\n"
        "after | 0.1 | touch $OUT/after\n",
        "--gpus", "1", "--until", "4",
    )  # fmt: skip
    assert done.returncode == 1
    lines = done.stdout.splitlines()
    assert lines[0].startswith("fails: failed with exit code 7")
    assert any(line.startswith("hangs: was interrupted") for line in lines)
    assert any(line.startswith("long: left out: 500 s,") for line in lines)
    assert (tmp_path / "out" / "fails.log").read_text() == "why\n"
    assert not (tmp_path / "out" / "long").exists()


@pytest.mark.parametrize(
    ("calls", "message"),
    [
        ("a | soon | true\n", "calls.txt:1: found 'a | soon | true', allowed: NAME | SECONDS | COMMAND"),
        ("a | 1 | true\n\na | 1 | true\n", "calls.txt:3: found a twice"),
        ("# nothing\n", "calls.txt: found no call"),
    ],
)
def test_a_bad_list_is_one_line(tmp_path, calls, message):
    done = run(tmp_path, calls, "--gpus", "1")
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()
