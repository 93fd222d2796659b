"""Medians, their bootstrap intervals, and the verdict that two sets of times allow.

The interval is the percentile bootstrap of the median: draw n of the n samples with replacement, take the median,
repeat 10 000 times, and cut 2.5 % off each end. Random numbers are seeded, so that a file always gives the same result.
For a ratio of two medians both sets are drawn independently.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ptbench.io.limits import limit

RESAMPLES = limit("resamples")
CONFIDENCE = limit("confidence")
SEED = 1986  # random seed: the year of the rendering equation, any constant would do
MOST_COUNTED = 400  # most samples for which counts of all resamples are cached: 4 MB, or 8 MB if over 255 in a set
MOST_EXCHANGED = 16  # most samples for which resamples are sorted by exchanges, whose number grows with the square
MINIMUM_SAMPLES = limit("fewest_samples")
THRESHOLD = limit("least_difference")

FASTER, SLOWER, SAME, UNSURE = "FASTER", "SLOWER", "SAME", "UNSURE"

VERDICT_RULE = (
    "Ratio = median time of the cell / median time of its baseline. "
    f"With at least {MINIMUM_SAMPLES} samples on both sides: "
    f"FASTER or SLOWER where the whole 95 % interval of the ratio lies more than {THRESHOLD:.0%} below or above 1; "
    f"SAME where all of it lies within 1 ± {THRESHOLD:.0%}; UNSURE otherwise, with the reason. "
    "Where the clock was measured, the same rule in cycles (time x clock) must not contradict it; if it does, UNSURE. "
    "Where it was not, the verdict is one in time alone and says so. Intervals have as many digits as show the verdict."
)
INTERVAL_TEXT = "95 % percentile bootstrap of the median ({} resamples, fixed seed)".format(
    f"{RESAMPLES:,}".replace(",", " ")
)


@dataclass(frozen=True)
class Estimate:
    """A median (or ratio of medians) with its confidence interval; one sample has none, so that both ends are None."""

    value: float
    low: float | None
    high: float | None
    n: int


@dataclass(frozen=True)
class Verdict:
    """A verdict in a word, with the reason why it is not firmer."""

    word: str
    reason: str = ""
    needs_samples: bool = False  # whether more samples alone could settle the verdict
    note: str = ""  # remark on the verdict that a reader needs
    withheld: str = ""  # verdict by the times alone, withheld because of how they were measured

    @property
    def said(self) -> str:
        """The reason and the note beside the verdict's word."""
        return "; ".join(text for text in (self.reason, self.note) if text)


def _indices(size: int, random: np.random.Generator) -> np.ndarray:
    return random.integers(0, size, size=(RESAMPLES, size))


