"""`compare`: which cells are held against each other, and what is said of them.

Second and third machines are the first one's file with times and clocks scaled by powers of two, so that every ratio is
known to the last bit.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from builder import Builder
from compare_builder import (
    cell_of,
    other_machine,
    other_program,
    rows_of,
    run_again,
    shuffled,
    wavefront_by_depth,
    without,
    written,
)
from conftest import RESULTS, committed
from convergence_builder import convergence_cell, convergence_study, on_gpu
from legibility import check_legible
from scipy import stats

from ptbench.compare import figure as compare_figure
from ptbench.compare.compared import compare_files
from ptbench.compare.noise import floor_of, repeats_of
from ptbench.figures import forest
from ptbench.io.results import load
from ptbench.stats.estimates import geometric_mean_of_ratios, ratio_estimate
from ptbench.studies.disturbed import is_contended

UNCACHED_2 = ("material.off.off", "cornell_open_unjittered", "depth:2/")


@pytest.fixture(scope="module")
def base() -> dict:
    return wavefront_by_depth()


@pytest.fixture
def compared(tmp_path):
    """Compares documents, the first being the reference; `noise` as --noise."""

    def run(*documents: dict, noise: tuple[dict, ...] = (), **options):
        files = [written(document, tmp_path / f"{index}.json") for index, document in enumerate(documents)]
        noisy = [written(document, tmp_path / f"noise{index}.json") for index, document in enumerate(noise)]
        return compare_files(files, noisy, **options)

    return run


def left_out(comparison) -> set[tuple[bool, str, str]]:
    return {(item.in_reference, item.kind, item.reason) for item in comparison.matching.alone}


# What is held against what


def test_order_does_not_matter_and_every_cell_finds_its_own(base, compared):
    (one,) = compared(base, shuffled(run_again(other_program(base), 2.0))).comparisons
    assert len(one.rows) == 8
    assert all(row.pair.reference.name == row.pair.other.name for row in one.rows)
    assert not one.matching.alone
    assert {row.ratio.value for row in one.rows} == {2.0}


def test_a_cell_that_is_missing_is_told_of(base, compared):
    other = without(other_program(run_again(base)), "cornell_closed_unjittered/backend:cuda/resolution:800x800/depth:2")
    other = without(other, "cached.off.aos.features.stream.exact.float/scene:cornell_open_unjittered")
    (one,) = compared(base, other).comparisons
    assert len(one.rows) == 4
    assert left_out(one) == {
        (True, "other settings", "depth 2 here, 8 there"),
        (True, "not run there", "no cell of this variant"),
    }
    assert one.time.used == 4


def change_scene(cell: dict) -> None:
    cell["scene_hash"] = "0" * 16


def change_precision(cell: dict) -> None:
    cell["axes"]["precision"] = "double"


def change_arithmetic(cell: dict) -> None:
    cell["axes"]["arithmetic"] = "fast"


def change_film(cell: dict) -> None:
    cell["film_hash"] = "0" * 16


def drop_films_of_caches(document: dict) -> None:
    """A file whose cells disagree on one film is refused, before it is compared."""
    for cell in document["ptbench"]["cells"]:
        if cell["axes"]["first_bounce"] != "off":
            cell["film_hash"] = ""


def change_claim(cell: dict) -> None:
    cell["claim"] = "biased"


def fail(cell: dict) -> None:
    cell |= {"status": "failed", "reason": "CUDA error 700"}


def cut_variant(cell: dict) -> None:
    cell["variant"] += "+block=512"


def change_spp(cell: dict) -> None:
    cell["spp"] = 16


@pytest.mark.parametrize(
    ("change", "kind", "of_reference"),
    [
        (change_precision, "other precision", "precision float here, double there"),
        (change_arithmetic, "other arithmetic", "arithmetic exact here, fast there"),
        (change_film, "other film", "film {} against 0000000000000000, which must be equal"),
        (change_claim, "other claim", "claims bitwise here and biased there"),
        (fail, "failed", "failed in the other file: CUDA error 700"),
        (cut_variant, "other tunables", "tunables standard here, block=512 there"),
        (change_spp, "other settings", "spp 32 here, 16 there"),
    ],
)
def test_other_work_is_never_paired_and_the_reason_is_told(base, compared, change, kind, of_reference):
    other = other_program(run_again(base))
    change(cell_of(other, *UNCACHED_2))
    drop_films_of_caches(other)
    (one,) = compared(base, other).comparisons
    assert len(one.rows) == 7
    film = cell_of(base, *UNCACHED_2)["film_hash"]
    assert (True, kind, of_reference.format(film)) in left_out(one)
    assert {item.in_reference for item in one.matching.alone} == {True, False}


def test_another_content_of_a_scene_is_another_scene(base, compared):
    other = other_program(run_again(base))
    for cell in other["ptbench"]["cells"]:
        if cell["scene"] == "cornell_open_unjittered":
            change_scene(cell)
    (one,) = compared(base, other).comparisons
    assert {row.pair.reference.scene for row in one.rows} == {"cornell_closed_unjittered"}
    here = cell_of(base, *UNCACHED_2)["scene_hash"]
    reason = f"cornell_open_unjittered is {here} here, {'0' * 16} there"
    assert (True, "other scene content", reason) in left_out(one)


def test_not_applicable_there_is_told_with_its_reason(base, compared):
    other = without(other_program(run_again(base)), "material.cached")
    cell = cell_of(base, "material.cached", "cornell_open_unjittered", "depth:2/")
    other["ptbench"]["not_applicable"].append(
        {
            "study": "cached",
            "scene": cell["scene"],
            "variant": cell["variant"],
            "axes": cell["axes"],
            "reason": "no room",
        }
    )
    (one,) = compared(base, other).comparisons
    assert (True, "n/a", "not applicable there: no room") in left_out(one)


def test_rays_that_differ_where_bits_are_claimed_are_other_work(base, compared):
    other = other_program(run_again(base))
    row = rows_of(other, cell_of(other, *UNCACHED_2))[3]
    before = row["pt_rays"]
    row["pt_rays"] = before + 1
    (one,) = compared(base, other).comparisons
    assert (
        True,
        "other film",
        f"{before:.0f} rays against {before + 1:.0f} with seed {row['pt_seed']:.0f}, which must be equal",
    ) in left_out(one)


def test_films_may_differ_on_demand_but_not_the_work(base, compared):
    other = other_program(run_again(base))
    changed, heavier = cell_of(other, *UNCACHED_2), cell_of(other, "material.off.off", "open", "depth:8/")
    change_film(changed)
    change_film(heavier)
    drop_films_of_caches(other)
    for row in rows_of(other, heavier):
        row["pt_rays"] *= 1.25
    (one,) = compared(base, other, films_may_differ=True).comparisons
    assert len(one.rows) == 7
    (row,) = [row for row in one.rows if row.pair.reference.name == changed["cell"]]
    assert row.remarks[-1].endswith("which must be equal")
    ((kind, reason),) = {(item.kind, item.reason) for item in one.matching.alone}
    assert kind == "other rays"
    assert "rays a path against" in reason


def test_the_same_samples_in_two_files_are_no_second_run(base, analysis, tmp_path):
    file = written(base, tmp_path / "a.json")
    code, out, err = analysis("compare", file, written(base, tmp_path / "b.json"))
    assert (code, out) == (2, "")
    assert "same renders 8" in err
    assert err.count("\n") == 1


def test_axes_that_an_older_file_lacks_are_what_they_were(base, compared):
    newer = other_program(run_again(base))
    for index, cell in enumerate(newer["ptbench"]["cells"]):
        cell["axes"]["robustness"] = "naive" if index == 0 else "robust"
    (one,) = compared(base, newer).comparisons
    assert len(one.rows) == 7
    assert one.matching.assumed[0].endswith("0.json is older than some axes; taken as robustness=robust")
    assert (False, "axis not there", "that file does not know robustness=naive") in left_out(one)


def test_a_file_of_before_the_accelerators_is_held_to_one_that_names_them(base, compared):
    newer = other_program(run_again(base))
    for index, cell in enumerate(newer["ptbench"]["cells"]):
        tree = "bvh2" if index == 0 else "brute_force"
        cell["axes"] |= {
            "robustness": "robust",
            "accelerator": tree,
            "builder": "sah_binned",
            "traversal": "while_while",
        }
    (one,) = compared(base, newer).comparisons
    assert len(one.rows) == 7
    assert one.matching.assumed[0].endswith(
        "robustness=robust, accelerator=brute_force, builder=sah_binned, traversal=while_while"
    )
    assert (False, "axis not there", "that file does not know accelerator=bvh2") in left_out(one)


def test_a_standard_that_moved_is_part_of_what_is_compared_and_told(base, compared):
    newer = other_program(run_again(base))
    cell_of(newer, *UNCACHED_2)["tunables"]["block"] = 128
    (one,) = compared(base, newer).comparisons
    remarks = [remark for row in one.rows for remark in row.remarks if "standard" in remark]
    assert remarks == ["other standard of block (256, now 128)"]


def test_files_of_two_backends_are_held_against_each_other_at_the_nearest_spp(compared):
    gpu, cpu = Builder().on_gpu(), Builder()
    # Films of other samples per pixel have other bits, exact or not.
    gpu.axes = cpu.axes = gpu.axes | {"arithmetic": "exact"}
    gpu.study("one")
    cpu.study("one")
    for spp in (8, 32):
        gpu.cell("one", ms_per_spp=1.0, spp=spp)
    cpu.cell("one", ms_per_spp=64.0, spp=2)
    (one,) = compared(gpu.document(), cpu.document()).comparisons
    assert one.matching.across_backends
    ((pair,),) = [[row.pair for row in one.rows]]
    assert (pair.reference.spp, pair.other.spp, pair.remarks) == (8, 2, ("spp 8 against 2",))
    assert one.rows[0].ratio.value == pytest.approx(64, rel=1e-15)
    ((in_reference, kind, _),) = left_out(one)
    assert (in_reference, kind) == (True, "already paired")
    assert [item.ratio for item in one.normalised] == [None, None]
    assert one.normalised[0].how == "132 SMs and 2 threads do not compare"


@pytest.mark.parametrize("gpu_first", [True, False])
def test_of_two_samples_per_pixel_as_near_the_larger_is_taken(compared, gpu_first):
    gpu, cpu = Builder().on_gpu().study("one"), Builder().study("one")
    cpu.axes = gpu.axes
    for spp in (8, 32):
        gpu.cell("one", spp=spp)
    cpu.cell("one", spp=16)
    files = (gpu, cpu) if gpu_first else (cpu, gpu)
    (one,) = compared(*(builder.document() for builder in files)).comparisons
    ((pair,),) = [[row.pair for row in one.rows]]
    assert {pair.reference.spp, pair.other.spp} == {16, 32}


def test_within_one_backend_spp_must_be_equal(compared):
    files = [Builder().study("one"), Builder().study("one")]
    for builder, spps in zip(files, ((4, 8), (4, 16)), strict=True):
        for spp in spps:
            builder.cell("one", spp=spp)
    files[1].context["ptbench.git_sha"] = "other"
    for row in files[1].rows:
        row["pt_timestamp"] = row.get("pt_timestamp", 0) + 1
    (one,) = compared(*(builder.document() for builder in files)).comparisons
    assert [row.pair.other.spp for row in one.rows] == [4]
    assert (True, "other settings", "spp 8 here, 16 there") in left_out(one)


def test_cells_rendered_in_parts_are_held_against_such_only(compared):
    files = []
    for name in ("a", "b"):
        builder = convergence_study(on_gpu())
        builder.context["ptbench.machine"] = name
        builder.study("one")
        builder.cell("one", ms_per_spp=1.0 if name == "a" else 2.0, spp=1024, depth=4, noise=1e-3)
        whole = builder.cell("one", spp=1024, resolution=[64, 64], noise=1e-3)
        if name == "a":
            builder.cells.remove(whole)
            builder.rows = [row for row in builder.rows if row["run_name"] != whole["cell"]]
            convergence_cell(builder)
        files.append(builder.document())
    (one,) = compared(*files).comparisons
    assert [row.pair.reference.depth for row in one.rows] == [4]
    assert left_out(one) == {
        (True, "other clock", "rendered in parts, with checkpoints, here only"),
        (False, "other clock", "rendered in parts, with checkpoints, there only"),
    }


# Verdicts


def test_a_second_gpu_in_time_cycles_and_per_size(base, compared):
    other = other_machine(run_again(base, 2.0, clock=0.5), "small-gpu")
    (one,) = compared(base, other).comparisons
    assert {(row.ratio.value, row.cycles.value, row.verdict.word) for row in one.rows} == {(2.0, 1.0, "SLOWER")}
    assert one.time.estimate.value == pytest.approx(2, rel=1e-15)
    assert one.time.verdict.word == "SLOWER"
    assert one.cycles.estimate.value == 1.0
    by_clock, by_bandwidth = one.normalised
    # Half the multiprocessors took as many cycles: twice as good for its size.
    assert (by_clock.by, by_clock.factor, by_clock.ratio.value) == ("SM x clock", 0.5, 0.5)
    assert by_bandwidth.factor == 0.5
    assert by_bandwidth.ratio.value == pytest.approx(1, rel=1e-15)
    assert by_bandwidth.how.startswith("time x 2407 GB/s over time x 4814 GB/s")


def test_three_machines_are_each_held_against_the_first(base, compared):
    files = [other_machine(run_again(base, scale), name) for scale, name in ((2.0, "b"), (0.25, "c"))]
    one, two = compared(base, *files).comparisons
    assert [c.time.estimate.value for c in (one, two)] == pytest.approx([2, 0.25], rel=1e-15)
    assert [c.time.verdict.word for c in (one, two)] == ["SLOWER", "FASTER"]
    assert {row.verdict.word for row in two.rows} == {"FASTER"}


def test_without_sampled_clocks_the_rated_ones_count_and_that_is_told(base, compared):
    one_file, other = run_again(base), other_machine(run_again(base, 2.0), "small-gpu")
    for document in (one_file, other):
        for row in document["benchmarks"]:
            for key in ("pt_clock_mhz_before", "pt_clock_mhz_after"):
                row.pop(key, None)
    other["context"]["ptbench.cuda_clock_mhz"] = "990"
    (one,) = compared(one_file, other).comparisons
    assert (one.cycles.estimate, one.cycles.used, one.cycles.left_out) == (None, 0, 8)
    assert one.normalised[0].ratio.value == pytest.approx(0.5, rel=1e-15)
    assert "66 SMs x 990 MHz (rated)" in one.normalised[0].how


def test_on_one_machine_a_clock_that_moved_vetoes(base, compared):
    (one,) = compared(base, run_again(other_program(base), 0.5, clock=2.0)).comparisons
    assert {row.verdict.word for row in one.rows} == {"UNSURE"}
    assert {row.verdict.reason for row in one.rows if row.verdict.reason.startswith("FASTER")} == {
        "FASTER in time but SAME in cycles: the clocks differed"
    }
    assert one.time.verdict.word == "UNSURE"


def test_too_few_samples_and_busy_hosts_have_no_verdict(base, compared):
    other = run_again(other_program(base), 4.0)
    few, busy = cell_of(other, *UNCACHED_2), cell_of(other, "material.off.off", "closed", "depth:8/")
    dropped = rows_of(other, few)[8]
    other["benchmarks"] = [row for row in other["benchmarks"] if row is not dropped]
    for row in rows_of(other, few):
        row["repetitions"] = 8
    for row in rows_of(other, busy)[:2]:
        row |= {"pt_contended": 1, "pt_device_ms": 0.5 * row["pt_wall_ms"]}
    rows_of(other, busy)[5]["pt_low_clock"] = 1
    (one,) = compared(base, other).comparisons
    words = {row.pair.reference.name: row for row in one.rows}
    assert words[few["cell"]].verdict.reason == "n = 8, a verdict needs 9"
    assert "other processes" in words[busy["cell"]].verdict.reason
    assert words[busy["cell"]].remarks[1:] == ("1 low-clock (other)", "2 contended (other)")
    assert one.count("UNSURE") == 2
    assert one.count("SLOWER") == 6
    assert [row.verdict.word for row in one.rows] == ["SLOWER"] * 6 + ["UNSURE"] * 2  # worst first
    assert one.time.used == 8


def test_the_geometric_mean_is_over_what_both_have(base, compared):
    """A cell that only one file has, however slow, is in no mean; Google's compare.py would count it."""
    other = run_again(other_program(base), 2.0, only="cornell_open_unjittered")
    other = run_again(without(other, "closed_unjittered/backend:cuda/resolution:800x800/depth:2"), 1.0)
    slow = run_again(base, 1024.0, only="closed_unjittered/backend:cuda/resolution:800x800/depth:2")
    (one,) = compared(slow, other).comparisons
    # Four of six ratios are 2, two are 1.
    assert one.time.estimate.value == pytest.approx(2 ** (4 / 6), rel=1e-15)
    assert (one.time.used, one.time.smallest, one.time.largest) == (6, 1.0, 2.0)


