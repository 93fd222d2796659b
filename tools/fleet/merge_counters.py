"""Merges files of `ptbench inspect --counters` into one, and adds the counters of libraries' kernels by ncu.

    python3 tools/fleet/merge_counters.py DIR > inspect_schedulers.json

DIR has inspect_NAME.json, and csv/NAME-N.csv for its N-th variant, as tools/fleet/ncu_all_kernels.sh leaves them. An
entry gets `caches: kept` and, where other kernels ran, `other_kernels`, with counters as for ptbench's own kernels.
"""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterable
from pathlib import Path

_SUMS = {
    "seconds": "gpu__time_duration.sum",
    "warp_instructions": "smsp__inst_executed.sum",
    "thread_instructions": "smsp__thread_inst_executed.sum",
    "fma": "sm__inst_executed_pipe_fma.sum",
    "alu": "sm__inst_executed_pipe_alu.sum",
    "xu": "sm__inst_executed_pipe_xu.sum",
    "lsu": "sm__inst_executed_pipe_lsu.sum",
    "fp64": "sm__inst_executed_pipe_fp64.sum",
    "memory_bytes": "dram__bytes.sum",
}
# Counters in per cent, averaged with time as weight; those of caches and stalls only if the program requested them.
_SHARES = {
    "achieved_occupancy": "sm__warps_active.avg.pct_of_peak_sustained_active",
    "l1": "l1tex__throughput.avg.pct_of_peak_sustained_elapsed",
    "l2": "lts__throughput.avg.pct_of_peak_sustained_elapsed",
    "l1_hit_rate": "l1tex__t_sector_hit_rate.pct",
    "l2_hit_rate": "lts__t_sector_hit_rate.pct",
    "memory_stalls": "smsp__warp_issue_stalled_long_scoreboard_per_warp_active.pct",
}
_UNITS = {"ns": 1e-9, "nsecond": 1e-9, "us": 1e-6, "usecond": 1e-6, "ms": 1e-3, "msecond": 1e-3,
          "Kbyte": 1e3, "Mbyte": 1e6, "Gbyte": 1e9}  # fmt: skip
_PER_RAY = ("warp_instructions", "thread_instructions", "fma", "alu", "xu", "lsu", "fp64", "memory_bytes")


def kernels_of(lines: Iterable[str]) -> dict[str, dict[str, float]]:
    """Counters summed over the launches of each kernel, from `ncu --csv --page raw`; kernel names without arguments."""
    table = csv.reader(line for line in lines if line.startswith('"'))
    names, units = next(table), next(table)
    column = {name: index for index, name in enumerate(names)}
    found: dict[str, dict[str, float]] = {}
    for row in table:

        def value(metric: str, row: list[str] = row) -> float:
            index = column[metric]
            return float(row[index].replace(",", "")) * _UNITS.get(units[index], 1.0)

        there = {name: metric for name, metric in _SHARES.items() if metric in column}
        sums = found.setdefault(
            row[column["Kernel Name"]].partition("(")[0], dict.fromkeys((*_SUMS, *there, "launches"), 0.0)
        )
        for name, metric in _SUMS.items():
            sums[name] += value(metric)
        for name, metric in there.items():
            sums[name] += 1e-2 * value(metric) * value(_SUMS["seconds"])
        sums["launches"] += 1
    return found


def counters_of(sums: dict[str, float], rays: float, ceilings: dict[str, float]) -> dict:
    """A kernel's counters in the form in which `ptbench inspect` writes them."""
    seconds = sums["seconds"]
    reached = {
        "issue": sums["warp_instructions"] / ceilings["issue_g_warp_instructions_per_second"],
        **{pipe: sums[pipe] / ceilings[f"{pipe}_g_warp_instructions_per_second"] for pipe in ("fma", "alu", "xu")},
        "memory": sums["memory_bytes"] / ceilings["memory_gb_per_second"],
    }
    shares = {name: sums[name] / seconds for name in _SHARES if name in sums}
    of_ceiling = {name: 1e-9 * value / seconds for name, value in reached.items()}
    of_ceiling |= {name: shares.pop(name) for name in ("l1", "l2") if name in shares}
    return {
        "launches": int(sums["launches"]),
        "milliseconds": 1e3 * seconds,
        "active_lanes": sums["thread_instructions"] / sums["warp_instructions"],
        **{f"{name}_per_ray": sums[name] / rays for name in _PER_RAY},
        **shares,
        "of_ceiling": of_ceiling,
        "bound": max(of_ceiling, key=lambda name: of_ceiling[name]),
    }


def merged(folder: Path) -> list[dict]:
    """The entries of all inspection files, merged with their tables of ncu."""
    read = [
        (folder / "csv" / f"{file.stem.removeprefix('inspect_')}-{number}.csv", entry)
        for file in sorted(folder.glob("inspect_*.json"))
        for number, entry in enumerate(json.loads(file.read_text(encoding="utf-8")))
    ]
    compiled = {_module_of(entry): entry["kernels"] for _, entry in read if entry["kernels"]}
    for table, entry in read:
        counted = {
            name: counters_of(sums, entry["rays"], entry["ceilings"])
            for name, sums in kernels_of(table.read_text(encoding="utf-8").splitlines()).items()
        }
        # A module from the compile cache has no resource usage in its entry; another entry of the module gives it.
        kernels = entry["kernels"] or compiled[_module_of(entry)]
        own = [{key: value for key, value in kernel.items() if key != "counters"} for kernel in kernels]
        for kernel in own:
            if (counters := counted.pop(kernel["name"], None)) is not None:
                kernel["counters"] = counters
        entry |= {"kernels": own, "caches": "kept"}
        if counted:
            entry["other_kernels"] = [{"name": name, "counters": counters} for name, counters in counted.items()]
    return [entry for _, entry in read]


def _module_of(entry: dict) -> str:
    return json.dumps([entry["scene"], entry["options"], entry["code_bytes"]])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"{sys.argv[0]}: found {len(sys.argv) - 1} arguments, allowed: the folder")
    print(json.dumps(merged(Path(sys.argv[1])), indent=1))
