"""The columns of tables made from result files: names with units, types, and meanings.

Units: _ms milliseconds, _mhz megahertz, _bytes.
"""

from collections.abc import Mapping, Sequence

# Column types by pandas' names: categories for names and choices that repeat; integers, flags and texts may be missing.
CATEGORY, INTEGER, NUMBER, FLAG, TEXT = "category", "Int64", "float64", "boolean", "string"

# The type and the meaning of each column, which is the same in every table that has the column.
COLUMNS = {
    # Columns about the result file.
    "file": (CATEGORY, "path of the result file, as given"),
    "machine": (CATEGORY, "the machine's name in results/"),
    "suite": (CATEGORY, "suite that was run; `adhoc` where the command line said what; empty: a file of no suite"),
    "commit": (CATEGORY, "commit of the program"),
    "commit_dirty": (FLAG, "whether it had changes that were not committed"),
    "date": (CATEGORY, "when the file was written"),
    # Columns that identify what was measured.
    "cell": (CATEGORY, "the cell's name, its key within the file"),
    "studies": (CATEGORY, "studies that it belongs to, with commas between"),
    "study": (CATEGORY, "a study of the suite"),
    "scene": (CATEGORY, "the scene's name"),
    "scene_hash": (CATEGORY, "hash of the scene's content"),
    "backend": (CATEGORY, "`cpu` or `cuda`"),
    "variant": (CATEGORY, "the variant's shown name"),
    "AXES": (CATEGORY, "one column an axis (reference.md), its choice; missing: the file is older than the axis"),
    "TUNABLES": (INTEGER, "one column a tunable; missing: no choice of the variant has it"),
    "width": (INTEGER, "pixels"),
    "height": (INTEGER, "pixels"),
    "depth": (INTEGER, "ray segments in a path at most, the camera ray included"),
    "spp": (INTEGER, "samples a pixel of one timed render"),
    "is_convergence": (FLAG, "whether errors are measured on the way"),
    # Columns about the status of a row.
    "status": (
        CATEGORY,
        "`ok`, `failed` or `interrupted`; of a check `passed`, `failed`, `known limit`, `n/a` or `broken`",
    ),
    "reason": (TEXT, "why it is not `ok`, or not applicable; empty if it is"),
    # Columns about timed samples.
    "repetition": (INTEGER, "index of the sample within its cell, from 0"),
    "seed": (INTEGER, "of the render; samples of one repetition have one seed in all cells"),
    "order": (INTEGER, "place in time among all samples of the run, from 0"),
    "timestamp": (NUMBER, "when the sample ended, seconds since 1970-01-01 UTC"),
    "wall_ms": (
        NUMBER,
        "wall time, ms: of a sample's render, `spp` samples in every pixel; of a checkpoint since the start",
    ),
    "device_ms": (NUMBER, "the same on the device's own clock, ms"),
    "end_to_end_ms": (NUMBER, "wall time with scene buffers and film, ms"),
    "cpu_ms": (NUMBER, "CPU time of all threads, ms"),
    "ms_per_spp": (NUMBER, "wall_ms / spp; of a verdict the median over samples"),
    "mega_cycles_per_spp": (NUMBER, "ms_per_spp times the clock round the render, 1e6 cycles; missing: no clock"),
    "mega_rays_per_second": (NUMBER, "rays over wall_ms, 1e6/s"),
    "rays": (NUMBER, "rays that were traced"),
    "paths": (NUMBER, "paths that were started"),
    "clock_mhz_before": (NUMBER, "clock before the render, MHz"),
    "clock_mhz_after": (NUMBER, "clock after it, MHz"),
    "low_clock": (FLAG, "whether one of these is far below the file's highest (method.md)"),
    "contended": (FLAG, "whether other processes, or a quota, took CPU time meanwhile"),
    "foreign_cpu_ms": (NUMBER, "CPU time that other processes took, ms"),
    "throttled_periods": (INTEGER, "periods in which a quota of CPU time was used up meanwhile"),
    "throttled_ms": (NUMBER, "for how long threads stood still for it, ms"),
    "involuntary_switches": (INTEGER, "times that the process had to give up a processor"),
    "launches": (INTEGER, "kernels, copies and graphs that the host enqueued"),
    "graph_nodes": (INTEGER, "nodes of the graphs that were launched"),
    "host_waits": (INTEGER, "times that the host waited for the device"),
    # Columns about cells.
    "claim": (CATEGORY, "what the variant claims of its image"),
    "claim_check": (TEXT, "what verification found, in words"),
    "film_hash": (CATEGORY, "hash of the film of the instrumented pass"),
    "samples": (INTEGER, "good samples"),
    "failed_samples": (INTEGER, "failed ones"),
    "median_ms_per_spp": (NUMBER, "median of the samples' ms_per_spp"),
    "median_mega_rays_per_second": (NUMBER, "median of the samples' mega_rays_per_second"),
    "low_clock_samples": (INTEGER, "samples with low_clock"),
    "contended_samples": (INTEGER, "samples with contended"),
    "disturbed_samples": (INTEGER, "contended ones whose time may be wrong for it"),
    "nonfinite": (INTEGER, "path samples that were infinite or no number"),
    "negative": (INTEGER, "path samples below 0"),
    "saturated": (INTEGER, "path samples brighter than the film holds"),
    "unfinished_walks": (INTEGER, "paths lost in a subsurface body whose cap they met"),
    "instrumented_spp": (INTEGER, "samples a pixel of the instrumented pass"),
    "instrumented_wall_ms": (NUMBER, "wall time of that pass, ms; it counts, so it is slower than samples"),
    "COUNTERS": (INTEGER, "one column a counter of the instrumented pass"),
    "block": (INTEGER, "threads a block"),
    "device_bytes": (INTEGER, "device memory of the render, bytes"),
    "path_bytes": (INTEGER, "of that a path in the queue, with all that compacts and sorts it, bytes"),
    "path_state_bytes": (INTEGER, "of path_bytes one copy of the path itself, bytes"),
    "prepare_ms": (NUMBER, "memory, upload and graph before the clock starts, ms"),
    "mesh_triangles": (INTEGER, "triangles of the scene's meshes"),
    "mesh_nodes": (INTEGER, "nodes of their trees; 0: every triangle in turn"),
    "mesh_node_bytes": (INTEGER, "of all nodes, bytes"),
    "mesh_leaf_bytes": (INTEGER, "of the triangles as leaves hold them, bytes"),
    "mesh_sah_cost": (NUMBER, "expected cost of a line through the largest tree (surface area heuristic)"),
    "mesh_build_ms": (NUMBER, "time of the builder, ms; in no sample"),
    "mesh_encode_ms": (NUMBER, "time to bring its tree into the accelerator's format, ms; in no sample"),
    # Columns about verdicts.
    "label": (CATEGORY, "the choice, and what else varies in the study"),
    "is_baseline": (FLAG, "whether the others are held against it"),
    "ms_per_spp_low": (NUMBER, "lower end of the median's confidence interval (method.md)"),
    "ms_per_spp_high": (NUMBER, "upper end"),
    "ratio": (NUMBER, "time over the baseline's"),
    "ratio_low": (NUMBER, "lower end of its confidence interval"),
    "ratio_high": (NUMBER, "upper end"),
    "verdict": (CATEGORY, "FASTER, SLOWER, SAME or UNSURE (method.md)"),
    "verdict_reason": (TEXT, "why, in words"),
    # Columns about stages, bounces and kernels of the instrumented pass.
    "stage": (CATEGORY, "stage of the instrumented pass; missing: it has none"),
    "stage_ms": (NUMBER, "its time in the whole pass, ms"),
    "stage_ms_per_spp": (NUMBER, "stage_ms / instrumented_spp"),
    "unaccounted_ms": (NUMBER, "time of the pass in no stage, ms; below 0 where stages overlap"),
    "bounce": (INTEGER, "from 0, the camera ray's"),
    "live_paths": (INTEGER, "paths that traced this bounce's ray, in the instrumented pass"),
    "live_share": (NUMBER, "their share of all paths"),
    "kernel": (CATEGORY, "function or kind of kernel"),
    "registers": (INTEGER, "registers a thread"),
    "local_bytes": (INTEGER, "local memory a thread, bytes"),
    "shared_bytes": (INTEGER, "static shared memory a block, bytes"),
    # Columns about checkpoints of convergence cells.
    "checkpoint_spp": (INTEGER, "samples a pixel so far"),
    "mse": (NUMBER, "mean squared error against the reference, its noise included"),
    "mse_dual": (NUMBER, "the same against both halves of the reference, unbiased by its noise; may be below 0"),
    "rel_mse": (NUMBER, "mse relative to the reference's square, pixel by pixel (result-fields.md)"),
    "rel_mse_dual": (NUMBER, "the same of mse_dual"),
    "smape": (NUMBER, "symmetric mean absolute percentage error (result-fields.md)"),
    "bias2": (NUMBER, "squared bias from the render's two halves; may be below 0"),
    "mean_error_r": (NUMBER, "mean of x-r, red"),
    "mean_error_g": (NUMBER, "green"),
    "mean_error_b": (NUMBER, "blue"),
    "shared": (FLAG, "whether the film has the bits of another cell's, whose errors these are"),
    "shared_with": (CATEGORY, "that cell"),
    "reference": (CATEGORY, "the reference's name"),
    "reference_variance": (NUMBER, "variance of a pixel and channel of it"),
    "dual_error": (NUMBER, "standard error that its noise alone gives to mse_dual"),
    "independent_samples": (FLAG, "whether samples of a pixel know nothing of each other"),
    "biases": (TEXT, "declared biases, with semicolons between"),
    # Columns about checks of `ptbench stability`.
    "case": (CATEGORY, "the case's name"),
    "catalogue": (CATEGORY, "its number in the project's catalogue of numerics"),
    "family": (CATEGORY, "family of cases"),
    "kind": (CATEGORY, "kind of case"),
    "sweep": (CATEGORY, "what a sweep of cases varies"),
    "point": (CATEGORY, "all parameters as text"),
    "PARAMETERS": (NUMBER, "one column a parameter of a case"),
    "quantity": (CATEGORY, "what is measured; missing: nothing was"),
    "relation": (CATEGORY, "how it is held to `exact`"),
    "measured": (NUMBER, "its value"),
    "exact": (NUMBER, "the exact one"),
    "error": (NUMBER, "how far off, as the relation has it"),
    "allowed": (NUMBER, "how far off it may be"),
    "standard_error": (NUMBER, "of a measured value that is random"),
    "over_allowed": (NUMBER, "error / allowed"),
    "looks": (INTEGER, "times that a random value was looked at"),
    "must_pass": (FLAG, "whether ptbench claims that it passes"),
    # Columns about batches of `ptbench rays`.
    "mesh": (CATEGORY, "the mesh's name"),
    "triangles": (INTEGER, "its triangles"),
    "accelerator": (CATEGORY, "choice of the axis accelerator"),
    "builder": (CATEGORY, "choice of the axis builder; missing: no tree is needed"),
    "class": (CATEGORY, "class of rays: primary, shadow and so on"),
    "query": (CATEGORY, "nearest hit, or any"),
    "repetitions": (INTEGER, "times that the batch was traced"),
    "giga_rays_per_second": (NUMBER, "median rate, 1e9/s"),
    "giga_rays_per_second_low": (NUMBER, "lower end of its confidence interval"),
    "giga_rays_per_second_high": (NUMBER, "upper end"),
    "nodes_per_ray": (NUMBER, "nodes that a ray visits"),
    "boxes_per_ray": (NUMBER, "boxes that it is held against"),
    "triangles_per_ray": (NUMBER, "triangles that it is held against"),
    "active_lanes": (NUMBER, "of a warp's 32, the mean (--counters)"),
    "memory_stalls": (NUMBER, "of the time of warps, waiting for what they loaded (--counters)"),
    "bound": (CATEGORY, "the ceiling that the batch comes nearest to (--counters)"),
    "nodes": (INTEGER, "nodes of the tree"),
    "node_bytes": (INTEGER, "of all nodes, bytes"),
    "leaf_bytes": (INTEGER, "of the triangles as leaves hold them, bytes"),
    "sah_cost": (NUMBER, "expected cost of a line through the tree"),
    "build_ms": (NUMBER, "time of the builder, ms"),
    "encode_ms": (NUMBER, "time to bring its tree into the accelerator's format, ms"),
    "device_build_ms": (NUMBER, "median where the GPU built, ms"),
    "device_encode_ms": (NUMBER, "median where the GPU encoded, ms"),
    "agree": (FLAG, "whether all batches of the class left the same hits"),
}