def test_back_to_front_is_the_reciprocal(base, compared):
    other = run_again(other_program(base), 2.0, only="cornell_open_unjittered")
    (there,), (back,) = compared(base, other).comparisons, compared(other, base).comparisons
    assert there.time.estimate.value * back.time.estimate.value == pytest.approx(1, rel=1e-15)
    assert there.count("SLOWER") == back.count("FASTER") == 4


def test_the_interval_of_a_geometric_mean():
    """One pair has its ratio's interval; that of many independent pairs is narrower by the root of their number."""
    random = np.random.default_rng(3)
    pairs = [(random.normal(10, 1, 9), random.normal(10, 1, 9)) for _ in range(64)]
    assert geometric_mean_of_ratios(pairs[:1]).value == pytest.approx(ratio_estimate(*pairs[0]).value, rel=1e-15)
    whole = geometric_mean_of_ratios(pairs)
    singles = [ratio_estimate(*pair) for pair in pairs]
    assert whole.value == pytest.approx(stats.gmean([single.value for single in singles]), rel=1e-13)
    widths = np.log([single.high / single.low for single in singles])
    # A quantile of 10 000 draws is known to 2 %, and medians of nine take few values: 10 % is five times that.
    assert np.log(whole.high / whole.low) == pytest.approx(np.sqrt(np.sum(widths**2)) / 64, rel=0.1)
    with pytest.raises(ValueError, match="no ratios"):
        geometric_mean_of_ratios([])


