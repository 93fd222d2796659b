"""Result files as rows, each a dictionary of plain values by column; `ptbench.frames` makes pandas tables of them.

Nothing is dropped: a failed sample is a row with status "failed", the reason, and no times, and so is every sample of a
failed cell, since nobody knows what it timed. Missing values are missing from the row.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.errors import InputError, bad_value
from ptbench.io.cells import WORK_COUNTERS, Cell, Result, Sample
from ptbench.io.convergence import Checkpoint
from ptbench.io.nodes import read_json, shown
from ptbench.io.rays import SCHEMA as RAYS_SCHEMA
from ptbench.io.rays import Batch, RayMesh, Rays, Tree, is_rays, rays_of
from ptbench.io.results import result_of
from ptbench.io.stability import SCHEMA, Row, Stability, is_stability, stability_of
from ptbench.stats.estimates import median_estimate
from ptbench.studies import rows as studies
from ptbench.tidy.columns import FLAG, GROUPS, INTEGER, NUMBER, SAMPLE, STATUS, types_of

# Files to tabulate, as paths or loaded: one or several.
Loaded = Result | Stability | Rays
Files = Path | str | Loaded | Iterable[Path | str | Loaded]

OK, FAILED = "ok", "failed"


@dataclass(frozen=True)
class Rows:
    """The rows of a table without missing values; `types` lists all columns in order."""

    rows: tuple[dict, ...]
    types: dict[str, str]

    def columns(self) -> dict[str, np.ndarray]:
        """The table as one array per column, each as long as the table.

        Numbers are float64 with NaN where missing; counts int64, or float64 with NaN if any is missing; flags bool, or
        objects with None if any is missing; texts are objects with None.
        """
        return {name: _array([row.get(name) for row in self.rows], kind) for name, kind in self.types.items()}


def _array(values: list, kind: str) -> np.ndarray:
    is_whole = None not in values
    if kind == NUMBER or (kind == INTEGER and not is_whole):
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    if kind == INTEGER:
        return np.array(values, dtype=np.int64)
    return np.array(values, dtype=bool if kind == FLAG and is_whole else object)


def samples(files: Files) -> Rows:
    """One row per timed sample, including failed ones; a cell without samples has a row in `cells` only."""
    rows = []
    for result, cell in _cells(files):
        identity = _identity(result, cell)
        rows += [identity | _sample(cell, sample) for sample in cell.samples]
        rows += [identity | failure for failure in _failures(cell)]
    return _rows(rows, "samples")


def cells(files: Files) -> Rows:
    """One row per cell; medians are over its valid samples, and missing for a failed cell."""
    return _rows([_identity(result, cell) | _cell(cell) for result, cell in _cells(files)], "cells")


def stages(files: Files) -> Rows:
    """One row per cell and stage of the instrumented pass, which counts and is slower than the timed samples.

    A cell without such a pass, or whose pass has no stages, is one row without a stage.
    """
    rows = []
    for result, cell in _cells(files):
        identity = _identity(result, cell) | _status(cell)
        done = cell.instrumented
        if done is None or not done.stage_ms:
            rows.append(identity)
            continue
        whole = {
            "instrumented_spp": done.spp,
            "instrumented_wall_ms": done.wall_ms,
            "unaccounted_ms": done.unaccounted_ms,
        }
        for stage, ms in done.stage_ms.items():
            rows.append(identity | whole | {"stage": stage, "stage_ms": ms, "stage_ms_per_spp": ms / done.spp})
    return _rows(rows, "stages")


def live_paths(files: Files) -> Rows:
    """One row per cell and bounce (from 0, the camera ray's): paths alive in the instrumented pass, and their share."""
    rows = []
    for result, cell in _cells(files):
        done = cell.instrumented
        for bounce, alive in enumerate(done.live_paths if done is not None else ()):
            counted = {"bounce": bounce, "live_paths": alive, "live_share": alive / done.paths}
            rows.append(_identity(result, cell) | _status(cell) | counted)
    return _rows(rows, "live_paths")


def kernels(files: Files) -> Rows:
    """One row per cell and CUDA kernel: registers and local memory per thread, shared memory per block."""
    rows = []
    for result, cell in _cells(files):
        for name, kernel in (cell.cuda.kernels if cell.cuda is not None else {}).items():
            made = {"kernel": name, "registers": kernel.registers}
            made |= {"local_bytes": kernel.local_bytes, "shared_bytes": kernel.shared_bytes}
            rows.append(_identity(result, cell) | _status(cell) | made)
    return _rows(rows, "kernels")


def curves(files: Files) -> Rows:
    """One row per sample and checkpoint of convergence cells; a failed sample is one row without a checkpoint."""
    rows = []
    for result, cell in _cells(files):
        if cell.convergence is None:
            continue
        known = cell.convergence
        identity = _identity(result, cell) | {
            "shared_with": known.shared_with or None,
            "reference": known.reference.name,
            "reference_variance": known.reference.variance,
            "dual_error": known.reference.dual_error,
            "independent_samples": known.independent_samples,
            "biases": "; ".join(known.biases),
        }
        for sample in cell.samples:
            drawn = {"repetition": sample.repetition, "seed": sample.seed} | _status(cell)
            if cell.failed or not sample.checkpoints:
                rows.append(identity | drawn)
                continue
            rows += [identity | drawn | _checkpoint(checkpoint) for checkpoint in sample.checkpoints]
        rows += [identity | failure for failure in _failures(cell)]
    return _rows(rows, "curves")


def not_applicable(files: Files) -> Rows:
    """One row per study, scene and variant that was left out before the run."""
    rows = [
        _of_file(result)
        | item.axes
        | {"study": item.study, "scene": item.scene, "variant": item.variant, "reason": item.reason}
        for result in _results(files)
        for item in result.not_applicable
    ]
    return _rows(rows, "not_applicable")


def stability(files: Files) -> Rows:
    """One row per check of `ptbench stability`, with numbers that may be NaN or infinite.

    A check without a measurement (n/a, broken) has no `quantity`, which tells it from one that measured NaN.
    """
    rows = []
    for known in load_files(files):
        if not isinstance(known, Stability):
            raise bad_value(known.path, "$.schema", "nothing", f'"{SCHEMA}", a result of `ptbench stability`')
        rows += [_of_file(known) | _check(row) for row in known.rows]
    return _rows(rows, "stability")


def verdicts(files: Files) -> Rows:
    """One row per study and cell: its median time, the ratio over the study's baseline, and the verdict.

    Intervals are those of every table and figure: 95 %, by bootstrap of the medians.
    """
    rows = []
    for result in _results(files):
        for study in result.studies:
            rows += [_identity(result, row.cell) | _verdict(study.name, row) for row in studies.measure(result, study)]
    return _rows(rows, "verdicts")


def rays(files: Files) -> Rows:
    """One row per batch of `ptbench rays`: mesh, tree, class of rays and kernel, with the rate."""
    rows = []
    for known in load_files(files):
        if not isinstance(known, Rays):
            raise bad_value(known.path, "$.schema", "another kind of file", f'"{RAYS_SCHEMA}", of `ptbench rays`')
        for mesh in known.meshes:
            of_mesh = {"backend": known.backend, "mesh": mesh.name, "triangles": mesh.triangles}
            for tree in mesh.trees:
                rows += [_of_file(known) | of_mesh | _tree(tree) | _batch(batch, mesh) for batch in tree.batches]
    return _rows(rows, "rays")


TABLES = {
    "samples": samples,
    "cells": cells,
    "verdicts": verdicts,
    "stages": stages,
    "live_paths": live_paths,
    "kernels": kernels,
    "curves": curves,
    "not_applicable": not_applicable,
    "stability": stability,
    "rays": rays,
}


def _tree(tree: Tree) -> dict:
    names = ("accelerator", "nodes", "node_bytes", "leaf_bytes", "sah_cost", "build_ms", "encode_ms")
    told = {name: getattr(tree, name) for name in names} | {"builder": tree.builder or None}
    for name in ("device_build_ms", "device_encode_ms"):
        if times := getattr(tree, name):
            told[name] = float(np.median(times))
    return told


def _batch(batch: Batch, mesh: RayMesh) -> dict:
    rate = median_estimate(batch.giga_rays_per_second)
    told = {name: getattr(batch, name) for name in ("kernel", "query", "rays")}
    told |= {name: getattr(batch, name) for name in ("nodes_per_ray", "boxes_per_ray", "triangles_per_ray")}
    if batch.counters is not None:
        told |= {name: getattr(batch.counters, name) for name in ("active_lanes", "memory_stalls", "bound")}
    told |= {"class": batch.ray_class, "repetitions": len(batch.ms), "agree": mesh.agree[batch.ray_class]}
    ends = {"giga_rays_per_second_low": rate.low, "giga_rays_per_second_high": rate.high}
    return told | {"giga_rays_per_second": rate.value} | ends


def _verdict(study: str, row: studies.Row) -> dict:
    told = {"study": study, "label": row.label, "is_baseline": row.is_baseline} | _status(row.cell)
    for name, estimate in (("ms_per_spp", row.estimate), ("ratio", row.ratio)):
        if estimate is not None:
            told |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
    if row.verdict is not None:
        told |= {"verdict": row.verdict.word, "verdict_reason": row.verdict.said}
    return told


def _rows(rows: Sequence[dict], table: str) -> Rows:
    return Rows(tuple(rows), types_of(rows, *GROUPS[table]))


def table_of(files: tuple[Loaded, ...], name: str = "") -> Rows:
    """The table of that name; by default "samples", or "stability" or "rays" for such files. Raises InputError."""
    kinds = {type(file) for file in files}
    name = name or ("stability" if Stability in kinds else "rays" if Rays in kinds else "samples")
    if name not in TABLES:
        raise InputError(f'found the table "{name}", allowed: {", ".join(TABLES)}')
    return TABLES[name](files)


def load_files(files: Files) -> tuple[Loaded, ...]:
    """Reads and checks each file that is not loaded yet; raises InputError."""
    several = [files] if isinstance(files, (str, Path, Result, Stability, Rays)) else files
    return tuple(_load(Path(one)) if isinstance(one, (str, Path)) else one for one in several)


def _load(path: Path) -> Loaded:
    root = read_json(path)
    if is_rays(root):
        return rays_of(root)
    return stability_of(root) if is_stability(root) else result_of(root)


def _results(files: Files) -> Iterator[Result]:
    for one in load_files(files):
        if isinstance(one, Stability):
            allowed = "a result of `ptbench run`; ptbench.frames.stability reads it"
            raise bad_value(one.path, "$.schema", shown(SCHEMA), allowed)
        if isinstance(one, Rays):
            raise bad_value(one.path, "$.schema", shown(RAYS_SCHEMA), "a result of `ptbench run`; it is for `rays`")
        yield one


def _cells(files: Files) -> Iterator[tuple[Result, Cell]]:
    return ((result, cell) for result in _results(files) for cell in result.cells)


def _of_file(result: Loaded) -> dict:
    return {
        "file": str(result.path),
        "machine": result.about("machine"),
        "suite": result.suite,
        "commit": result.about("git_sha"),
        "commit_dirty": result.context.get("ptbench.git_dirty", "").lower() in ("true", "1"),
        "date": result.context.get("date", ""),
    }


def _identity(result: Result, cell: Cell) -> dict:
    return {
        **_of_file(result),
        "cell": cell.name,
        "studies": ",".join(cell.studies),
        "scene": cell.scene,
        "scene_hash": cell.scene_hash,
        "backend": cell.backend,
        "variant": cell.variant,
        **cell.axes,
        **{f"tunable_{name}": value for name, value in cell.tunables.items()},
        "width": cell.resolution[0],
        "height": cell.resolution[1],
        "depth": cell.depth,
        "spp": cell.spp,
        "is_convergence": cell.convergence is not None,
    }


def _status(cell: Cell) -> dict:
    """The status of a cell or its sample; "failed" for all samples of a failed cell, whatever the file says."""
    return {"status": FAILED, "reason": cell.failure} if cell.failed else {"status": cell.status, "reason": cell.reason}


def _sample(cell: Cell, sample: Sample) -> dict:
    told = {"repetition": sample.repetition, "seed": sample.seed, "order": sample.order, "timestamp": sample.timestamp}
    if cell.failed:
        return told | {"status": FAILED, "reason": cell.failure}
    columns = SAMPLE.keys() - STATUS.keys() - sample.work.keys() - set(WORK_COUNTERS)
    measured = {name: getattr(sample, name) for name in columns}
    return told | measured | sample.work | {"status": OK, "reason": ""}


def _failures(cell: Cell) -> list[dict]:
    return [
        {"repetition": repetition, "status": FAILED, "reason": message or cell.failure}
        for repetition, message in zip(cell.failed_repetitions, cell.errors, strict=True)
    ]


def _cell(cell: Cell) -> dict:
    names = ("claim", "claim_check", "film_hash", "low_clock_samples", "contended_samples", "disturbed_samples")
    faults = ("nonfinite", "negative", "saturated", "unfinished_walks")
    row = {name: getattr(cell, name) for name in (*names, *faults)}
    row |= {"samples": len(cell.samples), "failed_samples": len(cell.errors)}
    row |= {f"counter_{name}": count for name, count in cell.counters.items()}
    if cell.measured:
        row["median_ms_per_spp"] = float(np.median(cell.ms_per_spp))
        row["median_mega_rays_per_second"] = float(np.median([s.mega_rays_per_second for s in cell.samples]))
    if cell.instrumented is not None:
        row |= {"instrumented_spp": cell.instrumented.spp, "instrumented_wall_ms": cell.instrumented.wall_ms}
    if cell.cuda is not None:
        facts = ("block", "device_bytes", "path_bytes", "path_state_bytes", "prepare_ms")
        row |= {name: getattr(cell.cuda, name) for name in facts}
    if cell.meshes is not None:
        row |= {f"mesh_{name}": value for name, value in vars(cell.meshes).items()}
    return row | _status(cell)


def _checkpoint(checkpoint: Checkpoint) -> dict:
    channels = checkpoint.mean_error or (None, None, None)
    return {
        "checkpoint_spp": checkpoint.spp,
        **checkpoint.times,
        **checkpoint.errors,
        **dict(zip(("mean_error_r", "mean_error_g", "mean_error_b"), channels, strict=True)),
        "nonfinite": checkpoint.nonfinite,
        "shared": checkpoint.shared,
    }


def _check(row: Row) -> dict:
    case, measured = row.case, row.measured
    told = {name: getattr(case, name) for name in ("catalogue", "family", "kind", "sweep")}
    told |= {"case": case.name, "point": ", ".join(f"{name}={value:g}" for name, value in row.point)}
    told |= {f"parameter_{name}": value for name, value in row.point}
    told |= {"variant": row.variant, **row.axes, "looks": row.looks, "must_pass": row.must_pass}
    told |= {"status": row.status, "reason": row.reason}
    if measured is not None:
        names = ("quantity", "relation", "exact", "error", "allowed", "standard_error", "over_allowed")
        told |= {"measured": measured.value} | {name: getattr(measured, name) for name in names}
    return told
