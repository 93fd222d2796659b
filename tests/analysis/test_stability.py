"""Results of `ptbench stability`: how they are laid out, drawn and told of, and what is wrong with a bad file."""

from __future__ import annotations

import json
import math

import pytest
from builder import Builder
from legibility import check_legible
from stability_builder import (
    DOUBLE,
    FAMILIES,
    FAST,
    FLOAT,
    MIXED,
    NAIVE,
    WAVEFRONT,
    StabilityBuilder,
    large,
)

from ptbench.errors import InputError, NotDrawable
from ptbench.figures.registry import collect_study, draw
from ptbench.figures.stability import heatmap as stability_heatmap
from ptbench.figures.stability import sweep as stability_sweep
from ptbench.figures.stability.heatmap import MOST_ROWS, colour
from ptbench.io.nodes import read_json
from ptbench.io.results import load
from ptbench.io.stability import stability_of
from ptbench.plots.command import default_folder
from ptbench.stability.layout import Layout, number
from ptbench.stability.summary import family_text, summary

NEE = {"direct_light": "nee"}


def loaded(builder: StabilityBuilder, tmp_path):
    return stability_of(read_json(builder.write(tmp_path / "stability.json")))


def heat_pages(builder: StabilityBuilder, tmp_path):
    return stability_heatmap.collect(loaded(builder, tmp_path))


def heat_cells(page) -> dict[tuple[str, str], object]:
    return {
        (row.label, column): cell
        for group in page.groups
        for row in group.rows
        for column, cell in zip(page.columns, row.cells, strict=True)
    }


def sweep_pages(builder: StabilityBuilder, tmp_path):
    return stability_sweep.collect(loaded(builder, tmp_path))


def family(builder: StabilityBuilder, tmp_path, name: str = "cavities") -> str:
    stability = loaded(builder, tmp_path)
    return family_text(stability, Layout(stability), name)


def swept(values=(1.0, 0.1, 0.01), **changes) -> StabilityBuilder:
    """The error of robust float is 1e-7 / a, of naive a thousand times that, of double a thousandth of a millionth."""
    builder = StabilityBuilder().case(**changes)
    for a in values:
        for axes, error in ((FLOAT, 1e-7), (NAIVE, 1e-4), (MIXED, 5e-8), (DOUBLE, 1e-16), (FAST, 2e-7)):
            builder.row(axes, error / a, 1e-15 if axes == DOUBLE else 1e-6, a=a)
    return builder


# ---- Names ----


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.1, "0.1"), (1024, "1024"), (2.0**-20, "2^-20"), (-(2.0**-12), "-2^-12"), (2.0**24, "2^24"), (1e-6, "1e-6"),
     (1e8, "1e8"), (0, "0"), (131072, "131072"), (0.5, "0.5")],
)  # fmt: skip
def test_parameters_are_short(value, text):
    assert number(value) == text


def test_columns_are_named_by_what_differs_and_those_that_must_pass_come_first(tmp_path):
    builder = StabilityBuilder().case()
    for axes in (FLOAT, NAIVE, FAST, DOUBLE, DOUBLE | NAIVE, FAST | NAIVE, WAVEFRONT):
        builder.row(axes, 0)
    page = heat_pages(builder, tmp_path)[0]
    assert page.columns == (
        "float", "double", "wavefront", "float naive", "float fast", "double naive", "float fast naive",
    )  # fmt: skip
    assert page.must_pass == 3


def test_an_estimator_is_a_row_of_its_own_and_a_point_is_named_by_what_is_not_standard(tmp_path):
    builder = StabilityBuilder().case("lamp").row(FLOAT, 0, a=0.01).row(NEE, 0, a=0.01)
    builder.row(NEE | DOUBLE, 0, a=0.1, depth=3).case("plates", "dielectrics", sweep="").row(FLOAT, 0)
    page = heat_pages(builder, tmp_path)[0]
    assert page.columns == ("float", "double")
    assert [(group.family, [row.label for row in group.rows]) for group in page.groups] == [
        ("cavities", ["S1 lamp a=0.01", "S1 lamp a=0.01 nee", "S1 lamp a=0.1 depth=3 nee"]),
        ("dielectrics", ["S2 plates"]),
    ]


