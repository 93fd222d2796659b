"""Builds result files in memory: the documented format, with times that follow a simple known law.

Times repeat exactly. Half of a cell's samples lie below its centre and half above, so with an odd count the median *is*
the centre; those above lie three times as far off, so the mean is not. Device time is not the wall time either.
"""

from __future__ import annotations

import json
import re
import statistics
from pathlib import Path

AXES = {
    "integrator": "wavefront",
    "compaction": "none",
    "sorting": "none",
    "first_bounce": "off",
    "direct_light": "off",
    "layout": "aos",
    "specialisation": "features",
}
GPU_AXES = {
    "integrator": "wavefront",
    "compaction": "none",
    "sorting": "none",
    "sort_key": "material",
    "first_bounce": "off",
    "direct_light": "off",
    "russian_roulette": "off",
    "sampler": "pcg4d",
    "layout": "aos",
    "specialisation": "features",
    "launch": "stream",
    "arithmetic": "precise",
    "precision": "float",
}
# What every variant on the GPU has; a variant's name spells the values that differ.
STANDARDS = {"block": 256, "shading_fmas": 0, "spp_in_flight": 1}


def agreeing(document: dict) -> dict:
    """The document, with what follows from its samples' wall times in any result of the program."""
    samples: dict[str, list[dict]] = {}
    for row in document["benchmarks"]:
        if "pt_wall_ms" in row:
            row["real_time"] = row["pt_wall_ms"]
            if "pt_end_to_end_ms" in row:
                row["pt_end_to_end_ms"] = max(row["pt_wall_ms"], row["pt_end_to_end_ms"])
            samples.setdefault(row["run_name"], []).append(row)
    for row in document["benchmarks"]:
        if row.get("aggregate_name") == "median" and row["run_name"] in samples:
            for key in ("real_time", "cpu_time"):
                row[key] = statistics.median(sample[key] for sample in samples[row["run_name"]])
    return document


