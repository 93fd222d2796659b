"""Whether a variant converges to the right image, and what the seeds allow to say of it.

`assess` looks at all convergence cells of a file at once, because their tests share one error probability; RULES
explains the verdicts in words.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ptbench.convergence.fit import (
    LEAST_CHECKPOINTS,
    Curve,
    Fit,
    Slope,
    curve_of,
    fit_of,
    mean_error_of_reference,
    reference_error,
)
from ptbench.io.cells import Cell, Result
from ptbench.io.limits import limit
from ptbench.numbers import plural
from ptbench.stats.estimates import Estimate, median_estimate, telling_digits
from ptbench.stats.intervals import LEVEL_OF_OUTLIERS, half_width, holm, standard_error, stands_apart

CONVERGES, PLATEAU, NOISE_LIMITED, INVALID = "converges", "plateau", "noise-limited", "invalid"
# Suffix of the name of a cell whose film was evaluated at checkpoints after 1, 2, 4, .. samples per pixel.
CHECKPOINTS = "/checkpoints:octaves"
NO_VERDICT = "no verdict"
# Probability that any verdict on the errors of one result file is wrong.
LEVEL_OF_A_FILE = 0.01
LEAST_SEEDS = limit("fewest_seeds")
# Largest share of the squared error at the last checkpoint that an undetected bias may have in a "converging" variant.
MOST_HIDDEN = 0.1
# Log-log slope of the error over an octave of samples; above it, the error falls more slowly than averaged noise does.
FLAT_SLOPE = -0.9

RULES = (
    "Fit: MSE(n) = bias² + σ²/n by weighted least squares over the checkpoints, weights from the spread between seeds, "
    "σ² alone where bias² comes out below 0; one fit a seed with common weights, so that the intervals (95 %, t over "
    "seeds) need no independence of checkpoints. bias² itself: the cross product of a run's halves at the last "
    "checkpoint, mean over seeds; with samples that are not independent, what the fit of the last 4 checkpoints leaves "
    "(a lower bound).",
    f"Verdicts hold over the whole file with probability {1 - LEVEL_OF_A_FILE:.0%} (Bonferroni over its distinct error "
    "curves; half of it for bias², half for the image's mean error in three channels); the uncertainty of the "
    "reference, common to all seeds, is in the intervals. **plateau at B**: the interval of bias² lies above 0, B its "
    "root; or that of the mean error excludes 0, B at least its root mean square. "
    f"**converges**: neither, the upper end of bias² is at most {MOST_HIDDEN:.0%} of σ²/N at the last checkpoint N, "
    "and the error does not fall significantly slower than 1/n. **noise-limited**: no bias was found, but one of more "
    f"than {MOST_HIDDEN:.0%} of the last squared error could be there, or the error falls too slowly: more spp, seeds "
    "or pixels, or a better reference would tell. **invalid**: a pixel was not finite.",
    "Slope: d log MSE / d log n, jackknife over seeds of the logarithm of their mean; the reference's uncertainty, "
    "which moves all checkpoints alike, is in its interval. It is tested against -1 over all "
    f"distinct error curves (Holm, family-wise {LEVEL_OF_A_FILE:.0%}); samples that are not independent only against "
    "being flatter.",
)


@dataclass(frozen=True)
class Verdict:
    """Whether the error keeps falling, and at which root of the dual squared error it stops."""

    word: str
    reason: str = ""
    plateau: float | None = None  # root mean square error at which the error stops falling, the bias B
    declared: bool = False  # whether the plateau is expected, because the cell declares a bias
    is_bound: bool = False  # `plateau` is only a lower bound of the bias B, derived from the mean error

    @property
    def text(self) -> str:
        """The word of the convergence verdict, with the plateau where there is one."""
        if self.plateau is None:
            return self.word
        return f"{self.word} at {'least ' if self.is_bound else ''}{self.plateau:.3g}"


@dataclass(frozen=True)
class Assessment:
    """How one cell's error converges."""

    curve: Curve
    verdict: Verdict
    fit: Fit | None = None
    bias2_family: tuple[float, float] | None = None  # confidence interval of bias^2 that the verdict rests on
    ms_per_spp: dict[str, Estimate] = field(default_factory=dict)  # ms per sample per pixel, by name of the clock
    doubts: tuple[str, ...] = ()
    alone: Cell | None = None  # companion cell: the same render without checkpoints

    @property
    def cell(self) -> Cell:
        """The cell whose convergence is assessed."""
        return self.curve.cell

    @property
    def ms_alone(self) -> np.ndarray | None:
        """Milliseconds per sample per pixel of the companion cell without checkpoints; None: it was not run."""
        return None if self.alone is None else self.alone.ms_per_spp

    @property
    def last_error(self) -> float:
        """The mean dual squared error at the last checkpoint."""
        return float(self.curve.mean[-1])

    @property
    def has_noise(self) -> bool:
        """Whether more samples change the error beyond rounding, judged at the last checkpoints."""
        if self.fit is None or self.fit.sigma2.value <= 1e-9 * float(np.abs(self.curve.mean).max()):
            return False
        # An error that is equal, in every pixel, for half of the samples and for all of them has no noise.
        halves, whole = self.curve.bias2, self.curve.mse[:, -1]
        return halves is None or not np.allclose(halves, whole, rtol=1e-9, atol=0)

    @property
    def plateau_bias2(self) -> float:
        """The squared bias of a plateau; 0 where none was found."""
        return self.verdict.plateau**2 if self.verdict.plateau is not None else 0.0

    @property
    def crossing_spp(self) -> float | None:
        """Samples per pixel at which the noise equals the bias; more samples gain little."""
        if not self.has_noise or self.verdict.plateau is None or self.verdict.is_bound:
            return None
        return self.fit.sigma2.value / self.plateau_bias2


