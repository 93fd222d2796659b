"""The cost of one cell over another: in time, in time to equal error, or in variance alone."""

from collections.abc import Mapping

from ptbench.convergence.assessment import Assessment
from ptbench.convergence.efficiency import compare
from ptbench.io.cells import Cell
from ptbench.stats.estimates import Estimate, inverse, ratio_estimate
from ptbench.stats.intervals import bootstrap_interval, resampled

# Costs by which estimators are compared: variance alone if verdicts on time are withdrawn (studies/withdrawn.py).
TIME, WORK, VARIANCE = "time", "time to equal error", "variance at equal samples"
_BIASED = "biased"


def cost_ratio(statistic: str, assessed: Mapping[str, Assessment], cell: Cell, base: Cell) -> Estimate | None:
    """The cost of a cell over a baseline by the named statistic; below 1 is better; None where it is undefined."""
    if statistic == TIME:
        return ratio_estimate(cell.ms_per_spp, base.ms_per_spp)
    if cell.name not in assessed or base.name not in assessed or cell.claim == _BIASED:
        return None
    ours, theirs = assessed[cell.name], assessed[base.name]
    if statistic == WORK:
        return _work(ours, theirs)
    if ours.fit is None or theirs.fit is None:
        return None
    own, other = ours.fit.sigma2_of_seeds, theirs.fit.sigma2_of_seeds
    if len(own) != len(other) or min(own.mean(), other.mean()) <= 0:
        return None
    rows = resampled(len(own))
    return bootstrap_interval(
        float(own.mean() / other.mean()), own[rows].mean(axis=1) / other[rows].mean(axis=1), len(own)
    )


def _work(ours: Assessment, theirs: Assessment) -> Estimate | None:
    compared = compare(ours, theirs)
    efficiency = None if compared is None else compared.efficiency
    if efficiency is None or efficiency.value <= 0 or compared.doubt:
        return None
    return inverse(efficiency)