# Noise


def noisy_run(base: dict) -> dict:
    """A second run in which one cell was slower by 1/16 and another faster."""
    again = run_again(base, 17 / 16, only=cell_of(base, *UNCACHED_2)["cell"])
    return run_again(again, 31 / 32, only=cell_of(base, "material.off.off", "closed", "depth:8/")["cell"])


def test_two_runs_of_one_program_tell_the_noise_floor(base, compared):
    found = compared(base, noisy_run(base))
    (one,), (floor,), (repeat,) = found.comparisons, found.floors, found.repeats
    assert one.repeated
    assert floor.value == pytest.approx(1 / 16, rel=1e-12)
    assert floor.chance == pytest.approx(8 / 9)
    assert sorted(repeat.ratios) == pytest.approx([31 / 32, *[1.0] * 6, 17 / 16], rel=1e-15)
    assert repeat.geometric_mean.value == pytest.approx((31 / 32 * 17 / 16) ** (1 / 8), rel=1e-14)
    # The repeated run that gives the noise floor is not judged by it.
    assert (one.floors, one.threshold) == ((), 0.01)
    assert one.count("SLOWER") == 1


def test_of_nineteen_ratios_the_largest_and_of_thirty_nine_the_second_is_the_floor(tmp_path):
    """k = ceil(0.95 (m + 1)): of 19 ratios the 19th, of 39 the 38th; of 5, which are too few, the largest."""
    for count, rank in ((5, 5), (19, 19), (39, 38)):
        files = []
        for run in range(2):
            builder = Builder().study("one")
            builder.context["ptbench.program_hash"] = "abc"
            for index in range(count):
                factor = 1 + run * (index + 1) / 256
                builder.cell("one", ms_per_spp=factor, depth=index + 1, noise=1e-4)
            for row in builder.rows:
                row["pt_timestamp"] = row.get("pt_timestamp", 0) + run
            files.append(builder.document())
        results = [load(written(document, tmp_path / f"{run}.json")) for run, document in enumerate(files)]
        floor = floor_of(results[0], repeats_of(results))
        assert floor.value == pytest.approx(rank / 256, rel=1e-12), count
        assert floor.chance == pytest.approx(rank / (count + 1))


