"""A study on a Slurm cluster of four nodes on this machine, with what goes wrong on clusters.

    .venv/bin/python tests/slurm/study.py [--binary build/ptbench] [--out tests/slurm/tally.json]

200 cells in 4 tasks. In the middle one node is cut off with all that runs on it, on another the program is killed, on a
third it stands still until its time limit is over, and the fourth's task is cancelled. What is missing is submitted
again; one shard is then run once more, and comes back from elsewhere too. Exit code 0 where nothing is lost and nothing
double: the study is complete, each cell and sample is there once, with the films of a run without a cluster. --out
keeps the tally. Needs root, slurm-wlm and munge, and takes a few minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from cluster import NODES, Cluster, kill, missing_programs, wait_until

_HERE = Path(__file__).resolve().parent
_ROOT = _HERE.parents[1]
_SUITE = _HERE / "study.json"
_SHARDS = 4
_LONGEST = 900  # seconds
_IN_THE_MIDDLE = 15  # samples of a shard's 150


class Failed(Exception):
    """What should hold does not."""


def _expect(is_so: bool, what: str) -> None:
    if not is_so:
        raise Failed(what)
    print(f"holds: {what}", flush=True)


def _ptbench(cluster: Cluster, *arguments: str) -> subprocess.CompletedProcess:
    """A command of the Python package."""
    environment = cluster.environment | {"PYTHONPATH": str(_ROOT / "analysis")}
    answer = subprocess.run(
        [sys.executable, "-m", "ptbench", *arguments], env=environment, capture_output=True, text=True, check=False
    )
    print(answer.stdout + answer.stderr, end="", flush=True)
    return answer


def _films(file: Path) -> dict[tuple[str, int], str]:
    rows = [row for row in json.loads(file.read_text())["benchmarks"] if row["run_type"] == "iteration"]
    films = {(row["run_name"], row["repetition_index"]): row["film_hash"] for row in rows}
    _expect(len(films) == len(rows), f"{file.name}: each of {len(rows)} samples stands once")
    return films


def _samples(study: Path, shard: int) -> int:
    try:
        return (study / "any" / f"shard-{shard}-of-{_SHARDS}.json.journal.jsonl").read_text().count('"type":"sample"')
    except OSError:
        return 0


def _nodes_of_shards(study: Path) -> dict[int, str]:
    """The node on which each shard was started last."""
    nodes = {}
    for shard in range(1, _SHARDS + 1):
        log = study / "any" / f"shard-{shard}.log"
        started = re.findall(r"start \d+, on (\w+)", log.read_text()) if log.exists() else []
        if started:
            nodes[shard] = started[-1]
    return nodes


def _stop_in_the_middle(cluster: Cluster, study: Path) -> dict[str, int]:
    """Has each task's program stand still once it has taken some samples. Returns the shards by node."""
    waiting = set(range(1, _SHARDS + 1))

    def all_stand() -> bool:
        nodes = _nodes_of_shards(study)
        for shard in sorted(waiting):
            if _samples(study, shard) >= _IN_THE_MIDDLE:
                for process in cluster.processes_on(nodes[shard], "ptbench"):
                    kill(process, signal.SIGSTOP)
                waiting.remove(shard)
        return not waiting

    wait_until(all_stand, _LONGEST, f"{_IN_THE_MIDDLE} samples in each shard")
    shards = {node: shard for shard, node in _nodes_of_shards(study).items()}
    _expect(sorted(shards) == sorted(NODES), "four tasks run on four nodes")
    return shards


def _job(study: Path) -> str:
    """Slurm's number of the array."""
    return json.loads((study / "submission.json").read_text())["arrays"][0]["jobs"][0]


def _go_wrong(cluster: Cluster, study: Path) -> dict[str, int]:
    """Does to three tasks in the middle of the study what clusters do. Returns their shards."""
    shard_on = _stop_in_the_middle(cluster, study)
    cancelled, cut_off, killed, stopped = NODES
    cluster.kill_node(cut_off)
    for process in cluster.processes_on(killed, "ptbench"):
        kill(process)
    cluster.called("scancel", f"{_job(study)}_{shard_on[cancelled]}")
    return {
        "cut_off": shard_on[cut_off],
        "killed": shard_on[killed],
        "over_time": shard_on[stopped],
        "cancelled": shard_on[cancelled],
    }


def _study(cluster: Cluster, binary: Path, study: Path) -> dict:
    call = ["submit", "--suite", str(_SUITE), "--slurm", "--backend", "cpu", "--shards", str(_SHARDS)]
    call += ["--time", "2", "--binary", str(binary), "--out", str(study)]
    _expect(_ptbench(cluster, *call).returncode == 0, "the study is submitted")
    again = _ptbench(cluster, *call)
    _expect(
        again.returncode == 0 and "nothing to submit" in again.stdout, "what is queued or runs is not submitted again"
    )
    wrong = _go_wrong(cluster, study)
    print(f"went wrong: {wrong}", flush=True)
    wait_until(cluster.is_idle, _LONGEST, "all tasks ended, or given up by Slurm")
    first = _ptbench(cluster, "collect", str(study))
    _expect(
        first.returncode == 1 and f"missing: shard {wrong['cancelled']} (" in first.stdout,
        "the shard that was cancelled is missing, and collect says so",
    )
    _expect(first.stdout.count("missing: shard") == 1, "no other shard is missing")
    cluster.start_node(NODES[1])
    again = _ptbench(cluster, *call)
    _expect(f": shards {wrong['cancelled']} of {_SHARDS} " in again.stdout, "it alone is submitted again")
    wait_until(cluster.is_idle, _LONGEST, "it ended")
    _expect(_ptbench(cluster, "collect", str(study)).returncode == 0, "the study is complete")
    _come_back_twice(cluster, binary, study)
    last = _ptbench(cluster, "collect", str(study))
    _expect(last.returncode == 0 and "left out" in last.stdout, "a shard that came back twice counts once")
    return wrong


