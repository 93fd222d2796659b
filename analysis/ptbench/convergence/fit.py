"""The error law of a variant: MSE = bias^2 + sigma^2 / n, its slope by octave, and the mean error, one value per seed.

A cell has K seeds, each with errors at 1, 2, 4, ... samples per pixel. Everything rests on the dual-reference error,
whose expectation at n samples per pixel is bias^2 + sigma^2 / n, free of the reference's noise.
"""

from dataclasses import dataclass

import numpy as np

from ptbench.io.cells import Cell
from ptbench.io.convergence import CLOCKS, Reference
from ptbench.stats.estimates import Estimate
from ptbench.stats.intervals import LEVEL, half_width, jackknife, t_interval, t_test

LEAST_CHECKPOINTS = 3
# Number of last checkpoints that are fitted where samples depend on each other: the 1/n law holds only at the end.
_LAST_CHECKPOINTS = 4


@dataclass(frozen=True)
class Curve:
    """A cell's errors and times as arrays, with seeds as rows and checkpoints as columns."""

    cell: Cell
    seeds: tuple[int, ...]
    spp: np.ndarray
    mse: np.ndarray
    times: dict[str, np.ndarray]
    bias2: np.ndarray | None  # squared bias of each seed at the last checkpoint; None: not measured
    mean_error: np.ndarray | None  # mean error of each seed at the last checkpoint, for three channels
    incomplete: int = 0  # number of samples (timed repetitions) left out because checkpoints are missing
    nonfinite: int = 0  # pixels with a nonfinite value, over all samples and checkpoints
    nonfinite_at: str = ""

    @property
    def count(self) -> int:
        """The number of seeds of a curve."""
        return len(self.seeds)

    @property
    def mean(self) -> np.ndarray:
        """The mean squared error over seeds at each checkpoint."""
        return self.mse.mean(axis=0)

    @property
    def reference(self) -> Reference:
        """The reference image that the errors are measured against."""
        return self.cell.convergence.reference

    @property
    def independent(self) -> bool:
        """Whether the samples of the checkpoints are independent, as the fitted law assumes."""
        return self.cell.convergence.independent_samples

    @property
    def ms_per_spp(self) -> np.ndarray:
        """Milliseconds of wall time per sample per pixel, one value per seed."""
        return self.times["wall_ms"][:, -1] / self.spp[-1]


@dataclass(frozen=True)
class Slope:
    """The log-log slope d log MSE / d log n between `first` and `last` samples per pixel."""

    first: int
    last: int
    estimate: Estimate
    p: float | None = None  # p-value of the hypothesis that the log-log slope of the error is -1
    rejected: bool = False

    @property
    def is_flatter(self) -> bool:
        """Whether the error falls significantly more slowly than 1/spp."""
        return self.rejected and self.estimate.value > -1


@dataclass(frozen=True)
class Fit:
    """The error law fitted to one curve; arrays have one value per seed for resampling."""

    sigma2: Estimate
    bias2: Estimate
    bias2_of_fit: Estimate
    sigma2_of_seeds: np.ndarray
    bias2_of_seeds: np.ndarray
    slope: Slope | None
    octaves: tuple[Slope, ...]
    mean_error: tuple[Estimate, ...]


def curve_of(cell: Cell) -> Curve:
    """The curve of a cell's complete samples; missing errors are NaN."""
    spp = cell.convergence.checkpoints
    whole = [sample for sample in cell.samples if len(sample.checkpoints) == len(spp)]

    def table(value) -> np.ndarray:
        rows = [[value(checkpoint) for checkpoint in sample.checkpoints] for sample in whole]
        return np.array(rows, dtype=float).reshape(len(whole), len(spp))

    points = [(sample, checkpoint) for sample in whole for checkpoint in sample.checkpoints]
    bad = [(sample, checkpoint) for sample, checkpoint in points if checkpoint.nonfinite]
    bias2 = table(lambda checkpoint: checkpoint.errors["bias2"])[:, -1]
    last = [sample.checkpoints[-1].mean_error for sample in whole]
    return Curve(
        cell=cell,
        seeds=tuple(sample.repetition if sample.seed is None else sample.seed for sample in whole),
        spp=np.array(spp, dtype=float),
        mse=table(lambda checkpoint: checkpoint.errors["mse_dual"]),
        times={
            clock: table(lambda checkpoint, clock=clock: checkpoint.times[clock])
            for clock in CLOCKS
            if points and all(clock in checkpoint.times for _, checkpoint in points)
        },
        bias2=None if not whole or np.isnan(bias2).any() else bias2,
        mean_error=None if not whole or None in last else np.array(last, dtype=float),
        incomplete=len(cell.samples) - len(whole),
        nonfinite=sum(checkpoint.nonfinite for _, checkpoint in bad),
        nonfinite_at=f"{bad[0][1].spp} spp of seed {bad[0][0].seed}" if bad else "",
    )


