"""Result files as pandas data frames, for plots and statistics of one's own.

    from ptbench import frames

    frames.samples(paths)         one row a timed sample
    frames.cells(paths)           one row a cell: what was run, its medians, its counters, its status
    frames.verdicts(paths)        one row a study and cell: its median, the ratio over the baseline, the verdict
    frames.stages(paths)          one row a cell and stage of the instrumented pass
    frames.live_paths(paths)      one row a cell and bounce
    frames.kernels(paths)         one row a cell and CUDA kernel
    frames.curves(paths)          one row a sample and checkpoint of convergence cells
    frames.not_applicable(paths)  one row a variant that was left out, with the reason
    frames.stability(paths)       one row a check of `ptbench stability`
    frames.rays(paths)            one row a batch of `ptbench rays`

`paths` is one path or several, or files that are loaded; they are checked as every command checks them, and InputError
says what is wrong in one. Units are in the columns' names: _ms milliseconds, _mhz megahertz, _bytes. Names, choices and
statuses are categorical, counts are nullable integers (Int64), times are float64. A value that a file does not have is
missing (NaN, <NA>): an axis that the file is older than, a clock that was not measured, a tunable that no choice of the
variant has.

Nothing is dropped: a sample that failed is a row with status "failed", the reason, and no times; so is every sample of
a cell that failed, since nobody knows what it timed. pandas itself drops rows with missing keys unless it is told
otherwise: group with `groupby(keys, observed=True, dropna=False)`.
"""

import numpy as np

try:
    import pandas as pd
except ImportError as error:
    raise ImportError("ptbench.frames needs pandas: pip install pandas, or this package as [frames]") from error

from ptbench.tidy import columns, rows
from ptbench.tidy.rows import Files, Rows


def samples(paths: Files) -> pd.DataFrame:
    """One row a timed sample, failed ones too; a cell without a sample has no row here, but one in `cells`."""
    return frame_of(rows.samples(paths))


def cells(paths: Files) -> pd.DataFrame:
    """One row a cell. Medians are of its good samples, missing for a failed cell."""
    return frame_of(rows.cells(paths))


def verdicts(paths: Files) -> pd.DataFrame:
    """One row a study and cell of it: its median time, the ratio over the study's baseline, and the verdict.

    Intervals are those of every table and figure: 95 %, by bootstrap of the medians.
    """
    return frame_of(rows.verdicts(paths))


def stages(paths: Files) -> pd.DataFrame:
    """One row a cell and stage of the instrumented pass, which counts and is slower than the timed samples.

    A cell that never got to that pass, or whose pass has no stages, is one row without a stage.
    """
    return frame_of(rows.stages(paths))


def live_paths(paths: Files) -> pd.DataFrame:
    """One row a cell and bounce (from 0, the camera ray's): paths alive, and their share of all, in the instrumented
    pass."""
    return frame_of(rows.live_paths(paths))


def kernels(paths: Files) -> pd.DataFrame:
    """One row a cell and CUDA kernel: registers and local memory a thread, shared memory a block."""
    return frame_of(rows.kernels(paths))


def curves(paths: Files) -> pd.DataFrame:
    """One row a sample and checkpoint of the convergence cells; a failed sample is one row without a checkpoint."""
    return frame_of(rows.curves(paths))


def not_applicable(paths: Files) -> pd.DataFrame:
    """One row a study, scene and variant that was left out before the run."""
    return frame_of(rows.not_applicable(paths))


def stability(paths: Files) -> pd.DataFrame:
    """One row a check of `ptbench stability`; numbers that are not finite are NaN or infinite, as they came out.

    A check that measured nothing (n/a, broken) has no `quantity`: that tells it from one that measured NaN.
    """
    return frame_of(rows.stability(paths))


def rays(paths: Files) -> pd.DataFrame:
    """One row a batch of `ptbench rays`: a mesh, a tree, a class of rays and a kernel, with its rate."""
    return frame_of(rows.rays(paths))


def frame_of(table: Rows) -> pd.DataFrame:
    """Rows as typed columns, in the order of `table.types`."""
    return pd.DataFrame(
        {name: _column([row.get(name) for row in table.rows], kind) for name, kind in table.types.items()},
        columns=list(table.types),
    )


def _column(values: list, kind: str) -> pd.Series:
    if kind == columns.CATEGORY:
        # Categories are in the order in which the values appear, as everything else orders them.
        return pd.Series(pd.Categorical(values, categories=list(dict.fromkeys(v for v in values if v is not None))))
    if kind == columns.NUMBER:
        return pd.Series(np.array([np.nan if value is None else value for value in values], dtype=float))
    return pd.Series(values, dtype=kind)
