"""A submitted suite in DIR/submission.json, which `submit` continues from and `collect` checks results against."""

import json
import subprocess
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.files import picked, read_whole, write_text

_SCHEMA = "ptbench-submission-1"
ANY = "any"


@dataclass
class Array:
    """A job array: every shard of a suite, on GPUs of one model or (`any`) wherever Slurm places it."""

    name: str
    jobs: list[str] = field(default_factory=list)  # Slurm's job ids, one for each call of sbatch


@dataclass
class Submission:
    """A suite that is run on a cluster, as stored in its folder."""

    folder: Path
    binary: str
    call: list[str]  # arguments of `ptbench run` that all tasks share
    shards: int
    cells: dict[str, list[str]]  # names of the cells of each shard, by its number, "1" to "N"
    arrays: list[Array]

    def result(self, array: Array, shard: int) -> Path:
        """The result file of a shard's task."""
        return self.folder / array.name / f"shard-{shard}-of-{self.shards}.json"

    def script(self, array: Array) -> Path:
        """The sbatch script of a job array."""
        return self.folder / f"{array.name}.sbatch"

    def settings(self) -> dict:
        """The settings that must be equal when a suite is submitted again."""
        arrays = [array.name for array in self.arrays]
        return {**picked(self, "call shards"), "arrays": arrays, "cells": self.cells}

    def write(self) -> None:
        """Writes the submission into its folder."""
        document = {
            "schema": _SCHEMA,
            **picked(self, "binary call shards"),
            "arrays": [asdict(array) for array in self.arrays],
            "cells": self.cells,
        }
        write_text(self.folder / "submission.json", json.dumps(document, indent=1) + "\n")


def read_submission(folder: Path) -> Submission:
    """Reads the submission stored in a folder; raises InputError."""
    file = folder / "submission.json"
    try:
        document = json.loads(read_whole(file))
        if document["schema"] != _SCHEMA:
            raise bad_value(file, "$.schema", json.dumps(document["schema"]), f'"{_SCHEMA}"')
        return Submission(
            folder, document["binary"], document["call"], document["shards"], document["cells"],
            [Array(array["name"], list(array["jobs"])) for array in document["arrays"]],
        )  # fmt: skip
    except (ValueError, KeyError, TypeError) as error:
        raise bad_value(file, "$", f"{type(error).__name__}: {error}", "what `submit` wrote") from error


def cells_of_shards(binary: str, call: list[str], shards: int) -> dict[str, list[str]]:
    """The cells of each shard by name, as the program distributes them; raises InputError with its message."""
    cells = {}
    for shard in range(1, shards + 1):
        part = [] if shards == 1 else ["--shard", f"{shard}/{shards}"]
        try:
            listed = subprocess.run(
                [binary, *call, *part, "--dry-run"], capture_output=True, text=True, check=False, timeout=600
            )
        except OSError as error:
            raise bad_value("--binary", binary, error.strerror or "no program", "ptbench") from error
        if listed.returncode != 0:
            said = listed.stderr.strip().splitlines() or [f"exit code {listed.returncode}"]
            raise InputError(said[-1].removeprefix("ptbench: "))
        cells[str(shard)] = [line for line in listed.stdout.splitlines() if "/scene:" in line and " " not in line]
    return cells