def test_cases_are_in_the_order_of_the_catalogue_whatever_the_rows_are(tmp_path):
    builder = StabilityBuilder().case("first").case("second")
    builder.row(FLOAT, 0, case="second").row(FLOAT, 0, case="first", a=0.01).row(FLOAT, 0, case="first", a=1)
    labels = [row.label for row in heat_pages(builder, tmp_path)[0].groups[0].rows]
    assert labels == ["S1 first a=0.01", "S1 first a=1", "S2 second a=0.1"]


# ---- The heat map ----


def test_a_cell_is_the_worst_quantity(tmp_path):
    builder = StabilityBuilder().case(sweep="")
    builder.row(FLOAT, 2e-7, 1e-6, quantity="mean").row(FLOAT, 5e-7, 1e-6, quantity="farthest").row(NAIVE, 3e-3, 1e-6)
    cells = heat_cells(heat_pages(builder, tmp_path)[0])
    worst = cells["S1 lamp", "float"]
    assert (worst.kind, worst.over_allowed, worst.quantity) == ("value", pytest.approx(0.5), "farthest")
    assert cells["S1 lamp", "float naive"].over_allowed == pytest.approx(3000)
    assert not cells["S1 lamp", "float naive"].is_failure


def test_what_is_no_number_is_told_apart(tmp_path):
    builder = StabilityBuilder().case(sweep="")
    builder.row(FLOAT, 1e-3, status="known limit", reason="24 bits").row(NAIVE, 1, status="broken", reason="3 negative")
    builder.none(MIXED, reason="has no intersection").row(WAVEFRONT, 2e-6).case("other", sweep="")
    builder.row(FLOAT, 0.0, 0.0).row(NAIVE, 1.0, 0.0).none(DOUBLE, "broken", "out of memory").row(MIXED, 0)
    page = heat_pages(builder, tmp_path)[0]
    cells = heat_cells(page)
    kinds = {key: cell.kind for key, cell in cells.items()}
    assert kinds == {
        ("S1 lamp", "float"): "value", ("S1 lamp", "double_intersection"): "n/a", ("S1 lamp", "wavefront"): "value",
        ("S1 lamp", "double"): "missing", ("S1 lamp", "float naive"): "broken", ("S2 other", "float"): "value",
        ("S2 other", "double_intersection"): "value", ("S2 other", "wavefront"): "missing",
        ("S2 other", "double"): "broken", ("S2 other", "float naive"): "value",
    }  # fmt: skip
    assert [key for key, cell in cells.items() if cell.is_limit] == [("S1 lamp", "float")]
    assert [key for key, cell in cells.items() if cell.is_failure] == [("S1 lamp", "wavefront"), ("S2 other", "double")]
    assert cells["S2 other", "float"].over_allowed == 0
    assert math.isinf(cells["S2 other", "float naive"].over_allowed)
    figure = stability_heatmap.draw(page)
    assert [text.get_text() for text in figure.axes[0].texts] == ["1e3", "2 !", "0", "0", "!", "∞"]
    faces = [patch.get_facecolor()[:3] for patch in figure.axes[0].patches]
    assert sum(face == pytest.approx((208 / 255,) * 3) for face in faces) == 1
    assert sum(bool(patch.get_hatch()) for patch in figure.axes[0].patches) == 2
    check_legible(figure, "heatmap")


@pytest.mark.parametrize("value", [math.inf, math.nan, -math.inf])
def test_what_is_not_finite_is_infinitely_far_off(tmp_path, value):
    builder = StabilityBuilder().case(sweep="").row(NAIVE, value, status="failed").row(FLOAT, 0)
    page = heat_pages(builder, tmp_path)[0]
    assert math.isinf(heat_cells(page)["S1 lamp", "float naive"].over_allowed)
    assert "∞" in [text.get_text() for text in stability_heatmap.draw(page).axes[0].texts]


