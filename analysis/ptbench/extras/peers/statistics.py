"""Variance and time per sample of a renderer, and how two compare: medians of rounds, bootstraps over rounds and seeds.

The variance of a pixel's mean over N samples, across pictures of several seeds, is multiplied by N and averaged over
pixels and channels. A round's time is the median of its renders. Efficiency is 1 / (variance x time); ratios are of its
reciprocal, the cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.stats.estimates import SEED, Estimate, median_estimate, ratio_estimate
from ptbench.stats.intervals import bootstrap_interval, resampled


@dataclass(frozen=True)
class Measured:
    """A renderer's time per sample by round in ms, and its variance per sample by seed."""

    ms_per_spp: np.ndarray
    variance: np.ndarray

    @property
    def time(self) -> Estimate:
        """Milliseconds per sample per pixel, the median over rounds."""
        return median_estimate(self.ms_per_spp)

    @property
    def noise(self) -> Estimate:
        """Variance of one sample per pixel, the mean over pixels and channels."""
        drawn = self.variance[resampled(len(self.variance))].mean(axis=1)
        return bootstrap_interval(float(self.variance.mean()), drawn, len(self.variance))

    def time_over(self, base: Measured) -> Estimate:
        """This renderer's time per sample over that of the renderer `base`."""
        return ratio_estimate(self.ms_per_spp, base.ms_per_spp)

    def cost_over(self, base: Measured) -> Estimate:
        """This renderer's variance times time over that of `base`: how many times as long until the error is equal."""
        # One generator resamples times and variances of both renderers, so that the four bootstraps are independent.
        random = np.random.default_rng(SEED)
        drawn = self._drawn_cost(random) / base._drawn_cost(random)
        count = min(len(self.ms_per_spp), len(self.variance), len(base.ms_per_spp), len(base.variance))
        return bootstrap_interval(self.cost / base.cost, drawn, count)

    @property
    def cost(self) -> float:
        """Variance per sample times time per sample."""
        return float(np.median(self.ms_per_spp) * self.variance.mean())

    def _drawn_cost(self, random: np.random.Generator) -> np.ndarray:
        times = np.median(self.ms_per_spp[resampled(len(self.ms_per_spp), random)], axis=1)
        return times * self.variance[resampled(len(self.variance), random)].mean(axis=1)


def variance_of_seeds(images: np.ndarray, spp: int) -> list[float]:
    """Variance of one sample per pixel, one value per seed to be averaged; images: seeds, rows, columns, channels."""
    images = images.astype(np.float64)
    seeds = len(images)
    squares = ((images - images.mean(axis=0)) ** 2).mean(axis=(1, 2, 3))
    return (squares * spp * seeds / (seeds - 1)).tolist()


def by_round(samples: Sequence[dict]) -> np.ndarray:
    """Milliseconds per sample per pixel, one value per round."""
    rounds: dict[int, list[float]] = {}
    for sample in samples:
        rounds.setdefault(sample["round"], []).append(sample["ms"] / sample["spp"])
    return np.array([float(np.median(values)) for _, values in sorted(rounds.items())])