class Builder:
    """A result file under construction; the defaults are those of a small run that went well."""

    def __init__(self, suite: str = "quick"):
        self.context = {
            "date": "2025-03-01T12:00:00+00:00",
            "host_name": "host",
            "num_cpus": 2,
            "ptbench.schema_version": "1",
            "ptbench.version": "0.1.0",
            "ptbench.git_sha": "0123abcd4567",
            "ptbench.git_dirty": "false",
            "ptbench.command_line": "build/ptbench run --suite quick",
            "ptbench.machine": "amd-epyc-2-cores",
            "ptbench.cpu_model": "AMD EPYC 7763 64-Core Processor",
            "ptbench.os": "Debian GNU/Linux 12",
            "ptbench.compiler": "GCC 12.2.0",
            "ptbench.compiler_flags": "-O3 -fopenmp",
            "ptbench.backend": "cpu",
            "ptbench.threads": "2",
            "ptbench.thrust_version": "3.0.1",
            "ptbench.suite": suite,
            "ptbench.status": "completed",
        }
        self.studies: list[dict] = []
        self.cells: list[dict] = []
        self.rows: list[dict] = []
        self.not_applicable: list[dict] = []
        self.axes = AXES
        self.backend = "cpu"
        self.baselines: dict[str, str] | None = None  # as in files from before there were two backends

    def on_gpu(self) -> Builder:
        """From here on the file is one from a GPU: four more axes, tunables, baselines, counters, device facts."""
        self.axes, self.backend = GPU_AXES, "cuda"
        self.baselines = dict(GPU_AXES)
        self.context |= {
            "ptbench.machine": "nvidia-h200",
            "ptbench.cpu_model": "Intel(R) Xeon(R) CPU E5-2690",
            "ptbench.backend": "cuda",
            "ptbench.threads": "16",
            "ptbench.cuda_device": "NVIDIA H200",
            "ptbench.cuda_compute_capability": "9.0",
            "ptbench.cuda_multiprocessors": "132",
            "ptbench.cuda_clock_mhz": "1980",
            "ptbench.cuda_driver": "13.0",
            "ptbench.cuda_nvrtc": "13.1",
        }
        return self

    def study(self, name: str, figure: str | None = None, title: str = "") -> Builder:
        self.studies.append({"name": name, "figure": figure or name, "title": title})
        return self

    def cell(
        self,
        study: str | None,
        scene: str = "cornell_open",
        ms_per_spp: float = 3.0,
        *,
        depth: int = 8,
        spp: int = 4,
        n: int = 9,
        noise: float = 0.02,
        live_paths: list[int] | None = None,
        axes: dict[str, str] | None = None,
        low_clock: int = 0,
        contended: int = 0,
        device_share: float = 0.9,
        error: str = "",
        clock_mhz: float = 3690.0,
        tunables: dict[str, int] | None = None,
        standards: dict[str, int] | None = None,
        sample_work: dict[str, float] | None = None,
        **fields,
    ) -> dict:
        """Adds a cell and its samples: `n` of them, from (1 - noise) to (1 + 3 noise) times the centre.

        On the GPU, `tunables` are those that differ from STANDARDS and `standards`; the latter may name more.
        """
        chosen = {**self.axes, **(axes or {})}
        variant = ".".join(chosen.values())
        usual = {**STANDARDS, **(standards or {})} if self.backend == "cuda" else {}
        tuned = {**usual, **(tunables or {})}
        variant += "".join(f"+{key}={value}" for key, value in tuned.items() if usual.get(key) != value)
        resolution = fields.pop("resolution", [200, 200])
        size = f"{resolution[0]}x{resolution[1]}"
        name = f"{variant}/scene:{scene}/backend:{self.backend}/resolution:{size}/depth:{depth}/spp:{spp}"
        cell = {
            "cell": name,
            "studies": [] if study is None else [study],
            "scene": scene,
            "scene_hash": "0123456789abcdef",
            "backend": self.backend,
            "variant": variant,
            "axes": chosen,
            "resolution": resolution,
            "depth": depth,
            "spp": spp,
            "status": "failed" if error else "ok",
            "reason": "",
            "claim": "bitwise",
            "claim_check": "film bits equal to the reference's",
            "film_hash": "fedcba9876543210",
            "mean_rgb": [0.1, 0.1, 0.1],
            "nonfinite": 0,
            "negative": 0,
            "saturated": 0,
            "unfinished_walks": 0,
            "features": ["axis_box"],
            "kernel_features": ["axis_box"],
            "specialisation_note": "exact",
        }
        if self.backend == "cuda":
            cell["tunables"] = tuned
            cell["counters"] = {"launches": 24 * spp, "graph_nodes": 0, "host_waits": 7 * spp, "connections": 0}
            cell["cuda"] = {
                "block": tuned["block"],
                "device_bytes": 3 << 20,
                "path_bytes": 96,
                "prepare_ms": 0.5,
                "options": ["--gpu-architecture=sm_90", f"-DPT_BLOCK={tuned['block']}"],
                "kernels": {
                    "generate_paths": {"registers": 26, "local_bytes": 0, "shared_bytes": 0},
                    "intersect_paths": {"registers": 31, "local_bytes": 0, "shared_bytes": 4},
                    "shade_paths": {"registers": 40, "local_bytes": 8, "shared_bytes": 4},
                },
            }
        if live_paths is not None:
            cell["instrumented"] = {
                "live_paths": live_paths,
                "paths": live_paths[0],
                "spp": 1,
                "stage_ms": {"generate": 1.0, "intersect": 7.0, "shade": 4.0},
                "wall_ms": 13.2,
                "unaccounted_ms": 1.2,
            }
        cell.update(fields)
        self.cells.append(cell)
        paths = resolution[0] * resolution[1] * spp
        for index in range(n):
            row = {
                "name": name,
                "run_name": name,
                "run_type": "iteration",
                "repetitions": n,
                "repetition_index": index,
                "threads": 1,
                "iterations": 1,
                "time_unit": "ms",
            }
            if error:
                row |= {"real_time": 0.0, "cpu_time": 0.0, "error_occurred": True, "error_message": error}
            else:
                shift = 0.0 if n == 1 else noise * (2 * index / (n - 1) - 1)
                shift *= 3 if shift > 0 else 1
                wall = ms_per_spp * spp * (1 + shift)
                row |= {
                    "real_time": wall,
                    "cpu_time": 2 * wall,
                    "pt_wall_ms": wall,
                    "pt_device_ms": device_share * wall,
                    "pt_end_to_end_ms": wall + 3,
                    "pt_seed": float(index + 1),
                    "pt_spp": float(spp),
                    "pt_paths": float(paths),
                    "pt_rays": 4.0 * paths,
                    "pt_rays_per_second": 4.0 * paths / wall * 1e3,
                    "pt_order": float(index),
                    "pt_timestamp": 1.7e9 + index,
                    "pt_clock_mhz_before": clock_mhz,
                    "pt_clock_mhz_after": clock_mhz,
                    "pt_low_clock": 1.0 if index < low_clock else 0.0,
                    "pt_contended": 1.0 if index < contended else 0.0,
                }
                row |= {f"pt_{key}": value for key, value in (sample_work or {}).items()}
            self.rows.append(row)
        if n and not error:
            self.rows.append(
                {
                    "name": f"{name}_median",
                    "run_name": name,
                    "run_type": "aggregate",
                    "aggregate_name": "median",
                    "aggregate_unit": "time",
                    "real_time": ms_per_spp * spp,
                    "cpu_time": 2 * ms_per_spp * spp,
                    "time_unit": "ms",
                }
            )
        return cell

    def skip(self, study: str, scene: str, reason: str, axes: dict[str, str], tuned: str = "") -> Builder:
        chosen = {**self.axes, **axes}
        variant = ".".join(chosen.values()) + tuned
        entry = {"study": study, "scene": scene, "variant": variant, "axes": chosen, "reason": reason}
        self.not_applicable.append(entry)
        return self

    def document(self) -> dict:
        ptbench = {"studies": self.studies, "cells": self.cells, "not_applicable": self.not_applicable}
        if self.baselines is not None:
            ptbench["baselines"] = self.baselines
        return agreeing({"context": self.context, "benchmarks": self.rows, "ptbench": ptbench})

    def write(self, path: Path) -> Path:
        path.write_text(json.dumps(self.document(), indent=1), encoding="utf-8")
        return path


