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

from collections.abc import Callable

import numpy as np

try:
    import pandas as pd
except ImportError as error:
    raise ImportError("ptbench.frames needs pandas: pip install pandas, or this package as [frames]") from error

from ptbench.tidy import columns, rows
from ptbench.tidy.rows import Files, Rows


def frame_of(table: Rows) -> pd.DataFrame:
    """A data frame of the rows, with typed columns in the order of `table.types`."""
    return pd.DataFrame(
        {name: _column([row.get(name) for row in table.rows], kind) for name, kind in table.types.items()},
        columns=list(table.types),
    )


def _framed(table: Callable[[Files], Rows]) -> Callable[[Files], pd.DataFrame]:
    """Wraps a function that returns rows as one that returns a data frame."""

    def framed(paths: Files) -> pd.DataFrame:
        return frame_of(table(paths))

    framed.__name__, framed.__doc__ = table.__name__, table.__doc__
    return framed


samples = _framed(rows.samples)
cells = _framed(rows.cells)
verdicts = _framed(rows.verdicts)
stages = _framed(rows.stages)
live_paths = _framed(rows.live_paths)
kernels = _framed(rows.kernels)
curves = _framed(rows.curves)
not_applicable = _framed(rows.not_applicable)
stability = _framed(rows.stability)
rays = _framed(rows.rays)


def _column(values: list, kind: str) -> pd.Series:
    if kind == columns.CATEGORY:
        # Categories are ordered by first appearance, as everywhere in ptbench.
        return pd.Series(pd.Categorical(values, categories=list(dict.fromkeys(v for v in values if v is not None))))
    if kind == columns.NUMBER:
        return pd.Series(np.array([np.nan if value is None else value for value in values], dtype=float))
    return pd.Series(values, dtype=kind)