def weights_of(mse: np.ndarray) -> np.ndarray:
    """Weights of the fit: 1 / variance of the error at each checkpoint.

    A few seeds estimate a variance badly, but relative spreads are much alike at all checkpoints, so each checkpoint's
    relative spread is taken to be at least the median one.
    """
    mean = np.abs(mse.mean(axis=0))
    spread = mse.std(axis=0, ddof=1) if len(mse) > 1 else np.zeros_like(mean)
    floor = np.where(mean > 0, mean, mean.max())
    if not floor.any():
        return np.ones_like(mean)
    floor = np.where(floor > 0, floor, floor.max())
    typical = float(np.median(spread / floor))
    # Seeds whose errors agree exactly get a relative spread of 1e-12, that of rounding.
    return 1 / np.maximum(spread, max(typical, 1e-12) * floor) ** 2


def fit_law(spp: np.ndarray, mse: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fits (bias², σ²) to each seed, and σ² with bias² held at 0 where the mean of the free fit is negative."""
    root = np.sqrt(weights_of(mse))
    design = np.stack([np.ones_like(spp), 1 / spp], axis=1) * root[:, None]
    size = np.linalg.norm(design, axis=0)
    bias2, sigma2 = (np.linalg.pinv(design / size) / size[:, None]) @ (mse * root).T
    if bias2.mean() >= 0:
        return bias2, sigma2, sigma2
    noise = design[:, 1]
    return bias2, sigma2, (mse * root) @ noise / (noise @ noise)


def slopes_of(curve: Curve) -> tuple[Slope | None, tuple[Slope, ...]]:
    """The slope over all checkpoints and the slopes by octave, where the error stands clear of its spread."""
    if curve.count < 2:
        return None, ()
    mean = curve.mean
    spread = curve.mse.std(axis=0, ddof=1) / np.sqrt(curve.count)
    # Slopes need errors clear of noise: heavy tails spoil the first checkpoints, and the reference's noise the last.
    clear = np.flatnonzero(mean > 3 * spread)
    if not len(clear) or (mean[clear[0] : clear[-1] + 1] <= 0).any():
        return None, ()
    first, last = int(clear[0]), int(clear[-1]) + 1
    octaves = tuple(_slope(curve, slice(index, index + 2)) for index in range(first, last - 1))
    return (_slope(curve, slice(first, last)) if last - first >= LEAST_CHECKPOINTS else None), octaves


def _slope(curve: Curve, part: slice) -> Slope:
    x = np.log(curve.spp[part])
    x = (x - x.mean()) / ((x - x.mean()) ** 2).sum()
    values = curve.mse[:, part]

    # The jackknife's mean without one seed may be negative where the reference's noise is large.
    lowest = 1e-3 * np.abs(values.mean(axis=0))

    def slope(mean: np.ndarray) -> float:
        return float(x @ np.log(np.maximum(mean, lowest)))

    value, error = jackknife(slope, values)
    freedom = curve.count - 1
    # The reference's noise shifts the squared errors of all seeds and checkpoints alike, and so widens the interval.
    offset = reference_error(curve.reference, curve.cell.pixels)
    common = offset * abs(float((x / np.maximum(values.mean(axis=0), lowest)).sum()))
    half = half_width(error, freedom, LEVEL, common)
    both, above = t_test(value, error, freedom, -1.0, common)
    estimate = Estimate(value, value - half, value + half, curve.count)
    return Slope(int(curve.spp[part][0]), int(curve.spp[part][-1]), estimate, both if curve.independent else above)


def reference_error(reference: Reference, pixels: int) -> float:
    """Standard error of the offset that the reference's noise adds to each dual error (mean of e1 e2 over pixels).

    The file's value is used if present; else pixels are assumed equally noisy, and a pixel's channels fully correlated.
    """
    if reference.is_exact:
        return 0.0
    if reference.dual_error is not None:
        return reference.dual_error
    return 2 * reference.variance / np.sqrt(pixels)


def mean_error_of_reference(reference: Reference, pixels: int) -> float:
    """The standard error that the reference's noise adds to one channel's mean error."""
    # The reference's variance is the mean of three channels'; the factor 3 allows that one channel has all of it.
    return 0.0 if reference.is_exact else float(np.sqrt(3 * reference.variance / pixels))


def fit_of(curve: Curve) -> Fit:
    """Fits variance, squared bias, slopes and mean error of a cell, each with its interval over seeds."""
    offset = reference_error(curve.reference, curve.cell.pixels)
    from_fit, _, sigma2 = fit_law(curve.spp, curve.mse)
    bias2 = curve.bias2
    if not curve.independent:
        last = slice(max(0, len(curve.spp) - _LAST_CHECKPOINTS), None)
        from_fit, _, _ = fit_law(curve.spp[last], curve.mse[:, last])
    if bias2 is None:
        bias2 = from_fit
    slope, octaves = slopes_of(curve)
    noise = mean_error_of_reference(curve.reference, curve.cell.pixels)
    channels = () if curve.mean_error is None else tuple(t_interval(c, LEVEL, noise) for c in curve.mean_error.T)
    return Fit(
        sigma2=t_interval(sigma2),
        bias2=t_interval(bias2, LEVEL, offset),
        bias2_of_fit=t_interval(from_fit, LEVEL, offset),
        sigma2_of_seeds=sigma2,
        bias2_of_seeds=bias2,
        slope=slope,
        octaves=octaves,
        mean_error=channels,
    )
