"""Collects the shards of a submitted suite: reads and checks their results, and merges them by machine."""

import json
import subprocess
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from ptbench.errors import InputError
from ptbench.io.files import LARGEST_RESULT, read_whole
from ptbench.submit.submission import Array, Submission


@dataclass
class ShardFile:
    """The complete result of a shard."""

    file: Path
    shard: int
    machine: str
    identity: str  # hash of a run's machine, build, settings and cells
    date: str
    films: dict[tuple[str, int], str]  # film hashes by cell and repetition


@dataclass
class Group:
    """The shards that were run on one kind of machine."""

    machine: str
    shards: dict[int, ShardFile] = field(default_factory=dict)
    twice: list[Path] = field(default_factory=list)  # result files left out: another file has the shard

    def missing(self, count: int) -> list[int]:
        """The numbers of the missing shards."""
        return [shard for shard in range(1, count + 1) if shard not in self.shards]


def read_shard(file: Path) -> ShardFile | None:
    """Reads the result of a shard; None where it is missing or incomplete."""
    try:
        document = json.loads(read_whole(file, LARGEST_RESULT))
        context, run = document["context"], document["ptbench"]["run"]
        if context["ptbench.status"] != "completed":
            return None
        films = {
            (row["run_name"], row["repetition_index"]): row["film_hash"]
            for row in document["benchmarks"]
            if row["run_type"] == "iteration" and "film_hash" in row
        }
        shard = int(run.get("shard", "1/1").partition("/")[0])
        return ShardFile(file, shard, context["ptbench.machine"], run["identity"], context["date"], films)
    except (InputError, ValueError, KeyError, TypeError, AttributeError):
        return None


def groups_of(submission: Submission, array: Array) -> list[Group]:
    """The shards in an array's folder, grouped by machine; of duplicate shards the earlier one counts.

    Raises InputError where two results of a shard differ in cells or films.
    """
    found = [read_shard(file) for file in sorted((submission.folder / array.name).glob("*.json"))]
    groups: dict[str, Group] = {}
    for shard in sorted((shard for shard in found if shard is not None), key=lambda shard: (shard.date, shard.file)):
        group = groups.setdefault(shard.identity, Group(shard.machine))
        kept = group.shards.setdefault(shard.shard, shard)
        if kept is shard:
            continue
        if kept.films != shard.films:
            raise InputError(f"{shard.file}: shard {shard.shard}: found other cells or films than in {kept.file}")
        group.twice.append(shard.file)
    return list(groups.values())


def merge(submission: Submission, group: Group, out: Path) -> None:
    """Merges all shards into one result file by `ptbench merge`, which checks each cell and sample again."""
    files = [str(group.shards[shard].file) for shard in sorted(group.shards)]
    if submission.shards == 1:
        out.write_bytes(Path(files[0]).read_bytes())
        return
    merged = subprocess.run(
        [submission.binary, "merge", *files, "--out", str(out), "--overwrite"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if merged.returncode not in (0, 1):  # exit code 1: a cell failed, which the merged result records
        said = merged.stderr.strip().splitlines() or [f"exit code {merged.returncode}"]
        raise InputError(said[-1].removeprefix("ptbench: "))


def tally_of(submission: Submission, result: Path) -> dict:
    """The cells of a merged result compared with those submitted."""
    document = json.loads(read_whole(result, LARGEST_RESULT))
    times = Counter(cell["cell"] for cell in document["ptbench"]["cells"])
    wanted = [cell for cells in submission.cells.values() for cell in cells]
    samples = [row for row in document["benchmarks"] if row["run_type"] == "iteration" and "film_hash" in row]
    return {
        "cells": len(wanted),
        "once": sum(times[cell] == 1 for cell in wanted),
        "missing": sum(times[cell] == 0 for cell in wanted),
        "twice": sum(count > 1 for count in times.values()),
        "failed": sum(cell["status"] == "failed" for cell in document["ptbench"]["cells"]),
        "samples": len(samples),
        "samples_twice": len(samples) - len({(row["run_name"], row["repetition_index"]) for row in samples}),
        "sessions": len(document["ptbench"]["run"]["sessions"]),
    }


def samples_in_journal(result: Path) -> int:
    """The number of samples that an unfinished task has in its journal."""
    try:
        text = Path(f"{result}.journal.jsonl").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return 0
    return text.count('"type":"sample"')
