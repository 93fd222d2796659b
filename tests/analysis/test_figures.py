"""What the figures show: the numbers they compute, and that nothing of a page overlaps or is cut off."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from builder import CLOSED, OPEN, Builder, small
from legibility import check_legible

from ptbench import numbers
from ptbench.errors import NotDrawable
from ptbench.figures import lines, rows, style
from ptbench.figures.registry import collect_study, draw
from ptbench.io.results import load

SMALL = ("remaining_paths", "sorting_by_depth", "first_bounce_by_depth", "compaction", "integrator")


def collected(builder: Builder, tmp_path, name: str):
    result = load(builder.write(tmp_path / "result.json"))
    study = next(study for study in result.studies if study.name == name)
    return result, study, collect_study(result, study)


def test_remaining_paths_are_the_files_counts(tmp_path):
    _, _, data = collected(small(), tmp_path, "remaining_paths")
    assert [line.scene for line in data.lines] == ["cornell_open", "cornell_closed"]
    assert data.lines[0].counts == tuple(OPEN)
    assert data.lines[1].counts == tuple(CLOSED)
    assert data.lines[0].fractions == pytest.approx([count / 40000 for count in OPEN])


def along_depth(tmp_path, axis: str, **asked: str):
    """A file whose one study has two choices of the axis at two depths."""
    builder = Builder().study("asked")
    for depth in (4, 8):
        builder.cell("asked", depth=depth)
        builder.cell("asked", depth=depth, axes={axis: "other"})
    builder.studies = [{"name": "asked", "title": "", **asked}]
    result = load(builder.write(tmp_path / "result.json"))
    return result, result.studies[0]


@pytest.mark.parametrize(
    ("axis", "title"), [("sorting", "Material sorting: time by depth"), ("layout", "Time by path depth")]
)
def test_an_axis_may_have_a_figure_of_its_own_along_something(tmp_path, axis, title):
    result, study = along_depth(tmp_path, axis, compares=axis, along="depth", type="time")
    assert collect_study(result, study).title == title


def test_an_older_file_that_names_that_figure_compares_the_axis_along_the_depth(tmp_path):
    result, study = along_depth(tmp_path, "sorting", figure="sorting_by_depth")
    assert (study.compares, study.along) == ("sorting", "depth")
    assert collect_study(result, study).title == "Material sorting: time by depth"
    with pytest.raises(NotDrawable, match='no figure is called "layout_by_depth"'):
        collect_study(*along_depth(tmp_path, "layout", figure="layout_by_depth"))


def test_counts_are_per_spp_and_shares_are_of_all_paths(tmp_path):
    builder = Builder().study("remaining_paths")
    cell = builder.cell("remaining_paths", live_paths=[800, 200])
    cell["instrumented"] |= {"spp": 2, "paths": 1000}
    _, _, data = collected(builder, tmp_path, "remaining_paths")
    assert data.lines[0].counts == (400, 100)
    assert data.lines[0].fractions == (0.8, 0.2)


def test_remaining_paths_draw_the_deepest_cell(tmp_path):
    builder = Builder().study("remaining_paths")
    for depth in (2, 8, 4):
        builder.cell("remaining_paths", depth=depth, live_paths=OPEN[:depth])
    _, _, data = collected(builder, tmp_path, "remaining_paths")
    assert len(data.lines) == 1
    assert len(data.lines[0].counts) == 8


def test_remaining_paths_say_which_counts_are_missing_differ_or_cannot_be(tmp_path):
    builder = Builder().study("remaining_paths")
    builder.cell("remaining_paths", "fine", live_paths=[100, 50])
    builder.cell("remaining_paths", "fine", live_paths=[100, 49], axes={"layout": "soa"})
    builder.cell("remaining_paths", "none")
    builder.cell("remaining_paths", "rising", live_paths=[100, 50, 60])
    _, _, data = collected(builder, tmp_path, "remaining_paths")
    assert [line.scene for line in data.lines] == ["fine"]
    kinds = [note.kind for note in data.notes]
    assert kinds == ["counts differ", "no counts", "wrong counts"]
    assert "rising: live paths rise at bounce 2" in data.caption


def test_no_counts_at_all_is_not_drawable(tmp_path):
    builder = Builder().study("remaining_paths")
    builder.cell("remaining_paths")
    with pytest.raises(NotDrawable, match="cornell_open: no live path counts"):
        collected(builder, tmp_path, "remaining_paths")


@pytest.mark.parametrize(
    ("name", "other", "factor"),
    [("sorting_by_depth", "material", lambda depth: 3.0), ("first_bounce_by_depth", "cached", lambda d: 1 - 0.3 / d)],
)
def test_times_by_depth_are_the_files_medians(tmp_path, name, other, factor):
    _, _, data = collected(small(), tmp_path, name)
    baseline = "none" if name == "sorting_by_depth" else "off"
    assert data.order == (baseline, other)
    assert [panel.title for panel in data.panels] == ["cornell_open", "cornell_closed"]
    for panel, slower in zip(data.panels, (1.0, 1.6), strict=True):
        base, varied = panel.lines
        assert (base.label, varied.label) == (baseline, other)
        assert base.is_baseline
        assert base.xs == varied.xs == (2, 4, 8)
        assert [t.value for t in base.times] == pytest.approx([slower * 0.4 * depth for depth in (2, 4, 8)])
        assert [t.value for t in varied.times] == pytest.approx(
            [slower * 0.4 * depth * factor(depth) for depth in (2, 4, 8)]
        )
        assert base.ratios == (None, None, None)
        assert [r.value for r in varied.ratios] == pytest.approx([factor(depth) for depth in (2, 4, 8)])
        # From the 2nd to the 8th of nine samples: 3/4 of the spread below, three times that above.
        assert [t.low / t.value for t in base.times] == pytest.approx([0.985] * 3)
        assert [t.high / t.value for t in base.times] == pytest.approx([1.045] * 3)


def test_the_lines_drawn_are_the_numbers_collected(tmp_path):
    _, _study, data = collected(small(), tmp_path, "sorting_by_depth")
    axes = draw(data).axes[0]
    drawn = [line for line in axes.get_lines() if line.get_linestyle() != "None" and len(line.get_xdata()) == 3]
    for line, shown in zip(data.panels[0].lines, drawn, strict=True):
        assert list(shown.get_xdata()) == list(line.xs)
        assert list(shown.get_ydata()) == pytest.approx([time.value for time in line.times])
    looks = [(line.get_color(), line.get_marker(), line.get_linestyle()) for line in drawn]
    assert all(a != b for one, two in combinations(looks, 2) for a, b in zip(one, two, strict=True))


def test_compaction_rows_are_the_files_medians_and_ratios(tmp_path):
    _, _, data = collected(small(), tmp_path, "compaction")
    assert [group.title for group in data.groups] == ["cornell_open, depth 8", "cornell_closed, depth 8"]
    items = data.groups[1].items
    # The baseline first, then from fast to slow.
    assert [item.label for item in items] == ["none", "scatter", "thrust_remove_if", "thrust_partition"]
    assert [item.time.value for item in items] == pytest.approx([4.8, 4.8 * 0.9, 4.8 * 1.05, 4.8 * 1.4])
    assert [item.ratio and item.ratio.value for item in items] == pytest.approx([None, 0.9, 1.05, 1.4])
    assert [item.verdict and item.verdict.word for item in items] == [None, "FASTER", "UNSURE", "SLOWER"]


def test_dots_drawn_are_the_medians(tmp_path):
    _, _study, data = collected(small(), tmp_path, "compaction")
    axes = draw(data).axes[0]
    dots = [line for line in axes.get_lines() if len(line.get_xdata()) == 1 and line.get_marker() != "None"]
    assert [dot.get_xdata()[0] for dot in dots] == pytest.approx([item.time.value for item in data.groups[0].items])


def test_failed_and_not_applicable_choices_keep_their_rows(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    builder.cell("compaction", axes={"compaction": "broken"}, error="illegal address", n=2)
    builder.skip("compaction", "cornell_open", "needs warps", {"compaction": "warp"})
    _, _, data = collected(builder, tmp_path, "compaction")
    assert [(item.label, item.instead) for item in data.groups[0].items] == [
        ("none", ""),
        ("broken", "failed"),
        ("warp", "n/a"),
    ]
    assert "Failed: broken in cornell_open at depth 8 (illegal address)." in data.caption
    assert "Not applicable: warp in cornell_open (needs warps)." in data.caption


def test_one_depth_is_drawn_as_rows(tmp_path):
    builder = Builder().study("sorting_by_depth")
    builder.cell("sorting_by_depth", ms_per_spp=2)
    builder.cell("sorting_by_depth", ms_per_spp=6, axes={"sorting": "material"})
    _, _, data = collected(builder, tmp_path, "sorting_by_depth")
    assert isinstance(data, rows.Data)
    assert [item.time.value for item in data.groups[0].items] == pytest.approx([2, 6])


def test_other_axes_that_vary_become_lines_of_their_own_with_their_own_baseline(tmp_path):
    builder = Builder().study("sorting_by_depth")
    for depth in (2, 4):
        for integrator, factor in (("wavefront", 1), ("megakernel", 0.5)):
            for sorting, more in (("none", 1), ("material", 4)):
                axes = {"integrator": integrator, "sorting": sorting}
                builder.cell("sorting_by_depth", ms_per_spp=depth * factor * more, depth=depth, axes=axes)
    _, _, data = collected(builder, tmp_path, "sorting_by_depth")
    assert isinstance(data, lines.Data)
    assert data.order == (
        "none, integrator=wavefront",
        "none, integrator=megakernel",
        "material, integrator=wavefront",
        "material, integrator=megakernel",
    )
    ratios = [[ratio.value for ratio in line.ratios] for line in data.panels[0].lines[2:]]
    assert np.array(ratios) == pytest.approx(4)


def test_the_caption_says_what_is_needed_to_trust_the_figure(tmp_path):
    builder = small()
    builder.context["ptbench.git_dirty"] = "true"
    for name in SMALL:
        _, _, data = collected(builder, tmp_path, name)
        for needed in (
            "amd-epyc-2-cores",
            "AMD EPYC 7763",
            "2 threads",
            "backend cpu",
            "cornell_open, cornell_closed",
            "200×200",
            "4 spp",
            "git 0123abcd4567 (dirty)",
        ):
            assert needed in data.caption, (name, needed)
        if name == "remaining_paths":
            assert "no interval" in data.caption
        else:
            assert "n = 9 samples" in data.caption
            assert "95 % percentile bootstrap of the median (10 000 resamples, fixed seed)" in data.caption


def test_the_caption_says_what_is_amiss(tmp_path):
    builder = Builder().study("compaction")
    builder.context["ptbench.status"] = "interrupted"
    builder.cell("compaction", n=9, low_clock=2)
    builder.cell("compaction", n=4, axes={"compaction": "a"}, status="interrupted")
    builder.cell("compaction", n=9, axes={"compaction": "b"}, claim="biased", nonfinite=3)
    builder.cell("compaction", n=0, axes={"compaction": "c"}, status="interrupted")
    _, _, data = collected(builder, tmp_path, "compaction")
    for said in (
        "Run interrupted: cells and samples may be missing.",
        "2 cells interrupted while measuring.",
        "1 cell without a sample.",
        "1 cell with fewer than 9 samples (no verdict).",
        "2 of 22 samples at a low clock, kept.",
        "Declared biased: b.",
        "1 cell with nonfinite film values.",
        "n = 4 to 9 samples",
    ):
        assert said in data.caption, said


def many(choices: int, depths: int, scenes: int, long_names: bool) -> Builder:
    builder = Builder().study("remaining_paths").study("sorting_by_depth").study("compaction")
    for scene in range(scenes):
        name = f"scene_{scene}" + ("_whose_name_is_rather_long_for_a_label" if long_names else "")
        builder.cell("remaining_paths", name, live_paths=[9000000 - 7 * k for k in range(3 * depths)], depth=64)
        for choice in range(choices):
            label = "none" if choice == 0 else f"choice_{choice}" + ("_and_some_more_words" if long_names else "")
            for depth in range(1, depths + 1):
                # All lines end within a tenth: their labels have to be moved apart.
                time = depth * (1 + 0.1 * choice / choices)
                builder.cell("sorting_by_depth", name, time, depth=depth, n=2, axes={"sorting": label, "layout": "x"})
            time = 0.002 * 10 ** (4 * choice / choices)
            builder.cell("compaction", name, time, n=2, axes={"compaction": label, "layout": "y"})
    return builder


@pytest.mark.parametrize(
    ("choices", "depths", "scenes", "long_names"),
    [(2, 1, 1, False), (12, 8, 2, False), (12, 3, 1, True), (3, 2, 5, True), (2, 30, 2, False)],
)
def test_nothing_overlaps_or_is_cut_off(tmp_path, choices, depths, scenes, long_names):
    for name in ("remaining_paths", "sorting_by_depth", "compaction"):
        _, _study, data = collected(many(choices, depths, scenes, long_names), tmp_path, name)
        check_legible(draw(data), name)


def test_twelve_looks_differ_pairwise_in_marker_and_in_colour_or_line():
    looks = [style.look(index) for index in range(12)]
    assert len({look.marker for look in looks}) == 12
    assert len({(look.colour, str(look.line)) for look in looks}) == 12


@pytest.mark.parametrize(
    ("targets", "sizes", "expected"),
    [
        ([5.0, 1.0], [1, 1], [5.0, 1.0]),
        ([5.0, 5.0], [1, 1], [4.5, 5.5]),
        ([5.0, 5.0, 5.0], [1, 1, 1], [4.0, 5.0, 6.0]),
        ([0.0, 9.0], [1, 1], [0.5, 9.0]),
        ([10.0, 10.0], [1, 2], [7.5, 9.0]),
    ],
)
def test_labels_move_as_little_as_they_can(targets, sizes, expected):
    assert style.spread(targets, sizes, 0, 10) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (1.23456, "1.235"),
        (12, "12.00"),
        (123.456, "123.5"),
        (999.99, "1000"),
        (1234.5, "1234"),
        (56789, "56789"),
        (0.0123456, "0.01235"),
        (0.00001234, "1.234e-05"),
    ],
)
def test_numbers(value, text):
    assert numbers.figures(value) == text


def test_integrators_are_held_against_the_wavefront_of_the_same_layout(tmp_path):
    builder = Builder().study("integrator")
    for integrator, layout, wall in (("wavefront", "aos", 8.0), ("wavefront", "soa", 6.0), ("depth_first", "aos", 4.0)):
        builder.cell("integrator", "cornell_open", wall, axes={"integrator": integrator, "layout": layout}, n=9)
    _, _, data = collected(builder, tmp_path, "integrator")
    ratios = {item.label: item.ratio.value if item.ratio else None for item in data.groups[0].items}
    assert ratios["wavefront, layout=aos"] is None
    assert ratios["wavefront, layout=soa"] is None
    assert ratios["depth_first, layout=aos"] == pytest.approx(0.5, rel=0.1)


def test_an_axis_is_a_figure_of_its_own(tmp_path):
    builder = Builder().study("layout")
    for layout, wall in (("aos", 8.0), ("soa", 6.0)):
        builder.cell("layout", "cornell_open", wall, axes={"layout": layout}, n=9)
    _, _, data = collected(builder, tmp_path, "layout")
    assert data.title == "The choices of layout against each other"
    aos, soa = data.groups[0].items
    assert (aos.label, aos.is_baseline, aos.ratio) == ("aos", True, None)
    assert (soa.label, soa.is_baseline) == ("soa", False)
    assert soa.ratio.value == pytest.approx(0.75, rel=0.1)