def _come_back_twice(cluster: Cluster, binary: Path, study: Path) -> None:
    """Shard 1 as a task that Slurm starts once more, and as a result from elsewhere."""
    result = study / "any" / f"shard-1-of-{_SHARDS}.json"
    content = result.read_bytes()
    cluster.called("sbatch", "--array=1", str(study / "any.sbatch"))
    wait_until(cluster.is_idle, _LONGEST, "the task that is run once more")
    log = (study / "any" / "shard-1.log").read_text()
    _expect(
        "nothing left to do" in log and result.read_bytes() == content, "a task that is run once more finds its result"
    )
    elsewhere = [str(binary), "run", "--suite", str(_SUITE), "--backend", "cpu", "--quiet", "--shard", f"1/{_SHARDS}"]
    _run_alone([*elsewhere, "--out", str(study / "any" / "shard-1-from-elsewhere.json")])


def _run_alone(call: list[str]) -> None:
    ended = subprocess.run(call, capture_output=True, text=True, check=False)
    _expect(ended.returncode == 0, f"{' '.join(call[1:4])} runs without a cluster {ended.stderr}".strip())


def _tally(study: Path, wrong: dict, alone: Path) -> dict:
    tally = json.loads((study / "tally.json").read_text())["arrays"]["any"]
    (machine,) = tally["machines"]
    merged = _films(study / f"{machine['machine']}.json")
    films = _films(alone)
    starts = {
        shard: len(re.findall(r"^task \S+, start", (study / "any" / f"shard-{shard}.log").read_text(), re.MULTILINE))
        for shard in range(1, _SHARDS + 1)
    }
    return {
        "schema": "ptbench-slurm-study-1",
        "slurm": subprocess.run(["slurmctld", "-V"], capture_output=True, text=True, check=True).stdout.split()[-1],
        "tasks": _SHARDS,
        "nodes": len(NODES),
        "complete": tally["complete"],
        "cells": machine["cells"],
        "cells_once": machine["once"],
        "cells_missing": machine["missing"],
        "cells_twice": machine["twice"],
        "cells_failed": machine["failed"],
        "samples": machine["samples"],
        "samples_twice": machine["samples_twice"],
        "films_as_alone": sum(merged.get(sample) == film for sample, film in films.items()),
        "films_alone": len(films),
        "went_wrong": {what: {"shard": shard, "starts": starts[shard]} for what, shard in wrong.items()},
        "left_out": machine["left_out"],
    }


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--binary", type=Path, default=_ROOT / "build" / "ptbench")
    parser.add_argument("--out", type=Path, help="keep the tally there")
    parser.add_argument("--keep", action="store_true", help="leave the folder of the study and of the daemons' logs")
    return parser.parse_args()


def main() -> int:
    """Runs it all."""
    options = _options()
    lacking = missing_programs() + ([] if os.geteuid() == 0 else ["root"])
    if lacking:
        print(f"study.py: found no {', '.join(lacking)}, allowed: slurm-wlm and munge, as root", file=sys.stderr)
        return 2
    path = f"{os.environ['PATH']}:/usr/sbin"
    os.environ |= {"PTBENCH_HOME": str(_ROOT), "OMP_NUM_THREADS": "1", "PATH": path}
    folder = Path(tempfile.mkdtemp(prefix="ptbench_slurm_"))
    print(f"in {folder}", flush=True)
    try:
        with Cluster(folder) as cluster:
            wrong = _study(cluster, options.binary.resolve(), folder / "study")
        alone = folder / "alone.json"
        call = [str(options.binary.resolve()), "run", "--suite", str(_SUITE), "--backend", "cpu", "--quiet"]
        _run_alone([*call, "--out", str(alone)])
        tally = _tally(folder / "study", wrong, alone)
        _expect(
            tally["films_as_alone"] == tally["films_alone"] == tally["samples"], "the films of a run without a cluster"
        )
        _expect(tally["complete"] and tally["cells_once"] == tally["cells"] == 200, "200 cells, each once")
    except (Failed, TimeoutError) as error:
        print(f"study.py: {error} (logs in {folder})", file=sys.stderr)
        return 1
    if options.out is not None:
        options.out.write_text(json.dumps(tally, indent=1) + "\n")
    print(json.dumps(tally, indent=1))
    if not options.keep:
        subprocess.run(["rm", "-r", str(folder)], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
