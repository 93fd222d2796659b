"""What each column of rows from result files says: for Parquet's columns, and as the page docs/columns.md.

The page is written by `python3 -m ptbench.tidy.descriptions > docs/columns.md`.
"""

import sys

from ptbench.tidy.columns import CATEGORY, FLAG, FROM_FILES, GROUPS, INTEGER, NUMBER, TEXT

# The meaning of each column. Where tables have a column of one name, it says one thing in all of them.
MEANINGS = {
    # the file
    "file": "path of the result file, as given",
    "machine": "the machine's name in results/",
    "suite": "suite that was run; `adhoc` where the command line said what; empty: a file of no suite",
    "commit": "commit of the program",
    "commit_dirty": "whether it had changes that were not committed",
    "date": "when the file was written",
    # what was measured
    "cell": "the cell's name, its key within the file",
    "studies": "studies that it belongs to, with commas between",
    "study": "a study of the suite",
    "scene": "the scene's name",
    "scene_hash": "hash of the scene's content",
    "backend": "`cpu` or `cuda`",
    "variant": "the variant's shown name",
    "AXES": "one column an axis (reference.md), its choice; missing: the file is older than the axis",
    "TUNABLES": "one column a tunable; missing: no choice of the variant has it",
    "width": "pixels",
    "height": "pixels",
    "depth": "ray segments in a path at most, the camera ray included",
    "spp": "samples a pixel of one timed render",
    "is_convergence": "whether errors are measured on the way",
    # status
    "status": "`ok`, `failed` or `interrupted`; of a check `passed`, `failed`, `known limit`, `n/a` or `broken`",
    "reason": "why it is not `ok`, or not applicable; empty if it is",
    # samples
    "repetition": "index of the sample within its cell, from 0",
    "seed": "of the render; samples of one repetition have one seed in all cells",
    "order": "place in time among all samples of the run, from 0",
    "timestamp": "when the sample ended, seconds since 1970-01-01 UTC",
    "wall_ms": "wall time, ms: of a sample's render, `spp` samples in every pixel; of a checkpoint since the start",
    "device_ms": "the same on the device's own clock, ms",
    "end_to_end_ms": "wall time with scene buffers and film, ms",
    "cpu_ms": "CPU time of all threads, ms",
    "ms_per_spp": "wall_ms / spp; of a verdict the median over samples",
    "mega_cycles_per_spp": "ms_per_spp times the clock round the render, 1e6 cycles; missing: no clock",
    "mega_rays_per_second": "rays over wall_ms, 1e6/s",
    "rays": "rays that were traced",
    "paths": "paths that were started",
    "clock_mhz_before": "clock before the render, MHz",
    "clock_mhz_after": "clock after it, MHz",
    "low_clock": "whether one of these is far below the file's highest (method.md)",
    "contended": "whether other processes, or a quota, took CPU time meanwhile",
    "foreign_cpu_ms": "CPU time that other processes took, ms",
    "throttled_periods": "periods in which a quota of CPU time was used up meanwhile",
    "throttled_ms": "for how long threads stood still for it, ms",
    "involuntary_switches": "times that the process had to give up a processor",
    "launches": "kernels, copies and graphs that the host enqueued",
    "graph_nodes": "nodes of the graphs that were launched",
    "host_waits": "times that the host waited for the device",
    # cells
    "claim": "what the variant claims of its image",
    "claim_check": "what verification found, in words",
    "film_hash": "hash of the film of the instrumented pass",
    "samples": "good samples",
    "failed_samples": "failed ones",
    "median_ms_per_spp": "median of the samples' ms_per_spp",
    "median_mega_rays_per_second": "median of the samples' mega_rays_per_second",
    "low_clock_samples": "samples with low_clock",
    "contended_samples": "samples with contended",
    "disturbed_samples": "contended ones whose time may be wrong for it",
    "nonfinite": "path samples that were infinite or no number",
    "negative": "path samples below 0",
    "saturated": "path samples brighter than the film holds",
    "unfinished_walks": "paths lost in a subsurface body whose cap they met",
    "instrumented_spp": "samples a pixel of the instrumented pass",
    "instrumented_wall_ms": "wall time of that pass, ms; it counts, so it is slower than samples",
    "COUNTERS": "one column a counter of the instrumented pass",
    "block": "threads a block",
    "device_bytes": "device memory of the render, bytes",
    "path_bytes": "of that a path in the queue, with all that compacts and sorts it, bytes",
    "path_state_bytes": "of path_bytes one copy of the path itself, bytes",
    "prepare_ms": "memory, upload and graph before the clock starts, ms",
    "mesh_triangles": "triangles of the scene's meshes",
    "mesh_nodes": "nodes of their trees; 0: every triangle in turn",
    "mesh_node_bytes": "of all nodes, bytes",
    "mesh_leaf_bytes": "of the triangles as leaves hold them, bytes",
    "mesh_sah_cost": "expected cost of a line through the largest tree (surface area heuristic)",
    "mesh_build_ms": "time of the builder, ms; in no sample",
    "mesh_encode_ms": "time to bring its tree into the accelerator's format, ms; in no sample",
    # verdicts
    "label": "the choice, and what else varies in the study",
    "is_baseline": "whether the others are held against it",
    "ms_per_spp_low": "lower end of the median's confidence interval (method.md)",
    "ms_per_spp_high": "upper end",
    "ratio": "time over the baseline's",
    "ratio_low": "lower end of its confidence interval",
    "ratio_high": "upper end",
    "verdict": "FASTER, SLOWER, SAME or UNSURE (method.md)",
    "verdict_reason": "why, in words",
    # stages, bounces, kernels
    "stage": "stage of the instrumented pass; missing: it has none",
    "stage_ms": "its time in the whole pass, ms",
    "stage_ms_per_spp": "stage_ms / instrumented_spp",
    "unaccounted_ms": "time of the pass in no stage, ms; below 0 where stages overlap",
    "bounce": "from 0, the camera ray's",
    "live_paths": "paths that traced this bounce's ray, in the instrumented pass",
    "live_share": "their share of all paths",
    "kernel": "function or kind of kernel",
    "registers": "registers a thread",
    "local_bytes": "local memory a thread, bytes",
    "shared_bytes": "static shared memory a block, bytes",
    # checkpoints
    "checkpoint_spp": "samples a pixel so far",
    "mse": "mean squared error against the reference, its noise included",
    "mse_dual": "the same against both halves of the reference, unbiased by its noise; may be below 0",
    "rel_mse": "mse relative to the reference's square, pixel by pixel (result-fields.md)",
    "rel_mse_dual": "the same of mse_dual",
    "smape": "symmetric mean absolute percentage error (result-fields.md)",
    "bias2": "squared bias from the render's two halves; may be below 0",
    "mean_error_r": "mean of x-r, red",
    "mean_error_g": "green",
    "mean_error_b": "blue",
    "shared": "whether the film has the bits of another cell's, whose errors these are",
    "shared_with": "that cell",
    "reference": "the reference's name",
    "reference_variance": "variance of a pixel and channel of it",
    "dual_error": "standard error that its noise alone gives to mse_dual",
    "independent_samples": "whether samples of a pixel know nothing of each other",
    "biases": "declared biases, with semicolons between",
    # ptbench stability
    "case": "the case's name",
    "catalogue": "its number in the project's catalogue of numerics",
    "family": "family of cases",
    "kind": "kind of case",
    "sweep": "what a sweep of cases varies",
    "point": "all parameters as text",
    "PARAMETERS": "one column a parameter of a case",
    "quantity": "what is measured; missing: nothing was",
    "relation": "how it is held to `exact`",
    "measured": "its value",
    "exact": "the exact one",
    "error": "how far off, as the relation has it",
    "allowed": "how far off it may be",
    "standard_error": "of a measured value that is random",
    "over_allowed": "error / allowed",
    "looks": "times that a random value was looked at",
    "must_pass": "whether ptbench claims that it passes",
    # ptbench rays
    "mesh": "the mesh's name",
    "triangles": "its triangles",
    "accelerator": "choice of the axis accelerator",
    "builder": "choice of the axis builder; missing: no tree is needed",
    "class": "class of rays: primary, shadow and so on",
    "query": "nearest hit, or any",
    "repetitions": "times that the batch was traced",
    "giga_rays_per_second": "median rate, 1e9/s",
    "giga_rays_per_second_low": "lower end of its confidence interval",
    "giga_rays_per_second_high": "upper end",
    "nodes_per_ray": "nodes that a ray visits",
    "boxes_per_ray": "boxes that it is held against",
    "triangles_per_ray": "triangles that it is held against",
    "active_lanes": "of a warp's 32, the mean (--counters)",
    "memory_stalls": "of the time of warps, waiting for what they loaded (--counters)",
    "bound": "the ceiling that the batch comes nearest to (--counters)",
    "nodes": "nodes of the tree",
    "node_bytes": "of all nodes, bytes",
    "leaf_bytes": "of the triangles as leaves hold them, bytes",
    "sah_cost": "expected cost of a line through the tree",
    "build_ms": "time of the builder, ms",
    "encode_ms": "time to bring its tree into the accelerator's format, ms",
    "device_build_ms": "median where the GPU built, ms",
    "device_encode_ms": "median where the GPU encoded, ms",
    "agree": "whether all batches of the class left the same hits",
}
_TYPES = {CATEGORY: "text", TEXT: "text", INTEGER: "whole number", NUMBER: "number", FLAG: "true, false"}
_HEAD = """# Every column of flat tables

Written by `python3 -m ptbench.tidy.descriptions` from the package's own tables; [results.md](results.md) is the guide.
The same tables are the data frames of `ptbench.frames`. A value that a file does not have is empty in CSV and null in
Parquet.
"""


def meaning_of(column: str) -> str:
    """The meaning of a column, also one that is named by what the files hold."""
    if column in MEANINGS:
        return MEANINGS[column]
    for stands_for, prefix in FROM_FILES.items():
        if prefix and column.startswith(prefix):
            return f"{column.removeprefix(prefix)}: {MEANINGS[stands_for]}"
    return "the variant's choice on this axis"


def page() -> str:
    """The page of all tables as Markdown."""
    parts = [_HEAD]
    for table, groups in GROUPS.items():
        columns = {name: kind for group in groups for name, kind in group.items()}
        lines = [f"| {_shown(name)} | {_TYPES[kind]} | {MEANINGS[name]} |\n" for name, kind in columns.items()]
        parts += [f"\n## {table}\n\n| column | type | meaning |\n|---|---|---|\n", *lines]
    return "".join(parts)


def _shown(name: str) -> str:
    if name not in FROM_FILES:
        return f"`{name}`"
    return f"`{FROM_FILES[name]}NAME`" if FROM_FILES[name] else "an axis"


if __name__ == "__main__":
    sys.stdout.write(page())
