"""Fits, slopes and verdicts of convergence cells, against known laws: exactly without noise, counted with it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from builder import Builder
from convergence_builder import SPPS, Law, convergence_cell, convergence_study, on_gpu, rows_of_errors
from scipy import stats

from ptbench.convergence.assessment import CONVERGES, INVALID, NO_VERDICT, NOISE_LIMITED, PLATEAU, assess
from ptbench.convergence.fit import Curve, fit_law, fit_of, slopes_of
from ptbench.errors import InputError
from ptbench.io.results import load
from ptbench.stats.intervals import bootstrap_interval, holm, jackknife, resampled, stands_apart, t_interval, t_test

EXACT = Law(noisy=False)


def assessed(builder: Builder, tmp_path) -> list:
    return list(assess(load(builder.write(tmp_path / "result.json"))).values())


def alone(tmp_path, law: Law, **fields):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, law, **fields)
    return assessed(builder, tmp_path)[0]


# ---- What is known exactly ----


def test_without_noise_the_law_is_found_exactly(tmp_path):
    one = alone(tmp_path, Law(sigma2=0.3, bias2=2e-3, noisy=False))
    assert one.fit.sigma2.value == pytest.approx(0.3, rel=1e-9)
    assert one.fit.bias2.value == pytest.approx(2e-3, rel=1e-12)
    assert one.fit.bias2_of_fit.value == pytest.approx(2e-3, rel=1e-9)
    assert one.verdict.word == PLATEAU
    assert one.verdict.plateau == pytest.approx(2e-3**0.5)
    assert one.verdict.text == "plateau at 0.0447"
    assert one.crossing_spp == pytest.approx(150)


@pytest.mark.parametrize("power", [0.5, 1.0, 1.5])
def test_without_noise_slopes_are_exact_by_octave_and_over_all(tmp_path, power):
    one = alone(tmp_path, Law(noisy=False, power=power), independent=power == 1)
    assert [octave.estimate.value for octave in one.fit.octaves] == pytest.approx([-power] * 10)
    assert [(octave.first, octave.last) for octave in one.fit.octaves] == [(n, 2 * n) for n in SPPS[:-1]]
    assert one.fit.slope.estimate.value == pytest.approx(-power)
    assert one.fit.slope.rejected == (power < 1)


def test_samples_that_depend_on_each_other_may_fall_faster_but_not_slower(tmp_path):
    fast = alone(tmp_path, Law(noisy=False, power=1.5), independent=False)
    assert (fast.verdict.word, fast.fit.slope.rejected) == (CONVERGES, False)
    slow = alone(tmp_path, Law(noisy=False, power=0.8), independent=False)
    assert slow.fit.slope.is_flatter
    # The same fall where samples are independent is a slope of -1 no more.
    steep = alone(tmp_path, Law(noisy=False, power=1.5))
    assert steep.fit.slope.rejected
    assert not steep.fit.slope.is_flatter


def test_time_per_spp_is_that_of_each_clock(tmp_path):
    one = alone(tmp_path, EXACT, ms_per_spp=2.0, seeds=9, time_noise=0.0)
    assert {clock: time.value for clock, time in one.ms_per_spp.items()} == pytest.approx(
        {"wall_ms": 2.0, "device_ms": 1.8, "cpu_ms": 4.0}
    )


def test_exact_convergence_against_a_closed_form(tmp_path):
    one = alone(tmp_path, EXACT, closed_form=True)
    assert (one.verdict.word, one.verdict.reason, one.doubts) == (CONVERGES, "", ())


def test_weights_follow_the_spread_and_negative_errors_do_not_stop_the_fit():
    spp = np.array([1.0, 2, 4, 8])
    # The last checkpoint is mostly noise of the reference: it hardly counts.
    mse = np.array([[1.0, 0.5, 0.25, sign * 5 - 0.1] for sign in (1, -1, 1, -1, 1, -1, 1, -1)])
    bias2, _, sigma2 = fit_law(spp, mse)
    assert sigma2.mean() == pytest.approx(1.0, rel=0.01)
    assert abs(bias2.mean()) < 0.01


# ---- Verdicts from noise ----


def test_an_unbiased_variant_converges(tmp_path):
    one = alone(tmp_path, Law(sigma2=0.25, reference_variance=1e-6))
    assert one.verdict.word == CONVERGES
    assert not one.fit.slope.rejected
    assert one.fit.sigma2.low < 0.25 < one.fit.sigma2.high or abs(one.fit.sigma2.value / 0.25 - 1) < 0.02


def test_a_plateau_is_found_within_its_interval_and_its_declared_reason_given(tmp_path):
    reason = "first_bounce=cached: pixel, lens and shutter are sampled once"
    one = alone(tmp_path, Law(bias2=4e-4, reference_variance=1e-6), biases=[reason])
    assert one.verdict.word == PLATEAU
    assert one.verdict.declared
    assert one.verdict.reason == f"declared: {reason}"
    assert one.verdict.plateau**2 == pytest.approx(4e-4, rel=0.15)
    assert one.fit.bias2.low < 4e-4 < one.fit.bias2.high
    assert one.fit.slope.is_flatter


def test_a_plateau_below_the_visible_curve_is_found_from_the_halves(tmp_path):
    # A tenth of the noise that is left at the last checkpoint.
    one = alone(tmp_path, Law(sigma2=0.25, bias2=0.25 / 1024 / 10))
    assert (one.verdict.word, one.verdict.declared) == (PLATEAU, False)
    assert one.verdict.reason == "no declared bias predicts it"


def test_a_wrong_mean_is_a_bias_that_bias2_may_be_too_weak_to_see(tmp_path):
    one = alone(tmp_path, Law(mean_bias=0.001))
    assert one.bias2_family[0] < 0
    assert one.verdict.word == PLATEAU
    assert "image's mean, which is off by +0.00095, " in one.verdict.reason
    assert one.verdict.is_bound
    assert one.verdict.text == f"plateau at least {one.verdict.plateau:.3g}"
    assert one.crossing_spp is None


def test_the_reference_makes_slopes_as_uncertain_as_it_is(tmp_path):
    spps = [2**k for k in range(11)]
    one = alone(tmp_path, Law(noisy=False, reference_variance=1e-2), reference={"dual_error": 1e-6})
    # Of x = log n less its mean, over the sum of its squares; an offset of 1 e-6 moves log MSE by that over MSE.
    x = np.log(spps) - np.mean(np.log(spps))
    common = 1e-6 * abs(np.sum(x / (0.25 / np.array(spps)))) / np.sum(x**2)
    estimate = one.fit.slope.estimate
    assert estimate.value == pytest.approx(-1)
    assert (estimate.high - estimate.low) / 2 == pytest.approx(1.959964 * common, rel=1e-6)
    known = alone(tmp_path, Law(noisy=False, reference_variance=1e-2), reference={"dual_error": 0.0})
    assert known.fit.slope.estimate.high == pytest.approx(known.fit.slope.estimate.low)


def test_a_known_error_beside_an_estimated_one_widens_a_t_test():
    assert t_test(-0.9, 0.05, 7, -1.0, 0.0) == t_test(-0.9, 0.05, 7, -1.0)
    # All of it known: the normal distribution's.
    assert t_test(-0.9, 0.0, 7, -1.0, 0.05)[0] == pytest.approx(0.0455, rel=1e-3)
    assert t_test(-0.9, 0.05, 7, -1.0, 0.05)[0] > t_test(-0.9, 0.05, 7, -1.0)[0]


def test_too_few_pixels_or_samples_are_noise_limited(tmp_path):
    one = alone(tmp_path, Law(pixels=64))
    assert one.verdict.word == NOISE_LIMITED
    assert "could be there; more spp, seeds or pixels would tell" in one.verdict.reason


def test_a_poor_reference_limits_what_can_be_said(tmp_path):
    one = alone(tmp_path, Law(noisy=False, reference_variance=1e-2))
    assert (one.verdict.word, one.fit.bias2.value) == (NOISE_LIMITED, 0)
    assert "a better reference would tell" in one.verdict.reason
    # A file that knows the reference's part better is believed.
    one = alone(tmp_path, Law(noisy=False, reference_variance=1e-2), reference={"dual_error": 1e-9})
    assert one.verdict.word == CONVERGES


def test_an_error_that_falls_too_slowly_does_not_converge(tmp_path):
    law = Law(noisy=False, power=0.7)
    builder = convergence_study(on_gpu())
    cell = convergence_cell(builder, law)
    for row in builder.rows:
        for checkpoint in row.get("pt_checkpoints", []):
            checkpoint["bias2"] = 0.0
    one = assessed(builder, tmp_path)[0]
    assert cell["convergence"]["independent_samples"]
    assert (one.verdict.word, one.verdict.reason) == (NOISE_LIMITED, "falls slower than 1/n: slope -0.700")


def test_a_pixel_that_is_not_finite_makes_the_cell_invalid(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, EXACT)
    row = next(row for row in builder.rows if row["repetition_index"] == 3)
    row["pt_checkpoints"][4] |= {"nonfinite": 2, "mse": None, "mse_dual": None, "me_rgb": [None, None, None]}
    one = assessed(builder, tmp_path)[0]
    assert (one.verdict.word, one.fit) == (INVALID, None)
    assert one.verdict.reason == "2 pixels were not finite, first at 16 spp of seed 4"


@pytest.mark.parametrize(
    ("fields", "word", "reason"),
    [
        ({"seeds": 5}, NO_VERDICT, "5 seeds, a verdict needs 8"),
        ({"seeds": 1}, NO_VERDICT, "1 complete seeds; a spread needs two, a verdict 8"),
        ({"spps": [1, 2]}, NO_VERDICT, "2 checkpoints, a fit needs 3"),
        ({"error": "out of memory"}, NO_VERDICT, "failed: out of memory"),
    ],
)
def test_what_cannot_be_judged_says_why(tmp_path, fields, word, reason):
    one = alone(tmp_path, EXACT, **fields)
    assert (one.verdict.word, one.verdict.reason) == (word, reason)


def test_a_run_cut_short_is_left_out_and_told_of(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, EXACT, seeds=9)
    row = next(row for row in builder.rows if row["repetition_index"] == 8)
    del row["pt_checkpoints"][5:]
    one = assessed(builder, tmp_path)[0]
    assert one.curve.count == 8
    assert one.doubts == ("1 sample without all checkpoints, left out",)


def test_one_seed_with_a_heavy_tail_puts_the_interval_in_doubt(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(sigma2=0.25))
    for checkpoint in next(row for row in builder.rows if row["repetition_index"] == 2)["pt_checkpoints"]:
        checkpoint["mse_dual"] *= 1.5
    one = assessed(builder, tmp_path)[0]
    assert any("σ² of seed 3 stands apart" in doubt and "8 seeds is doubtful" in doubt for doubt in one.doubts)


def test_cells_of_equal_bits_are_one_curve_and_one_test(tmp_path):
    builder = convergence_study(on_gpu())
    base = convergence_cell(builder, Law(noisy=False, bias2=1e-3))
    convergence_cell(builder, Law(), shared_with=base, axes={"integrator": "megakernel"}, ms_per_spp=0.5)
    one, other = assessed(builder, tmp_path)
    assert other.fit.slope.rejected
    assert other.verdict == one.verdict
    assert other.bias2_family == one.bias2_family
    assert other.ms_per_spp["wall_ms"].value == pytest.approx(one.ms_per_spp["wall_ms"].value / 4)


# ---- Coverage: counts over many files' worth of seeds ----


def curve_of_law(law: Law, trial: int, spps: list[int], seeds: int = 8) -> Curve:
    rows = [rows_of_errors(law, 1000 * trial + seed, spps, reference_seed=trial) for seed in range(seeds)]
    template = CURVE_CELL[law.pixels]
    return Curve(
        cell=template,
        seeds=tuple(range(seeds)),
        spp=np.array(spps, dtype=float),
        mse=np.array([[row["mse_dual"] for row in of_seed] for of_seed in rows]),
        times={},
        bias2=np.array([of_seed[-1]["bias2"] for of_seed in rows]),
        mean_error=None,
    )


CURVE_CELL: dict = {}


@pytest.fixture(scope="module", autouse=True)
def template(tmp_path_factory):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(noisy=False, pixels=64))
    file = builder.write(tmp_path_factory.mktemp("template") / "result.json")
    CURVE_CELL[64] = load(file).cells[0]


def within(count: int, trials: int, probability: float) -> bool:
    """Whether a count is one that the probability gives, in all but a millionth of seeds."""
    low, high = stats.binom.ppf([1e-6, 1 - 1e-6], trials, probability)
    return low <= count <= high


def test_intervals_hold_the_truth_as_often_as_they_say():
    trials, law = 200, Law(sigma2=0.25, bias2=0.01, pixels=64)
    hits = {"sigma2": 0, "bias2": 0, "bias2_of_fit": 0}
    for trial in range(trials):
        fit = fit_of(curve_of_law(law, trial, [1, 2, 4, 8, 16, 32]))
        for name, truth in (("sigma2", 0.25), ("bias2", 0.01), ("bias2_of_fit", 0.01)):
            interval = getattr(fit, name)
            hits[name] += interval.low <= truth <= interval.high
    # Weights and a bias held at 0 come from the same seeds: a little is lost against the nominal 95 %.
    assert all(within(count, trials, 0.95) or count / trials > 0.92 for count in hits.values()), hits
    assert all(count / trials > 0.9 for count in hits.values()), hits


def test_a_slope_of_minus_one_is_rejected_as_often_as_its_p_says():
    trials, law = 250, Law(sigma2=0.25, pixels=64)
    slopes = [slopes_of(curve_of_law(law, trial, [1, 2, 4, 8, 16, 32]))[0] for trial in range(trials)]
    for level in (0.2, 0.05, 0.01):
        assert within(sum(slope.p < level for slope in slopes), trials, level), level
    assert np.mean([slope.estimate.value for slope in slopes]) == pytest.approx(-1, abs=0.005)


def test_expanded_percentiles_cover_what_plain_ones_do_not():
    random = np.random.default_rng(5)
    drawn, trials = resampled(8), 400
    plain = expanded = 0
    for _ in range(trials):
        values = random.normal(1, 0.2, 8)
        means = values[drawn].mean(axis=1)
        low, high = np.percentile(means, [2.5, 97.5])
        plain += low <= 1 <= high
        interval = bootstrap_interval(float(values.mean()), means, 8)
        expanded += interval.low <= 1 <= interval.high
    assert within(expanded, trials, 0.95)
    assert plain < expanded


# ---- The tools, against other implementations ----


def test_t_interval_and_test_are_scipys():
    values = np.array([1.0, 1.4, 0.7, 1.1, 1.9, 0.8, 1.2, 1.0])
    interval = t_interval(values)
    expected = stats.t.interval(0.95, 7, loc=values.mean(), scale=stats.sem(values))
    assert (interval.low, interval.high) == pytest.approx(expected)
    both, above = t_test(values.mean(), stats.sem(values), 7, 1.0)
    assert both == pytest.approx(stats.ttest_1samp(values, 1.0).pvalue)
    assert above == pytest.approx(stats.ttest_1samp(values, 1.0, alternative="greater").pvalue)
    # A reference's offset, common to all seeds, adds in squares.
    wider = t_interval(values, common=0.1)
    half, common = expected[1] - values.mean(), 0.1 * stats.norm.ppf(0.975)
    assert wider.high - wider.value == pytest.approx(np.hypot(half, common))


def test_jackknife_of_a_mean_is_the_mean_and_its_standard_error():
    values = np.array([[1.0], [2.0], [4.0], [9.0]])
    assert jackknife(lambda mean: float(mean[0]), values) == pytest.approx((4.0, stats.sem(values[:, 0])))


def test_holm_steps_down_and_stops():
    assert holm([0.02, 0.001, 0.2, 0.003], 0.01) == [False, True, False, True]
    assert holm([0.004, 0.004], 0.01) == [True, True]
    assert holm([0.006, 0.009], 0.01) == [False, False]
    assert holm([], 0.01) == []


def test_who_stands_apart():
    assert stands_apart(np.array([1.0, 1.1, 0.9, 1.05, 0.95, 1.02, 0.98, 9.0])) == 7
    assert stands_apart(np.array([1.0, 1.1, 0.9, 1.05, 0.95, 1.02, 0.98, 1.2])) is None
    assert stands_apart(np.full(8, 3.0)) is None
    assert stands_apart(np.array([1.0, 2.0])) is None


# ---- Bad input ----


def spoiled(tmp_path, spoil) -> str:
    builder = convergence_study(on_gpu())
    cell = convergence_cell(builder, EXACT, spps=[1, 2, 4])
    row = next(row for row in builder.rows if row["run_type"] == "iteration")
    spoil(cell["convergence"], row["pt_checkpoints"])
    file = builder.write(tmp_path / "bad.json")
    with pytest.raises(InputError) as error:
        load(file)
    message = str(error.value)
    assert message.startswith(f"{file}: ")
    assert "\n" not in message
    return message.removeprefix(f"{file}: ")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (
            lambda cell, rows: rows[1].update(spp=1),
            "$.benchmarks[0].pt_checkpoints[1].spp: found 1, allowed: more than the 1 of the checkpoint before",
        ),
        (
            lambda cell, rows: rows[2].update(wall_ms=0),
            "$.benchmarks[0].pt_checkpoints[2].wall_ms: found 0, allowed: a finite number above 0",
        ),
        (
            lambda cell, rows: rows[0].update(mse=-1),
            "$.benchmarks[0].pt_checkpoints[0].mse: found -1, allowed: a finite number of at least 0",
        ),
        (
            lambda cell, rows: rows[0].update(me_rgb=[0, 0]),
            "$.benchmarks[0].pt_checkpoints[0].me_rgb: found [0, 0], allowed: three numbers",
        ),
        (
            lambda cell, rows: cell.update(checkpoints=[1, 2, 2]),
            "$.ptbench.cells[0].convergence.checkpoints: found [1, 2, 2], "
            "allowed: samples per pixel that increase, at least one",
        ),
        (
            lambda cell, rows: cell.update(independent_samples="yes"),
            '$.ptbench.cells[0].convergence.independent_samples: found "yes", allowed: true or false',
        ),
        (
            lambda cell, rows: cell["reference"].update(kind="guessed"),
            '$.ptbench.cells[0].convergence.reference.kind: found "guessed", allowed: "rendered" or "closed_form"',
        ),
        (
            lambda cell, rows: cell.update(images={"reference": "../r.pfm", "by_spp": {}}),
            '$.ptbench.cells[0].convergence.images.reference: found "../r.pfm", '
            "allowed: FOLDER/FILE, beside the result file",
        ),
        (
            lambda cell, rows: cell.update(images={"reference": "a/r.pfm", "by_spp": {"few": "a/b.pfm"}}),
            '$.ptbench.cells[0].convergence.images.by_spp: found "few", allowed: samples per pixel',
        ),
    ],
)
def test_bad_convergence_cells_are_refused_with_one_line(tmp_path, spoil, message):
    assert spoiled(tmp_path, spoil) == message


def test_checkpoints_that_are_not_the_cells_are_refused(tmp_path):
    message = spoiled(tmp_path, lambda cell, rows: rows[2].update(spp=8))
    assert message.startswith("pt_checkpoints of wavefront.")
    assert message.endswith("repetition 0: found [1, 2, 8], allowed: the cell's: [1, 2, 4]")


def test_a_study_of_an_unknown_type_is_refused(tmp_path):
    builder = Builder().study("s")
    builder.studies[0]["type"] = "guess"
    builder.write(tmp_path / "x.json")
    with pytest.raises(InputError, match='type: found "guess", allowed: "time" or "convergence"'):
        load(tmp_path / "x.json")
    assert json.loads((tmp_path / "x.json").read_text())["ptbench"]["studies"][0]["type"] == "guess"


def test_a_curve_that_is_no_such_law_is_told_of(tmp_path):
    # Four frozen rays, taken in turn: noise up to 4 spp, none after.
    builder = convergence_study(on_gpu())
    convergence_cell(builder, EXACT, biases=["first_bounce=cached_jitters"])
    for row in builder.rows:
        for checkpoint in row.get("pt_checkpoints", []):
            checkpoint["mse_dual"] = 0.04 / min(checkpoint["spp"], 4) * (1 + 0.001 * row["pt_seed"])
            checkpoint["bias2"] = 0.01
    one = assessed(builder, tmp_path)[0]
    assert one.verdict.text == "plateau at 0.1"
    assert one.doubts[0].startswith("the curve is no bias² + σ²/n")
