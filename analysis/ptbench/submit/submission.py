"""What was submitted: DIR/submission.json, from which `submit` goes on and `collect` knows what should come back."""

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
    """A job array: every shard of the suite, on GPUs of one model or (`any`) wherever Slurm puts it."""

    name: str
    jobs: list[str] = field(default_factory=list)  # Slurm's numbers, one a call of sbatch


@dataclass
class Submission:
    """A suite that is run on a cluster, as its folder keeps it."""

    folder: Path
    binary: str
    call: list[str]  # of `ptbench run`, without what differs from task to task
    shards: int
    cells: dict[str, list[str]]  # by shard, "1" to "N"
    arrays: list[Array]

    def result(self, array: Array, shard: int) -> Path:
        """The file that a task writes its result to."""
        return self.folder / array.name / f"shard-{shard}-of-{self.shards}.json"

    def script(self, array: Array) -> Path:
        """The script that sbatch is given."""
        return self.folder / f"{array.name}.sbatch"

    def settings(self) -> dict:
        """The settings that have to be the same when the suite is submitted again."""
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
    """Reads the submission of a folder; raises InputError."""
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
    """The cells of each shard by name, as the program deals them; raises InputError with what it says."""
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