@pytest.mark.parametrize(
    ("ratio", "text"),
    [(0, "0"), (1, "1"), (1.004, ">1"), (0.998, "1"), (0.4567, "0.46"), (839.2, "839"), (2e5, "2e5"), (3e-4, "3e-4")],
)
def test_numbers_in_cells_are_short(ratio, text):
    assert stability_heatmap.number(ratio) == text


def test_colours_are_blue_up_to_one_red_above_it_and_darker_farther_off():
    def parts(value: float) -> tuple[int, int]:
        face = colour(value)
        return int(face[1:3], 16), int(face[5:7], 16)

    assert all(blue > red for red, blue in map(parts, (0, 1e-9, 0.01, 0.5, 1)))
    assert all(red > blue for red, blue in map(parts, (1.01, 2, 100, 1e9, math.inf)))
    assert [parts(v)[0] for v in (1, 0.1, 0.01, 1e-3, 1e-4)] == sorted(
        (parts(v)[0] for v in (1, 0.1, 0.01, 1e-3, 1e-4)), reverse=True
    )
    assert colour(0) == colour(1e-7)
    assert colour(math.inf) == colour(1e7)


def test_what_no_case_has_is_no_column_but_is_told(tmp_path):
    builder = StabilityBuilder().case().row(FLOAT, 0).none(MIXED, reason="no").none(MIXED | NAIVE, reason="no")
    page = heat_pages(builder, tmp_path)[0]
    assert page.columns == ("float",)
    assert "left out: double_intersection, double_intersection naive." in page.caption


def test_a_file_in_which_nothing_applies_is_drawn_grey(tmp_path):
    builder = StabilityBuilder().case(kind="missing", missing_feature="no spectra").none(FLOAT, reason="no spectra")
    (cell,) = heat_cells(heat_pages(builder, tmp_path)[0]).values()
    assert cell.kind == "n/a"


def test_many_rows_are_split_by_family_and_no_page_is_too_long(tmp_path):
    builder = StabilityBuilder()
    for name, where, points in (("a", "film", 30), ("b", "film", 40), ("c", "own", 50), ("d", "own", 1)):
        builder.case(name, where)
        for a in range(1, points + 1):
            builder.row(FLOAT, 0, a=a)
    pages = heat_pages(builder, tmp_path)
    lengths = {page.name: [len(group.rows) for group in page.groups] for page in pages}
    assert lengths == {
        "heatmap_film_1": [30], "heatmap_film_2": [40], "heatmap_own_1": [MOST_ROWS], "heatmap_own_2": [6],
    }  # fmt: skip
    assert pages[2].title == "Error over allowed: own (1 of 2)"


# ---- Sweeps ----


def test_lines_are_the_errors_over_the_exact_value(tmp_path):
    (page,) = sweep_pages(swept(), tmp_path)
    (panel,) = page.panels
    assert (page.name, page.title) == ("sweep_lamp", "S1 lamp: what lamp is")
    assert panel.y_label == "error / exact value"
    assert panel.x_label == "a: what a is"
    lines = {line.label: line for line in panel.lines}
    assert list(lines) == ["robust float", "robust double_intersection", "robust double", "naive float", "fast float"]
    assert lines["robust float"].xs == (0.01, 0.1, 1.0)
    assert lines["robust float"].errors == pytest.approx((5e-6, 5e-7, 5e-8))
    assert lines["naive float"].errors == pytest.approx((5e-3, 5e-4, 5e-5))
    assert [bound.label for bound in panel.bounds] == ["robust float", "robust double"]
    assert panel.bounds[0].allowed == pytest.approx((5e-7,) * 3)
    figure = stability_sweep.draw(page)
    check_legible(figure, "sweep")
    axes = next(axes for axes in figure.axes if axes.get_ylabel())
    drawn = {line.get_label(): line for line in axes.get_lines()}
    assert list(drawn["robust double"].get_ydata()) == pytest.approx([5e-15, 5e-16, 5e-17])
    assert list(drawn["robust double"].get_xdata()) == pytest.approx([-2, -1, 0])
    assert axes.get_yscale() == "log"
    texts = [text.get_text() for text in figure.texts]
    assert {"robust float", "fast float", "allowed in single precision", "allowed in double precision"} <= set(texts)