def test_what_is_within_the_floor_is_the_same(base, compared):
    other = run_again(other_program(base), 65 / 64)
    (plain,) = compared(base, other).comparisons
    (judged,) = compared(base, other, noise=(noisy_run(base),)).comparisons
    assert plain.count("SAME") < 8
    assert (judged.count("SAME"), judged.count("SLOWER")) == (8, 0)
    assert judged.threshold == pytest.approx(1 / 16, rel=1e-12)
    slower = run_again(other_program(base), 5 / 4)
    assert compared(base, slower, noise=(noisy_run(base),)).comparisons[0].count("SLOWER") == 8


def test_runs_among_the_files_are_found_and_a_floor_is_of_its_machine_only(base, compared):
    found = compared(base, noisy_run(base), run_again(other_program(base), 65 / 64))
    assert found.comparisons[1].threshold == pytest.approx(1 / 16, rel=1e-12)
    # A second run is no second machine in the ranking.
    assert found.ranked == ("A", "C")
    there = other_machine(base, "b"), other_machine(noisy_run(base), "b")
    found = compared(base, run_again(other_program(base)), noise=there)
    assert found.comparisons[0].threshold == 0.01
    assert [floor.machine for floor in found.floors] == ["b"]


def test_a_noise_file_that_is_given_already_is_refused(base, analysis, tmp_path):
    files = [written(base, tmp_path / "a.json"), written(run_again(base), tmp_path / "b.json")]
    copy = written(base, tmp_path / "copy.json")
    for noise, twin in ((files[1], files[1]), (copy, files[0])):
        code, out, err = analysis("compare", *files, "--noise", noise)
        assert (code, out) == (2, "")
        assert err == (
            f"python3 -m ptbench: {noise}: --noise: found the very samples of {twin}, allowed: a run of its own\n"
        )
    again = written(run_again(run_again(base)), tmp_path / "c.json")
    assert analysis("compare", *files, "--noise", again)[0] == 0
    assert analysis("compare", *files, "--noise", again, again)[0] == 2


