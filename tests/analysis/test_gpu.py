"""Result files from a GPU: what they add, what is compared with what, and how their figures and tables name it."""

from __future__ import annotations

import pytest
from builder import GPU_AXES, LIVE, Builder, small
from legibility import check_legible, texts_of

from ptbench.errors import InputError, NotDrawable
from ptbench.figures.registry import collect_study, draw, figure_names
from ptbench.io.cells import Kernel
from ptbench.io.results import load
from ptbench.studies.gpu import hottest_kernel
from ptbench.studies.groups import in_file_order
from ptbench.studies.notes import notes_of
from ptbench.studies.questions import Question, fixed_tunables, question_of
from ptbench.studies.rows import baseline_of, measure


def loaded(builder: Builder, tmp_path):
    return load(builder.write(tmp_path / "result.json"))


def rows_of(builder: Builder, tmp_path):
    result = loaded(builder, tmp_path)
    return measure(result, result.studies[0])


def drawn(builder: Builder, tmp_path):
    result = loaded(builder, tmp_path)
    study = result.studies[0]
    data = collect_study(result, study)
    return data, draw(data)


# ---- What is read ----


def test_the_new_keys_of_a_cell(tmp_path):
    builder = Builder().on_gpu()
    builder.cell(None, spp=8, tunables={"block": 64, "payload": 1})
    cell = loaded(builder, tmp_path).cells[0]
    assert cell.tunables == {"block": 64, "shading_fmas": 0, "spp_in_flight": 1, "payload": 1}
    assert cell.tuned == {"block": "64", "payload": "1"}
    assert cell.on_gpu
    assert (cell.cuda.block, cell.cuda.device_bytes, cell.cuda.path_bytes) == (64, 3 << 20, 96)
    assert cell.cuda.prepare_ms == 0.5
    assert cell.cuda.options == ("--gpu-architecture=sm_90", "-DPT_BLOCK=64")
    assert cell.cuda.kernels["shade_paths"] == Kernel(registers=40, local_bytes=8, shared_bytes=4)
    assert cell.device_share == pytest.approx(0.9)
    assert cell.work_per_spp("launches") == 24
    assert cell.work_per_spp("host_waits") == 7
    assert loaded(builder, tmp_path).baselines == GPU_AXES


def test_older_files_have_none_of_them(tmp_path):
    result = loaded(small(), tmp_path)
    assert result.baselines == {}
    for cell in result.cells:
        assert (cell.tunables, cell.tuned, cell.counters, cell.cuda, cell.on_gpu) == ({}, {}, {}, None, False)
        assert cell.work_per_spp("launches") is None


def test_a_file_may_lack_the_device_time(tmp_path):
    builder = Builder()
    builder.cell(None)
    del builder.rows[0]["pt_device_ms"]
    assert loaded(builder, tmp_path).cells[0].device_share is None


def test_work_is_the_samples_own_where_they_have_it(tmp_path):
    builder = Builder().on_gpu()
    builder.cell(None, spp=4, sample_work={"launches": 8.0, "host_waits": 0.0, "graph_nodes": 96.0})
    cell = loaded(builder, tmp_path).cells[0]
    assert [cell.work_per_spp(name) for name in ("launches", "host_waits", "graph_nodes")] == [2, 0, 24]


def test_an_instrumented_pass_without_a_graph_says_nothing_of_a_graph_launch(tmp_path):
    builder = Builder().on_gpu()
    builder.cell(None, axes={"launch": "graph"})
    counted = builder.cell(None, "other", spp=4, axes={"launch": "graph"})
    counted["counters"] |= {"launches": 4, "graph_nodes": 96}
    without, with_graph = loaded(builder, tmp_path).cells
    assert without.work_per_spp("launches") is None
    assert without.work_per_spp("host_waits") is None
    assert (with_graph.work_per_spp("launches"), with_graph.work_per_spp("graph_nodes")) == (1, 24)