def _why_not(curve: Curve) -> Verdict | None:
    """The verdict on a cell whose curve cannot be fitted; None: it can be."""
    if curve.nonfinite:
        return Verdict(INVALID, f"{curve.nonfinite} pixels were not finite, first at {curve.nonfinite_at}")
    if curve.cell.failed:
        return Verdict(NO_VERDICT, f"failed: {curve.cell.failure}")
    if curve.count < 2:
        return Verdict(NO_VERDICT, f"{curve.count} complete seeds; a spread needs two, a verdict {LEAST_SEEDS}")
    if len(curve.spp) < LEAST_CHECKPOINTS:
        return Verdict(NO_VERDICT, f"{len(curve.spp)} checkpoints, a fit needs {LEAST_CHECKPOINTS}")
    if np.isnan(curve.mse).any():
        return Verdict(INVALID, "a checkpoint has no dual-reference error")
    return None


def _verdict(curve: Curve, fit: Fit, slope: Slope | None, curves: int) -> tuple[Verdict, tuple[float, float]]:
    """The convergence verdict, and the interval of bias² that it rests on."""
    level = LEVEL_OF_A_FILE / 2 / curves
    freedom = curve.count - 1
    offset = reference_error(curve.reference, curve.cell.pixels)
    half = half_width(standard_error(fit.bias2_of_seeds), freedom, level, offset)
    low, high = fit.bias2.value - half, fit.bias2.value + half
    biases = curve.cell.convergence.biases
    why = f"declared: {'; '.join(biases)}" if biases else "no declared bias predicts it"
    if low > 0:
        return Verdict(PLATEAU, why, float(np.sqrt(fit.bias2.value)), bool(biases)), (low, high)
    if (off := _mean_off(curve, level)) is not None:
        reason = f"from the image's mean, which is off by {_listed(off)}; {why}"
        return Verdict(PLATEAU, reason, float(np.sqrt(np.mean(off**2))), bool(biases), is_bound=True), (low, high)
    if curve.count < LEAST_SEEDS:
        return Verdict(NO_VERDICT, f"{plural(curve.count, 'seed')}, a verdict needs {LEAST_SEEDS}"), (low, high)
    if slope is None:
        return Verdict(NOISE_LIMITED, "the error does not stand clear of the reference's noise"), (low, high)
    if slope.is_flatter or _flattens(fit):
        return Verdict(NOISE_LIMITED, f"falls slower than 1/n: {_slope_text(slope, fit)}"), (low, high)
    if not curve.independent:
        return Verdict(CONVERGES, "within its last error: no halves to take bias² from"), (low, high)
    last = max(fit.sigma2.value, 0) / curve.spp[-1]
    if high > MOST_HIDDEN * last:
        common = half_width(0, freedom, level, offset) > 0.5 * half
        what = "a better reference" if common else "more spp, seeds or pixels"
        share = f"{_percent(high / last)} of the last squared error" if last > 0 else f"{high:.2g}"
        return Verdict(NOISE_LIMITED, f"bias² of up to {share} could be there; {what} would tell"), (low, high)
    return Verdict(CONVERGES), (low, high)


def _percent(share: float) -> str:
    """A share in per cent, in digits that show on which side of the limit it lies."""
    digits = telling_digits([100 * share], [100 * MOST_HIDDEN], lambda value, count: f"{value:.{count}f}", least=0)
    return f"{100 * share:.{digits}f} %"


