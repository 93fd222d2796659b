"""Costs of convergence: efficiency, time to an error, baselines, names, what checkpoints cost."""

from __future__ import annotations

import math

import pytest
from builder import Builder
from convergence_builder import SPPS, Law, convergence_cell, convergence_study, on_gpu, without_checkpoints

from ptbench.convergence.assessment import _percent, assess
from ptbench.convergence.costs import VARIANCE, WORK, cost_ratio
from ptbench.convergence.efficiency import (
    DISTURBED,
    HIGHER,
    CheckpointCost,
    baseline_among,
    by_place,
    checkpoint_costs,
    compare,
    ends_beside_one,
    names_in,
    render_times,
    target_of,
    time_to,
)
from ptbench.convergence.tables import convergence_tables
from ptbench.io.results import load
from ptbench.report.findings import efficiencies_of
from ptbench.stats.estimates import Estimate

NEE, MEGAKERNEL = {"direct_light": "nee"}, {"integrator": "megakernel"}


def exact(**fields) -> Law:
    return Law(noisy=False, **fields)


def test_an_interval_beside_a_word_shows_it():
    """An interval is printed with the digits that its verdict needs: [1.00, 1.02] would contradict SLOWER."""
    cell = None
    cost = CheckpointCost(cell, Estimate(1.012, 1.0003, 1.0204, 9), "")
    assert (cost.word, cost.interval) == ("SLOWER with checkpoints", "[1.0003, 1.0204]")
    assert CheckpointCost(cell, Estimate(1.01, 1.0089, 1.01021, 9), "").interval == "[1.0089, 1.0102]"
    assert CheckpointCost(cell, Estimate(1.01, None, None, 1), "").interval == ""
    assert ends_beside_one(Estimate(1.0, 1.0012, 1.02, 8)) == "[1.001, 1.020]"
    assert ends_beside_one(Estimate(1.0, 0.99996, 1.5, 8)) == "[0.99996, 1.5000]"
    assert ends_beside_one(Estimate(2.0, 1.5, 2.5, 8)) == "[1.50, 2.50]"
    assert ends_beside_one(Estimate(2.0, None, None, 1)) == ""


def test_a_hidden_bias_is_told_in_digits_that_show_the_limit():
    assert [_percent(share) for share in (0.1004, 0.11, 0.18)] == ["10.04 %", "11 %", "18 %"]


def group_of(builder: Builder, tmp_path):
    result = load(builder.write(tmp_path / "result.json"))
    return result, list(assess(result).values())


def pair(tmp_path, first: Law, second: Law, **fields):
    builder = convergence_study(on_gpu())
    one = convergence_cell(builder, first, ms_per_spp=2.0, time_noise=0.0)
    about = {"ms_per_spp": 4.0, "time_noise": 0.0, "axes": NEE, **fields}
    other = convergence_cell(builder, second, **about)
    without_checkpoints(builder, one, 2.0, spp=SPPS[-1])
    without_checkpoints(builder, other, about["ms_per_spp"], spp=SPPS[-1], axes=about["axes"])
    return group_of(builder, tmp_path)[1]


def test_efficiency_is_the_ratio_of_work_normalised_variances(tmp_path):
    plain, nee = pair(tmp_path, exact(sigma2=0.5), exact(sigma2=0.05))
    compared = compare(nee, plain)
    assert compared.work.value == pytest.approx(0.05 * 4)
    assert compared.efficiency.value == pytest.approx(0.5 * 2 / (0.05 * 4))
    assert (compared.efficiency.low, compared.efficiency.high) == pytest.approx((5, 5))
    assert compare(plain, plain).efficiency is None