def _columns(names: str) -> dict[str, str]:
    """The types of the named columns."""
    return {name: COLUMNS[name][0] for name in names.split()}


FILE = _columns("file machine suite commit commit_dirty date")
IDENTITY = _columns("cell studies scene scene_hash backend variant AXES TUNABLES width height depth spp is_convergence")
STATUS = _columns("status reason")
SAMPLE = _columns(
    "repetition seed order timestamp wall_ms device_ms end_to_end_ms cpu_ms ms_per_spp mega_cycles_per_spp "
    "mega_rays_per_second rays paths clock_mhz_before clock_mhz_after low_clock contended foreign_cpu_ms "
    "throttled_periods throttled_ms involuntary_switches launches graph_nodes host_waits status reason"
)
CELL = _columns(
    "claim claim_check film_hash samples failed_samples median_ms_per_spp median_mega_rays_per_second "
    "low_clock_samples contended_samples disturbed_samples nonfinite negative saturated unfinished_walks "
    "instrumented_spp instrumented_wall_ms COUNTERS block device_bytes path_bytes path_state_bytes prepare_ms "
    "mesh_triangles mesh_nodes mesh_node_bytes mesh_leaf_bytes mesh_sah_cost mesh_build_ms mesh_encode_ms status "
    "reason"
)
# Rays of a batch are integers; a sample's rays are doubles, as Google Benchmark writes every counter.
RAYS = _columns(
    "backend mesh triangles accelerator builder class kernel query rays repetitions giga_rays_per_second "
    "giga_rays_per_second_low giga_rays_per_second_high nodes_per_ray boxes_per_ray triangles_per_ray "
    "active_lanes memory_stalls bound nodes node_bytes leaf_bytes sah_cost build_ms encode_ms device_build_ms "
    "device_encode_ms agree"
) | {"rays": INTEGER}
STAGE = _columns("stage stage_ms stage_ms_per_spp instrumented_spp instrumented_wall_ms unaccounted_ms status reason")
CHECKPOINT = _columns(
    "repetition seed checkpoint_spp wall_ms device_ms cpu_ms mse mse_dual rel_mse rel_mse_dual smape bias2 "
    "mean_error_r mean_error_g mean_error_b nonfinite shared shared_with reference reference_variance dual_error "
    "independent_samples biases status reason"
)
CHECK = _columns(
    "case catalogue family kind sweep point PARAMETERS variant AXES quantity relation measured exact error "
    "allowed standard_error over_allowed looks must_pass status reason"
)
LIVE_PATHS = _columns("bounce live_paths live_share status reason")
KERNEL = _columns("kernel registers local_bytes shared_bytes status reason")
LEFT_OUT = _columns("study scene variant AXES reason")
VERDICT = _columns(
    "study label is_baseline ms_per_spp ms_per_spp_low ms_per_spp_high ratio ratio_low ratio_high verdict "
    "verdict_reason status reason"
)
# Placeholders, in lists of columns, for columns that result files name, with the prefix of those columns' names.
FROM_FILES = {"AXES": "", "TUNABLES": "tunable_", "COUNTERS": "counter_", "PARAMETERS": "parameter_"}
# The columns of each table, in groups.
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
    """The types of a table's columns, in the groups' order; columns named by files replace their placeholders."""
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
        # Columns of axes have no prefix, so columns with any of the other prefixes are excluded.
        types |= {
            key: kind for key in found if key not in fixed and key.startswith(prefix) and not key.startswith(others)
        }
    return types
