"""Calls of Slurm's commands."""

import re
import subprocess
from pathlib import Path

from ptbench.errors import InputError


def _called(*command: str) -> subprocess.CompletedProcess:
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    except OSError as error:
        raise InputError(f"{command[0]}: found no such program, allowed: Slurm's, on a login node") from error


def submit(script: Path, shards: list[int]) -> str:
    """Queues the shards of an array; returns the job id."""
    answer = _called("sbatch", "--parsable", f"--array={','.join(map(str, shards))}", str(script))
    if answer.returncode != 0:
        said = answer.stderr.strip().splitlines() or [f"exit code {answer.returncode}"]
        raise InputError(f"{script}: sbatch: {said[-1]}")
    return answer.stdout.strip().split(";")[0]


def tasks_of(jobs: list[str]) -> dict[int, str]:
    """States of the queued or running tasks of these jobs; jobs that Slurm has forgotten have none."""
    answer = _called("squeue", "--noheader", "--array", "--me", "--format=%F %K %T")
    if answer.returncode != 0:
        raise InputError(f"squeue: {answer.stderr.strip()}")
    tasks = {}
    for line in answer.stdout.splitlines():
        match = re.fullmatch(r"\s*(\d+) (\d+) (\w+)\s*", line)
        if match and match[1] in jobs:
            tasks[int(match[2])] = match[3]
    return tasks
