"""Result files to compare: a real one cut down, and what other machines, programs and runs would have left instead."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable
from pathlib import Path

from builder import agreeing
from conftest import committed

REAL = "nvidia-h200/first_bounce_e3d4f13.json"
_TIMES = ("real_time", "cpu_time", "pt_wall_ms", "pt_device_ms", "pt_end_to_end_ms", "pt_cpu_ms")


def real(keep: Callable[[dict], bool], source: str = REAL) -> dict:
    """A real result file with the cells that are wanted only."""
    document = committed(source)
    cells = [cell for cell in document["ptbench"]["cells"] if keep(cell)]
    names = {cell["cell"] for cell in cells}
    document["ptbench"]["cells"] = cells
    document["benchmarks"] = [row for row in document["benchmarks"] if row["run_name"] in names]
    return document


def wavefront_by_depth() -> dict:
    """Eight cells: two scenes, with and without a cache, at depths 2 and 8; nine samples each."""
    document = real(
        lambda cell: (
            cell["axes"]["integrator"] == "wavefront"
            and cell["depth"] in (2, 8)
            and cell["scene"].endswith("_unjittered")
        )
    )
    assert len(document["ptbench"]["cells"]) == 8
    return document


def run_again(document: dict, scale: float = 1.0, *, clock: float = 1.0, only: str = "") -> dict:
    """The result of the program on another day: times and clocks of the cells with `only` times a factor."""
    document = copy.deepcopy(document)
    for row in document["benchmarks"]:
        if only in row["run_name"]:
            for key in _TIMES:
                if key in row:
                    row[key] *= scale
            for key in ("pt_clock_mhz_before", "pt_clock_mhz_after"):
                if key in row:
                    row[key] *= clock
        if "pt_timestamp" in row:
            row["pt_timestamp"] += 86400.0
    return document


def other_program(document: dict) -> dict:
    """Another commit's."""
    document = copy.deepcopy(document)
    document["context"] |= {"ptbench.git_sha": "1" * 40, "ptbench.program_hash": "0" * 16}
    return document


def other_machine(document: dict, name: str, units: int = 66, memory_clock: float = 1600.5) -> dict:
    """Another GPU's: by default half the multiprocessors and half the bandwidth of the real file's."""
    document = copy.deepcopy(document)
    document["context"] |= {
        "ptbench.machine": name,
        "ptbench.cuda_device": name.upper(),
        "ptbench.cuda_multiprocessors": str(units),
        "ptbench.cuda_memory_clock_mhz": str(memory_clock),
    }
    return document


def shuffled(document: dict, seed: int = 1) -> dict:
    document = copy.deepcopy(document)
    order = random.Random(seed)
    order.shuffle(document["ptbench"]["cells"])
    order.shuffle(document["benchmarks"])
    return document


def without(document: dict, part: str) -> dict:
    """Less the cells whose names hold `part`."""
    document = copy.deepcopy(document)
    cells = document["ptbench"]["cells"]
    document["ptbench"]["cells"] = [cell for cell in cells if part not in cell["cell"]]
    document["benchmarks"] = [row for row in document["benchmarks"] if part not in row["run_name"]]
    return document


def cell_of(document: dict, *parts: str) -> dict:
    """The one cell whose name holds all of `parts`."""
    (cell,) = [cell for cell in document["ptbench"]["cells"] if all(part in cell["cell"] for part in parts)]
    return cell


def rows_of(document: dict, cell: dict) -> list[dict]:
    return [row for row in document["benchmarks"] if row["run_name"] == cell["cell"] and "pt_wall_ms" in row]


def rename(document: dict, cell: dict, name: str) -> None:
    for row in document["benchmarks"]:
        if row["run_name"] == cell["cell"]:
            row["name"] = row["name"].replace(cell["cell"], name)
            row["run_name"] = name
    cell["cell"] = name


def written(document: dict, path: Path) -> Path:
    path.write_text(json.dumps(agreeing(document)), encoding="utf-8")
    return path