@pytest.mark.parametrize(("of", "disturbed", "word"), [(0, 0, HIGHER), (0, 1, DISTURBED), (1, 8, DISTURBED)])
def test_an_efficiency_by_disturbed_times_has_no_verdict(tmp_path, of, disturbed, word):
    """Eight seeds: one disturbed is more than a tenth, on either side."""
    builder = convergence_study(on_gpu())
    cells = [
        convergence_cell(builder, exact(sigma2=sigma2), axes=axes, time_noise=0.0, contended=disturbed * (of == index))
        for index, (sigma2, axes) in enumerate(((0.5, {}), (0.05, NEE)))
    ]
    result, (plain, nee) = group_of(builder, tmp_path)
    assert [one.cell.name for one in (plain, nee)] == [cell["cell"] for cell in cells]
    compared = compare(nee, plain)
    assert compared.word == word
    assert bool(compared.doubt) == (disturbed > 0)
    assert compared.efficiency.value == pytest.approx(10)  # the number stays, without a verdict
    assert [one.word for one in efficiencies_of(result, result.studies[0])] == [word]
    assert (cost_ratio(WORK, assess(result), nee.cell, plain.cell) is None) == (disturbed > 0)
    # A variance at equal samples has no time in it.
    assert cost_ratio(VARIANCE, assess(result), nee.cell, plain.cell).value == pytest.approx(0.1)
    text = "\n".join(map(str, convergence_tables(result, result.studies[0])))
    assert ("disturbed)" in text) == (disturbed > 0)


@pytest.mark.parametrize("disturbed", [0, 1])
def test_an_efficiency_is_judged_by_the_renders_that_time_it(tmp_path, disturbed):
    """If both cells also ran without checkpoints, those times alone decide, even where they are disturbed."""
    builder = convergence_study(on_gpu()).study("cornell_without_checkpoints", "")
    for sigma2, axes in ((0.5, {}), (0.05, NEE)):
        cell = convergence_cell(builder, exact(sigma2=sigma2), axes=axes, time_noise=0.0, contended=8 * (1 - disturbed))
        size = {"spp": SPPS[-1], "resolution": cell["resolution"]}
        builder.cell("cornell_without_checkpoints", n=8, axes=axes, noise=0.0, contended=8 * disturbed, **size)
    _, group = group_of(builder, tmp_path)
    plain, nee = group
    assert plain.alone is not None
    assert compare(nee, plain).word == (DISTURBED if disturbed else HIGHER)
    # What checkpoints cost is of both.
    assert [cost.word for cost in checkpoint_costs(group)] == [DISTURBED, DISTURBED]


def test_cells_of_one_error_curve_compare_by_their_times_alone(tmp_path):
    builder = convergence_study(on_gpu())
    base = convergence_cell(builder, Law(), ms_per_spp=2.0, time_noise=0.0)
    convergence_cell(builder, Law(), shared_with=base, axes=MEGAKERNEL, ms_per_spp=0.5, time_noise=0.0)
    _, (one, other) = group_of(builder, tmp_path)
    efficiency = compare(other, one).efficiency
    assert (efficiency.low, efficiency.value, efficiency.high) == pytest.approx((4, 4, 4))


def test_seeds_that_differ_are_drawn_apart_and_widen_the_interval(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(pixels=256))
    convergence_cell(builder, Law(pixels=256), axes=NEE, first_seed=101)
    _, (one, other) = group_of(builder, tmp_path)
    efficiency = compare(other, one).efficiency
    assert efficiency.low < efficiency.value < efficiency.high
    assert efficiency.low < 1 < efficiency.high


def test_samples_that_depend_on_each_other_count_by_their_last_error(tmp_path):
    plain, sobol = pair(
        tmp_path, exact(sigma2=0.5), exact(sigma2=0.5, power=1.5), axes={"sampler": "sobol_owen"}, independent=False
    )
    last = 0.5 / SPPS[-1] ** 0.5  # times the last spp
    assert compare(sobol, plain).work.value == pytest.approx(last * 4)
    # The squared error is 0.5 / n^1.5, and is to be 0.01^2.
    assert time_to(sobol, 0.01).value == pytest.approx((0.5 / 1e-4) ** (1 / 1.5) * 4, rel=1e-6)
    assert time_to(sobol, 1e-6).value == math.inf


