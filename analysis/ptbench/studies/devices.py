"""Parallel efficiency of several GPUs in a host, from cells that differ in the axis `devices`.

Strong scaling renders the same image; weak scaling takes as many times the samples as there are GPUs. Either way the
efficiency is the speedup in samples per second over the number of GPUs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.io.axes import DEVICES, PARTITION
from ptbench.io.cells import Cell
from ptbench.stats.estimates import Estimate, median_estimate, ratio_estimate

WHOLE = "samples"  # choice of the axis partition by which each GPU renders the whole image


def devices_of(cell: Cell) -> int:
    """The number of GPUs that rendered the cell."""
    return int(cell.axes.get(DEVICES, "1"))


@dataclass(frozen=True)
class Scaled:
    """A cell on several GPUs beside the one-GPU cell that it is compared with."""

    cell: Cell
    one: Cell

    @property
    def efficiency(self) -> Estimate:
        """The parallel efficiency, including the film reduction."""
        return self._over(self.cell.ms_per_spp)

    @property
    def without_reduction(self) -> Estimate:
        """The parallel efficiency without the time of the film reduction."""
        return self._over(np.array([sample.render_ms / sample.spp for sample in self.cell.samples]))

    @property
    def reduce_ms(self) -> Estimate:
        """Milliseconds of the film reduction."""
        return median_estimate(np.array([sample.device_reduce_ms or 0.0 for sample in self.cell.samples]))

    @property
    def idle_share(self) -> Estimate:
        """The load imbalance: the GPUs' mean share of idle time until the slowest has rendered."""
        return median_estimate(np.array([1 - np.mean(s.own_device_ms) / s.render_ms for s in self.cell.samples]))

    @property
    def has_same_films(self) -> bool:
        """Whether samples of one seed left the same film on one and on several GPUs, bit for bit (strong scaling)."""
        theirs = {sample.seed: sample.film_hash for sample in self.one.samples}
        both = [sample for sample in self.cell.samples if sample.seed in theirs]
        return bool(both) and all(sample.film_hash == theirs[sample.seed] for sample in both)

    def _over(self, ms_per_spp: np.ndarray) -> Estimate:
        ratio, count = ratio_estimate(self.one.ms_per_spp, ms_per_spp), devices_of(self.cell)
        ends = (None if end is None else end / count for end in (ratio.low, ratio.high))
        return Estimate(ratio.value / count, *ends, ratio.n)


def strong(cells: Sequence[Cell]) -> list[Scaled]:
    """Strong scaling: every measured cell on several GPUs, beside the same cell on one GPU if that is measured."""
    return _scaled(cells, lambda cell: cell.spp)


def weak(cells: Sequence[Cell]) -> list[Scaled]:
    """Weak scaling: every cell on several GPUs, beside one GPU with its part of the samples."""
    return _scaled(cells, lambda cell: cell.spp / devices_of(cell))


def _scaled(cells: Sequence[Cell], spp_of_one) -> list[Scaled]:
    measured = [cell for cell in cells if cell.measured]
    ones = {_setting(cell, cell.spp): cell for cell in measured if devices_of(cell) == 1}
    several = [cell for cell in measured if devices_of(cell) > 1]
    found = [(cell, ones.get(_setting(cell, spp_of_one(cell)))) for cell in several]
    return [Scaled(cell, one) for cell, one in found if one is not None]


def _setting(cell: Cell, spp: float) -> tuple:
    axes = tuple(sorted((axis, of) for axis, of in cell.axes.items() if axis not in (DEVICES, PARTITION)))
    tunables = tuple(sorted(cell.tunables.items()))
    return cell.scene, cell.backend, cell.resolution, cell.depth, spp, axes, tunables
