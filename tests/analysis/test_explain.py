"""Explaining a difference: the account adds up exactly, and says no more than the file allows."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from builder import AXES, Builder, rates_named
from conftest import RESULTS, stored_text
from legibility import check_legible

from ptbench.errors import InputError
from ptbench.extras.explain.accounting import OUTSIDE, PASSES, WHOLE, account_of, accounting_of
from ptbench.extras.explain.command import pairs_of
from ptbench.extras.explain.facts import MILLION_RAYS, NS_A_RAY, facts_of, rated_bandwidth
from ptbench.extras.explain.figure import draw
from ptbench.extras.explain.found import Choice, Found
from ptbench.extras.explain.text import explained, finding, how_far
from ptbench.figures import style
from ptbench.io.cells import Result
from ptbench.io.inspection import inspected_of, load_inspected, price_of_a_ray
from ptbench.io.results import load, load_kept
from ptbench.studies.variants import find_variant

H200 = RESULTS / "nvidia-h200"
CPU = RESULTS / "amd-epyc-2-threads"
SPP = 4


def passed(wall: float, stages: dict[str, float], live: tuple[int, ...] = (4, 2, 1)) -> dict:
    """An instrumented pass of `wall` and `stages` ms a spp, with paths in thousands."""
    paths = [1000 * alive * SPP for alive in live]
    stage_ms = {name: ms * SPP for name, ms in stages.items()}
    return {"live_paths": paths, "paths": paths[0], "spp": SPP, "stage_ms": stage_ms, "wall_ms": wall * SPP}


def compacted() -> Builder:
    """Two cells whose account is exact in binary: compaction costs 4 and saves 1.5 ms a spp, and all of it is 2."""
    builder = Builder("compaction").on_gpu().study("compaction")
    builder.context |= {
        "ptbench.cuda_memory_clock_mhz": "4000",
        "ptbench.cuda_memory_bus_bits": "1024",
        "ptbench.cuda_l2_bytes": "2000000",
    }
    common = {"noise": 0.0, "spp": SPP, "depth": 4}
    none = builder.cell(
        "compaction", ms_per_spp=3.5, sample_work={"launches": 8, "host_waits": 0, "graph_nodes": 0},
        instrumented=passed(4.0, {"generate": 0.25, "intersect": 1.0, "shade": 2.0}), **common,
    )  # fmt: skip
    scan = builder.cell(
        "compaction", ms_per_spp=5.5, sample_work={"launches": 16, "host_waits": 8, "graph_nodes": 0},
        axes={"compaction": "scan"},
        instrumented=passed(6.0, {"compact": 4.0, "generate": 0.25, "intersect": 0.5, "shade": 1.0}), **common,
    )  # fmt: skip
    none["cuda"]["path_state_bytes"] = scan["cuda"]["path_state_bytes"] = 64
    none["counters"]["compactions"], scan["counters"]["compactions"] = 0, 12
    scan["cuda"]["kernels"] = {**scan["cuda"]["kernels"], "shade_paths": {"registers": 48, "local_bytes": 16}}
    return builder


def pair_of(builder: Builder, folder: Path, choice: Choice | None = None):
    """The file, and the pair of its first two variants."""
    result = load(builder.write(folder / "compaction.json"))
    names = tuple(dict.fromkeys(cell.variant for cell in result.cells))[:2]
    return result, pairs_of(result, names, choice or Choice()).pairs[0]


def facts_by_name(pair) -> dict:
    return {fact.quantity: fact for fact in pair.facts}


def test_the_account_is_exact(tmp_path):
    _, pair = pair_of(compacted(), tmp_path)
    accounting = pair.accounting
    steps = {step.name: step.difference for step in accounting.steps}
    assert steps == {"generate": 0, "intersect": -0.5, "shade": -1, "compact": 4, OUTSIDE: -0.5, PASSES: 0}
    assert accounting.difference == 2 == sum(steps.values())
    assert sum(step.difference for step in accounting.steps if not step.is_stage) == -0.5
    assert sum(step.difference for step in accounting.stages) == 2.5
    assert (accounting.a.outside, accounting.b.outside) == (0.75, 0.25)
    assert (accounting.a.passes, accounting.b.passes) == (-0.5, -0.5)


def test_a_stages_range_is_what_the_passes_differ_by(tmp_path):
    _, pair = pair_of(compacted(), tmp_path)
    ranges = {step.name: (step.low, step.high) for step in pair.accounting.stages}
    # Each stage takes between none and all of the 0.5 that either pass took more; none takes less than no time.
    assert ranges == {
        "generate": (-0.25, 0.25),
        "intersect": (-1.0, 0.0),
        "shade": (-1.5, -0.5),
        "compact": (3.5, 4.0),
    }
    assert [step.name for step in pair.accounting.stages if step.is_settled] == ["shade", "compact"]


def test_a_range_holds_for_the_whole_interval_of_the_median(tmp_path):
    builder = compacted()
    # The median stays 3.5, the interval of it does not: the last four of nine samples took 8 ms.
    rows = [row for row in builder.rows if row["name"] == builder.cells[0]["cell"] and "pt_wall_ms" in row]
    for row in rows[5:]:
        row["pt_wall_ms"] = 8.0 * SPP
    _, pair = pair_of(builder, tmp_path)
    account = pair.accounting.a
    assert (account.total.value, account.total.low, account.total.high) == (3.5, 3.5, 8.0)
    assert account.range_of(["shade"]) == (2.0 - 0.5, 2.0 + 4.0)
    assert pair.accounting.difference == 2


def test_the_finding_names_the_stages_that_are_settled(tmp_path):
    _, pair = pair_of(compacted(), tmp_path)
    assert finding(pair) == (
        "SLOWER: B (compaction=scan) takes 1.571 [1.571, 1.571] of the time of A (compaction=none), 5.500 against "
        "3.500 ms a spp; B spends 3.50 to 4.00 ms more in compact, but 0.500 to 1.50 ms less in shade."
    )


def test_what_does_not_add_up_is_said(tmp_path):
    _, pair = pair_of(compacted(), tmp_path)
    a, b = how_far(pair)
    assert "add up to 81.2 % of the instrumented pass's wall time (more than 5 % off)" in a
    assert "92.9 % of the timed median (more than 5 % off): they are that pass's times" in a
    assert "95.8 % of the instrumented pass's wall time (within 5 %)" in b
    assert "104.5 % of the timed median (within 5 %)" in b


def test_what_else_differs_comes_from_the_rows(tmp_path):
    result, pair = pair_of(compacted(), tmp_path)
    facts = facts_by_name(pair)
    assert (facts[MILLION_RAYS].a, facts[MILLION_RAYS].b) == (0.16, 0.16)  # four a pixel of 200x200
    assert facts[NS_A_RAY].a == pytest.approx(3.5e6 / 160000)
    assert facts[NS_A_RAY].says == "+2.00 ms over B's rays"
    upkeep = facts["compact, instrumented ms"]
    assert (upkeep.a, upkeep.b) == (0, 4)
    assert upkeep.says == "tracing and shading give back 38 % of what it costs more"  # 1.5 of 4
    live = facts["live share of the queue, mean over bounces"]
    assert (live.a, live.b) == (7 / 16, 1.0)  # 4 + 2 + 1 + 0 of four bounces with four slots each
    launches = facts["launches a spp"]
    assert (launches.a, launches.b) == (2, 4)
    # A launch took 5.5 / 4 ms in the one cell and 3.5 / 2 in the other.
    assert launches.says.startswith("at most 2.75 ms more, at the least time that a launch took in any cell")
    waits = facts["host waits a spp"]
    assert (waits.a, waits.b) == (0, 2)
    assert waits.says.startswith("the whole difference would be 1000 us a wait")
    assert (facts["registers a thread, shade_paths"].a, facts["registers a thread, shade_paths"].b) == (40, 48)
    assert facts["local memory a thread, bytes, shade_paths"].b == 16
    assert "registers a thread, generate_paths" not in facts
    assert rated_bandwidth(result) == 2 * 4000e6 * 128
    # 64 bytes in and out for 7000 path segments: at 1024 GB/s that is no time at all, and says so.
    states = facts["MB of path states a spp"]
    assert states.a == states.b == 2 * 64 * 7000 / 1e6
    assert "at the memory's rated 1024 GB/s" in states.says
    assert facts["MB of states in the queue"].a == 64 * 40000 / 1e6


@pytest.mark.parametrize("of_live_paths", ["wavefront_refill", "wavefront_materials"])
def test_a_queue_that_is_refilled_or_appended_to_holds_live_paths(tmp_path, of_live_paths):
    builder = Builder("refill").on_gpu().study("refill")
    for integrator in ("wavefront", of_live_paths):
        axes = {} if integrator == "wavefront" else {"integrator": integrator}
        cell = builder.cell(
            "refill", ms_per_spp=3.5, noise=0.0, spp=SPP, depth=4, axes=axes, instrumented=passed(4.0, {"shade": 2.0})
        )
        cell["counters"]["compactions"] = 0
    _, pair = pair_of(builder, tmp_path)
    live = facts_by_name(pair)["live share of the queue, mean over bounces"]
    assert (live.a, live.b) == (7 / 16, 1.0)


def test_the_difference_in_rays_and_in_their_price_add_up(tmp_path):
    builder = compacted()
    for row in builder.rows:
        if row["name"] == builder.cells[1]["cell"] and "pt_rays" in row:
            row["pt_rays"] /= 2
    _, pair = pair_of(builder, tmp_path)
    facts = facts_by_name(pair)
    assert facts[MILLION_RAYS].says == "-1.75 ms at A's time a ray"
    assert facts[NS_A_RAY].says == "+3.75 ms over B's rays"
    assert pair.accounting.difference == -1.75 + 3.75


def test_one_stage_is_the_timed_median_whatever_its_pass_took(tmp_path):
    builder = compacted()
    builder.cells[0]["instrumented"] = passed(16.0, {"trace": 16.0})
    _, pair = pair_of(builder, tmp_path)
    accounting = pair.accounting
    assert accounting.merged
    steps = {step.name: (step.a, step.b) for step in accounting.steps}
    assert steps == {WHOLE: (3.5, 1.75), "compact": (None, 4.0), OUTSIDE: (None, 0.25), PASSES: (None, -0.5)}
    assert sum(step.difference for step in accounting.steps) == accounting.difference
    told = how_far(pair)
    assert told[0].endswith("A has trace; B has generate, intersect, shade.")
    assert "its instrumented pass took 4.571 of that" in told[1]


def test_where_nothing_is_divided_the_finding_says_so(tmp_path):
    builder = compacted()
    builder.cells[0]["instrumented"] = passed(16.0, {"trace": 16.0})
    builder.cells[1].pop("instrumented")
    _, pair = pair_of(builder, tmp_path)
    assert account_of(pair.cells[1]).stages == {WHOLE: 5.5}
    assert "the file does not divide either" in finding(pair)
    assert "the same rays at 1.571 of the time a ray" in finding(pair)
    assert "B has no instrumented pass" in how_far(pair)[2]


@pytest.mark.parametrize(
    ("ms", "noise", "n", "starts"),
    [
        (3.5, 0.0, 9, "SAME: B (compaction=scan) and A (compaction=none) take the same time"),
        (3.6, 0.05, 9, "UNSURE: B (compaction=scan) and A (compaction=none) are not known to differ"),
        (7.0, 0.0, 5, "UNSURE: B (compaction=scan) and A (compaction=none) are not known to differ"),
    ],
)
def test_without_a_verdict_there_is_nothing_to_explain(tmp_path, ms, noise, n, starts):
    builder = Builder("compaction").on_gpu().study("compaction")
    builder.cell("compaction", ms_per_spp=3.5, noise=0.0)
    builder.cell("compaction", ms_per_spp=ms, noise=noise, n=n, axes={"compaction": "scan"})
    _, pair = pair_of(builder, tmp_path)
    assert finding(pair).startswith(starts)
    assert "there is nothing to explain" in finding(pair)
    assert "spends" not in finding(pair)


_SHARE = re.compile(r"\d %[^|.;]* (of (the|this) difference|of what it)|whole difference")


def unsettled(ms: float, noise: float, n: int = 9) -> Builder:
    """The result that compacted() builds, with other times for the second cell."""
    builder = compacted()
    row_of = [row for row in builder.rows if row["name"] == builder.cells[1]["cell"] and "pt_wall_ms" in row]
    for index, row in enumerate(row_of):
        share = ms * SPP * (1 + noise * (2 * index / (len(row_of) - 1) - 1)) / row["pt_wall_ms"]
        row |= {key: share * row[key] for key in ("pt_wall_ms", "pt_device_ms")}
    builder.rows = [row for row in builder.rows if row.get("repetition_index", 0) < n]
    for row in builder.rows:
        row["repetitions"] = n
    return builder


@pytest.mark.parametrize(
    ("word", "ms", "noise", "n"), [("SAME", 3.5, 0.0, 9), ("UNSURE", 3.6, 0.1, 9), ("UNSURE", 5.5, 0.0, 5)]
)
def test_no_share_of_a_difference_that_is_not_known_to_be_there(tmp_path, word, ms, noise, n):
    result, pair = pair_of(unsettled(ms, noise, n), tmp_path)
    assert pair.verdict.word == word
    text = explained(result, (pair.cells[0].variant, pair.cells[1].variant), Found([pair]))
    assert not _SHARE.search(text)
    parts = [line.split("|")[-2].strip() for line in text.splitlines() if line.startswith("|")]
    begin = parts.index("Part of the difference")
    assert set(parts[begin + 2 : begin + 9]) == {"—"}
    assert facts_by_name(pair)["compact, instrumented ms"].says == "+4.00 ms here, -1.50 ms in tracing and shading"


def test_with_a_verdict_the_shares_are_told(tmp_path):
    result, pair = pair_of(compacted(), tmp_path)
    text = explained(result, (pair.cells[0].variant, pair.cells[1].variant), Found([pair]))
    assert _SHARE.search(text)
    assert "| 100 % |" in text


def test_committed_pairs_without_a_verdict_have_no_shares():
    result, pairs = every_pair(H200 / "first_bounce.json")
    unsettled_pairs = 0
    for a, b in pairs[::2]:
        for pair in pairs_of(result, (a.variant, b.variant), Choice(a.scene, a.depth, a.resolution)).pairs:
            if not pair.has_difference:
                unsettled_pairs += 1
                assert not _SHARE.search(explained(result, (a.variant, b.variant), Found([pair])))
    assert unsettled_pairs > 0


def test_a_share_close_to_its_limit_is_printed_in_digits_that_show_it(tmp_path):
    builder = compacted()
    wall = 4.0
    builder.cells[0]["instrumented"] = passed(wall, {"generate": 0.25, "shade": 0.9496 * wall - 0.25})
    _, pair = pair_of(builder, tmp_path)
    assert "add up to 94.96 % of the instrumented pass's wall time (more than 5 % off)" in how_far(pair)[1]


def every_pair(path: Path) -> tuple[Result, list]:
    """Every measured cell of a file, held against the first measured one of its setting."""
    result = load(path)
    first: dict[tuple, object] = {}
    pairs = []
    for cell in result.cells:
        if cell.measured:
            at = (cell.scene, cell.depth, cell.resolution, cell.convergence is None)
            if at in first:
                pairs.append((first[at], cell))
            first.setdefault(at, cell)
    return result, pairs


@pytest.mark.parametrize(
    "path",
    [H200 / "compaction.json", H200 / "schedulers.json", H200 / "convergence.json", CPU / "seeds.json"],
    ids=lambda path: f"{path.parent.name}-{path.stem}",
)
def test_every_committed_difference_adds_up(path):
    result, pairs = every_pair(path)
    assert len(pairs) > 10
    for a, b in pairs[::3]:  # each takes a bootstrap
        accounting = accounting_of(a, b)
        total = sum(step.difference for step in accounting.steps)
        # Sums of a dozen doubles: rounding alone.
        size = sum(abs(step.difference) for step in accounting.steps) + accounting.a.total.value
        assert total == pytest.approx(accounting.difference, rel=0, abs=1e-14 * size + 1e-15)
        for account in (accounting.a, accounting.b):
            parts = sum(account.stages.values()) + account.outside + account.passes
            assert parts == pytest.approx(account.total.value, rel=1e-12)
        for step in accounting.stages:
            assert step.low <= step.difference + 1e-12 * size
            assert step.high >= step.difference - 1e-12 * size
    assert len(facts_of(result, accounting)) > 2


def test_a_committed_file_is_explained(analysis, tmp_path):
    a, b = "wavefront.none.aos", "wavefront.thrust_remove_if.aos"
    code, said, wrong = analysis(
        "explain", H200 / "compaction.json", a, b, "--scene", "cornell_open", "--out", tmp_path
    )
    assert (code, wrong) == (0, "")
    result = load_kept(H200 / "compaction.json")
    assert f"- A: {find_variant(result, a)}" in said
    assert "B (compaction=thrust_remove_if) takes" in said
    assert "| compact" in said
    page = (tmp_path / "explain.md").read_text(encoding="utf-8")
    pictures = sorted(path.name for path in tmp_path.glob("*.png"))
    assert pictures
    for picture in pictures:
        assert f"]({picture})" in page
        assert (tmp_path / picture).with_suffix(".svg").is_file()


def test_names_by_parts():
    result = load_kept(H200 / "schedulers.json")
    whole = "wavefront_fused.atomic_append.none.material.off.off.packed.features.graph.precise.float+spp_in_flight=4"
    shown = "wavefront_fused compaction=atomic_append layout=packed launch=graph spp_in_flight=4"
    assert find_variant(result, shown) == shown
    assert find_variant(result, whole) == shown  # as the file spells it
    assert find_variant(result, "wavefront_fused.atomic_append.graph+spp_in_flight=4") == shown
    # All its tunables at their standards, though others have this name and a tunable as well.
    assert find_variant(result, "persistent") == "persistent"
    assert find_variant(result, "persistent,piece=4") == "persistent piece=4"
    compaction = load_kept(H200 / "compaction.json")
    assert find_variant(compaction, "wavefront.none.soa") == "wavefront layout=soa arithmetic=exact"
    found = find_variant(compaction, "integrator=wavefront compaction=gap_fill layout=aos")
    assert found == "wavefront compaction=gap_fill arithmetic=exact"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("megakernal", "persistent"), r'variant A: found "megakernal", allowed: .*; nearest: megakernel'),
        (("persistent", "wavefront_fused.aos.none.none"), r'variant B: found "wavefront_fused\.aos\.none\.none"'),
        (
            ("wavefront_fused.packed", "persistent"),
            r"variant A: found \d+ variants .* which differ in compaction \(",
        ),
        (("persistent", "persistent"), "the variants: found .* for both names, allowed: two variants"),
        (
            ("megakernel", "persistent", "--scene", "nope"),
            'the scene: found "nope", allowed: one in which both ran: c',
        ),
        (("megakernel", "persistent", "--depth", "63"), "allowed: scene, backend, resolution and depth that both ran"),
        (("", "persistent"), 'variant A: found ""'),
    ],
)
def test_a_wrong_call_is_one_line(analysis, tmp_path, arguments, expected):
    out = tmp_path / "out"
    code, said, wrong = analysis("explain", H200 / "schedulers.json", *arguments, "--out", out)
    assert (code, said) == (2, "")
    assert wrong.count("\n") == 1
    with pytest.raises(InputError, match=expected):
        raise InputError(wrong.strip())
    assert not out.exists()


def test_a_stability_file_is_refused(analysis, tmp_path):
    file = tmp_path / "stability.json"
    file.write_text(json.dumps({"schema": "ptbench-stability-1"}), encoding="utf-8")
    code, _, wrong = analysis("explain", file, "a", "b")
    assert (code, wrong.count("\n")) == (2, 1)
    assert "allowed: a result of `ptbench run`, which has times" in wrong


def test_what_has_no_pair_is_listed(tmp_path):
    builder = compacted()
    builder.cell("compaction", "cornell_closed", n=3, error="the device is gone", axes={"compaction": "scan"})
    builder.cell("compaction", "cornell_closed")
    builder.cell("compaction", "furnace")
    builder.cell("compaction", depth=4, spp=8)
    result = load(builder.write(tmp_path / "compaction.json"))
    names = tuple(dict.fromkeys(cell.variant for cell in result.cells))
    found = pairs_of(result, names, Choice())
    assert [str(pair.setting) for pair in found.pairs] == ["cornell_open, cuda, 200x200, depth 4"]
    left_out = "\n".join(found.left_out)
    assert "cornell_closed, cuda, 200x200, depth 8: nothing to explain" in left_out
    assert "(failed: the device is gone)" in left_out
    assert f"only {names[0]} ran with: furnace, cuda, 200x200, depth 8" in left_out
    assert "spp:8: the pair with the same spp is shown" in left_out
    text = explained(result, names, found)
    for item in found.left_out:
        assert f"- {item}" in text


def test_an_older_file_without_a_gpu_is_explained(tmp_path):
    builder = Builder().study("compaction")
    assert builder.axes is AXES
    for choice, time in (("none", 2.0), ("scan", 1.0)):
        cell = builder.cell("compaction", ms_per_spp=time, noise=0.0, axes={"compaction": choice}, live_paths=[8, 4])
        cell["instrumented"]["wall_ms"] = 13.0
    _, pair = pair_of(builder, tmp_path)
    assert facts_by_name(pair)["threads busy, CPU time over wall time"].a == 2.0
    assert "launches a spp" not in facts_by_name(pair)
    assert finding(pair).startswith("FASTER")


def test_counters_of_inspect_multiply_to_the_time_a_ray():
    result = load_kept(H200 / "schedulers.json")
    entries = load_inspected(H200 / "inspect_cornell_open_45_schedulers.json")
    raw = {item["variant"].split(".")[0]: item for item in json.loads(stored_text(entries[0].file))}
    cells = {
        name: next(c for c in result.cells if c.variant == find_variant(result, name) and c.scene == "cornell_open_45")
        for name in ("megakernel", "persistent")
    }
    counted = {name: inspected_of(cell, entries) for name, cell in cells.items()}
    price = price_of_a_ray(counted["megakernel"], counted["persistent"])

    def time(name: str) -> float:
        counters = raw[name]["kernels"][0]["counters"]
        return counters["warp_instructions_a_ray"] / counters["of_ceiling"]["issue"]

    assert price.time == pytest.approx(time("persistent") / time("megakernel"), rel=1e-12)
    elsewhere = next(
        c for c in result.cells if c.variant == cells["megakernel"].variant and c.scene == "cornell_closed"
    )
    assert inspected_of(elsewhere, entries) is None


LAST_AXES = {
    "robustness": "robust",
    "accelerator": "brute_force",
    "builder": "sah_binned",
    "traversal": "while_while",
    "traversal_stack": "local",
    "levels": "each_object",
    "light_sampling": "solid_angle",
    "devices": "1",
    "partition": "samples",
    "light_selection": "uniform",
    "subsurface_sampling": "classical",
}


@pytest.mark.parametrize("known", [0, 1, 3, 5, 6, 7, 9, 10])
def test_counters_are_found_whichever_of_the_last_axes_a_file_is_too_old_to_name(known):
    result = load_kept(H200 / "schedulers.json")
    (cell,) = (
        c for c in result.cells if c.variant == find_variant(result, "megakernel") and c.scene == "cornell_open_45"
    )
    entries = load_inspected(H200 / "inspect_cornell_open_45_schedulers.json")
    entry = next(e for e in entries if e.choices[0] == "megakernel")
    without = tuple(choice for choice in entry.choices if choice not in LAST_AXES.values())
    aged = replace(entry, choices=(*without, *list(LAST_AXES.values())[:known]))
    plain = {axis: c for axis, c in cell.axes.items() if axis not in LAST_AXES}
    named = plain | LAST_AXES
    for axes in (plain, named):
        assert inspected_of(replace(cell, axes=axes), [aged]) is aged
    other = replace(cell, axes=named | {"accelerator": "bvh2"})
    assert inspected_of(other, [aged]) is None


def test_counters_stand_in_the_page_or_are_said_to_be_missing():
    result = load_kept(H200 / "schedulers.json")
    entries = load_inspected(H200 / "inspect_cornell_open_45_schedulers.json")
    names = find_variant(result, "megakernel"), find_variant(result, "persistent")
    said = explained(result, names, pairs_of(result, names, Choice("cornell_open_45"), entries))
    assert "| A: megakernel " in said
    assert "(for active lanes)" in said
    said = explained(result, names, pairs_of(result, names, Choice("cornell_closed", depth=8), entries))
    assert "the counters' files have none of megakernel in" in said
    assert "Kernel (inspect)" not in said


SCHEDULERS = H200 / "inspect_cornell_open_45_schedulers.json"


def _counted(tmp_path: Path, word: str, change=lambda value: None) -> Path:
    value = rates_named(json.loads(stored_text(SCHEDULERS)), word)
    change(value)
    path = tmp_path / f"inspect_{word}.json"
    path.write_text(json.dumps(value), encoding="utf-8")
    return path


def test_counters_of_either_word_say_the_same(tmp_path):
    result = load_kept(H200 / "schedulers.json")
    names = find_variant(result, "megakernel"), find_variant(result, "persistent")
    entries = {word: load_inspected(_counted(tmp_path, word)) for word in ("a", "per")}
    raw = json.loads(stored_text(SCHEDULERS))[0]["kernels"][0]["counters"]
    for found in entries.values():
        kernel = found[0].kernels[0]
        assert kernel.warp_instructions_per_ray == raw["warp_instructions_a_ray"]
        assert kernel.thread_instructions_per_ray == raw["thread_instructions_a_ray"]
        assert kernel.memory_bytes_per_ray == raw["memory_bytes_a_ray"]
    said = {
        explained(result, names, pairs_of(result, names, Choice("cornell_open_45"), found))
        for found in entries.values()
    }
    assert len(said) == 1
    assert "(for active lanes)" in said.pop()


@pytest.mark.parametrize(("word", "other"), [("per", "a"), ("a", "per")])
def test_counters_of_both_words_or_with_a_gap_are_refused(tmp_path, word, other):
    def refused(change, text: str):
        path = _counted(tmp_path, word, change)
        with pytest.raises(InputError, match=re.escape(f"{path}: {text}")):
            load_inspected(path)

    allowed = f"allowed: X_{word}_Y, as before it in the file"
    refused(
        lambda v: v[0]["kernels"][0]["counters"].update({f"xu_{other}_ray": 1.0}),
        f'$[0].kernels[0].counters: found the key "xu_{other}_ray", {allowed}',
    )
    refused(
        lambda v: v.append(rates_named(v[0], other)),
        f'$[{len(json.loads(stored_text(SCHEDULERS)))}].kernels[0]: found the key "threads_{other}_block", {allowed}',
    )
    refused(
        lambda v: v[0]["ceilings"].update({f"memory_gb_{other}_second": 1.0}),
        f'$[0].ceilings: found the key "memory_gb_{other}_second", {allowed}',
    )
    refused(
        lambda v: v[1]["kernels"][0]["counters"].pop(f"thread_instructions_{word}_ray"),
        f"$[1].kernels[0].counters.thread_instructions_{word}_ray: found nothing, allowed: this key is required",
    )


def many_stages() -> Builder:
    """Long labels, every kind of stage, and stages that overlap: their sum is more than the wall time."""
    builder = compacted()
    builder.cells[1]["instrumented"] = passed(
        6.0, {"compact": 2.0, "first bounce": 1.0, "bounce": 2.0, "sort": 1.0, "fill cache": 0.5, "generate": 0.25}
    )
    return builder


@pytest.mark.parametrize("build", [compacted, many_stages])
def test_the_figure_can_be_read(tmp_path, build):
    result, pair = pair_of(build(), tmp_path)
    with style.applied():
        figure = draw(result, pair)
    check_legible(figure, build.__name__)


def test_the_figure_of_committed_cells_can_be_read():
    result = load_kept(H200 / "schedulers.json")
    names = find_variant(result, "wavefront.cub_select_flagged.graph"), find_variant(result, "persistent")
    (pair,) = pairs_of(result, names, Choice("cornell_open")).pairs
    with style.applied():
        check_legible(draw(result, pair), "committed")