def test_time_to_an_error_counts_the_plateau(tmp_path):
    plain, biased = pair(tmp_path, exact(sigma2=0.5), exact(sigma2=0.05, bias2=4e-4))
    assert time_to(plain, 0.05).value == pytest.approx(0.5 / 0.0025 * 2)
    assert time_to(biased, 0.05).value == pytest.approx(0.05 / (0.0025 - 4e-4) * 4)
    for error in (0.02, 0.01):
        never = time_to(biased, error)
        assert (never.value, never.low, never.high) == (math.inf, math.inf, math.inf)


def test_time_beyond_what_was_measured_grows_in_proportion(tmp_path):
    plain, _ = pair(tmp_path, exact(sigma2=0.5), exact())
    assert time_to(plain, 0.001).value == pytest.approx(0.5e6 * 2)


def test_time_to_an_error_has_an_interval_over_seeds(tmp_path):
    builder = convergence_study(on_gpu())
    cell = convergence_cell(builder, Law(sigma2=0.25, pixels=256), time_noise=0.0)
    without_checkpoints(builder, cell, 2.0, spp=SPPS[-1])
    _, (one,) = group_of(builder, tmp_path)
    time = time_to(one, 0.05)
    assert time.low < time.value < time.high
    assert time.low < 0.25 / 0.0025 * 2 < time.high
    assert time.value == pytest.approx(200, rel=0.1)


def parts_of(tmp_path, first_ms: float) -> list:
    """A whole render takes 2 ms a sample, one in parts 6 ms, and its first part `first_ms`."""
    builder = convergence_study(on_gpu())
    cell = convergence_cell(builder, exact(sigma2=0.5), ms_per_spp=6.0, time_noise=0.0)
    for row in builder.rows:
        if "pt_checkpoints" in row:
            row["pt_checkpoints"][0]["wall_ms"] = first_ms
    without_checkpoints(builder, cell, 2.0, spp=SPPS[-1])
    return group_of(builder, tmp_path)[1]


def test_stops_at_checkpoints_are_not_in_the_time_to_an_error(tmp_path):
    """0.5 / 0.05^2 = 200 samples, each of 2 ms."""
    (one,) = parts_of(tmp_path, 6.0)
    assert time_to(one, 0.05).value == pytest.approx(400)
    (times,), how = render_times([one])
    assert times == pytest.approx(2.0 * one.curve.spp)
    assert "without checkpoints" in how


@pytest.mark.parametrize(("first_ms", "is_told"), [(21.9, True), (22.1, False)])
def test_a_time_that_may_be_launches_for_a_twentieth_is_not_told(tmp_path, first_ms, is_told):
    """400 ms by samples alone, of which a launch may take what the first part has beyond its sample's 2 ms."""
    (one,) = parts_of(tmp_path, first_ms)
    assert (time_to(one, 0.05) is not None) == is_told


def test_without_a_render_in_one_piece_no_time_to_an_error_is_told(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, exact(sigma2=0.5), ms_per_spp=6.0, time_noise=0.0)
    _, (one,) = group_of(builder, tmp_path)
    assert time_to(one, 0.05) is None
    (times,), how = render_times([one])
    assert times == pytest.approx(6.0 * one.curve.spp)
    assert "cut at their checkpoints" in how


def test_the_target_is_one_that_every_variant_without_a_plateau_reached(tmp_path):
    group = pair(tmp_path, exact(sigma2=0.25), exact(sigma2=0.05, bias2=0.09))
    # sqrt(0.25 / 1024) = 0.0156; the other one's plateau is at 0.3.
    assert target_of(group) == 0.02
    group = pair(tmp_path, exact(sigma2=0.25, bias2=0.01), exact(sigma2=0.05, bias2=0.09))
    assert target_of(group) == 0.5


def test_a_target_is_found_just_below_a_power_of_ten(tmp_path):
    group = pair(tmp_path, exact(sigma2=1024 * 0.0099**2), exact(sigma2=1024 * 0.005**2))
    assert target_of(group) == 0.02


def test_a_plateau_far_below_the_error_is_none_for_the_target(tmp_path):
    # The first one's plateau is a twentieth of its last squared error.
    group = pair(tmp_path, exact(sigma2=0.25, bias2=0.25 / 1024 / 20), exact(sigma2=0.05, bias2=0.09))
    assert group[0].verdict.word == "plateau"
    assert target_of(group) == 0.02


