"""What came back: read, held against what was submitted, and merged by machine."""

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
    """A shard's result that is complete."""

    file: Path
    shard: int
    machine: str
    identity: str  # of the run: machine, build, settings, cells
    date: str
    films: dict[tuple[str, int], str]  # by cell and repetition


@dataclass
class Group:
    """The shards that one machine's kind brought back."""

    machine: str
    shards: dict[int, ShardFile] = field(default_factory=dict)
    twice: list[Path] = field(default_factory=list)  # left out: the same shard is there already

    def missing(self, count: int) -> list[int]:
        """The numbers of the shards that are not there."""
        return [shard for shard in range(1, count + 1) if shard not in self.shards]


def read_shard(file: Path) -> ShardFile | None:
    """A shard's result; None where there is none, or one that is not complete."""
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
    """The shards in an array's folder, grouped by machine; of a shard that is there twice the earlier one counts.

    Raises InputError where the two do not hold the same cells with the same films.
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
    """One result file of all shards, by `ptbench merge`, which checks each cell and sample once more."""
    files = [str(group.shards[shard].file) for shard in sorted(group.shards)]
    if submission.shards == 1:
        out.write_bytes(Path(files[0]).read_bytes())
        return
    merged = subprocess.run(
        [submission.binary, "merge", *files, "--out", str(out), "--overwrite"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if merged.returncode not in (0, 1):  # 1: a cell failed, which the result says
        said = merged.stderr.strip().splitlines() or [f"exit code {merged.returncode}"]
        raise InputError(said[-1].removeprefix("ptbench: "))


def tally_of(submission: Submission, result: Path) -> dict:
    """Cells of a merged result against those that were submitted."""
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
    """The samples that an unfinished task has kept."""
    try:
        text = Path(f"{result}.journal.jsonl").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return 0
    return text.count('"type":"sample"')