def test_the_hottest_kernel_is_that_of_the_longest_stage(tmp_path):
    builder = Builder().on_gpu()
    hot = builder.cell(None, live_paths=[10, 5])
    hot["instrumented"]["stage_ms"] = {"intersect": 3.0, "shade": 2.0, "compact": 9.0}
    builder.cell(None, "no_stages")
    bare = builder.cell(None, "no_kernels")
    bare["cuda"]["kernels"] = {}
    cells = loaded(builder, tmp_path).cells
    assert [hottest_kernel(cell) for cell in cells] == ["intersect_paths 31", "shade_paths 40 + 8 B local", ""]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda cell: cell["tunables"].update(block="64"), 'cells[0].tunables.block: found "64", allowed: an integer'),
        (lambda cell: cell.update(tunables=[]), "cells[0].tunables: found [], allowed: an object"),
        (
            lambda cell: cell["counters"].update(launches=-1),
            "cells[0].counters.launches: found -1, allowed: an integer",
        ),
        (lambda cell: cell.update(cuda=3), "cells[0].cuda: found 3, allowed: an object"),
        (
            lambda cell: cell["cuda"]["kernels"]["shade_paths"].pop("registers"),
            "cells[0].cuda.kernels.shade_paths.registers: found nothing, allowed: this key is required",
        ),
        (lambda cell: cell["cuda"].update(options=[1]), "cells[0].cuda.options[0]: found 1, allowed: a string"),
    ],
)
def test_what_is_wrong_in_the_new_keys_is_named_with_its_place(tmp_path, change, message):
    builder = Builder().on_gpu()
    change(builder.cell(None))
    with pytest.raises(InputError) as caught:
        loaded(builder, tmp_path)
    assert message in str(caught.value)


def test_baselines_are_names(tmp_path):
    builder = Builder().on_gpu()
    builder.cell(None)
    builder.baselines["layout"] = 3
    with pytest.raises(InputError, match=r"\$\.ptbench\.baselines\.layout: found 3, allowed: a string"):
        loaded(builder, tmp_path)


# ---- Baselines ----


def test_the_baseline_is_the_files_own(tmp_path):
    builder = Builder().on_gpu().study("layout")
    builder.baselines["layout"] = "soa"
    for layout, time in (("aos", 3.0), ("soa", 2.0)):
        builder.cell("layout", ms_per_spp=time, axes={"layout": layout})
    aos, soa = rows_of(builder, tmp_path)
    assert (aos.is_baseline, soa.is_baseline) == (False, True)
    assert aos.ratio.value == pytest.approx(1.5)


def test_a_study_without_the_files_baseline_is_held_against_its_first_choice(tmp_path):
    builder = Builder().on_gpu().study("integrator")
    for integrator, time in (("megakernel", 4.0), ("persistent", 3.0)):
        builder.cell("integrator", ms_per_spp=time, axes={"integrator": integrator})
    result = loaded(builder, tmp_path)
    assert question_of(result, result.studies[0]) == Question("integrator", "megakernel")
    assert rows_of(builder, tmp_path)[1].ratio.value == pytest.approx(0.75)