def test_what_settles_on_a_wrong_image_has_no_noise_and_no_efficiency(tmp_path):
    builder = convergence_study(on_gpu())
    base = convergence_cell(builder, exact(sigma2=0.25))
    frozen = convergence_cell(builder, exact(sigma2=0.25), axes={"first_bounce": "cached_jitters"}, biases=["declared"])
    for row in builder.rows:
        for checkpoint in row.get("pt_checkpoints", []) if row["name"] == frozen["cell"] else []:
            # Four frozen samples: from there on nothing changes, and the halves are the whole.
            checkpoint["mse_dual"] = checkpoint["mse"] = 0.25 / min(checkpoint["spp"], 4)
            checkpoint["bias2"] = None if checkpoint["bias2"] is None else checkpoint["mse_dual"]
    assert base["cell"] != frozen["cell"]
    without_checkpoints(builder, frozen, 2.0, spp=SPPS[-1], axes={"first_bounce": "cached_jitters"})
    _, (plain, settled) = group_of(builder, tmp_path)
    assert (plain.has_noise, settled.has_noise) == (True, False)
    assert compare(settled, plain) is None
    assert settled.crossing_spp is None
    # 2 ms a sample; the error after one sample is 0.5, after four 0.25.
    assert time_to(settled, 0.9).value == pytest.approx(2, rel=0.01)
    assert time_to(settled, 0.25 * 1.0001).value == pytest.approx(8, rel=0.01)
    assert time_to(settled, 0.2).value == math.inf


def test_dependent_samples_at_their_plateau_have_no_efficiency(tmp_path):
    sobol = {"axes": {"sampler": "sobol_owen"}, "independent": False}
    plain, other = pair(tmp_path, exact(sigma2=0.5), exact(sigma2=0.5, bias2=0.1), **sobol)
    assert other.verdict.word == "plateau"
    assert compare(other, plain) is None


def test_no_time_is_shorter_than_the_first_checkpoint(tmp_path):
    plain, _ = pair(tmp_path, exact(sigma2=0.25), exact(sigma2=0.05))
    time = time_to(plain, 10.0)
    assert (time.low, time.value, time.high) == pytest.approx((2, 2, 2))


def test_the_time_to_an_error_lies_in_its_interval_where_the_mean_gave_the_plateau_away(tmp_path):
    builder = convergence_study(on_gpu())
    without_checkpoints(builder, convergence_cell(builder, Law(mean_bias=0.001)), 2.0, spp=SPPS[-1])
    _, (one,) = group_of(builder, tmp_path)
    assert one.verdict.is_bound
    time = time_to(one, 0.02)
    assert time.low < time.value < time.high


def test_the_baseline_is_the_plain_estimator_that_most_are_like(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, exact())
    for choice in ("off", "nee", "nee_mis"):
        convergence_cell(builder, exact(), axes={**MEGAKERNEL, "direct_light": choice})
    convergence_cell(builder, exact(bias2=1e-3), axes={**MEGAKERNEL, "first_bounce": "cached"}, biases=["declared"])
    result, group = group_of(builder, tmp_path)
    baseline = baseline_among(result, group)
    assert (baseline.cell.axes["integrator"], baseline.cell.axes["direct_light"]) == ("megakernel", "off")
    assert list(names_in(group, baseline).values()) == [
        "integrator=wavefront", "baseline", "direct_light=nee", "direct_light=nee_mis", "first_bounce=cached",
    ]  # fmt: skip


def test_plain_walks_are_the_baseline_of_guided_ones_with_several_settings(tmp_path):
    builder = convergence_study(on_gpu())
    builder.baselines["subsurface_sampling"] = "classical"
    convergence_cell(builder, exact(), axes={"subsurface_sampling": "classical"})
    for percent in (50, 75):
        guided = {"subsurface_sampling": "dwivedi"}
        convergence_cell(builder, exact(), axes=guided, tunables={"guided_percent": percent})
    result, group = group_of(builder, tmp_path)
    assert baseline_among(result, group).cell.axes["subsurface_sampling"] == "classical"