def test_noughts_stand_at_the_floor_and_infinities_at_the_top(tmp_path):
    builder = StabilityBuilder().case()
    for a, robust, naive in ((1, 0.0, 1e-5), (0.1, 1e-7, math.inf), (0, 2e-7, math.nan)):
        builder.row(FLOAT, robust, exact=0.0, a=a).row(NAIVE, naive, exact=0.0, status="failed", a=a)
    (page,) = sweep_pages(builder, tmp_path)
    (panel,) = page.panels
    assert panel.y_label == "absolute error"
    assert [line.errors for line in panel.lines] == [(2e-7, 1e-7, 0.0), (math.inf, math.inf, 1e-5)]
    axes = next(axes for axes in stability_sweep.draw(page).axes if axes.get_ylabel())
    floor, ceiling = stability_sweep.limits(panel)
    assert [(text.get_text(), text.xy[1]) for text in axes.texts] == [("0", floor), ("∞", ceiling), ("∞", ceiling)]
    drawn = {line.get_label(): list(line.get_ydata()) for line in axes.get_lines()}
    assert drawn["robust float"] == [2e-7, 1e-7, floor]
    assert floor < 1e-7
    # A swept value of 0 has no logarithm: it stands a step to the left of the others and says so.
    assert [axes.xaxis.get_major_formatter()(x) for x in axes.xaxis.get_major_locator()()] == ["0", "0.1", "1"]


def test_estimates_have_their_standard_errors(tmp_path):
    builder = StabilityBuilder().case()
    for a in (1, 2, 4):
        builder.row(FLOAT, 1e-3, 5e-3, standard_error=1e-3, a=a)
    (page,) = sweep_pages(builder, tmp_path)
    assert page.panels[0].lines[0].standard_errors == pytest.approx((5e-4,) * 3)
    axes = next(axes for axes in stability_sweep.draw(page).axes if axes.get_ylabel())
    (bars,) = axes.containers
    tops = sorted(segment[1][1] for segment in bars[2][0].get_segments())
    assert tops == pytest.approx([1e-3] * 3)


def test_each_value_of_another_parameter_has_a_panel_where_it_was_swept(tmp_path):
    builder = StabilityBuilder().case()
    for depth in (9, 100):
        for a in (1, 0.1, 0.01):
            builder.row(FLOAT, 1e-7, a=a, depth=depth)
    builder.row(FLOAT, 1e-7, a=1, depth=7)
    (page,) = sweep_pages(builder, tmp_path)
    assert [panel.title for panel in page.panels] == ["S1 lamp\nradiance", "S1 lamp depth=100\nradiance"]
    assert "In no panel: S1 lamp a=1 depth=7." in page.caption


def test_a_parameter_that_changes_with_the_swept_one_is_told(tmp_path):
    builder = StabilityBuilder().case()
    for a, depth in ((1, 9), (0.1, 9), (0.1, 100), (0.01, 1000)):
        builder.row(FLOAT, 1e-7 * depth, a=a, depth=depth)
    (page,) = sweep_pages(builder, tmp_path)
    (panel,) = page.panels
    assert panel.title == "S1 lamp (depth with it)\nradiance"
    assert panel.lines[0].errors == pytest.approx((5e-5, 4.5e-7, 4.5e-7))
    assert "In no panel: S1 lamp a=0.1 depth=100." in page.caption


def test_every_quantity_with_an_error_has_a_panel(tmp_path):
    builder = StabilityBuilder().case()
    for a in (1, 0.1, 0.01):
        builder.row(FLOAT, 1e-7, quantity="mean", a=a).row(FLOAT, 0.0, 0.0, quantity="leaked", a=a)
        builder.row(FLOAT, 1e-6, quantity="excess", relation="at most", a=a)
    (page,) = sweep_pages(builder, tmp_path)
    assert [(panel.title, panel.y_label) for panel in page.panels] == [
        ("S1 lamp\nmean", "error / exact value"), ("S1 lamp\nexcess", "absolute error"),
    ]  # fmt: skip


