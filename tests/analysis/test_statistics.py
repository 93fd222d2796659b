"""The bootstrap against theory and against scipy, and the verdict rule at its limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from ptbench.stats import estimates
from ptbench.stats.estimates import (
    FASTER,
    SAME,
    SLOWER,
    THRESHOLD,
    UNSURE,
    Estimate,
    Verdict,
    confirmed,
    decisive,
    interval_of_ratio,
    median_estimate,
    ratio_estimate,
    verdict_of_ratio,
    withheld,
    word_of,
)


def exact_interval(values: np.ndarray) -> tuple[float, float]:
    """The percentile bootstrap of an odd count's median without sampling (Efron 1979).

    A resample's median is at most the k-th smallest value when more than half of its n draws are among the k smallest.
    """
    ordered, n = np.sort(values), len(values)
    chance = np.array([stats.binom.sf(n // 2, n, k / n) for k in range(1, n + 1)])
    return ordered[np.searchsorted(chance, 0.025)], ordered[np.searchsorted(chance, 0.975)]


@pytest.mark.parametrize("n", [9, 15, 31])
def test_the_interval_is_the_exact_bootstrap_interval(n):
    values = np.random.default_rng(n).lognormal(size=n)
    estimate = median_estimate(values)
    assert estimate.value == np.median(values)
    assert (estimate.low, estimate.high) == pytest.approx(exact_interval(values))
    assert estimate.n == n


def test_known_values():
    # P(a resample's median <= the 2nd smallest) = P(Binomial(9, 2/9) >= 5) = 0.028: 2.5 % ends there; likewise above.
    estimate = median_estimate(np.array([8.0, 1.0, 7.0, 2.0, 5.0, 4.0, 6.0, 3.0, 100.0]))
    assert (estimate.value, estimate.low, estimate.high, estimate.n) == (5.0, 2.0, 8.0, 9)


def test_agrees_with_scipy():
    values = np.random.default_rng(5).normal(10, 1, size=20)
    theirs = stats.bootstrap((values,), np.median, method="percentile", n_resamples=20_000, rng=7).confidence_interval
    ours = median_estimate(values)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.05)


@pytest.mark.parametrize("sizes", [(2,), (9,), (10, 10), (11, 30), (31, 12), (3, 255), (256, 9), (390, 20)])
@pytest.mark.parametrize("decimals", [1, 12])
def test_counted_medians_are_those_of_the_resamples(sizes, decimals):
    sets = [np.round(np.random.default_rng(size).lognormal(size=size), decimals) + 0.1 for size in sizes]
    random = np.random.default_rng(estimates.SEED)
    for values, medians in zip(sets, estimates._medians_of(*sets), strict=True):
        resamples = values[random.integers(0, values.size, size=(estimates.RESAMPLES, values.size))]
        assert np.array_equal(medians, np.median(resamples, axis=1))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_no_number_is_not_counted(value):
    values = np.array([1.0, 2.0, value, 3.0])
    (medians,) = estimates._medians_of(values)
    random = np.random.default_rng(estimates.SEED)
    expected = np.median(values[random.integers(0, 4, size=(estimates.RESAMPLES, 4))], axis=1)
    assert np.array_equal(medians, expected, equal_nan=True)


def test_the_same_samples_give_the_same_interval():
    values = np.random.default_rng(1).normal(size=12)
    assert median_estimate(values) == median_estimate(values)
    assert ratio_estimate(values + 9, values + 8) == ratio_estimate(values + 9, values + 8)


def test_one_sample_has_no_interval():
    assert median_estimate([4.0]) == Estimate(4.0, None, None, 1)
    assert ratio_estimate([4.0], [2.0, 2.0]) == Estimate(2.0, None, None, 1)


def test_no_samples_have_no_median():
    with pytest.raises(ValueError, match="no samples"):
        median_estimate([])
    with pytest.raises(ValueError, match="no samples"):
        ratio_estimate([1.0], [])


def test_a_ratio_resamples_both_sides_independently():
    values = np.random.default_rng(2).normal(10, 1, size=15)
    ratio = ratio_estimate(values, values)
    assert ratio.value == 1
    # Drawn alike, both medians would always be equal and the interval a point.
    assert ratio.low < 0.97
    assert ratio.high > 1.03


def test_a_ratio_is_that_of_medians_and_its_n_the_smaller():
    ratio = ratio_estimate([3.0, 3.0, 90.0], [2.0, 2.0, 2.0, 2.0])
    assert (ratio.value, ratio.n) == (1.5, 3)


@pytest.mark.parametrize(
    ("low", "high", "n", "word"),
    [
        (0.90, 0.98, 9, FASTER),
        (0.90, 0.9899, 9, FASTER),
        (0.90, 0.9901, 9, UNSURE),
        (1.02, 1.10, 9, SLOWER),
        (1.0101, 1.10, 9, SLOWER),
        (1.0099, 1.10, 9, UNSURE),
        (0.995, 1.005, 9, SAME),
        (0.99, 1.01, 9, SAME),
        (0.989, 1.005, 9, UNSURE),
        (0.995, 1.011, 9, UNSURE),
        (0.80, 1.20, 9, UNSURE),
        (0.90, 0.95, 8, UNSURE),
        (1.00, 1.00, 8, UNSURE),
    ],
)
def test_the_verdict_rule(low, high, n, word):
    verdict = verdict_of_ratio(Estimate((low + high) / 2, low, high, n))
    assert verdict.word == word
    assert bool(verdict.reason) == (word == UNSURE)
    if n < 9:
        assert verdict.reason == "n = 8, a verdict needs 9"


def test_printed_intervals_show_what_is_claimed():
    verdict = verdict_of_ratio(Estimate(1, 0.99381, 1.01021, 9))
    assert verdict.reason == "interval [0.9938, 1.0102] reaches both sides of a 1 % limit"
    assert interval_of_ratio(Estimate(0.95, 0.9, 0.98996, 9)) == "[0.90000, 0.98996]"
    assert interval_of_ratio(Estimate(0.95, 0.9, 0.98, 9)) == "[0.900, 0.980]"
    assert interval_of_ratio(Estimate(20, 12.346, 30, 9)) == "[12.35, 30.00]"
    assert interval_of_ratio(Estimate(1.1, 1.00004, 1.2, 9), 0.0) == "[1.00004, 1.20000]"
    assert interval_of_ratio(Estimate(1, None, None, 1)) == ""


def test_the_verdict_by_the_printed_digits_is_the_verdict():
    """Random intervals, most with an end close to a limit; at 1 % and at noise floors of any digits."""
    random = np.random.default_rng(7)
    seen = set()
    for _ in range(4000):
        threshold = THRESHOLD if random.random() < 0.5 else float(random.uniform(0.01, 0.25))
        near = [1 - threshold, 1 + threshold, 1.0, float(random.uniform(0.5, 2))]
        ends = sorted(float(random.choice(near)) + random.normal() * 10 ** random.uniform(-9, -1) for _ in range(2))
        verdict = verdict_of_ratio(Estimate(sum(ends) / 2, *ends, 9), threshold)
        limit, shown = decisive(*ends, threshold)
        low, high = map(float, shown.strip("[]").split(", "))
        for told in (threshold, float(limit) / 100):
            assert word_of(low, high, told) == verdict.word, (ends, threshold, shown, limit)
        if verdict.word == UNSURE:
            assert f"interval {shown} reaches both sides of a {limit} % limit" == verdict.reason
            assert any(low <= side <= high for side in (1 - threshold, 1 + threshold))
        seen.add(verdict.word)
    assert seen == {FASTER, SLOWER, SAME, UNSURE}


def test_a_verdict_withheld_keeps_what_the_times_say():
    verdict = withheld(Verdict(SLOWER, note="a note"), "disturbed")
    assert (verdict.word, verdict.withheld, verdict.said) == (UNSURE, SLOWER, "disturbed; a note")


@pytest.mark.parametrize(
    ("time", "cycles", "word"),
    [
        (FASTER, FASTER, FASTER),
        (FASTER, UNSURE, FASTER),
        (FASTER, None, FASTER),
        (FASTER, SAME, UNSURE),
        (SAME, SLOWER, UNSURE),
        (UNSURE, FASTER, UNSURE),
    ],
)
def test_cycles_may_veto_but_not_decide(time, cycles, word):
    verdict = confirmed(Verdict(time), None if cycles is None else Verdict(cycles))
    assert verdict.word == word
    if time != UNSURE and word == UNSURE:
        assert f"{time} in time but {cycles} in cycles" in verdict.reason


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9, 16, 17, 40])
def test_medians_of_resamples_are_numpys_to_the_last_bit(count):
    """Of few values they are sorted by exchanges; some are equal, as times of a coarse clock are."""
    values = np.round(np.random.default_rng(count).lognormal(size=count), 1)
    found = estimates._resampled_medians(values, np.random.default_rng(7))
    drawn = values[np.random.default_rng(7).integers(0, count, size=(estimates.RESAMPLES, count))]
    assert np.array_equal(found, np.median(drawn, axis=1))