def test_noise_files_that_repeat_nothing_are_refused(base, analysis, tmp_path):
    files = [written(base, tmp_path / "a.json"), written(other_program(run_again(base)), tmp_path / "b.json")]
    stranger = written(other_machine(base, "b"), tmp_path / "n.json")
    code, out, err = analysis("compare", *files, "--noise", stranger)
    assert (code, out) == (2, "")
    assert err.startswith(f"python3 -m ptbench: {stranger}: --noise: found no other file of machine b and program ")
    assert err.count("\n") == 1


# Ranking


def test_a_change_of_order_needs_a_verdict_on_both_machines(base, compared):
    other = run_again(other_machine(base, "b"), 4.0, only="material.off.off.aos.features.stream.exact.float")
    # Uncached, the other machine is four times slower; cached, as fast: where the cache pays there, it leads by more.
    cached_first = compared(base, other).rankings
    assert all(not group.changes for group in cached_first)
    slow_cache = run_again(other_machine(base, "c"), 4.0, only="material.cached")
    groups = {(group.scene, group.depth): group for group in compared(base, slow_cache).rankings}
    assert len(groups) == 4
    group = groups["cornell_open_unjittered", 2]
    (change,) = group.changes
    assert [group.cells[index][0].axes["first_bounce"] for index in (change.ahead, change.behind)] == ["cached", "off"]
    assert (change.at, change.turned_at) == (0, 1)
    assert change.turned_ratio.value == 4 * change.ratio.value
    assert dict(zip([cells[0].axes["first_bounce"] for cells in group.cells], group.places, strict=True)) == {
        "off": (2, 1),
        "cached": (1, 2),
    }