def test_quantities_that_have_no_name_in_common_are_drawn_over_allowed(tmp_path):
    builder = StabilityBuilder().case()
    for a in (1, 0.1, 0.01):
        builder.row(FLOAT, 2e-7, 1e-6, quantity=f"radiance at {a}", a=a)
    (panel,) = sweep_pages(builder, tmp_path)[0].panels
    assert (panel.title, panel.y_label) == ("S1 lamp\nthe worst quantity", "error / allowed")
    assert panel.lines[0].errors == pytest.approx((0.2,) * 3)
    assert panel.lines[0].allowed == (1.0,) * 3


def test_many_cases_are_drawn_by_family(tmp_path):
    builder = StabilityBuilder()
    for index in range(15):
        builder.case(f"case{index}", "film" if index < 12 else "own")
        for a in (1, 0.1, 0.01):
            builder.row(FLOAT, 1e-7, a=a)
    pages = sweep_pages(builder, tmp_path)
    assert [(page.name, len(page.panels)) for page in pages] == [
        ("sweep_film_1", 10), ("sweep_film_2", 2), ("sweep_own", 3),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("builder", "reason"),
    [
        (StabilityBuilder().case(sweep="").row(FLOAT, 0), "no case of the file has a parameter that is swept"),
        (swept(values=(1.0, 0.1)), "no case was looked at in 3 points"),
    ],
)
def test_a_sweep_needs_three_points(tmp_path, builder, reason):
    with pytest.raises(NotDrawable, match=reason):
        sweep_pages(builder, tmp_path)


@pytest.mark.parametrize("figure", [stability_heatmap, stability_sweep])
def test_a_file_of_fifty_cases_can_be_read(tmp_path, figure):
    pages = figure.collect(loaded(large(), tmp_path))
    assert len(pages) == len(FAMILIES)
    for page in (pages[0], pages[3], pages[-1]):
        check_legible(figure.draw(page), page.name)
        assert "Machine amd-epyc-2-cores: AMD EPYC" in page.caption
        assert "git 0123abcd4567, full run, seed 1, 2025-03-01" in page.caption


# ---- The summary ----


def test_a_family_is_told_from_the_data(tmp_path):
    builder = StabilityBuilder().case("lamp", sweep="")
    builder.row(FLOAT, 5e-7).row(DOUBLE, 2e-16, 1e-15).row(NAIVE, 1e-3).row(FAST, 1e-7)
    builder.case("sphere").row(FLOAT, 2e-6, a=0.01).row(NAIVE, 1e-7, a=0.01).row(FLOAT, 8e-7).none(DOUBLE)
    builder.row(WAVEFRONT, 4e-4, status="known limit", reason="24 bits")
    assert family(builder, tmp_path) == (
        "**cavities**: 2 cases, at 3 points. Of 5 checks that must pass 3 passed, 1 failed or broke (sphere), 1 known "
        "limit. The naive kernels failed or broke in 1 of 2 (lamp). Fast arithmetic passed all of theirs, 1. Worst "
        "error over allowed: robust float 2 (sphere a=0.01); robust double 0.2 (lamp)."
    )


def test_a_known_limit_does_not_hide_the_next_worst(tmp_path):
    builder = StabilityBuilder().case(sweep="").row(FLOAT, math.inf, status="known limit", reason="24 bits")
    builder.case("other", sweep="").row(FLOAT, 2.5e-7)
    assert family(builder, tmp_path).endswith("robust float ∞ (lamp, a known limit; 0.25 elsewhere).")


def test_families_without_runs_and_without_duties(tmp_path):
    builder = StabilityBuilder().case(kind="missing", missing_feature="no spectra").none(FLOAT, reason="no spectra")
    builder.case("plates", "film", sweep="").row(NAIVE, 0)
    assert family(builder, tmp_path) == "**cavities**: 1 case, none of which was run."
    assert family(builder, tmp_path, "film") == (
        "**film**: 1 case, at 1 point. Nothing that must pass was run. The naive kernels passed all of theirs, 1."
    )