OPEN = [40000, 32682, 22608, 17480, 13922, 11235, 9123, 7438]
CLOSED = [40000, 39553, 38997, 38503, 38055, 37636, 37229, 36832]
LIVE = {"cornell_open": OPEN, "cornell_closed": CLOSED}


def crossing() -> Builder:
    """A study for each figure that follows a cost, on the GPU, with times whose crossovers are known by heart.

    With `none` taking b: `bucket` takes 1 + 0.8 b, so it is ahead where b is well above 5; `late` is half a millisecond
    slower everywhere, `always` a third faster.
    """
    builder = Builder("scaling").on_gpu()

    def choices(study: str, base: float, scene: str = "box", **where) -> None:
        for choice, time in (("none", base), ("bucket", 1 + 0.8 * base), ("late", base + 0.5), ("always", 0.7 * base)):
            builder.cell(study, scene, time, axes={"sorting": choice}, noise=0.01, **where)

    builder.study("scaling_by_resolution")
    for side in (64, 128, 256, 512):
        choices("scaling_by_resolution", 0.5 * (side / 64) ** 2, resolution=[side, side])
    builder.study("scaling_by_depth")
    for depth in (2, 4, 8, 16, 32, 64):
        choices("scaling_by_depth", depth / 2, depth=depth)
    builder.study("scaling_by_materials")
    for count in (1, 2, 4, 8, 16, 32, 64):
        choices("scaling_by_materials", 0.9 * count, f"materials_{count:02}")
    builder.study("scaling_by_shading_fmas")
    for fmas in (0, 16, 64, 256, 1024, 4096):
        choices("scaling_by_shading_fmas", 1 + fmas / 64, "heavy", tunables={"shading_fmas": fmas})
    return builder


def small(suite: str = "quick") -> Builder:
    """Two scenes, all five studies, everything well."""
    builder = Builder(suite)
    for name in ("remaining_paths", "sorting_by_depth", "first_bounce_by_depth", "compaction", "integrator"):
        builder.study(name)
    for scene, slower in (("cornell_open", 1.0), ("cornell_closed", 1.6)):
        builder.cell("remaining_paths", scene, slower * 3, live_paths=LIVE[scene], axes={"compaction": "scan"})
        for depth in (2, 4, 8):
            base = slower * 0.4 * depth
            shared = {"compaction": "thrust_remove_if"}
            both = builder.cell("sorting_by_depth", scene, base, depth=depth, axes=shared)
            both["studies"].append("first_bounce_by_depth")
            builder.cell("sorting_by_depth", scene, base * 3, depth=depth, axes=shared | {"sorting": "material"})
            cached = base * (1 - 0.3 / depth)
            builder.cell("first_bounce_by_depth", scene, cached, depth=depth, axes=shared | {"first_bounce": "cached"})
        for choice, factor in (("none", 1.0), ("thrust_remove_if", 1.05), ("thrust_partition", 1.4), ("scatter", 0.9)):
            builder.cell("compaction", scene, slower * 3 * factor, axes={"compaction": choice, "layout": "soa"})
        for integrator, factor in (("wavefront", 1.0), ("depth_first", 0.6)):
            axes = {"compaction": "gather", "integrator": integrator}
            builder.cell("integrator", scene, slower * 3 * factor, axes=axes)
    return builder


def rates_named(value: object, word: str) -> object:
    """What ptbench inspect wrote, with fields X_per_Y, or X_a_Y as in files of commit ede9627 and before."""
    if isinstance(value, dict):
        units = r"_(?:a|per)_(?=(?:ray|block|multiprocessor|second)$)"
        return {re.sub(units, f"_{word}_", key): rates_named(inner, word) for key, inner in value.items()}
    return [rates_named(item, word) for item in value] if isinstance(value, list) else value
