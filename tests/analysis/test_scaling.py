"""The figures that follow a cost: what is drawn where, and from where on one choice is said to overtake another."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from builder import Builder, crossing
from legibility import check_legible, texts_of
from matplotlib.figure import Figure

from ptbench.errors import NotDrawable
from ptbench.figures import lines, rows
from ptbench.figures.registry import collect_study, draw
from ptbench.figures.scaling import SWEEPS, Place, numbered_scenes
from ptbench.io.results import load
from ptbench.stats.estimates import Estimate, Verdict, verdict_of_ratio
from ptbench.studies.crossover import crossover_of
from ptbench.studies.questions import Question, question_of
from ptbench.studies.rows import Row

RESOLUTION, DEPTH, MATERIALS, FMAS = SWEEPS


def drawn(builder: Builder, tmp_path, name: str):
    result = load(builder.write(tmp_path / "result.json"))
    study = next(study for study in result.studies if study.name == name)
    data = collect_study(result, study)
    return data, draw(data)


def line_of(data: lines.Data, label: str, panel: int = 0) -> lines.Line:
    return next(line for line in data.panels[panel].lines if line.label == label)


# ---- What is drawn ----


@pytest.mark.parametrize(
    ("figure", "panel", "xs", "base"),
    [
        (RESOLUTION, "box", [64**2, 128**2, 256**2, 512**2], lambda x: 0.5 * x / 64**2),
        (DEPTH, "box", [2, 4, 8, 16, 32, 64], lambda x: x / 2),
        (MATERIALS, "materials", [1, 2, 4, 8, 16, 32, 64], lambda x: 0.9 * x),
        (FMAS, "heavy", [0, 16, 64, 256, 1024, 4096], lambda x: 1 + x / 64),
    ],
)
def test_times_and_ratios_are_the_files(tmp_path, figure, panel, xs, base):
    data, page = drawn(crossing(), tmp_path, figure)
    assert data.order == ("none", "bucket", "late", "always")
    assert data.baseline == "sorting=none"
    assert [p.title for p in data.panels] == [panel]
    for label, time in (
        ("none", lambda b: b), ("bucket", lambda b: 1 + 0.8 * b), ("late", lambda b: b + 0.5),
        ("always", lambda b: 0.7 * b),
    ):  # fmt: skip
        line = line_of(data, label)
        assert list(line.xs) == xs
        assert [t.value for t in line.times] == pytest.approx([time(base(x)) for x in xs])
        if label == "none":
            assert line.ratios == (None,) * len(xs)
        else:
            assert [r.value for r in line.ratios] == pytest.approx([time(base(x)) / base(x) for x in xs])
    times, ratios = page.axes
    assert times.get_yscale() == ratios.get_yscale() == "log"
    assert times.get_xscale() == ratios.get_xscale() == ("symlog" if figure == FMAS else "log")
    # 1 is marked by a line and has a tick.
    assert any(list(line.get_ydata()) == [1, 1] for line in ratios.get_lines())
    assert 1.0 in ratios.get_yticks()
    check_legible(page, figure)


def test_no_multiply_adds_stand_at_the_left(tmp_path):
    _, page = drawn(crossing(), tmp_path, FMAS)
    axes = page.axes[1]
    places = [axes.transAxes.inverted().transform(axes.transData.transform((x, 1)))[0] for x in (0, 16, 64, 256)]
    assert 0 < places[0] < 0.1
    steps = [b - a for a, b in pairwise(places)]
    # Two octaves each, and the step from 0 as wide.
    assert steps == pytest.approx([steps[0]] * 3)
    assert axes.get_xlabel() == "Multiply-adds injected into a shading (log scale right of 0)"


def test_ticks_of_image_sizes(tmp_path):
    builder = Builder().on_gpu().study(RESOLUTION)
    for size in ([640, 360], [1024, 1024]):
        builder.cell(RESOLUTION, resolution=size)
    data, page = drawn(builder, tmp_path, RESOLUTION)
    page.draw_without_rendering()
    assert [data.abscissa.tick(x) for x in data.panels[0].xs] == ["640×360", "1024²"]
    assert page.axes[0].get_xlabel() == "Image size (pixels, log scale)"


def test_lines_are_labelled_by_all_that_varies(tmp_path):
    builder = Builder().on_gpu().study(RESOLUTION)
    for side in (64, 128):
        for compaction, faster in (("none", 1.0), ("gap_fill", 0.5)):
            for depth in (4, 8):
                axes = {"compaction": compaction}
                time = side / 64 * faster * depth
                builder.cell(RESOLUTION, resolution=[side, side], depth=depth, axes=axes, ms_per_spp=time)
    data, _ = drawn(builder, tmp_path, RESOLUTION)
    assert data.order == ("none, depth=4", "none, depth=8", "gap_fill, depth=4", "gap_fill, depth=8")
    assert [r.value for r in line_of(data, "gap_fill, depth=8").ratios] == pytest.approx([0.5, 0.5])


def test_the_question_is_the_first_axis_that_varies(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth in (2, 4):
        for sorting in ("none", "bucket"):
            for layout in ("soa", "packed"):
                builder.cell(DEPTH, depth=depth, axes={"sorting": sorting, "layout": layout})
    result = load(builder.write(tmp_path / "x.json"))
    assert question_of(result, result.studies[0]) == Question("sorting", "none")
    for cell in builder.cells:
        cell["axes"]["sorting"] = "bucket"
    result = load(builder.write(tmp_path / "x.json"))
    # Without the file's baseline, its first choice.
    assert question_of(result, result.studies[0]) == Question("layout", "soa")
    for cell in builder.cells:
        cell["axes"]["layout"] = "soa"
    result = load(builder.write(tmp_path / "x.json"))
    assert question_of(result, result.studies[0]) is None


def test_the_tunable_along_x_is_matched_and_not_told(tmp_path):
    data, _ = drawn(crossing(), tmp_path, FMAS)
    assert all("shading_fmas" not in label for label in data.order)
    assert "shading_fmas" not in data.caption
    assert "tunables block=256, spp_in_flight=1" in data.caption


def test_one_choice_alone_is_a_line_without_ratios(tmp_path):
    builder = Builder().on_gpu().study(FMAS)
    for fmas in (0, 8, 64):
        builder.cell(FMAS, tunables={"shading_fmas": fmas}, axes={"integrator": "persistent"}, ms_per_spp=1 + fmas)
    data, page = drawn(builder, tmp_path, FMAS)
    assert data.order == ("persistent",)
    assert data.baseline == ""
    assert len(page.axes) == 1
    assert "ratios" not in data.caption
    assert "Crossover" not in data.caption
    check_legible(page, FMAS)


def test_tunables_alone_are_lines_without_ratios(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth in (2, 4):
        for block in (64, 256):
            builder.cell(DEPTH, depth=depth, tunables={"block": block})
    data, _ = drawn(builder, tmp_path, DEPTH)
    assert data.order == ("block=64", "block=256")


def test_cells_without_the_tunable_are_not_drawn_in_silence(tmp_path):
    builder = Builder().on_gpu().study(FMAS)
    for fmas in (0, 8):
        builder.cell(FMAS, tunables={"shading_fmas": fmas})
    del builder.cell(FMAS, axes={"integrator": "foreign"})["tunables"]["shading_fmas"]
    data, _ = drawn(builder, tmp_path, FMAS)
    assert data.order == ("wavefront",)
    assert "1 of 3 cells have no place along x." in data.caption


def test_a_file_that_has_not_what_the_figure_follows(tmp_path):
    builder = Builder().study(FMAS)
    builder.cell(FMAS)
    with pytest.raises(NotDrawable, match="no cell has what scaling_by_shading_fmas follows"):
        drawn(builder, tmp_path, FMAS)


def test_one_x_is_drawn_as_rows_or_not_at_all(tmp_path):
    builder = Builder().on_gpu().study(RESOLUTION)
    builder.cell(RESOLUTION, ms_per_spp=2.0)
    with pytest.raises(NotDrawable, match="all cells have one x and one choice"):
        drawn(builder, tmp_path, RESOLUTION)
    builder.cell(RESOLUTION, ms_per_spp=1.0, axes={"layout": "soa"})
    data, page = drawn(builder, tmp_path, RESOLUTION)
    assert isinstance(data, rows.Data)
    assert data.groups[0].items[1].ratio.value == pytest.approx(0.5)
    check_legible(page, RESOLUTION)


def test_nothing_timed_is_not_drawable(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    builder.cell(DEPTH, error="out of memory")
    with pytest.raises(NotDrawable, match=r"no cell has times: .*out of memory"):
        drawn(builder, tmp_path, DEPTH)


def test_a_cpu_file_without_baselines_is_drawn_too(tmp_path):
    builder = Builder().study(DEPTH)
    for depth in (2, 4, 8):
        builder.cell(DEPTH, depth=depth, ms_per_spp=depth)
        builder.cell(DEPTH, depth=depth, ms_per_spp=depth - 1, axes={"sorting": "bucket"})
    data, page = drawn(builder, tmp_path, DEPTH)
    assert data.baseline == "sorting=none"
    assert "2 threads, backend cpu" in data.caption
    check_legible(page, DEPTH)


# ---- Scenes by number ----


def test_scenes_are_numbered_by_the_end_of_their_names():
    assert numbered_scenes(["materials_01", "materials_08", "materials_64"]) == {
        "materials_01": Place("materials", 1),
        "materials_08": Place("materials", 8),
        "materials_64": Place("materials", 64),
    }
    assert numbered_scenes(["open-2", "closed-2", "7"]) == {
        "open-2": Place("open", 2),
        "closed-2": Place("closed", 2),
        "7": Place("scenes", 7),
    }


@pytest.mark.parametrize("scenes", [["box_1", "box"], ["box_00"], ["box_1", "box_01"]])
def test_scenes_that_have_no_number_of_their_own(scenes):
    assert numbered_scenes(scenes) is None


def test_families_of_scenes_are_panels(tmp_path):
    builder = Builder().on_gpu().study(MATERIALS)
    for family in ("open", "closed"):
        for count in (1, 2, 4):
            for layout in ("aos", "soa"):
                builder.cell(MATERIALS, f"{family}_{count}", axes={"layout": layout})
    data, page = drawn(builder, tmp_path, MATERIALS)
    assert [(panel.title, panel.xs) for panel in data.panels] == [("open", [1, 2, 4]), ("closed", [1, 2, 4])]
    check_legible(page, MATERIALS)


def test_scenes_without_a_number_stand_in_their_order(tmp_path):
    builder = Builder().on_gpu().study(MATERIALS)
    for time, scene in enumerate(("one", "two", "five"), 3):
        for layout, faster in (("aos", 1.0), ("soa", 0.5 if scene == "five" else 1.5)):
            builder.cell(MATERIALS, scene, ms_per_spp=time * faster, axes={"layout": layout})
    data, page = drawn(builder, tmp_path, MATERIALS)
    assert data.panels[0].xs == [1, 2, 3]
    assert [t.value for t in line_of(data, "aos").times] == pytest.approx([3, 4, 5])
    assert "Scenes: 1 one, 2 two, 3 five." in data.caption
    assert "scenes in the study's order: soa from five." in data.caption
    assert page.axes[1].get_xlabel() == "Scene, by its number in the caption"
    check_legible(page, MATERIALS)


# ---- Crossovers ----


@pytest.mark.parametrize(
    ("figure", "words"),
    [
        (RESOLUTION, "box: always from 64×64 pixels, the first measured; bucket from 256×256 pixels; "),
        (DEPTH, "box: always from depth 2, the first measured; bucket from depth 16; "),
        (MATERIALS, "materials: always from 1 material, the first measured; bucket from 8 materials; "),
        (FMAS, "heavy: always from 0 multiply-adds, the first measured; bucket from 1024 multiply-adds; "),
    ],
)
def test_crossovers_in_words(tmp_path, figure, words):
    data, page = drawn(crossing(), tmp_path, figure)
    words += "no crossover in the range measured: late"
    assert (
        "Crossover: the first x from which on the whole interval of a ratio to sorting=none is below 1; ringed, "
        in (data.caption)
    )
    assert f"{words}." in data.caption
    assert [note.full for note in data.notes if note.kind == "crossover"] == [words]
    # A ring stands where two lines cross: not at the first x, where nobody saw them cross.
    rings = [line for line in page.axes[1].get_lines() if line.get_markersize() == 13]
    assert [ring.get_xdata()[0] for ring in rings] == [line_of(data, "bucket").crossover.x]


def test_crossovers_are_in_the_summary_and_on_stdout(tmp_path, analysis):
    code, out, _ = analysis("plots", crossing().write(tmp_path / "scaling.json"))
    assert code == 0
    said = "crossover: box: always from depth 2, the first measured; bucket from depth 16; no crossover in the range"
    assert f"note: scaling_by_depth: {said}" in out
    assert f"- {said} measured: late\n" in (tmp_path / "figures" / "scaling" / "summary.md").read_text()
    for figure in SWEEPS:
        assert (tmp_path / "figures" / "scaling" / f"{figure}.png").stat().st_size > 1000


def row(ratio: tuple[float, float, float] | None, n: int = 9, verdict: Verdict | None = None) -> Row:
    """A row of which a crossover looks at the ratio (median, low, high) only."""
    estimate = None if ratio is None else Estimate(*ratio, n)
    if estimate is not None and verdict is None:
        verdict = verdict_of_ratio(estimate)
    return Row(None, "label", False, None, None, estimate, verdict)


ABOVE, ACROSS, BELOW, BARELY = (1.2, 1.1, 1.3), (0.99, 0.9, 1.01), (0.8, 0.7, 0.9), (0.997, 0.995, 0.999)


@pytest.mark.parametrize(
    ("ratios", "x", "is_first"),
    [
        ([ABOVE, ABOVE, BELOW, BELOW], 4, False),
        ([ABOVE, ABOVE, ABOVE, BELOW], 8, False),
        ([ABOVE, ACROSS, BELOW, BELOW], 4, False),
        ([ABOVE, BELOW, ACROSS, BELOW], 8, False),
        ([ABOVE, BELOW, BARELY, BELOW], 2, False),
        ([BELOW, BELOW, BELOW, BELOW], 1, True),
        ([ABOVE, ABOVE, ABOVE, ABOVE], None, False),
        ([BELOW, BELOW, BELOW, ABOVE], None, False),
        ([BELOW, BELOW, BELOW, (1.0, 0.9, 1.0)], None, False),
        ([ABOVE, ABOVE, ABOVE, ACROSS], None, False),
        ([None, BELOW, BELOW, BELOW], 2, False),
    ],
)
def test_the_first_x_from_which_on_the_whole_interval_is_below_1(ratios, x, is_first):
    xs = [1, 2, 4, 8]
    points = [(place, row(ratio)) for place, ratio in zip(xs, ratios, strict=True)]
    for order in (points, points[::-1]):
        crossover = crossover_of(order, xs)
        assert (crossover.x, crossover.is_first) == (x, is_first)
        assert crossover.doubts == ()


def test_a_line_without_any_ratio_has_no_crossover_to_speak_of():
    assert crossover_of([(1, row(None)), (2, row(None))], [1, 2]) is None


def test_what_is_missing_beyond_a_crossover_is_told():
    points = [(1, row(ABOVE)), (2, row(BELOW)), (4, row(None)), (8, row(BELOW))]
    assert crossover_of(points, [16, 1, 2, 4, 8, 16]).missing == (4, 16)


def test_a_crossover_without_a_verdict_says_why():
    busy = Verdict("UNSURE", "other processes took CPU time")
    points = [(1, row(ABOVE, verdict=busy)), (2, row(BELOW)), (4, row(BELOW, verdict=busy)), (8, row(BELOW, n=5))]
    crossover = crossover_of(points, [1, 2, 4, 8])
    assert crossover.x == 2
    assert crossover.doubts == ("other processes took CPU time", "n = 5, a verdict needs 9")
    alone = crossover_of([(1, row((0.8, None, None), n=1))], [1])
    assert (alone.x, alone.doubts) == (None, ("one sample has no interval",))


def test_doubts_and_gaps_are_in_the_words(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth, faster in ((2, 1.5), (4, 0.8), (8, 0.7), (16, 0.6)):
        builder.cell(DEPTH, depth=depth, ms_per_spp=depth)
        n, error = (5 if depth == 8 else 9), ("out of memory" if depth == 16 else "")
        builder.cell(DEPTH, depth=depth, ms_per_spp=depth * faster, axes={"layout": "soa"}, n=n, error=error)
        builder.cell(DEPTH, depth=depth, axes={"layout": "packed", "sorting": "none"}, n=1)
    data, page = drawn(builder, tmp_path, DEPTH)
    assert (
        "cornell_open: soa from depth 4 (n = 5, a verdict needs 9; no ratio at depth 16); "
        "no crossover in the range measured: packed (one sample has no interval)." in data.caption
    )
    check_legible(page, DEPTH)


def test_labels_with_commas_are_listed_apart(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth in (2, 4):
        for layout in ("aos", "soa"):
            for sorting, slower in (("none", 1), ("bucket", 2)):
                axes = {"sorting": sorting, "layout": layout}
                builder.cell(DEPTH, depth=depth, ms_per_spp=depth * slower, axes=axes)
    data, _ = drawn(builder, tmp_path, DEPTH)
    assert "no crossover in the range measured: bucket, layout=aos | bucket, layout=soa." in data.caption


# ---- Legible ----


def test_a_long_word_of_a_name_is_not_broken(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth in (2, 4):
        for compaction in ("none", "thrust_stable_partition"):
            for layout in ("aos", "soa"):
                axes = {"integrator": f"wavefront_{layout}", "compaction": compaction, "layout": layout}
                builder.cell(DEPTH, depth=depth, axes=axes)
    _, page = drawn(builder, tmp_path, DEPTH)
    assert any("\ncompaction=thrust_stable_partition,\n" in text.get_text() for text in texts_of(page))
    check_legible(page, DEPTH)


@pytest.mark.parametrize(("choices", "scenes", "long_names"), [(8, 1, True), (20, 2, False), (3, 5, True)])
def test_nothing_overlaps_or_is_cut_off(tmp_path, choices, scenes, long_names):
    builder = Builder().on_gpu().study(RESOLUTION).study(FMAS)
    for index in range(scenes):
        scene = f"scene_{index}" + ("_whose_name_is_rather_long_for_a_label" if long_names else "")
        for choice in range(choices):
            name = f"choice_{choice}" + ("_and_some_more_words" if long_names else "") if choice else "none"
            for layout in ("aos", "soa"):
                axes = {"compaction": name, "layout": layout}
                for side in (256, 512, 1024, 2048, 4096):
                    time = (1 + choice) + (side / 512) ** 2 * (1 - choice / choices / 2)
                    builder.cell(RESOLUTION, scene, time, n=2, resolution=[side, side], axes=axes)
                for fmas in (0, 1, 2, 4, 4096):
                    time = 1e-3 * (1 + choice) + fmas / 4096
                    builder.cell(FMAS, f"{scene}_b", time, n=2, tunables={"shading_fmas": fmas}, axes=axes)
    for name in (RESOLUTION, FMAS):
        data, page = drawn(builder, tmp_path, name)
        assert len(data.panels) == scenes * (2 if 2 * choices > 8 else 1)
        check_legible(page, name)


@pytest.mark.parametrize(("low", "high"), [(0.98, 1.02), (0.5, 1.1), (0.7, 3.0), (0.9, 4.9), (0.25, 1.2)])
def test_ratio_ticks_stand_apart_and_1_is_among_them(low, high):
    ticks = lines._ratio_ticks(low, high)
    assert 1.0 in ticks
    assert all(low <= tick <= high for tick in ticks)
    apart = [math.log(b / a) for a, b in pairwise(ticks)]
    assert all(gap >= 0.1 * math.log(high / low) for gap in apart)


@pytest.mark.parametrize(("low", "high", "ticks"), [(2.54, 5.92, [2.5, 3, 4, 5, 6]), (0.4, 4.1, [0.5, 1, 2, 3, 5])])
def test_a_logarithmic_axis_has_enough_ticks(low, high, ticks):
    axes = Figure().add_subplot()
    lines._log_y(axes, [low, high])
    bottom, top = axes.get_ylim()
    assert [tick for tick in axes.get_yticks() if bottom <= tick <= top] == pytest.approx(ticks)


def test_launches_are_lines_by_their_names(tmp_path):
    builder = Builder().on_gpu().study(DEPTH)
    for depth in (2, 8, 64, 256):
        for launch, time in (("stream", 0.01 * depth), ("graph", 0.0098 * depth), ("graph_while", 0.2 + 0.001 * depth)):
            axes = {"integrator": "wavefront_fused", "compaction": "block_scan_append", "launch": launch}
            builder.cell(DEPTH, depth=depth, ms_per_spp=time, axes=axes, noise=0.001)
    data, page = drawn(builder, tmp_path, DEPTH)
    assert data.order == ("stream", "graph", "graph_while")
    assert data.baseline == "launch=stream"
    assert "cornell_open: graph from depth 2, the first measured; graph_while from depth 64." in data.caption
    assert "integrator=wavefront_fused, compaction=block_scan_append" in data.caption
    check_legible(page, DEPTH)