def test_limits_and_failures_are_tables(tmp_path):
    builder = StabilityBuilder().case(sweep="a")
    builder.row(FLOAT, 1e-3, status="known limit", reason="a | b", a=0.01)
    builder.row(WAVEFRONT, 2e-3, status="known limit", reason="a | b", a=0.01)
    builder.row(DOUBLE, 3e-6, a=0.01).none(MIXED, "broken", "out of memory").row(NAIVE, 1)
    builder.case("spectra", kind="missing", missing_feature="no spectra").case("later")
    text = summary(loaded(builder, tmp_path), ["sweep: too few"])
    assert "Not drawn: sweep: too few\n" in text
    assert "| S1 lamp | a=0.01 | float, wavefront | radiance | 0.002 | 1e-6 | a \\| b |\n" in text
    failed = text.partition("## Failures")[2].splitlines()
    assert [line for line in failed if line.startswith("| S1")] == [
        "| S1 lamp | a=0.01 | double | failed | radiance | 2.000003 | 2 | 3e-6 | 1e-6 | 1 | — |",
        "| S1 lamp | a=0.1 | double_intersection | broken | — | — | — | — | — | — | out of memory |",
    ]
    assert "| S2 spectra | what spectra is | no spectra |" in text
    assert "## Cases without a row in this file\n\nS3 later.\n" in text


def test_no_limits_and_no_failures_are_said(tmp_path):
    text = summary(loaded(StabilityBuilder().case().row(FLOAT, 0).row(NAIVE, 1), tmp_path), [])
    assert "## Known limits\n\nNone.\n" in text
    assert "## Failures of what must pass\n\nNone: everything that must pass and was run" in text


# ---- The command ----


def test_the_command_draws_beside_the_file(tmp_path, analysis):
    path = swept().write(tmp_path / "stability.json")
    code, out, err = analysis("plots", path)
    folder = tmp_path / "figures/stability"
    names = ["heatmap.png", "heatmap.svg", "sweep_lamp.png", "sweep_lamp.svg", "summary.md"]
    assert (code, err) == (0, "")
    assert out.splitlines() == [str(folder / name) for name in names]
    assert (folder / "heatmap.png").read_bytes().startswith(b"\x89PNG")
    assert default_folder(loaded(swept(), tmp_path)) == folder
    other = swept().write(tmp_path / "monday.json")
    assert default_folder(stability_of(read_json(other))).name == "stability-monday"


def test_a_quick_file_of_one_case_is_drawn_without_a_sweep(tmp_path, analysis):
    builder = StabilityBuilder(quick=True).case().row(FLOAT, 1e-7).row(NAIVE, math.inf)
    builder.context["ptbench.status"] = "interrupted"
    code, out, _ = analysis("plots", builder.write(tmp_path / "stability.json"), "--out", tmp_path / "out")
    assert code == 0
    assert "not drawn: sweep: no case was looked at in 3 points" in out
    text = (tmp_path / "out/summary.md").read_text()
    assert "quick run" in text
    assert "- Run: NOT COMPLETE: interrupted" in text
    assert "the run is not complete (interrupted)" in heat_pages(builder, tmp_path)[0].caption


def test_a_file_without_rows_has_a_summary(tmp_path, analysis):
    code, out, _ = analysis("plots", StabilityBuilder().case().write(tmp_path / "stability.json"))
    assert code == 0
    assert out.startswith("not drawn: heatmap: the file has no rows\n")
    assert "Not drawn: heatmap" in (tmp_path / "figures/stability/summary.md").read_text()