def test_a_baseline_that_failed_is_still_the_baseline(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", error="out of memory")
    builder.cell("compaction", axes={"compaction": "gap_fill"})
    row = rows_of(builder, tmp_path)[1]
    assert (row.ratio, row.verdict.reason) == (None, "the baseline compaction=none has no times (failed)")


def test_in_older_files_a_missing_baseline_stays_missing(tmp_path):
    builder = Builder().study("integrator")
    builder.cell("integrator", axes={"integrator": "megakernel"})
    builder.cell("integrator", axes={"integrator": "persistent"})
    rows = rows_of(builder, tmp_path)
    assert [row.is_baseline for row in rows] == [False, False]
    assert rows[1].verdict.reason == "no cell with integrator=wavefront and all else equal"


@pytest.mark.parametrize("axis", GPU_AXES)
def test_every_axis_is_a_figure_and_has_a_baseline(tmp_path, axis):
    builder = Builder().on_gpu().study(axis)
    builder.cell(axis, ms_per_spp=4.0)
    builder.cell(axis, ms_per_spp=2.0, axes={axis: "other"})
    data, _ = drawn(builder, tmp_path)
    assert data.baseline == GPU_AXES[axis]
    assert [item.ratio and item.ratio.value for item in data.groups[0].items] == pytest.approx([None, 0.5])


# ---- Tunables ----


def test_cells_that_differ_in_a_tunable_have_baselines_of_their_own(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    for block, time in ((64, 4.0), (256, 2.0)):
        builder.cell("compaction", ms_per_spp=time, tunables={"block": block})
        builder.cell("compaction", ms_per_spp=0.5 * time, axes={"compaction": "gap_fill"}, tunables={"block": block})
    rows = rows_of(builder, tmp_path)
    assert [row.label for row in rows] == [
        "none, block=64", "gap_fill, block=64", "none, block=256", "gap_fill, block=256",
    ]  # fmt: skip
    assert [row.ratio and row.ratio.value for row in rows] == pytest.approx([None, 0.5, None, 0.5])


def test_no_baseline_at_the_same_value_is_no_baseline(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", tunables={"block": 64})
    builder.cell("compaction", axes={"compaction": "gap_fill"}, tunables={"block": 512})
    assert rows_of(builder, tmp_path)[1].verdict.reason == "no cell with compaction=none and all else equal"


def test_a_tunable_that_the_baseline_lacks_does_not_keep_it_away(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", ms_per_spp=2.0)
    for payload, time in ((0, 1.0), (1, 3.0)):
        builder.cell(
            "compaction",
            ms_per_spp=time,
            axes={"compaction": "cub_select_if"},
            tunables={"payload": payload},
            standards={"payload": 0},
        )
    rows = rows_of(builder, tmp_path)
    assert [row.label for row in rows] == ["none", "cub_select_if, payload=0", "cub_select_if, payload=1"]
    assert [row.ratio and row.ratio.value for row in rows] == pytest.approx([None, 0.5, 1.5])


def test_of_a_baselines_own_tunables_the_standard_is_preferred(tmp_path):
    builder = Builder().on_gpu().study("integrator")
    builder.cell("integrator", ms_per_spp=8.0, tunables={"read_back": 1}, standards={"read_back": 0})
    builder.cell("integrator", ms_per_spp=4.0, standards={"read_back": 0})
    builder.cell("integrator", ms_per_spp=2.0, axes={"integrator": "megakernel"})
    assert rows_of(builder, tmp_path)[2].ratio.value == pytest.approx(0.5)


def test_two_choices_at_their_own_standards_are_compared_and_the_caption_says_so(tmp_path):
    builder = Builder().on_gpu().study("integrator")
    builder.cell("integrator", ms_per_spp=4.0)
    builder.cell("integrator", ms_per_spp=1.0, axes={"integrator": "megakernel"}, standards={"block": 128})
    rows = rows_of(builder, tmp_path)
    # The name of a choice says its standard: nothing varies that a label would have to tell.
    assert [row.label for row in rows] == ["wavefront", "megakernel"]
    assert rows[1].ratio.value == pytest.approx(0.25)
    assert fixed_tunables([row.cell for row in rows], ()) == {
        "block": [128, 256], "shading_fmas": [0], "spp_in_flight": [1],
    }  # fmt: skip
    data, _ = drawn(builder, tmp_path)
    assert "tunables block=128 or 256 by choice, shading_fmas=0, spp_in_flight=1" in data.caption


def test_equal_values_come_before_equal_standing(tmp_path):
    builder = Builder().on_gpu().study("integrator")
    for block in (256, 128):
        builder.cell("integrator", ms_per_spp=4.0 if block == 256 else 2.0, tunables={"block": block})
        builder.cell(
            "integrator",
            ms_per_spp=1.0,
            axes={"integrator": "megakernel"},
            tunables={"block": block},
            standards={"block": 128},
        )
    ratios = {row.label: row.ratio.value for row in rows_of(builder, tmp_path) if row.ratio}
    assert ratios == pytest.approx({"megakernel, block=256": 0.25, "megakernel, block=128": 0.5})


def test_old_cells_match_as_before(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", spp=8)
    builder.cell("compaction", spp=4)
    builder.cell("compaction", spp=4, axes={"compaction": "a"})
    builder.cell("compaction", spp=2, axes={"compaction": "a"})
    result = loaded(builder, tmp_path)
    question = question_of(result, result.studies[0])
    found = [baseline_of(cell, result.cells, question).spp for cell in result.cells[2:]]
    assert found == [4, 8]


def test_a_figure_may_be_named_for_a_tunable(tmp_path, analysis):
    builder = Builder("tuned").on_gpu().study("payload")
    for choice, base in (("cub_select_if", 2.0), ("gap", 3.0)):
        for payload, slower in ((1, 1.5), (0, 1.0)):
            axes, time = {"compaction": choice}, base * slower
            builder.cell("payload", ms_per_spp=time, axes=axes, tunables={"payload": payload}, standards={"payload": 0})
    builder.cell("payload")
    data, figure = drawn(builder, tmp_path)
    assert data.baseline == "payload=0"
    assert "ratios: medians over that of payload=0," in data.caption
    assert "tunables block=256, shading_fmas=0, spp_in_flight=1." in data.caption
    ratios = {item.label: item.ratio and item.ratio.value for item in data.groups[0].items}
    assert ratios == pytest.approx(
        {
            "payload=0, compaction=cub_select_if": None,
            "payload=0, compaction=gap": None,
            "payload=1, compaction=cub_select_if": 1.5,
            "payload=1, compaction=gap": 1.5,
            "no payload, compaction=none": None,
        }
    )
    check_legible(figure, "payload")
    assert analysis("plots", tmp_path / "result.json")[0] == 0
    summary = (tmp_path / "figures" / "tuned-result" / "summary.md").read_text()
    assert "Baseline: payload=0, all else equal.\n" in summary


def test_a_tunable_without_its_standard_is_held_against_its_first_value(tmp_path):
    builder = Builder().on_gpu().study("block")
    for block in (64, 512):
        builder.cell("block", ms_per_spp=block / 64, tunables={"block": block})
    data, _ = drawn(builder, tmp_path)
    assert [item.ratio and item.ratio.value for item in data.groups[0].items] == pytest.approx([None, 8])


def test_a_tunables_values_stand_by_size_with_the_baseline_among_them(tmp_path):
    builder = Builder().on_gpu().study("regenerate_at")
    builder.cell("regenerate_at", ms_per_spp=0.5)
    for value, time in ((24, 2.0), (31, 1.0), (8, 3.0), (16, 2.5)):
        axes = {"integrator": "megakernel_regen"}
        builder.cell(
            "regenerate_at",
            ms_per_spp=time,
            axes=axes,
            tunables={"regenerate_at": value},
            standards={"regenerate_at": 24},
        )
    data, figure = drawn(builder, tmp_path)
    assert [item.label.partition(",")[0] for item in data.groups[0].items] == [
        *(f"regenerate_at={value}" for value in (8, 16, 24, 31)),
        "no regenerate_at",
    ]
    assert [item.is_baseline for item in data.groups[0].items] == [False, False, True, False, False]
    check_legible(figure, "regenerate_at")


def test_groups_that_differ_in_a_tunable_stand_by_its_size(tmp_path):
    builder = Builder().on_gpu().study("launch")
    for in_flight in (4, 16, 1):
        for launch in ("stream", "graph"):
            builder.cell("launch", axes={"launch": launch}, tunables={"spp_in_flight": in_flight})
    data, _ = drawn(builder, tmp_path)
    assert [group.title.rpartition(", ")[2] for group in data.groups] == [
        f"spp_in_flight={in_flight}" for in_flight in (1, 4, 16)
    ]


def test_a_figure_that_is_no_tunable_of_its_cells_is_unknown(tmp_path):
    builder = Builder().on_gpu().study("payload")
    builder.cell("payload")
    with pytest.raises(NotDrawable, match='no figure is called "payload"; there are remaining_paths, '):
        drawn(builder, tmp_path)


def test_a_sort_key_says_nothing_without_a_sort(tmp_path):
    builder = Builder().on_gpu().study("sorting")
    builder.cell("sorting", ms_per_spp=2.0)
    for key, time in (("material", 3.0), ("ray", 4.0)):
        builder.cell("sorting", ms_per_spp=time, axes={"sorting": "cub_radix", "sort_key": key})
    ratios = {row.label: row.ratio.value for row in rows_of(builder, tmp_path) if row.ratio}
    assert ratios == pytest.approx({"cub_radix, sort_key=material": 1.5, "cub_radix, sort_key=ray": 2.0})


def test_of_two_sorts_each_is_held_against_the_same_key(tmp_path):
    builder = Builder().on_gpu().study("sorting")
    builder.cell("sorting", axes={"sorting": "cub_radix"})
    builder.cell("sorting", axes={"sorting": "bucket", "sort_key": "ray"})
    assert rows_of(builder, tmp_path)[1].verdict.reason == "no cell with sorting=cub_radix and all else equal"


# ---- Many rows ----


def wide(choices: int = 20) -> Builder:
    builder = Builder().on_gpu().study("compaction")
    for layout, faster in (("aos", 1.0), ("soa", 0.5), ("packed", 0.6)):
        for choice in range(choices):
            name = f"choice_{choice}_of_the_compactions" if choice else "none"
            # Listed from slow to fast.
            builder.cell(
                "compaction", ms_per_spp=faster * (9 - 0.1 * choice), axes={"compaction": name, "layout": layout}
            )
    return builder


def test_many_rows_are_split_into_groups_with_a_baseline_each(tmp_path):
    data, figure = drawn(wide(), tmp_path)
    assert [group.title for group in data.groups] == [
        f"cornell_open, depth 8, layout={layout}" for layout in ("aos", "soa", "packed")
    ]
    for group in data.groups:
        assert len(group.items) == 20
        assert group.items[0].label == "none"
        assert group.items[0].is_baseline
        times = [item.time.value for item in group.items[1:]]
        assert times == sorted(times)
    assert len(data.order) == 20
    check_legible(figure, "compaction")


def baseline_lines(figure) -> list[int]:
    """How many dashed lines each group has: those that run from its first row to its last."""
    return [
        sum(list(line.get_ydata()) == [0, 1] and line.is_dashed() for line in axes.get_lines()) for axes in figure.axes
    ]


def test_few_rows_of_a_grid_are_split_too(tmp_path):
    data, figure = drawn(wide(2), tmp_path)
    titles = [f"cornell_open, depth 8, layout={layout}" for layout in ("aos", "soa", "packed")]
    assert [group.title for group in data.groups] == titles
    assert [[item.label for item in group.items] for group in data.groups] == [
        ["none", "choice_1_of_the_compactions"]
    ] * 3
    assert baseline_lines(figure) == [1, 1, 1]
    check_legible(figure, "compaction")


def test_few_rows_that_are_no_grid_stay_together(tmp_path):
    builder = wide(2)
    lacking = next(cell for cell in builder.cells if "choice_1" in cell["variant"] and cell["axes"]["layout"] == "soa")
    builder.cells.remove(lacking)
    builder.rows = [row for row in builder.rows if not row["name"].startswith(lacking["cell"])]
    data, figure = drawn(builder, tmp_path)
    assert [group.title for group in data.groups] == ["cornell_open, depth 8"]
    assert [item.label for item in data.groups[0].items][:3] == [
        "none, layout=soa", "none, layout=packed", "none, layout=aos",
    ]  # fmt: skip
    # Which of the three would it be?
    assert baseline_lines(figure) == [0]
    check_legible(figure, "compaction")


def test_a_tunable_that_some_choices_lack_splits_no_groups(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    for layout in ("aos", "soa"):
        builder.cell("compaction", axes={"layout": layout})
        for choice in ("a", "b", "c", "d"):
            for payload in (0, 1):
                axes = {"compaction": choice, "layout": layout}
                builder.cell("compaction", axes=axes, tunables={"payload": payload}, standards={"payload": 0})
    data, figure = drawn(builder, tmp_path)
    assert [group.title.rpartition(", ")[2] for group in data.groups] == ["layout=aos", "layout=soa"]
    labels = [item.label for item in data.groups[0].items]
    assert labels[0] == "none"
    assert set(labels[1:]) == {f"{choice}, payload={payload}" for choice in "abcd" for payload in (0, 1)}
    check_legible(figure, "compaction")


def test_many_lines_are_split_into_panels(tmp_path):
    builder = Builder().on_gpu().study("sorting_by_depth")
    for depth in (2, 4, 8):
        for layout in ("aos", "soa", "packed"):
            for sorting in ("none", "cub_radix", "bucket"):
                axes = {"sorting": sorting, "layout": layout}
                builder.cell("sorting_by_depth", depth=depth, ms_per_spp=depth, axes=axes)
    data, figure = drawn(builder, tmp_path)
    assert [panel.title for panel in data.panels] == [
        f"cornell_open, layout={layout}" for layout in ("aos", "soa", "packed")
    ]
    assert data.order == ("none", "cub_radix", "bucket")
    check_legible(figure, "sorting_by_depth")


def test_keys_in_the_order_of_the_file():
    assert in_file_order([("b", 2), ("b", 1), ("a", 1), ("b", 2), ("a", 2)]) == [
        ("b", 2), ("b", 1), ("a", 2), ("a", 1),
    ]  # fmt: skip
    assert in_file_order([("b", "16"), ("b", "4"), ("a", "4")]) == [("b", "4"), ("b", "16"), ("a", "4")]
    assert in_file_order([("b", "16"), ("b", None), ("b", "4")]) == [("b", "16"), ("b", None), ("b", "4")]
    assert in_file_order([]) == []


def test_an_axis_over_almost_two_decades_has_ticks_between_the_powers_of_ten(tmp_path):
    builder = Builder().on_gpu().study("integrator")
    for integrator, time in (("wavefront", 3.44), ("megakernel", 0.0485)):
        builder.cell("integrator", ms_per_spp=time, axes={"integrator": integrator})
    _, figure = drawn(builder, tmp_path)
    check_legible(figure, "integrator")
    assert {"0.05", "0.1", "0.2", "0.5", "1", "2"} <= {text.get_text() for text in texts_of(figure)}


# ---- What is not applicable ----


def test_choices_of_another_backend_are_one_note_and_no_rows(tmp_path, analysis):
    builder = Builder("both").on_gpu().study("integrator")
    builder.cell("integrator")
    builder.cell("integrator", axes={"integrator": "megakernel"})
    for scene in ("cornell_open", "cornell_closed"):
        reason = "integrator=depth_first is not there on the backend cuda"
        builder.skip("integrator", scene, reason, {"integrator": "depth_first"})
        reason = "compaction=std_remove_if is not there on the backend cuda"
        builder.skip("integrator", scene, reason, {"compaction": "std_remove_if"})
    builder.skip("integrator", "cornell_open", "needs more memory", {"integrator": "persistent"})
    data, _ = drawn(builder, tmp_path)
    assert [item.label for item in data.groups[0].items] == ["wavefront", "megakernel", "persistent"]
    assert [note.kind for note in data.notes if note.kind in ("n/a", "other backend")] == ["n/a", "other backend"]
    text = "ot on the backend cuda: integrator=depth_first, compaction=std_remove_if"
    assert f"N{text}." in data.caption
    code, out, _ = analysis("plots", tmp_path / "result.json")
    assert code == 0
    assert f"note: integrator: other backend: n{text}\n" in out
    # The table of what is not applicable leaves nothing out.
    summary = (tmp_path / "figures" / "both-result" / "summary.md").read_text()
    assert summary.count("is not there on the backend cuda") == 4


def test_a_variant_that_was_run_without_the_studys_tunable_is_not_missed(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", axes={"layout": "aos"})
    builder.cell("compaction", axes={"layout": "soa"})
    reason = "payload=1 tunes none of the variant's choices"
    builder.skip("compaction", "cornell_open", reason, {}, tuned="+payload=1")
    data, _ = drawn(builder, tmp_path)
    assert [item.label for item in data.groups[0].items] == ["none, layout=aos", "none, layout=soa"]
    assert "Not applicable" not in data.caption
    # A choice that was not run at all is shown as not applicable.
    builder.skip("compaction", "cornell_open", reason, {"compaction": "gap_fill"}, tuned="+payload=1")
    data, _ = drawn(builder, tmp_path)
    assert [item.label for item in data.groups[0].items if item.instead] == ["gap_fill"]
    assert f"Not applicable: gap_fill in cornell_open ({reason})." in data.caption


def test_a_choice_that_was_run_in_some_ways_is_not_shown_as_not_applicable(tmp_path):
    builder = Builder().on_gpu().study("sorting")
    builder.cell("sorting")
    builder.cell("sorting", axes={"sorting": "cub_radix", "sort_key": "ray"})
    builder.cell("sorting", axes={"sorting": "cub_radix"})
    builder.skip("sorting", "cornell_open", "sort_key=ray needs a sort, not sorting=none", {"sort_key": "ray"})
    data, _ = drawn(builder, tmp_path)
    assert [item.label for item in data.groups[0].items if item.instead] == []
    assert "Not applicable: none in cornell_open (sort_key=ray needs a sort, not sorting=none)." in data.caption


def test_older_files_keep_the_row_of_such_a_choice(tmp_path):
    builder = Builder().study("integrator")
    builder.cell("integrator")
    builder.cell("integrator", axes={"layout": "soa"})
    builder.cell("integrator", axes={"integrator": "depth_first"})
    builder.skip("integrator", "cornell_open", "needs layout=aos", {"integrator": "depth_first", "layout": "soa"})
    data, _ = drawn(builder, tmp_path)
    assert [item.label for item in data.groups[0].items if item.instead] == ["depth_first"]


def test_what_does_not_apply_stands_in_its_own_group(tmp_path):
    builder = wide(9)
    builder.skip("compaction", "cornell_open", "too wide", {"compaction": "warp", "layout": "packed"})
    data, _ = drawn(builder, tmp_path)
    assert [[item.label for item in group.items if item.instead] for group in data.groups] == [[], [], ["warp"]]


# ---- What figures and tables say ----


def everything(tmp_path) -> Builder:
    builder = Builder("gpu").on_gpu()
    for name in ("remaining_paths", "sorting_by_depth", "compaction", "arithmetic"):
        builder.study(name)
    for scene in LIVE:
        builder.cell("remaining_paths", scene, live_paths=LIVE[scene], axes={"integrator": "megakernel"})
        for depth in (2, 4):
            for sorting in ("none", "bucket"):
                axes = {"sorting": sorting, "layout": "soa"}
                builder.cell("sorting_by_depth", scene, depth=depth, axes=axes, clock_mhz=1979.6)
        for choice in ("none", "gap_fill"):
            builder.cell("compaction", scene, axes={"compaction": choice, "integrator": "wavefront_fused"})
        for arithmetic in ("precise", "exact"):
            builder.cell("arithmetic", scene, axes={"arithmetic": arithmetic, "layout": "packed"})
    return builder


def test_every_caption_names_the_gpu_and_no_page_speaks_of_the_host(tmp_path):
    result = loaded(everything(tmp_path), tmp_path)
    for study in result.studies:
        data = collect_study(result, study)
        for needed in (
            "Machine nvidia-h200: backend cuda;",
            "GPU NVIDIA H200 (compute capability 9.0, 132 multiprocessors)",
            "clock rated 1980 MHz, ",
            "CUDA driver 13.0, NVRTC 13.1",
            "precision float",
        ):
            assert needed in data.caption, (study.name, needed)
        arithmetic = "arithmetic precise, exact;" if study.name == "arithmetic" else "arithmetic precise;"
        assert arithmetic in data.caption, study.name
        figure = draw(data)
        for text in texts_of(figure):
            for host in ("CPU", "threads", "Xeon"):
                assert host not in text.get_text(), (study.name, text.get_text())
        check_legible(figure, study.name)
    by_depth = collect_study(result, result.studies[1])
    assert "1980 MHz round the samples" in by_depth.caption
    assert "tunables block=256" in by_depth.caption
    assert "arithmetic=" not in by_depth.caption


def test_a_busy_host_is_told_of_on_a_gpu_too(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", ms_per_spp=2.0, noise=0.001)
    builder.cell("compaction", ms_per_spp=1.0, noise=0.001, axes={"compaction": "gap_fill"}, contended=2)
    result = loaded(builder, tmp_path)
    rows = measure(result, result.studies[0])
    assert rows[1].verdict.word == "UNSURE"
    assert "other processes took CPU time" in rows[1].verdict.reason
    notes = notes_of(result, result.studies[0], rows)
    assert [note.kind for note in notes] == ["contended"]
    # Half the time and UNSURE: the figure has to say why.
    assert notes[0].short.endswith(" of the CPU, kept (1 verdict UNSURE for that).")


def test_a_busy_host_that_the_device_did_not_wait_for_voids_no_verdict(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", ms_per_spp=2.0, noise=0.001)
    builder.cell(
        "compaction", ms_per_spp=1.0, noise=0.001, axes={"compaction": "gap_fill"}, contended=2, device_share=0.99
    )
    result = loaded(builder, tmp_path)
    rows = measure(result, result.studies[0])
    assert rows[1].verdict.word == "FASTER"
    # The contended sample is told of, though the verdict stands.
    assert [note.kind for note in notes_of(result, result.studies[0], rows)] == ["contended"]


def test_a_busy_sample_that_voids_no_verdict_is_told_of_without_one(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction", n=20, contended=1)
    builder.cell("compaction", n=20, axes={"compaction": "gap_fill"})
    result = loaded(builder, tmp_path)
    rows = measure(result, result.studies[0])
    assert [note.short[-4:] for note in notes_of(result, result.studies[0], rows)] == ["ept."]


def test_a_failure_is_told_without_the_cells_own_name(tmp_path):
    builder = Builder().on_gpu().study("compaction")
    builder.cell("compaction")
    cell = builder.cell("compaction", axes={"compaction": "gap_fill"}, n=0, status="failed")
    cell["reason"] = f"{cell['variant']} of cornell_open at 200x200, 4 spp on NVIDIA H200: no 7 GiB: out of memory"
    data, _ = drawn(builder, tmp_path)
    assert "Failed: gap_fill in cornell_open at depth 8 (no 7 GiB: out of memory)." in data.caption


def test_the_summary_of_a_gpu_file(tmp_path, analysis):
    builder = Builder("gpu").on_gpu().study("compaction")
    builder.cell("compaction", ms_per_spp=2.0, live_paths=[10, 5])
    builder.cell("compaction", ms_per_spp=1.0, axes={"compaction": "gap_fill"}, tunables={"block": 64})
    builder.cell("compaction", axes={"compaction": "cub_select_if"}, error="out of memory")["cuda"] = {}
    code, _, _ = analysis("plots", builder.write(tmp_path / "gpu.json"))
    assert code == 0
    summary = (tmp_path / "figures" / "gpu" / "summary.md").read_text()
    lines = [[part.strip() for part in line.split("|")[1:-1]] for line in summary.splitlines() if line.startswith("|")]
    head, _, none, gap_fill, failed = lines[:5]
    columns = {name: head.index(name) for name in head}
    shown = [
        [row[columns[name]] for name in ("Device/wall", "Launches/spp", "Host waits/spp", "Hottest kernel's registers")]
        for row in (none, gap_fill, failed)
    ]
    assert shown == [
        ["0.900", "24", "7", "intersect_paths 31"],
        ["0.900", "24", "7", "shade_paths 40 + 8 B local"],
        ["—", "24", "7", "—"],
    ]
    assert "\nGPU NVIDIA H200 (compute capability 9.0, 132 multiprocessors); clock rated 1980 MHz" in summary
    assert "- GPU: NVIDIA H200, compute capability 9.0, multiprocessors: 132" in summary
    assert "- NVRTC options of every cell: `--gpu-architecture=sm_90`" in summary
    assert "- Host: Intel(R) Xeon(R) CPU E5-2690, 16 threads" in summary
    device = summary.partition("## On the device")[2]
    assert (
        "| cornell_open | 200x200 | 64 | 3.0 | 96 | 0.5000 "
        "| generate_paths 26/0/0, intersect_paths 31/0/4, shade_paths 40/8/4 |" in device
    )


def test_the_summary_of_a_graph_launch(tmp_path, analysis):
    builder = Builder("gpu").on_gpu().study("launch")
    builder.cell("launch")
    builder.cell(
        "launch", axes={"launch": "graph"}, sample_work={"launches": 1.0, "graph_nodes": 96.0, "host_waits": 0}
    )
    code, _, _ = analysis("plots", builder.write(tmp_path / "gpu.json"))
    assert code == 0
    summary = (tmp_path / "figures" / "gpu" / "summary.md").read_text()
    assert "| 0.900 | 0.25 (24 graph nodes) | 0 |" in summary


def test_a_summary_says_which_baseline_stands_in(tmp_path, analysis):
    builder = Builder("gpu").on_gpu().study("integrator")
    for integrator in ("megakernel", "persistent"):
        builder.cell("integrator", axes={"integrator": integrator})
    analysis("plots", builder.write(tmp_path / "gpu.json"))
    summary = (tmp_path / "figures" / "gpu" / "summary.md").read_text()
    expected = "Baseline: integrator=megakernel, all else equal. The study was not run with integrator=wavefront."
    assert expected in summary


def test_the_summary_of_a_cpu_file_has_none_of_it(quick_run):
    summary = (quick_run[1] / "summary.md").read_text()
    for absent in ("GPU", "Device/wall", "On the device", "NVRTC", "Host waits", "tunables"):
        assert absent not in summary
    assert "- Machine: amd-epyc-2-cores: AMD EPYC 7763 64-Core Processor, 2 threads" in summary


def test_where_the_time_goes_tells_sizes_apart(tmp_path, analysis):
    builder = Builder("sizes").on_gpu().study("compaction")
    for side in (64, 128):
        builder.cell("compaction", resolution=[side, side], live_paths=[10, 5])
    analysis("plots", builder.write(tmp_path / "sizes.json"))
    stages = (tmp_path / "figures/sizes/summary.md").read_text().partition("## Where the time goes")[2]
    assert "| Variant | Scene | Depth | Resolution | generate |" in stages
    assert "| cornell_open | 8 | 128x128 | 7.6 % |" in stages


def test_figures_are_the_ones_that_suites_may_name(tmp_path):
    assert figure_names(loaded(Builder().on_gpu().study("compaction"), tmp_path)) == [
        "remaining_paths",
        "sorting_by_depth",
        "first_bounce_by_depth",
        "scaling_by_resolution",
        "scaling_by_depth",
        "scaling_by_materials",
        "scaling_by_shading_fmas",
        *GPU_AXES,
        "robustness",
        "devices",
        "convergence",
    ]