def test_a_file_may_have_an_axis_that_the_package_does_not_know(tmp_path):
    builder = convergence_study(on_gpu())
    builder.baselines["own_axis"] = "usual"
    for choice in ("other", "usual"):
        convergence_cell(builder, exact(), axes={"own_axis": choice})
    result, group = group_of(builder, tmp_path)
    assert baseline_among(result, group).cell.axes["own_axis"] == "usual"


def test_where_one_axis_varies_its_choices_are_the_names(tmp_path):
    builder = convergence_study(on_gpu())
    for choice in ("off", "nee"):
        convergence_cell(builder, exact(), axes={"direct_light": choice})
    result, group = group_of(builder, tmp_path)
    assert list(names_in(group, baseline_among(result, group)).values()) == ["off", "nee"]


def test_a_variant_on_a_scene_for_another_stands_with_the_reference(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, exact())
    convergence_cell(
        builder, exact(bias2=1e-3), scene="cornell_open_unjittered", axes={"first_bounce": "cached"},
        reference={"scene": "cornell_open"},
    )  # fmt: skip
    result, group = group_of(builder, tmp_path)
    assert [place.scene for place in by_place(group)] == ["cornell_open"]
    assert names_in(group, baseline_among(result, group))[group[1].cell.name] == (
        "scene=…_unjittered, first_bounce=cached"
    )


@pytest.mark.parametrize(
    ("with_checkpoints", "noise", "word"),
    [(2.02, 0.02, "within noise"), (2.01, 1e-4, "within 1 %"), (2.2, 0.01, "SLOWER with checkpoints")],
)
def test_checkpoints_are_held_against_the_same_render_without(tmp_path, with_checkpoints, noise, word):
    builder = convergence_study(on_gpu()).study("cornell_without_checkpoints", "")
    cell = convergence_cell(builder, exact(), ms_per_spp=with_checkpoints, time_noise=noise)
    builder.cell(
        "cornell_without_checkpoints", ms_per_spp=2.0, n=8, spp=SPPS[-1], noise=noise, resolution=cell["resolution"]
    )
    _, group = group_of(builder, tmp_path)
    (cost,) = checkpoint_costs(group)
    assert cost.word == word
    assert cost.ratio.value == pytest.approx(with_checkpoints / 2, rel=0.02)


@pytest.mark.parametrize(("companions", "efficiency"), [(("off", "nee"), 10), (("nee",), 5), ((), 5)])
def test_efficiency_is_by_times_without_checkpoints_where_both_ran_so(tmp_path, companions, efficiency):
    """Ten times less noise; with checkpoints twice the time, without them the same."""
    builder = convergence_study(on_gpu()).study("cornell_without_checkpoints", "")
    for name, axes, sigma2, ms in (("off", {}, 0.5, 2.0), ("nee", NEE, 0.05, 4.0)):
        law = exact(sigma2=sigma2)
        cell = convergence_cell(builder, law, axes=axes, ms_per_spp=ms, time_noise=0.0)
        if name in companions:
            size = {"spp": SPPS[-1], "resolution": cell["resolution"]}
            builder.cell("cornell_without_checkpoints", axes=axes, ms_per_spp=1.0, n=8, noise=0.0, **size)
    _, (off, nee) = group_of(builder, tmp_path)
    assert compare(nee, off).efficiency.value == pytest.approx(efficiency)


def test_a_variant_without_noise_has_a_plateau_and_no_efficiency(tmp_path):
    # One frozen camera ray a pixel: more samples change nothing but the last bits.
    plain, frozen = pair(tmp_path, exact(sigma2=0.5), exact(sigma2=1e-15, bias2=4e-4), biases=["frozen"])
    assert (frozen.has_noise, frozen.crossing_spp) == (False, None)
    assert compare(frozen, plain) is None
    assert time_to(frozen, 0.01).value == math.inf
    assert frozen.verdict.text == "plateau at 0.02"