def _set(*path, value):
    def change(document: dict) -> None:
        for key in path[:-1]:
            document = document[key]
        if value is None:
            del document[path[-1]]
        else:
            document[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (_set("schema", value="ptbench-stability-9"), '$.schema: found "ptbench-stability-9", allowed: "ptbench-stab'),
        (_set("rows", 0, "status", value="fine"), '$.rows[0].status: found "fine", allowed: "passed" or "failed"'),
        (_set("rows", 0, "case", value="lamb"), '$.rows[0].case: found "lamb", allowed: the name of a case in $.cases'),
        (_set("rows", 0, "error", value="huge"), '$.rows[0].error: found "huge", allowed: "nan" or "inf" or "-inf"'),
        (_set("rows", 0, "allowed", value=None), "$.rows[0].allowed: found nothing"),
        (_set("rows", 0, "point", "a", value="x"), '$.rows[0].point.a: found "x"'),
        (_set("context", value=None), "$.context: found nothing"),
        (_set("cases", value={}), "$.cases: found {}, allowed: an array"),
    ],
)
def test_a_bad_file_is_one_line_and_exit_code_2(tmp_path, analysis, change, complaint):
    document = swept().document()
    change(document)
    path = tmp_path / "stability.json"
    path.write_text(json.dumps(document))
    code, out, err = analysis("plots", path)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"python3 -m ptbench: {path}: {complaint}")


def test_cases_have_names_of_their_own(tmp_path):
    with pytest.raises(InputError, match=r'cases\[1\].name: found "lamp" again'):
        loaded(StabilityBuilder().case().case(), tmp_path)


# ---- The cost of robustness ----


def costs(error: str = "") -> Builder:
    builder = Builder("robustness").study("cost", "robustness")
    for scene, base in (("cornell_open", 2.0), ("ball_glass", 4.0)):
        for robustness, precision, factor in (
            ("robust", "float", 1.0), ("naive", "float", 0.8), ("robust", "double_intersection", 1.5),
            ("robust", "double", 20.0),
        ):  # fmt: skip
            axes = {"specialisation": "generic", "precision": precision, "robustness": robustness}
            builder.cell(
                "cost", scene, base * factor, axes=axes, noise=0.01, error=error if robustness == "robust" else ""
            )
    reason = "has its own intersection"
    return builder.skip("cost", "ball_glass", reason, {"precision": "double_intersection", "robustness": "naive"})


def cost_data(builder: Builder, tmp_path):
    result = load(builder.write(tmp_path / "robustness.json"))
    return result.studies[0], collect_study(result, result.studies[0])


def test_costs_are_ratios_to_robust_float_on_a_logarithmic_axis(tmp_path):
    _study, data = cost_data(costs(), tmp_path)
    assert [group.title for group in data.groups] == ["cornell_open", "ball_glass"]
    for group in data.groups:
        assert {bar.label: bar.estimate.value for bar in group.bars} == pytest.approx(
            {"robust float": 1, "naive float": 0.8, "robust double_intersection": 1.5, "robust double": 20}
        )
        assert all(bar.estimate.low < bar.estimate.value < bar.estimate.high for bar in group.bars[1:])
    assert data.groups[1].bars[0].text == "1 = 4.000 ms per spp"
    assert "naive double_intersection: has its own intersection" in [note.full for note in data.notes]
    figure = draw(data)
    check_legible(figure, "cost_of_robustness")
    axes = figure.axes[0]
    assert axes.get_xscale() == "log"
    # Bars go from 1 to the ratio, to the left where it is below.
    spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
    assert spans == [pytest.approx((1, ratio)) for ratio in (1, 0.8, 1.5, 20)]


def test_what_else_varies_is_a_group_and_failures_have_no_bar(tmp_path):
    builder = costs()
    for axes, error in (({}, ""), ({"robustness": "naive"}, "out of memory")):
        where = {"specialisation": "features", "precision": "float", "robustness": "robust", **axes}
        builder.cell("cost", "ball_glass", 1.0, axes=where, error=error)
    _, data = cost_data(builder, tmp_path)
    assert [group.title for group in data.groups] == [
        "cornell_open, specialisation=generic", "ball_glass, specialisation=generic",
        "ball_glass, specialisation=features",
    ]  # fmt: skip
    naive = data.groups[2].bars[1]
    assert (naive.label, naive.estimate, naive.text) == ("naive float", None, "failed")


def test_costs_need_robust_float(tmp_path):
    with pytest.raises(NotDrawable, match="no cell of robust float has times"):
        cost_data(costs(error="out of memory"), tmp_path)