def test_a_swap_within_the_noise_is_no_change(compared):
    files = []
    for name, times in (("a", (1.0, 1.002)), ("b", (1.002, 1.0))):
        builder = Builder().study("one")
        builder.context["ptbench.machine"] = name
        for layout, time in zip(("x", "y"), times, strict=True):
            builder.cell("one", ms_per_spp=time, axes={"layout": layout}, noise=1e-4)
        files.append(builder.document())
    (group,) = compared(*files).rankings
    assert group.places == ((1, 2), (2, 1))
    assert (group.changes, group.within_noise) == ((), 1)


def test_equal_medians_share_a_place_and_change_nothing(compared):
    files = []
    for name, times in (("a", (1.0, 1.0, 2.0)), ("b", (4.0, 2.0, 1.0))):
        builder = Builder().study("one")
        builder.context["ptbench.machine"] = name
        for layout, time in zip(("x", "y", "z"), times, strict=True):
            builder.cell("one", ms_per_spp=time, axes={"layout": layout}, noise=1e-3)
        files.append(builder.document())
    (group,) = compared(*files).rankings
    assert group.places == ((1, 3), (1, 2), (3, 1))
    assert [(change.ahead, change.behind) for change in group.changes] == [(0, 2), (1, 2)]
    assert group.within_noise == 0


def test_what_sets_another_task_is_not_ranked_with_the_rest(compared):
    """Injected work and rendering in parts are no variants' merit."""
    files = []
    for name, factors in (("a", (1.0, 2.0)), ("b", (2.0, 1.0))):
        builder = Builder().on_gpu().study("one")
        builder.context["ptbench.machine"] = name
        for fmas, factor in zip((0, 64), factors, strict=True):
            tuned = {"shading_fmas": fmas}
            builder.cell("one", ms_per_spp=factor, tunables=tuned, noise=1e-3)
            builder.cell("one", ms_per_spp=8 * factor, axes={"layout": "x"}, tunables=tuned, noise=1e-3)
        files.append(builder.document())
    groups = compared(*files).rankings
    assert [(group.work, len(group.cells), group.changes) for group in groups] == [
        ("", 2, ()),
        ("shading_fmas=64", 2, ()),
    ]


