"""Result files as pandas data frames, for plots and statistics of one's own.

    from analysis import frames

    frames.samples(paths)         one row a timed sample
    frames.cells(paths)           one row a cell: what was run, its medians, its counters, its status
    frames.stages(paths)          one row a cell and stage of the instrumented pass
    frames.live_paths(paths)      one row a cell and bounce
    frames.kernels(paths)         one row a cell and CUDA kernel
    frames.curves(paths)          one row a sample and checkpoint of convergence cells
    frames.not_applicable(paths)  one row a variant that was left out, with the reason
    frames.stability(paths)       one row a check of `ptbench stability`

`paths` is one path or several; files are checked as `analysis plots` checks them, and InputError says what is wrong in
one. Units are in the columns' names: _ms milliseconds, _mhz megahertz, _bytes. Names, choices and statuses are
categorical, counts are nullable integers (Int64), times are float64. A value that a file does not have is missing (NaN,
<NA>): an axis that the file is older than, a clock that was not measured, a tunable that no choice of the variant has.

Nothing is dropped: a sample that failed is a row with status "failed", the reason, and no times; so is every sample of
a cell that failed, since nobody knows what it timed. pandas itself drops rows with missing keys unless it is told
otherwise: group with `groupby(keys, observed=True, dropna=False)`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

try:
    import pandas as pd
except ImportError as error:
    raise ImportError("analysis.frames needs pandas: pip install pandas, or this package as [frames]") from error

from ptbench.errors import bad_value
from ptbench.io.cells import WORK_COUNTERS, Cell, Result, Sample
from ptbench.io.convergence import CLOCKS, METRICS, Checkpoint
from ptbench.io.nodes import Node, read_json, shown
from ptbench.io.results import result_of
from ptbench.io.stability import SCHEMA, Row, Stability, is_stability, stability_of

Paths = Path | str | Iterable[Path | str]

OK, FAILED = "ok", "failed"

_CATEGORY, _INTEGER, _NUMBER, _FLAG, _TEXT = "category", "Int64", "float64", "boolean", "string"

_FILE = {
    "file": _CATEGORY,  # the path as given
    "machine": _CATEGORY,
    "suite": _CATEGORY,
    "commit": _CATEGORY,
    "commit_dirty": _FLAG,
    "date": _CATEGORY,
}
_IDENTITY = {
    "cell": _CATEGORY,
    "studies": _CATEGORY,  # joined by commas
    "scene": _CATEGORY,
    "scene_hash": _CATEGORY,
    "backend": _CATEGORY,
    "variant": _CATEGORY,
    "AXES": _CATEGORY,
    "TUNABLES": _INTEGER,
    "width": _INTEGER,
    "height": _INTEGER,
    "depth": _INTEGER,
    "spp": _INTEGER,
    "is_convergence": _FLAG,
}
_STATUS = {"status": _CATEGORY, "reason": _TEXT}
_SAMPLE = {
    "repetition": _INTEGER,
    "seed": _INTEGER,
    "order": _INTEGER,  # in which the run's samples were taken
    "timestamp": _NUMBER,  # seconds since 1970
    "wall_ms": _NUMBER,  # of the render, spp samples in every pixel
    "device_ms": _NUMBER,
    "end_to_end_ms": _NUMBER,
    "cpu_ms": _NUMBER,  # of all threads
    "ms_per_spp": _NUMBER,  # wall_ms / spp
    "mega_cycles_per_spp": _NUMBER,  # ms_per_spp times the clock round the render
    "mega_rays_per_second": _NUMBER,  # over wall_ms
    "rays": _NUMBER,
    "paths": _NUMBER,
    "clock_mhz_before": _NUMBER,
    "clock_mhz_after": _NUMBER,
    "low_clock": _FLAG,
    "contended": _FLAG,
    "foreign_cpu_ms": _NUMBER,
    "involuntary_switches": _INTEGER,
    **dict.fromkeys(WORK_COUNTERS, _INTEGER),
    **_STATUS,
}
_CELL = {
    "claim": _CATEGORY,
    "claim_check": _TEXT,
    "film_hash": _CATEGORY,
    "samples": _INTEGER,
    "failed_samples": _INTEGER,
    "median_ms_per_spp": _NUMBER,
    "median_mega_rays_per_second": _NUMBER,
    "low_clock_samples": _INTEGER,
    "contended_samples": _INTEGER,
    "disturbed_samples": _INTEGER,  # contended ones whose time may be wrong for it
    "nonfinite": _INTEGER,
    "negative": _INTEGER,
    "saturated": _INTEGER,
    "unfinished_walks": _INTEGER,
    "instrumented_spp": _INTEGER,
    "instrumented_wall_ms": _NUMBER,
    "COUNTERS": _INTEGER,  # of the instrumented pass
    "block": _INTEGER,
    "device_bytes": _INTEGER,
    "path_bytes": _INTEGER,
    "path_state_bytes": _INTEGER,
    "prepare_ms": _NUMBER,
    **_STATUS,
}
_STAGE = {
    "stage": _CATEGORY,
    "stage_ms": _NUMBER,  # of the whole pass
    "stage_ms_per_spp": _NUMBER,
    "instrumented_spp": _INTEGER,
    "instrumented_wall_ms": _NUMBER,
    "unaccounted_ms": _NUMBER,  # wall time in no stage; below zero where stages overlap
    **_STATUS,
}
_CHECKPOINT = {
    "repetition": _INTEGER,
    "seed": _INTEGER,
    "checkpoint_spp": _INTEGER,
    **dict.fromkeys(CLOCKS, _NUMBER),  # since the render's start
    **dict.fromkeys(METRICS, _NUMBER),
    "mean_error_r": _NUMBER,
    "mean_error_g": _NUMBER,
    "mean_error_b": _NUMBER,
    "nonfinite": _INTEGER,
    "shared": _FLAG,  # the errors were computed for another cell, whose film has the same bits
    "shared_with": _CATEGORY,
    "reference": _CATEGORY,
    "reference_variance": _NUMBER,
    "dual_error": _NUMBER,
    "independent_samples": _FLAG,
    "biases": _TEXT,  # declared ones, joined by semicolons
    **_STATUS,
}
_CHECK = {
    "case": _CATEGORY,
    "catalogue": _CATEGORY,
    "family": _CATEGORY,
    "kind": _CATEGORY,
    "sweep": _CATEGORY,
    "point": _CATEGORY,  # all parameters as text
    "PARAMETERS": _NUMBER,
    "variant": _CATEGORY,
    "AXES": _CATEGORY,
    "quantity": _CATEGORY,
    "relation": _CATEGORY,
    "measured": _NUMBER,
    "exact": _NUMBER,
    "error": _NUMBER,
    "allowed": _NUMBER,
    "standard_error": _NUMBER,
    "over_allowed": _NUMBER,
    "looks": _INTEGER,
    "must_pass": _FLAG,
    **_STATUS,
}
# Columns whose names come from the files: what stands for them above, and what their names begin with.
_FROM_FILES = {"AXES": "", "TUNABLES": "tunable_", "COUNTERS": "counter_", "PARAMETERS": "parameter_"}


def samples(paths: Paths) -> pd.DataFrame:
    """One row a timed sample, failed ones too; a cell without a sample has no row here, but one in `cells`."""
    rows = []
    for result, cell in _cells(paths):
        identity = _identity(result, cell)
        rows += [identity | _sample(cell, sample) for sample in cell.samples]
        rows += [identity | failure for failure in _failures(cell)]
    return _frame(rows, _FILE, _IDENTITY, _SAMPLE)


def cells(paths: Paths) -> pd.DataFrame:
    """One row a cell. Medians are of its good samples, missing for a failed cell."""
    return _frame([_identity(result, cell) | _cell(cell) for result, cell in _cells(paths)], _FILE, _IDENTITY, _CELL)


def stages(paths: Paths) -> pd.DataFrame:
    """One row a cell and stage of the instrumented pass, which counts and is slower than the timed samples.

    A cell that never got to that pass, or whose pass has no stages, is one row without a stage.
    """
    rows = []
    for result, cell in _cells(paths):
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
    return _frame(rows, _FILE, _IDENTITY, _STAGE)


def live_paths(paths: Paths) -> pd.DataFrame:
    """One row a cell and bounce (from 0, the camera ray's): paths alive, and their share of all, in the instrumented
    pass."""
    rows = []
    for result, cell in _cells(paths):
        done = cell.instrumented
        for bounce, alive in enumerate(done.live_paths if done is not None else ()):
            counted = {"bounce": bounce, "live_paths": alive, "live_share": alive / done.paths}
            rows.append(_identity(result, cell) | _status(cell) | counted)
    columns = {"bounce": _INTEGER, "live_paths": _INTEGER, "live_share": _NUMBER, **_STATUS}
    return _frame(rows, _FILE, _IDENTITY, columns)


def kernels(paths: Paths) -> pd.DataFrame:
    """One row a cell and CUDA kernel: registers and local memory a thread, shared memory a block."""
    rows = []
    for result, cell in _cells(paths):
        for name, kernel in (cell.cuda.kernels if cell.cuda is not None else {}).items():
            made = {"kernel": name, "registers": kernel.registers}
            made |= {"local_bytes": kernel.local_bytes, "shared_bytes": kernel.shared_bytes}
            rows.append(_identity(result, cell) | _status(cell) | made)
    columns = {"kernel": _CATEGORY, "registers": _INTEGER, "local_bytes": _INTEGER, "shared_bytes": _INTEGER}
    return _frame(rows, _FILE, _IDENTITY, columns | _STATUS)


def curves(paths: Paths) -> pd.DataFrame:
    """One row a sample and checkpoint of the convergence cells; a failed sample is one row without a checkpoint."""
    rows = []
    for result, cell in _cells(paths):
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
    return _frame(rows, _FILE, _IDENTITY, _CHECKPOINT)


def not_applicable(paths: Paths) -> pd.DataFrame:
    """One row a study, scene and variant that was left out before the run."""
    rows = [
        _of_file(result)
        | item.axes
        | {"study": item.study, "scene": item.scene, "variant": item.variant, "reason": item.reason}
        for result in _results(paths)
        for item in result.not_applicable
    ]
    columns = {"study": _CATEGORY, "scene": _CATEGORY, "variant": _CATEGORY, "AXES": _CATEGORY, "reason": _TEXT}
    return _frame(rows, _FILE, columns)


def stability(paths: Paths) -> pd.DataFrame:
    """One row a check of `ptbench stability`; numbers that are not finite are NaN or infinite, as they came out.

    A check that measured nothing (n/a, broken) has no `quantity`: that tells it from one that measured NaN.
    """
    rows = []
    for node in _nodes(paths):
        if not is_stability(node):
            raise bad_value(node.file, "$.schema", "nothing", f'"{SCHEMA}", a result of `ptbench stability`')
        known = stability_of(node)
        rows += [_of_file(known) | _check(row) for row in known.rows]
    return _frame(rows, _FILE, _CHECK)


def _nodes(paths: Paths) -> Iterator[Node]:
    several = [paths] if isinstance(paths, (str, Path)) else paths
    return (read_json(Path(path)) for path in several)


def _results(paths: Paths) -> Iterator[Result]:
    for node in _nodes(paths):
        if is_stability(node):
            found = shown(node.fields()["schema"])
            raise bad_value(
                node.file, "$.schema", found, "a result of `ptbench run`; analysis.frames.stability reads it"
            )
        yield result_of(node)


def _cells(paths: Paths) -> Iterator[tuple[Result, Cell]]:
    return ((result, cell) for result in _results(paths) for cell in result.cells)


def _of_file(result: Result | Stability) -> dict:
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
    """A failed cell's is "failed", whatever the file says of it otherwise."""
    return {"status": FAILED, "reason": cell.failure} if cell.failed else {"status": cell.status, "reason": cell.reason}


def _sample(cell: Cell, sample: Sample) -> dict:
    told = {"repetition": sample.repetition, "seed": sample.seed, "order": sample.order, "timestamp": sample.timestamp}
    if cell.failed:
        return told | {"status": FAILED, "reason": cell.failure}
    columns = _SAMPLE.keys() - _STATUS.keys() - sample.work.keys() - set(WORK_COUNTERS)
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


def _frame(rows: Sequence[dict], *groups: dict[str, str]) -> pd.DataFrame:
    """Rows as typed columns, in the groups' order; columns that the files name stand where the groups say."""
    planned = {name: kind for group in groups for name, kind in group.items()}
    found = dict.fromkeys(name for row in rows for name in row)
    fixed = planned.keys() - _FROM_FILES.keys()
    types: dict[str, str] = {}
    for name, kind in planned.items():
        if name not in _FROM_FILES:
            types[name] = kind
            continue
        prefix = _FROM_FILES[name]
        others = tuple(other for other in _FROM_FILES.values() if other and other != prefix)
        # An axis has no prefix: it is what is left.
        types |= {
            key: kind for key in found if key not in fixed and key.startswith(prefix) and not key.startswith(others)
        }
    columns = {name: _column([row.get(name) for row in rows], kind) for name, kind in types.items()}
    return pd.DataFrame(columns, columns=list(types))


def _column(values: list, kind: str) -> pd.Series:
    if kind == _CATEGORY:
        # In the order in which the values appear, as everything else orders them.
        return pd.Series(pd.Categorical(values, categories=list(dict.fromkeys(v for v in values if v is not None))))
    if kind == _NUMBER:
        return pd.Series(np.array([np.nan if value is None else value for value in values], dtype=float))
    return pd.Series(values, dtype=kind)
