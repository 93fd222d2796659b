"""The error at the last checkpoint weighed by render time, by MSE and by relMSE, without a fit, one value per seed.

harness/bench/error_table.cpp prints the same numbers at the end of a run. The two metrics weigh pixels differently: MSE
is dominated by the brightest, relMSE counts dark ones too, so an estimator may win by one and lose by the other. Both
metrics contain bias and noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.convergence.assessment import Assessment
from ptbench.io.cells import Cell
from ptbench.stats.estimates import Estimate
from ptbench.stats.intervals import bootstrap_interval, resampled
from ptbench.studies.disturbed import doubt_of

ERRORS = {"MSE": "mse_dual", "relMSE": "rel_mse_dual"}


@dataclass(frozen=True)
class LastErrors:
    """A cell's errors at its last checkpoint by metric, and its times, one value per seed."""

    cell: Cell
    seeds: tuple[int, ...]
    errors: dict[str, np.ndarray]
    ms_per_spp: np.ndarray
    timed: Cell  # cell whose times are used: the cell itself, or its companion rendered without checkpoints

    def mean(self, metric: str) -> float:
        """The mean error over seeds; the dual-reference error may make it negative."""
        return float(self.errors[metric].mean())

    def work(self, metric: str, drawn: np.ndarray) -> np.ndarray:
        """Error times render time, for each row of bootstrapped seeds."""
        ms = np.median(self.ms_per_spp[drawn], axis=1) * self.cell.spp
        return self.errors[metric][drawn].mean(axis=1) * ms

    def efficiency(self, baseline: LastErrors, metric: str) -> Estimate | None:
        """The baseline's error times time over this cell's; None where seeds differ or an error is not positive."""
        if self.seeds != baseline.seeds or self.mean(metric) <= 0 or baseline.mean(metric) <= 0:
            return None
        count = len(self.seeds)
        whole, drawn = np.arange(count)[None], resampled(count)
        value = float((baseline.work(metric, whole) / self.work(metric, whole))[0])
        return bootstrap_interval(value, baseline.work(metric, drawn) / self.work(metric, drawn), count)

    def doubt(self, baseline: LastErrors) -> str:
        """Why an efficiency has no verdict; empty: it may have one."""
        return doubt_of((self.timed, baseline.timed))


def last_errors(group: Sequence[Assessment]) -> dict[str, LastErrors]:
    """Errors at the last checkpoint of cells with two seeds or more; timed without checkpoints if all can be."""
    found = {one.cell.name: errors for one in group if (errors := _errors_of(one)) is not None}
    alone = {one.cell.name: one for one in group if one.ms_alone is not None}
    if all(name in alone and len(alone[name].ms_alone) == len(one.seeds) for name, one in found.items()):
        return {
            name: LastErrors(one.cell, one.seeds, one.errors, alone[name].ms_alone, alone[name].alone)
            for name, one in found.items()
        }
    return found


def _errors_of(assessment: Assessment) -> LastErrors | None:
    cell, curve = assessment.cell, assessment.curve
    if cell.failed or curve.incomplete or curve.count < 2:
        return None
    last = [sample.checkpoints[-1].errors for sample in cell.samples]
    values = {metric: [errors[key] for errors in last] for metric, key in ERRORS.items()}
    if any(value is None for column in values.values() for value in column):
        return None
    errors = {metric: np.array(column, dtype=float) for metric, column in values.items()}
    return LastErrors(cell, curve.seeds, errors, curve.ms_per_spp, cell)
