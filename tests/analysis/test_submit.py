"""`submit` and `collect` with stand-ins for Slurm and ptbench; with the real ones: tests/slurm/study.py."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from ptbench.cli.main import main
from ptbench.submit.script import script_of
from ptbench.submit.submission import Array, Submission

SHARDS = 3
# Two cells a shard; `merge` puts the files together as they are.
PTBENCH = """#!/usr/bin/env python3
import json, sys
from pathlib import Path
words = sys.argv[1:]
if words[0] == "merge":
    files = [json.loads(Path(word).read_text()) for word in words[1 : words.index("--out")]]
    whole = files[0]
    whole["benchmarks"] = [row for file in files for row in file["benchmarks"]]
    whole["ptbench"]["cells"] = [cell for file in files for cell in file["ptbench"]["cells"]]
    Path(words[words.index("--out") + 1]).write_text(json.dumps(whole))
elif "none_such" in words:
    sys.exit("ptbench: --suite: found none_such, allowed: a suite")
else:
    shard = words[words.index("--shard") + 1].partition("/")[0]
    print(f"a/scene:s{shard}/depth:2", f"b/scene:s{shard}/depth:2", "2 cells, 6 samples, 0 not applicable", sep="\\n")
"""
SBATCH = '#!/bin/sh\nhere=$(dirname "$0")\necho "$*" >>"$here/submitted"\necho "7$(wc -l <"$here/submitted")"\n'
SQUEUE = '#!/bin/sh\ncat "$(dirname "$0")/queue" 2>/dev/null || true\n'


def _program(file: Path, text: str) -> Path:
    file.write_text(text, encoding="utf-8")
    file.chmod(0o755)
    return file


@pytest.fixture
def tools(tmp_path, monkeypatch):
    folder = tmp_path / "tools"
    folder.mkdir()
    for name, text in (("ptbench", PTBENCH), ("sbatch", SBATCH), ("squeue", SQUEUE)):
        _program(folder / name, text)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")
    return folder


def _call(tools, study, *more) -> list[str]:
    binary = str(tools / "ptbench")
    return [
        "submit",
        "--suite",
        "s",
        "--slurm",
        "--shards",
        str(SHARDS),
        "--binary",
        binary,
        "--out",
        str(study),
        *more,
    ]


def _result(file: Path, shard: int, machine: str = "gpu", film: str = "f", date: str = "2026-01-01") -> None:
    cells = [f"{variant}/scene:s{shard}/depth:2" for variant in "ab"]
    rows = [
        {"run_name": cell, "run_type": "iteration", "repetition_index": index, "film_hash": f"{film}{shard}{index}"}
        for cell in cells
        for index in range(3)
    ]
    run = {"shard": f"{shard}/{SHARDS}", "identity": f"{machine:0<16}", "sessions": [{"samples": 6}]}
    document = {
        "context": {"ptbench.status": "completed", "ptbench.machine": machine, "date": date},
        "benchmarks": rows,
        "ptbench": {"run": run, "cells": [{"cell": cell, "status": "ok"} for cell in cells]},
    }
    file.write_text(json.dumps(document), encoding="utf-8")


def _submitted(tools) -> list[str]:
    return [line.split()[1] for line in (tools / "submitted").read_text().splitlines()]


def test_what_is_neither_done_nor_queued_is_submitted(tools, tmp_path, capsys):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    assert _submitted(tools) == ["--array=1,2,3"]
    (tools / "queue").write_text("71 1 RUNNING\n71 2 PENDING\n71 3 PENDING\n99 1 RUNNING\n")
    assert main(_call(tools, study)) == 0
    assert "nothing to submit: 3 shards queued" in capsys.readouterr().out
    _result(study / "any" / "shard-1-of-3.json", 1)
    (tools / "queue").write_text("71 2 RUNNING\n99 3 RUNNING\n")
    assert main(_call(tools, study)) == 0
    assert _submitted(tools) == ["--array=1,2,3", "--array=3"]


def test_a_script_that_somebody_changed_stays(tools, tmp_path):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    script = study / "any.sbatch"
    script.write_text(script.read_text() + "# mine\n")
    assert main(_call(tools, study)) == 0
    assert script.read_text().endswith("# mine\n")


def test_each_gpu_model_has_an_array(tools, tmp_path):
    study = tmp_path / "study"
    assert (
        main(_call(tools, study, "--gpu", "h100", "--gpu", "a100", "--time", "2:00:00", "--sbatch=--partition=p")) == 0
    )
    text = (study / "h100.sbatch").read_text()
    for line in ("--gres=gpu:h100:1", "--array=1-3", "--time=2:00:00", "--partition=p", "--requeue"):
        assert f"#SBATCH {line}\n" in text
    assert "#SBATCH --gres=gpu:a100:1\n" in (study / "a100.sbatch").read_text()
    assert len(_submitted(tools)) == 2


@pytest.mark.parametrize(
    ("more", "part"),
    [
        (["--suite", "none_such"], "--suite: found none_such, allowed: a suite"),
        (["--backend", "cpu", "--gpu", "h100"], "--gpu: argument"),
        (["--run=--seed=2"], "call: found another submission"),
    ],
)
def test_bad_calls_are_one_line(tools, tmp_path, capsys, more, part):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    capsys.readouterr()
    assert main(_call(tools, study, *more)) == 2
    err = capsys.readouterr().err
    assert part in err
    assert err.count("\n") == 1
    assert _submitted(tools) == ["--array=1,2,3"]


def test_collect_says_what_is_missing_and_then_merges(tools, tmp_path, capsys):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    _result(study / "any" / "shard-1-of-3.json", 1)
    _result(study / "any" / "shard-3-of-3.json", 3)
    (study / "any" / "shard-2-of-3.json.journal.jsonl").write_text('{"type":"sample"}\n{"type":"cell"}\n')
    (tools / "queue").write_text("71 2 PENDING\n")
    capsys.readouterr()
    assert main(["collect", str(study)]) == 1
    out = capsys.readouterr().out
    assert "missing: shard 2 (2 cells, first a/scene:s2/depth:2): pending, 1 sample kept" in out
    assert out.count("missing") == 1
    _result(study / "any" / "shard-2-of-3.json", 2)
    assert main(["collect", str(study)]) == 0
    (machine,) = json.loads((study / "tally.json").read_text())["arrays"]["any"]["machines"]
    expected = {"cells": 6, "once": 6, "missing": 0, "twice": 0, "samples": 18, "samples_twice": 0, "left_out": 0}
    assert {key: machine[key] for key in expected} == expected
    assert (study / "gpu.json").exists()


def test_a_shard_that_came_back_twice_counts_once(tools, tmp_path, capsys):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    for shard in range(1, SHARDS + 1):
        _result(study / "any" / f"shard-{shard}-of-3.json", shard)
    _result(study / "any" / "again.json", 2, date="2026-01-02")
    assert main(["collect", str(study)]) == 0
    assert "again.json left out" in capsys.readouterr().out
    _result(study / "any" / "again.json", 2, date="2026-01-02", film="other")
    assert main(["collect", str(study)]) == 2
    assert "found other cells or films" in capsys.readouterr().err


def test_machines_are_not_mixed(tools, tmp_path, capsys):
    study = tmp_path / "study"
    assert main(_call(tools, study)) == 0
    for shard, machine in ((1, "old"), (2, "new"), (3, "new")):
        _result(study / "any" / f"shard-{shard}-of-3.json", shard, machine)
    assert main(["collect", str(study)]) == 1
    out = capsys.readouterr().out
    assert "any on old: 1 of 3 shards" in out
    assert "any on new: 2 of 3 shards" in out
    assert "machines differ" in out
    assert not (study / "new.json").exists()


# ---- What a task does when its program ends ----


class Task:
    """The script, run as Slurm would, with a program that ends as it is told."""

    def __init__(self, folder: Path, program: str):
        self.folder = folder
        binary = _program(folder / "program", f"#!/bin/bash\n{program}\n")
        # As Slurm: what is requeued is ended.
        _program(folder / "scontrol", f'#!/bin/sh\necho "$*" >>{folder}/requeued\nkill -TERM $PPID\n')
        study = Submission(folder, str(binary), ["run", "--backend", "cpu"], SHARDS, {}, [Array("any")])
        script = _program(folder / "any.sbatch", script_of(study, study.arrays[0], "s", "10", []))
        environment = os.environ | {
            "PATH": f"{folder}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": "2", "SLURM_ARRAY_JOB_ID": "7",
            "SLURMD_NODENAME": "n1",
        }  # fmt: skip
        self.process = subprocess.Popen([str(script)], env=environment, stdout=subprocess.PIPE, text=True)

    def send(self, number: signal.Signals) -> None:
        """Sends the script a signal, once the program that it starts is running."""
        end = time.monotonic() + 30
        while not (self.folder / "runs").exists() and time.monotonic() < end:
            time.sleep(0.01)
        self.process.send_signal(number)

    def ended(self) -> tuple[str, str]:
        """What it said, and what was requeued."""
        out, _ = self.process.communicate(timeout=30)
        requeued = self.folder / "requeued"
        return out, requeued.read_text() if requeued.exists() else ""


UNTIL_TERM = 'trap "exit 130" TERM; touch "$(dirname "$0")/runs"; while :; do sleep 0.01; done'


@pytest.mark.parametrize(("code", "again"), [(0, False), (1, False), (2, False), (3, True), (137, True)])
def test_a_program_that_the_machine_ended_is_requeued(tmp_path, code, again):
    out, requeued = Task(tmp_path, f"exit {code}").ended()
    assert f"shard 2 of 3: exit code {code}" in out
    assert requeued == ("requeue 7_2\n" if again else "")


def test_a_task_whose_time_is_nearly_up_is_requeued(tmp_path):
    task = Task(tmp_path, UNTIL_TERM)
    task.send(signal.SIGUSR1)
    out, requeued = task.ended()
    assert "exit code 130" in out
    assert requeued == "requeue 7_2\n"


def test_a_task_that_was_cancelled_is_not(tmp_path):
    task = Task(tmp_path, UNTIL_TERM)
    task.send(signal.SIGTERM)
    out, requeued = task.ended()
    assert "exit code 130" in out
    assert requeued == ""


def test_the_program_is_given_its_shard(tmp_path):
    out, _ = Task(tmp_path, 'echo "$@"').ended()
    assert f"run --backend cpu --shard 2/3 --out {tmp_path}/any/shard-2-of-3.json --resume --other-host --quiet" in out


def test_the_page_says_what_the_study_on_slurm_found():
    root = Path(__file__).parents[2]
    tally = json.loads((root / "tests" / "slurm" / "tally.json").read_text())
    assert tally["complete"]
    assert tally["cells_once"] == tally["cells"] == 200
    assert tally["films_as_alone"] == tally["films_alone"] == tally["samples"]
    assert [tally[key] for key in ("cells_missing", "cells_twice", "samples_twice", "cells_failed")] == [0, 0, 0, 0]
    starts = {what: wrong["starts"] for what, wrong in tally["went_wrong"].items()}
    said = [
        f"{tally['cells_once']} of {tally['cells']} cells once, in {tally['tasks']} tasks on {tally['nodes']} nodes",
        f"{tally['films_as_alone']} of {tally['samples']} films as without a cluster",
        f"starts of the task whose node was cut off: {starts['cut_off']}, whose program was killed: {starts['killed']}",
        f"whose time was over: {starts['over_time']}, that was cancelled: {starts['cancelled']}",
        f"left out as double: {tally['left_out']}",
    ]
    page = (root / "docs" / "several_hosts.md").read_text()
    assert [words for words in said if words not in page] == []
