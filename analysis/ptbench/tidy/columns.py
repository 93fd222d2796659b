"""The columns of rows from result files: names, units in the names, and types.

Units: _ms milliseconds, _mhz megahertz, _bytes.
"""

from collections.abc import Mapping, Sequence

from ptbench.io.cells import WORK_COUNTERS
from ptbench.io.convergence import CLOCKS, METRICS

# Types by pandas' names. Names and choices repeat; a whole number, a truth value or a text may be missing.
CATEGORY, INTEGER, NUMBER, FLAG, TEXT = "category", "Int64", "float64", "boolean", "string"

FILE = {
    "file": CATEGORY,  # the path as given
    "machine": CATEGORY,
    "suite": CATEGORY,
    "commit": CATEGORY,
    "commit_dirty": FLAG,
    "date": CATEGORY,
}
IDENTITY = {
    "cell": CATEGORY,
    "studies": CATEGORY,  # joined by commas
    "scene": CATEGORY,
    "scene_hash": CATEGORY,
    "backend": CATEGORY,
    "variant": CATEGORY,
    "AXES": CATEGORY,
    "TUNABLES": INTEGER,
    "width": INTEGER,
    "height": INTEGER,
    "depth": INTEGER,
    "spp": INTEGER,
    "is_convergence": FLAG,
}
STATUS = {"status": CATEGORY, "reason": TEXT}
SAMPLE = {
    "repetition": INTEGER,
    "seed": INTEGER,
    "order": INTEGER,  # in which the run's samples were taken
    "timestamp": NUMBER,  # seconds since 1970
    "wall_ms": NUMBER,  # of the render, spp samples in every pixel
    "device_ms": NUMBER,
    "end_to_end_ms": NUMBER,
    "cpu_ms": NUMBER,  # of all threads
    "ms_per_spp": NUMBER,  # wall_ms / spp
    "mega_cycles_per_spp": NUMBER,  # ms_per_spp times the clock round the render
    "mega_rays_per_second": NUMBER,  # over wall_ms
    "rays": NUMBER,
    "paths": NUMBER,
    "clock_mhz_before": NUMBER,
    "clock_mhz_after": NUMBER,
    "low_clock": FLAG,
    "contended": FLAG,
    "foreign_cpu_ms": NUMBER,
    "throttled_periods": INTEGER,
    "throttled_ms": NUMBER,
    "involuntary_switches": INTEGER,
    **dict.fromkeys(WORK_COUNTERS, INTEGER),
    **STATUS,
}
CELL = {
    "claim": CATEGORY,
    "claim_check": TEXT,
    "film_hash": CATEGORY,
    "samples": INTEGER,
    "failed_samples": INTEGER,
    "median_ms_per_spp": NUMBER,
    "median_mega_rays_per_second": NUMBER,
    "low_clock_samples": INTEGER,
    "contended_samples": INTEGER,
    "disturbed_samples": INTEGER,  # contended ones whose time may be wrong for it
    "nonfinite": INTEGER,
    "negative": INTEGER,
    "saturated": INTEGER,
    "unfinished_walks": INTEGER,
    "instrumented_spp": INTEGER,
    "instrumented_wall_ms": NUMBER,
    "COUNTERS": INTEGER,  # of the instrumented pass
    "block": INTEGER,
    "device_bytes": INTEGER,
    "path_bytes": INTEGER,
    "path_state_bytes": INTEGER,
    "prepare_ms": NUMBER,
    # These columns are filled for scenes with meshes; builds and encodings are outside every sample's clock.
    "mesh_triangles": INTEGER,
    "mesh_nodes": INTEGER,
    "mesh_node_bytes": INTEGER,
    "mesh_leaf_bytes": INTEGER,
    "mesh_sah_cost": NUMBER,
    "mesh_build_ms": NUMBER,
    "mesh_encode_ms": NUMBER,
    **STATUS,
}
RAYS = {
    "backend": CATEGORY,
    "mesh": CATEGORY,
    "triangles": INTEGER,
    "accelerator": CATEGORY,
    "builder": CATEGORY,
    "class": CATEGORY,
    "kernel": CATEGORY,
    "query": CATEGORY,
    "rays": INTEGER,
    "repetitions": INTEGER,
    "giga_rays_per_second": NUMBER,  # median, and its 95 % interval
    "giga_rays_per_second_low": NUMBER,
    "giga_rays_per_second_high": NUMBER,
    "nodes_per_ray": NUMBER,
    "boxes_per_ray": NUMBER,
    "triangles_per_ray": NUMBER,
    "active_lanes": NUMBER,  # and the next two with --counters
    "memory_stalls": NUMBER,
    "bound": CATEGORY,
    "nodes": INTEGER,
    "node_bytes": INTEGER,
    "leaf_bytes": INTEGER,
    "sah_cost": NUMBER,
    "build_ms": NUMBER,
    "encode_ms": NUMBER,
    "device_build_ms": NUMBER,  # medians, where the GPU built
    "device_encode_ms": NUMBER,
    "agree": FLAG,  # all batches of the class left the same hits, and brute force's where they were held to it
}
STAGE = {
    "stage": CATEGORY,
    "stage_ms": NUMBER,  # of the whole pass
    "stage_ms_per_spp": NUMBER,
    "instrumented_spp": INTEGER,
    "instrumented_wall_ms": NUMBER,
    "unaccounted_ms": NUMBER,  # wall time in no stage; below zero where stages overlap
    **STATUS,
}
CHECKPOINT = {
    "repetition": INTEGER,
    "seed": INTEGER,
    "checkpoint_spp": INTEGER,
    **dict.fromkeys(CLOCKS, NUMBER),  # since the render's start
    **dict.fromkeys(METRICS, NUMBER),
    "mean_error_r": NUMBER,
    "mean_error_g": NUMBER,
    "mean_error_b": NUMBER,
    "nonfinite": INTEGER,
    "shared": FLAG,  # the errors were computed for another cell, whose film has the same bits
    "shared_with": CATEGORY,
    "reference": CATEGORY,
    "reference_variance": NUMBER,
    "dual_error": NUMBER,
    "independent_samples": FLAG,
    "biases": TEXT,  # declared ones, joined by semicolons
    **STATUS,
}
CHECK = {
    "case": CATEGORY,
    "catalogue": CATEGORY,
    "family": CATEGORY,
    "kind": CATEGORY,
    "sweep": CATEGORY,
    "point": CATEGORY,  # all parameters as text
    "PARAMETERS": NUMBER,
    "variant": CATEGORY,
    "AXES": CATEGORY,
    "quantity": CATEGORY,
    "relation": CATEGORY,
    "measured": NUMBER,
    "exact": NUMBER,
    "error": NUMBER,
    "allowed": NUMBER,
    "standard_error": NUMBER,
    "over_allowed": NUMBER,
    "looks": INTEGER,
    "must_pass": FLAG,
    **STATUS,
}
LIVE_PATHS = {"bounce": INTEGER, "live_paths": INTEGER, "live_share": NUMBER, **STATUS}
KERNEL = {
    "kernel": CATEGORY,
    "registers": INTEGER,
    "local_bytes": INTEGER,
    "shared_bytes": INTEGER,
    **STATUS,
}
LEFT_OUT = {"study": CATEGORY, "scene": CATEGORY, "variant": CATEGORY, "AXES": CATEGORY, "reason": TEXT}
VERDICT = {
    "study": CATEGORY,
    "label": CATEGORY,  # the choice and what else varies in the study
    "is_baseline": FLAG,
    "ms_per_spp": NUMBER,  # median, and its 95 % interval
    "ms_per_spp_low": NUMBER,
    "ms_per_spp_high": NUMBER,
    "ratio": NUMBER,  # time over the baseline's, and its 95 % interval
    "ratio_low": NUMBER,
    "ratio_high": NUMBER,
    "verdict": CATEGORY,
    "verdict_reason": TEXT,
    **STATUS,
}
# Columns whose names come from the files: what stands for them above, and what their names begin with.
FROM_FILES = {"AXES": "", "TUNABLES": "tunable_", "COUNTERS": "counter_", "PARAMETERS": "parameter_"}
# The columns of each table.
GROUPS = {
    "samples": (FILE, IDENTITY, SAMPLE),
    "cells": (FILE, IDENTITY, CELL),
    "verdicts": (FILE, IDENTITY, VERDICT),
    "stages": (FILE, IDENTITY, STAGE),
    "live_paths": (FILE, IDENTITY, LIVE_PATHS),
    "kernels": (FILE, IDENTITY, KERNEL),
    "curves": (FILE, IDENTITY, CHECKPOINT),
    "not_applicable": (FILE, LEFT_OUT),
    "stability": (FILE, CHECK),
    "rays": (FILE, RAYS),
}


def types_of(rows: Sequence[Mapping], *groups: Mapping[str, str]) -> dict[str, str]:
    """Types by column, in the groups' order; columns that the files name stand where the groups say."""
    planned = {name: kind for group in groups for name, kind in group.items()}
    found = dict.fromkeys(name for row in rows for name in row)
    fixed = planned.keys() - FROM_FILES.keys()
    types: dict[str, str] = {}
    for name, kind in planned.items():
        if name not in FROM_FILES:
            types[name] = kind
            continue
        prefix = FROM_FILES[name]
        others = tuple(other for other in FROM_FILES.values() if other and other != prefix)
        # A column without a prefix is an axis, which is what is left.
        types |= {
            key: kind for key in found if key not in fixed and key.startswith(prefix) and not key.startswith(others)
        }
    return types