def _resampled_medians(values: np.ndarray, random: np.random.Generator) -> np.ndarray:
    indices = _indices(values.size, random)
    if values.size > MOST_EXCHANGED or not np.isfinite(values).all():
        return np.median(values[indices], axis=1)
    order = np.argsort(values)
    ranks = np.empty(values.size, dtype=np.uint8)
    ranks[order] = np.arange(values.size)
    drawn = _sorted_columns(np.ascontiguousarray(ranks[indices].T))
    ascending = values[order]
    return (ascending[drawn[(values.size - 1) // 2]] + ascending[drawn[values.size // 2]]) / 2


def _sorted_columns(rows: np.ndarray) -> np.ndarray:
    """Sorts each column in place by exchanging whole neighbouring rows, which is fast for few rows."""
    for turn in range(len(rows)):
        for upper in range(turn % 2, len(rows) - 1, 2):
            less = np.minimum(rows[upper], rows[upper + 1])
            np.maximum(rows[upper], rows[upper + 1], out=rows[upper + 1])
            rows[upper] = less
    return rows


@lru_cache(maxsize=4)
def _times_drawn(*sizes: int) -> tuple[np.ndarray, ...]:
    """How often each resample draws each sample, as (size, RESAMPLES), for sets drawn in turn by one generator.

    The draws depend on the sizes alone, so that they are cached: in most files all cells have equally many samples.
    """
    random = np.random.default_rng(SEED)
    resamples = np.arange(RESAMPLES)
    drawn = []
    for size in sizes:
        times = np.zeros((size, RESAMPLES), dtype=np.uint8 if size <= np.iinfo(np.uint8).max else np.uint16)
        for column in _indices(size, random).T:
            times[column, resamples] += 1
        drawn.append(times)
    return tuple(drawn)


def _medians(values: np.ndarray, times_drawn: np.ndarray) -> np.ndarray:
    """The medians of `_resampled_medians`, computed in a fraction of the time by counting from the smallest value."""
    order = np.argsort(values)
    ascending = values[order]
    so_far, low, high = np.zeros((3, RESAMPLES), dtype=times_drawn.dtype)
    for index in order:
        so_far += times_drawn[index]
        low += so_far <= (values.size - 1) // 2
        high += so_far <= values.size // 2
    return (ascending[low] + ascending[high]) / 2


def _medians_of(*sets: np.ndarray) -> list[np.ndarray]:
    """The resampled medians of each set, drawn in turn by one generator."""
    if sum(values.size for values in sets) > MOST_COUNTED or not all(np.isfinite(values).all() for values in sets):
        random = np.random.default_rng(SEED)
        return [_resampled_medians(values, random) for values in sets]
    drawn = _times_drawn(*(values.size for values in sets))
    return [_medians(values, times) for values, times in zip(sets, drawn, strict=True)]


def _percentiles(values: np.ndarray) -> tuple[float, float]:
    tail = 50 * (1 - CONFIDENCE)
    low, high = np.percentile(values, [tail, 100 - tail])
    return float(low), float(high)


def median_estimate(values: np.ndarray) -> Estimate:
    """The median of a one-dimensional array with its 95 % interval, in the values' unit; one value has no interval.

    Raises ValueError for an empty array.
    """
    values = np.asarray(values, dtype=float)
    if values.size == 0:
        raise ValueError("no samples: there is no median")
    if values.size == 1:
        return Estimate(float(values[0]), None, None, 1)
    low, high = _percentiles(_medians_of(values)[0])
    return Estimate(float(np.median(values)), low, high, values.size)


def ratio_estimate(values: np.ndarray, baseline: np.ndarray) -> Estimate:
    """The median of `values` over the median of `baseline`, with its interval; n is the smaller number of samples."""
    values, baseline = np.asarray(values, dtype=float), np.asarray(baseline, dtype=float)
    n = min(values.size, baseline.size)
    if n == 0:
        raise ValueError("no samples: there is no ratio")
    ratio = float(np.median(values) / np.median(baseline))
    if n == 1:
        return Estimate(ratio, None, None, 1)
    # Both sides are resampled by one generator, as two generators of equal seed would resample them alike.
    medians, baseline_medians = _medians_of(values, baseline)
    low, high = _percentiles(medians / baseline_medians)
    return Estimate(ratio, low, high, n)


def inverse(ratio: Estimate) -> Estimate:
    """The estimate of the inverse of a ratio above 0; an end of its interval that is not above 0 has no inverse."""
    low, high = (1 / end if end is not None and end > 0 else None for end in (ratio.high, ratio.low))
    return Estimate(1 / ratio.value, low, high, ratio.n)


def geometric_mean_of_ratios(sides: Sequence[tuple[np.ndarray, np.ndarray]]) -> Estimate:
    """The geometric mean of ratios of medians of (values, baseline); n is the smallest number of samples.

    The pairs are a fixed set: the bootstrap resamples each side's samples, independently of every other side's. So the
    interval holds for these pairs and does not extend to other pairs that might have been chosen.
    """
    if not sides:
        raise ValueError("no ratios: there is no geometric mean")
    sides = [(np.asarray(values, dtype=float), np.asarray(baseline, dtype=float)) for values, baseline in sides]
    n = min(min(values.size, baseline.size) for values, baseline in sides)
    if n == 0:
        raise ValueError("no samples: there is no ratio")
    value = float(np.exp(np.mean([np.log(np.median(values) / np.median(baseline)) for values, baseline in sides])))
    if n == 1:
        return Estimate(value, None, None, 1)
    random = np.random.default_rng(SEED)
    drawn = np.zeros(RESAMPLES)
    for values, baseline in sides:
        drawn += np.log(_resampled_medians(values, random)) - np.log(_resampled_medians(baseline, random))
    low, high = _percentiles(np.exp(drawn / len(sides)))
    return Estimate(value, low, high, n)


def verdict_of_ratio(ratio: Estimate, threshold: float = THRESHOLD) -> Verdict:
    """The verdict that the interval of a ratio of times allows; a difference within `threshold` counts as none."""
    if ratio.n < MINIMUM_SAMPLES or ratio.low is None or ratio.high is None:
        return Verdict(UNSURE, f"n = {ratio.n}, a verdict needs {MINIMUM_SAMPLES}", needs_samples=True)
    word = word_of(ratio.low, ratio.high, threshold)
    if word != UNSURE:
        return Verdict(word)
    limit, ends = decisive(ratio.low, ratio.high, threshold)
    return Verdict(UNSURE, f"interval {ends} reaches both sides of a {limit} % limit")


def word_of(low: float, high: float, threshold: float = THRESHOLD) -> str:
    """The verdict's word for the interval of a ratio, whatever the number of samples."""
    if high < 1 - threshold:
        return FASTER
    if low > 1 + threshold:
        return SLOWER
    return SAME if low >= 1 - threshold and high <= 1 + threshold else UNSURE


def telling_digits(
    values: Sequence[float], limits: Sequence[float], text: Callable[[float, int], str], least: int = 3
) -> int:
    """The fewest digits, but at least `least`, with which every printed value is on its own side of each limit."""

    def sides(value: float) -> list[tuple[bool, bool]]:
        return [(value < limit, value > limit) for limit in limits]

    def tells(digits: int) -> bool:
        return all(sides(float(text(value, digits))) == sides(value) for value in values)

    return next((digits for digits in range(least, 18) if tells(digits)), 18)


def decisive(low: float, high: float, *thresholds: float) -> tuple[str, str]:
    """The first limit in per cent and the interval, in digits that show on which side of every limit each end lies.

    Thus a reader who judges by the printed numbers reaches the same verdict.
    """
    thresholds = thresholds or (THRESHOLD,)
    limit = _limit_text(low, high, thresholds[0])
    limits = [1 + sign * one for one in (*thresholds, float(limit) / 100) for sign in (-1, 1)]
    digits = telling_digits((low, high), limits, _rounded)
    return limit, f"[{_rounded(low, digits)}, {_rounded(high, digits)}]"


def _limit_text(low: float, high: float, threshold: float) -> str:
    """A limit in per cent, rounded so that each end of the interval stays on its side."""

    def sides(limit: float) -> list[tuple[bool, bool]]:
        return [(end < 1 - limit, end > 1 + limit) for end in (low, high)]

    texts = [f"{100 * threshold:.{digits}g}" for digits in range(3, 18)]
    return next((text for text in texts if sides(float(text) / 100) == sides(threshold)), texts[-1])


def interval_of_ratio(estimate: Estimate, *thresholds: float) -> str:
    """An interval such as "[0.9938, 1.0102]", in digits that show the verdict at those thresholds; may be empty."""
    if estimate.low is None or estimate.high is None:
        return ""
    return decisive(estimate.low, estimate.high, *thresholds)[1]


def _rounded(value: float, digits: int) -> str:
    return f"{value:.{digits if abs(value) < 10 else digits - 1}f}"


CLOCK_UNKNOWN = "cycles not compared: the clock is unknown"


def withheld(verdict: Verdict, reason: str) -> Verdict:
    """An UNSURE verdict for doubtful samples, which keeps the word by their times for use by a gate."""
    return Verdict(UNSURE, reason, note=verdict.note, withheld=verdict.word)


def confirmed(in_time: Verdict, in_cycles: Verdict | None) -> Verdict:
    """The verdict by time, unless that by cycles firmly contradicts it: then the clock differed, not the work."""
    if in_cycles is None or UNSURE in (in_time.word, in_cycles.word) or in_time.word == in_cycles.word:
        return in_time
    return Verdict(UNSURE, f"{in_time.word} in time but {in_cycles.word} in cycles: the clocks differed")