def _mean_off(curve: Curve, level: float) -> np.ndarray | None:
    """The mean error of each channel if any of them differs from 0."""
    if curve.mean_error is None:
        return None
    noise = mean_error_of_reference(curve.reference, curve.cell.pixels)
    means = curve.mean_error.mean(axis=0)
    halves = [half_width(standard_error(channel), curve.count - 1, level / 3, noise) for channel in curve.mean_error.T]
    # A mean error below 1e-12 is due to rounding in its sum, and no sign that the image differs from the reference.
    return means if (np.abs(means) > np.maximum(halves, 1e-12)).any() else None


def _flattens(fit: Fit) -> bool:
    last = fit.octaves[-2:]
    return len(last) == 2 and all(
        octave.estimate.low is not None and octave.estimate.low > FLAT_SLOPE for octave in last
    )


def _slope_text(slope: Slope, fit: Fit) -> str:
    if slope.is_flatter:
        return f"slope {slope.estimate.value:.3f}"
    return "slopes of the last two octaves " + ", ".join(f"{octave.estimate.value:.2f}" for octave in fit.octaves[-2:])


def _listed(values: np.ndarray) -> str:
    return ", ".join(f"{value:+.2g}" for value in values)


def _doubts(curve: Curve, fit: Fit, slope: Slope | None) -> tuple[str, ...]:
    doubts = []
    one, other = fit.bias2, fit.bias2_of_fit
    apart = max(one.low, other.low) - min(one.high, other.high)
    if curve.independent and apart > 1e-6 * abs(curve.mean[-1]):
        doubts.append("the curve is no bias² + σ²/n: the fit's bias² and that of the halves have no value in common")
    for what, values in (("σ²", fit.sigma2_of_seeds), ("bias²", fit.bias2_of_seeds)):
        index = stands_apart(values)
        if index is not None:
            doubts.append(
                f"{what} of seed {curve.seeds[index]} stands apart (Grubbs, {100 * LEVEL_OF_OUTLIERS:g} %): heavy "
                f"tails, a t-interval over {curve.count} seeds is doubtful"
            )
    if curve.count < LEAST_SEEDS:
        doubts.append(f"{plural(curve.count, 'seed')}, fewer than {LEAST_SEEDS}")
    if curve.incomplete:
        doubts.append(f"{plural(curve.incomplete, 'sample')} without all checkpoints, left out")
    if slope is not None and slope.last < curve.spp[-1]:
        doubts.append(f"slope up to {slope.last} spp: beyond, the error is within the reference's noise")
    return tuple(doubts)


def convergence_cells(cells: Sequence[Cell]) -> list[Cell]:
    """The cells whose film was evaluated at checkpoints."""
    return [cell for cell in cells if cell.convergence is not None]


_LAST: list[tuple[Result, dict[str, Assessment]]] = []


def assess(result: Result) -> dict[str, Assessment]:
    """Assesses every convergence cell of a file, by name; the last file's result is cached for figures and tables."""
    if not _LAST or _LAST[0][0] is not result:
        _LAST[:] = [(result, _assess(result))]
    return _LAST[0][1]


def _assess(result: Result) -> dict[str, Assessment]:
    curves = [curve_of(cell) for cell in convergence_cells(result.cells)]
    unfit = {curve.cell.name: verdict for curve in curves if (verdict := _why_not(curve)) is not None}
    fits = {curve.cell.name: fit_of(curve) for curve in curves if curve.cell.name not in unfit}
    # Cells with equal bits share one error curve, which is tested once.
    own = [name for name in fits if _origin(result, name, fits) == name]
    tested = [name for name in own if fits[name].slope is not None]
    rejected = dict(zip(tested, holm([fits[name].slope.p for name in tested], LEVEL_OF_A_FILE), strict=True))
    companions = {cell.name: cell for cell in result.cells if cell.convergence is None and cell.measured}
    assessed = {}
    for curve in curves:
        name = curve.cell.name
        alone = companions.get(name.removesuffix(CHECKPOINTS))
        times = {clock: median_estimate(ms[:, -1] / curve.spp[-1]) for clock, ms in curve.times.items() if len(ms)}
        if name in unfit:
            assessed[name] = Assessment(curve, unfit[name], ms_per_spp=times, alone=alone)
            continue
        fit = fits[name]
        slope = fit.slope
        if slope is not None and rejected.get(_origin(result, name, fits)):
            slope = replace(slope, rejected=True)
            fit = replace(fit, slope=slope)
        verdict, family = _verdict(curve, fit, slope, len(own))
        assessed[name] = Assessment(curve, verdict, fit, family, times, _doubts(curve, fit, slope), alone)
    return assessed


def _origin(result: Result, name: str, fits: dict[str, Fit]) -> str:
    """The name of the cell whose errors a cell has: its own, or that of the cell that it shares them with."""
    cell = next(cell for cell in result.cells if cell.name == name)
    other = cell.convergence.shared_with
    return other if other in fits else name