# The command


def test_exit_codes_of_fail_on(base, analysis, tmp_path):
    a = written(base, tmp_path / "a.json")
    same = written(run_again(other_program(base)), tmp_path / "same.json")
    slower = written(run_again(other_program(base), 2.0), tmp_path / "slower.json")
    faster = written(run_again(other_program(base), 0.5), tmp_path / "faster.json")
    elsewhere = written(other_machine(run_again(base, 2.0), "b"), tmp_path / "elsewhere.json")
    less = written(without(run_again(other_program(base)), "depth:2"), tmp_path / "less.json")

    def code(*arguments: object) -> int:
        return analysis("compare", a, *arguments)[0]

    assert code(slower) == 0
    assert code(slower, "--fail-on", "slower") == 1
    assert code(faster, elsewhere, "--fail-on", "slower") == 1
    assert code(faster, "--fail-on", "slower") == 0
    assert code(faster, "--fail-on", "different") == 1
    assert code(same, "--fail-on", "different", "--fail-on", "unmatched") == 0
    assert code(less, "--fail-on", "slower") == 0
    assert code(less, "--fail-on", "slower", "--fail-on", "unmatched") == 1


def test_a_wrong_call_is_one_line_and_writes_nothing(base, analysis, tmp_path):
    a = written(base, tmp_path / "a.json")
    schema = run_again(base)
    schema["context"]["ptbench.schema_version"] = "2"
    garbage = tmp_path / "garbage.json"
    garbage.write_bytes(b"\x89PNG\r\n")
    stability = RESULTS / "amd-epyc-2-threads" / "stability.json"
    strangers = run_again(base)
    for cell in strangers["ptbench"]["cells"]:
        cell["scene"], cell["scene_hash"] = "elsewhere_" + cell["scene"], cell["scene_hash"][::-1]
    calls = {
        "found one result file": (a,),
        'schema_version: found "2", allowed: "1"': (a, written(schema, tmp_path / "schema.json")),
        "garbage.json: byte 0: found bytes that are not UTF-8": (a, garbage),
        "found a file of `ptbench stability`": (a, stability),
        "nothing.json: the file: found no such file": (a, tmp_path / "nothing.json"),
        "found no cell to hold against one of": (a, written(strangers, tmp_path / "strangers.json")),
        "(scene not there 8)": (a, tmp_path / "strangers.json"),
        "the following arguments are required: RESULT.json": (),
        '--fail-on: found the word "odd", allowed: slower, different, unmatched, failed': (a, a, "--fail-on", "odd"),
    }
    out_folder = tmp_path / "out"
    for expected, arguments in calls.items():
        code, out, err = analysis("compare", *arguments, "--out", out_folder, "--json", out_folder / "c.json")
        assert (code, out) == (2, ""), expected
        assert expected in err
        assert err.count("\n") == 1
        assert not out_folder.exists()


