"""Confidence intervals and tests over a handful of seeds.

Checkpoints of one run depend on each other, since later ones contain the samples of earlier ones. So every quantity is
estimated once per seed, or as a function of means over seeds, and its spread between seeds is its uncertainty.
"""

from collections.abc import Callable, Sequence

import numpy as np

from ptbench.stats import special
from ptbench.stats.estimates import CONFIDENCE, RESAMPLES, SEED, Estimate

LEVEL = round(1 - CONFIDENCE, 12)  # error probability of the displayed intervals
# Probability that a value is called an outlier among normally distributed ones although it is none.
LEVEL_OF_OUTLIERS = 0.01


def t_quantile(probability: float, freedom: int) -> float:
    """The quantile of Student's t with `freedom` degrees of freedom."""
    return float(special.stdtrit(freedom, probability))


def standard_error(values: np.ndarray) -> float:
    """Standard error of the mean over seeds."""
    return float(np.std(values, ddof=1) / np.sqrt(len(values)))


def half_width(error: float, freedom: int, level: float = LEVEL, common: float = 0.0) -> float:
    """Half the width of the t-interval of a mean; `common` is the standard error of an offset that all seeds share."""
    return float(np.hypot(t_quantile(1 - level / 2, freedom) * error, float(special.ndtri(1 - level / 2)) * common))


def t_interval(values: np.ndarray, level: float = LEVEL, common: float = 0.0) -> Estimate:
    """The mean over seeds with its t-interval; one seed has no interval."""
    values = np.asarray(values, dtype=float)
    mean = float(np.mean(values))
    if values.size < 2:
        return Estimate(mean, None, None, values.size)
    half = half_width(standard_error(values), values.size - 1, level, common)
    return Estimate(mean, mean - half, mean + half, values.size)


def jackknife(function: Callable[[np.ndarray], float], values: np.ndarray) -> tuple[float, float]:
    """The jackknife of a smooth function of the mean over seeds (rows of `values`): corrected estimate, standard error.

    Each seed is left out once. The logarithm of a mean of few heavy-tailed values is too low on average; the jackknife
    removes that bias to first order.
    """
    count = len(values)
    total = values.sum(axis=0)
    whole = function(total / count)
    without = np.array([function((total - row) / (count - 1)) for row in values])
    pseudo = count * whole - (count - 1) * without
    return float(pseudo.mean()), standard_error(pseudo)


def t_test(estimate: float, error: float, freedom: float, expected: float, common: float = 0.0) -> tuple[float, float]:
    """P-values of a t-test of `estimate` against `expected`: two-sided, and one-sided for being above.

    `common` is a known standard error besides the estimated one; their sum has Satterthwaite's degrees of freedom.
    """
    if common > 0:
        both = float(np.hypot(error, common))
        error, freedom = both, min(freedom * (both / max(error, 1e-12 * both)) ** 4, 1e9)
    # Errors of all seeds that agree up to rounding allow no test: only the estimate and expected value are compared.
    if error <= 1e-9 * max(1.0, abs(expected)):
        if abs(estimate - expected) <= 1e-6:
            return 1.0, 0.5
        return 0.0, 0.0 if estimate > expected else 1.0
    t = (estimate - expected) / error
    return float(2 * special.stdtr(freedom, -abs(t))), float(special.stdtr(freedom, -t))


def welch_test(values: np.ndarray, others: np.ndarray) -> float:
    """The two-sided p-value of Welch's test for equal means of two sets of at least two values each."""
    errors = np.array([standard_error(values), standard_error(others)])
    error = float(np.hypot(*errors))
    difference = float(np.mean(values) - np.mean(others))
    if error == 0:
        return 1.0 if difference == 0 else 0.0
    shares = (errors / error) ** 2
    freedom = 1 / float(np.sum(shares**2 / (np.array([len(values), len(others)]) - 1)))
    return float(2 * special.stdtr(freedom, -abs(difference) / error))


def holm(p_values: Sequence[float], level: float) -> list[bool]:
    """Holm's method: the rejected hypotheses, with a probability of at most `level` that any rejection is wrong."""
    rejected = [False] * len(p_values)
    for rank, index in enumerate(sorted(range(len(p_values)), key=lambda index: p_values[index])):
        if p_values[index] > level / (len(p_values) - rank):
            break
        rejected[index] = True
    return rejected


def stands_apart(values: np.ndarray, level: float = LEVEL_OF_OUTLIERS) -> int | None:
    """Grubbs' test: the index of one outlier among otherwise normal values; None: there is none."""
    count = len(values)
    spread = float(np.std(values, ddof=1)) if count > 2 else 0.0
    if spread <= 1e-12 * float(np.max(np.abs(values))):
        return None
    distances = np.abs(values - np.mean(values)) / spread
    t = t_quantile(1 - level / (2 * count), count - 2)
    critical = (count - 1) / np.sqrt(count) * np.sqrt(t * t / (count - 2 + t * t))
    return int(np.argmax(distances)) if distances.max() > critical else None


def resampled(count: int, random: np.random.Generator | None = None) -> np.ndarray:
    """Bootstrap draws of seeds with replacement: RESAMPLES rows of indices."""
    random = random if random is not None else np.random.default_rng(SEED)
    return random.integers(0, count, size=(RESAMPLES, count))


def bootstrap_interval(value: float, drawn: np.ndarray, count: int, level: float = LEVEL) -> Estimate:
    """The percentile interval of bootstrap values `drawn` over `count` seeds, widened for few seeds.

    A percentile interval of a mean of n values is narrower than the t-interval by sqrt((n - 1) / n) and by the normal's
    quantile over t's; Hesterberg's expanded percentiles (2015) correct both. Infinite values are kept.
    """
    if count < 2:
        return Estimate(value, None, None, count)
    tail = float(special.ndtr(-np.sqrt(count / (count - 1)) * t_quantile(1 - level / 2, count - 1)))
    ordered = np.sort(np.where(np.isnan(drawn), np.inf, drawn))
    low = ordered[int(np.floor(tail * (len(ordered) - 1)))]
    high = ordered[int(np.ceil((1 - tail) * (len(ordered) - 1)))]
    return Estimate(value, float(low), float(high), count)