def test_stdout_json_and_page_say_the_same(base, analysis, tmp_path):
    other = run_again(without(other_program(base), "depth:2/spp:32"), 2.0)
    files = [written(base, tmp_path / "a.json"), written(other, tmp_path / "b.json")]
    code, out, err = analysis("compare", *files, "--json", tmp_path / "c.json", "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    assert "4 cells are in both; left out are 4 of 8 in A and 0 of 4 in B." in out
    assert "Verdicts: 4 SLOWER, 0 UNSURE, 0 SAME, 0 FASTER." in out
    assert "Geometric mean in time: 2.000 [" in out
    assert "over 4 pairs (the cells of both files), 0 left out" in " ".join(out.split())
    assert "No two of the files are of one machine and one program" in out
    assert not [line for line in out.splitlines() if line != line.rstrip()]
    table = [line for line in out.splitlines() if line.startswith(("Verdict  ", "SLOWER"))]
    assert len(table) == 5
    assert len({line.index("cornell") for line in table[1:]}) == 1
    document = json.loads((tmp_path / "c.json").read_text())
    (comparison,) = document["comparisons"]
    assert [pair["ratio"]["value"] for pair in comparison["pairs"]] == [2.0] * 4
    assert {item["kind"] for item in comparison["left_out"]} == {"other settings"}
    assert len(comparison["left_out"]) == 4
    page = (tmp_path / "out" / "compare.md").read_text()
    assert page.count("| other settings | depth 2 here, 8 there |") == 4
    assert "![forest_B](forest_B.png)" in page
    written_files = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written_files == ["compare.md", "forest_B.png", "forest_B.svg"]
    assert out.splitlines()[-4:] == [
        str(tmp_path / "c.json"),
        *(str(tmp_path / "out" / name) for name in ("forest_B.png", "forest_B.svg", "compare.md")),
    ]


def test_the_figure_can_be_read_and_shows_every_pair(base, compared):
    found = compared(base, run_again(other_machine(base, "small-gpu"), 2.0, only="cached"))
    (data,) = compare_figure.collect(found, found.comparisons[0])
    assert len([item for group in data.groups for item in group.items]) == 2 + 8
    check_legible(forest.draw(data), "forest")


def test_a_long_comparison_is_drawn_on_several_pages():
    def group(title: str, count: int) -> forest.Group:
        return forest.Group(title, tuple(range(count)))

    parts = forest.pages([group("a", 3), group("b", 4), group("c", 9)], 6)
    assert [[(part.title, len(part.items)) for part in page] for page in parts] == [
        [("a", 3)],
        [("b", 4), ("c", 2)],
        [("c (continued)", 6)],
        [("c (continued)", 1)],
    ]


# The real pair


def test_the_h200_against_the_cpu():
    """Four of the CPU's 70 cells are n/a on the GPU; the six with a cache did other work at other spp."""
    files = [RESULTS / machine / "seeds.json" for machine in ("nvidia-h200", "amd-epyc-2-threads")]
    (one,) = compare_files(files).comparisons
    assert one.matching.across_backends
    assert len(one.rows) == 60
    refused = [item.cell.axes["first_bounce"] for item in one.matching.alone if item.kind == "other rays"]
    assert refused == ["cached"] * 12
    absent = [item for item in one.matching.alone if not item.in_reference and item.kind == "n/a"]
    assert len(absent) == 4
    assert {item.cell.axes["integrator"] for item in absent} == {"depth_first"}
    # The means once more, from the files' own rows and SciPy's.
    medians = []
    for file in files:
        rows = committed(str(file.relative_to(RESULTS)))["benchmarks"]
        medians.append({row["run_name"]: row["real_time"] for row in rows if row.get("aggregate_name") == "median"})
    ratios = [
        (medians[1][row.pair.other.name] / row.pair.other.spp)
        / (medians[0][row.pair.reference.name] / row.pair.reference.spp)
        for row in one.rows
    ]
    assert one.time.estimate.value == pytest.approx(stats.gmean(ratios), rel=1e-12)
    # Six cells of the GPU wait for their host, which was busy during one sample of nine.
    disturbed = [row.verdict for row in one.rows if is_contended(row.pair.reference)]
    assert [(verdict.word, verdict.withheld) for verdict in disturbed] == [("UNSURE", "SLOWER")] * len(disturbed)
    assert 0 < len(disturbed) <= 6
    assert {row.verdict.word for row in one.rows if not is_contended(row.pair.reference)} == {"SLOWER"}


def test_two_suites_of_one_program_are_a_real_aa_run():
    found = compare_files([RESULTS / "nvidia-h200" / f"{suite}.json" for suite in ("cis565", "compaction")])
    (one,), (floor,) = found.comparisons, found.floors
    assert one.repeated
    assert len(one.rows) == len(floor.ratios) == 20
    assert floor.chance == pytest.approx(20 / 21)
    # No false alarm.
    assert one.count("SLOWER") == one.count("FASTER") == 0


def test_a_suite_that_was_renamed_is_compared_with_its_old_results(tmp_path):
    """cis565 was called seeds; its result files are not edited."""
    old = RESULTS / "nvidia-h200" / "seeds.json"
    document = run_again(committed("nvidia-h200/seeds.json"), 0.5)
    document["context"]["ptbench.suite"] = "cis565"
    (one,) = compare_files([old, written(document, tmp_path / "cis565.json")]).comparisons
    assert not one.matching.alone
    assert len(one.rows) == len(load(old).cells) > 100
    assert {row.ratio.value for row in one.rows} == {0.5}
