"""What a report opens with: sentences no firmer than the verdicts, and a figure with a row for each comparison."""

from __future__ import annotations

import math

import pytest
from browser import browser, find_chromium
from builder import Builder, small
from convergence_builder import convergence_cell, convergence_study, on_gpu
from legibility import check_legible
from stability_builder import large

from ptbench.figures import forest, style
from ptbench.io.stability import BROKEN, FAILED, NOT_APPLICABLE
from ptbench.report.findings import HIGHER, LOWER, NOT_TOLD_APART, efficiencies_of, findings_of, stability_findings
from ptbench.report.forest import MOST_ROWS, _times
from ptbench.report.sources import load
from ptbench.stats.estimates import FASTER, SAME, SLOWER, UNSURE

BOXES = ("cornell_open", "cornell_closed")


def compactions(ratios: dict[str, tuple[float, float]], **cell) -> Builder:
    """A study of compactions, each at its ratios to "none" in the open and the closed box."""
    builder = Builder()
    builder.study("compaction", "compaction", "Stream compaction")
    for index, scene in enumerate(BOXES):
        builder.cell("compaction", scene, 3.0, noise=0.001, **cell)
        for choice, ratio in ratios.items():
            builder.cell("compaction", scene, 3 * ratio[index], noise=0.001, axes={"compaction": choice}, **cell)
    return builder


def found(builder: Builder, folder):
    return findings_of(load(builder.write(folder / "run.json")))


@pytest.mark.parametrize(
    ("ratios", "answer"),
    [
        ({"scatter": (0.5, 0.6)}, "`scatter` pays"),
        ({"scatter": (0.5, 0.6), "gather": (0.7, 0.8), "scan": (2, 2)}, "`scatter`, `gather` pay"),
        ({"scatter": (0.5, 2)}, "it depends on the place what pays"),
        ({"scatter": (0.5, 1)}, "`scatter` pays in some places"),
        ({"scatter": (2, 3)}, "nothing pays"),
        ({"scatter": (2, 1.0095)}, "nothing is shown to pay"),
        ({"scatter": (1, 1)}, "no difference"),
        ({"scatter": (1.0095, 1.0095)}, "these data do not decide"),
    ],
)
def test_the_answer_is_no_firmer_than_the_verdicts(tmp_path, ratios, answer):
    said = found(compactions(ratios), tmp_path)
    assert said.items[0].startswith(f"**Stream compaction**: {answer} (against `compaction=none`: ")


def test_outcomes_have_their_ends_with_intervals_and_places(tmp_path):
    said = found(compactions({"scatter": (0.5, 2), "gather": (2, 3), "scan": (4, 5), "gap_fill": (6, 7)}), tmp_path)
    assert said.head.startswith("8 comparisons of times, all else equal: 1 FASTER, 7 SLOWER.")
    (text,) = said.items
    assert "**FASTER** here and **SLOWER** there: `scatter` (1 FASTER, 1 SLOWER) 0.500 [0.49" in text
    assert "(cornell_open) to 2.000 [" in text
    assert "**SLOWER** everywhere: `gather`, `scan`, `gap_fill`, 2.000 [" in text
    assert "(`gather`, cornell_open) to 7.000 [" in text
    assert text.endswith("(`gap_fill`, cornell_closed).")


def test_unsure_says_why(tmp_path):
    assert (
        "UNSURE is not SAME; these data do not decide: 2 for too few samples."
        in found(compactions({"scatter": (0.5, 0.5)}, n=8), tmp_path).head
    )
    busy = found(compactions({"scatter": (0.5, 0.5)}, contended=5), tmp_path)
    assert "2 for other processes took CPU time during more than a tenth of the samples." in busy.head
    assert "these data do not decide (against" in busy.items[0]


def test_nothing_compared_is_said(tmp_path):
    builder = Builder()
    builder.study("compaction")
    builder.cell("compaction")
    assert found(builder, tmp_path).head.startswith("This file compares nothing")
    assert found(builder, tmp_path).items == ()


def test_errors_are_told_by_whole_intervals(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder)
    convergence_cell(builder, axes={"integrator": "megakernel"}, ms_per_spp=1.0)
    result = load(builder.write(tmp_path / "run.json"))
    (one,) = efficiencies_of(result, result.studies[0])
    sides = (one.estimate.low > 1, one.estimate.high < 1)
    assert one.word == {(True, False): HIGHER, (False, True): LOWER, (False, False): NOT_TOLD_APART}[sides]
    said = findings_of(result)
    assert said.head.startswith("1 comparison of efficiency")
    assert f"Efficiency against the baseline's: 1 {one.word}." in said.items[0]


def test_stability_counts_what_must_pass(tmp_path):
    stability = load(large(cases=8, points=2).write(tmp_path / "stability.json"))
    rows = [row for row in stability.rows if row.must_pass and row.status != NOT_APPLICABLE]
    said = stability_findings(stability).head
    assert said.startswith(f"Of {len(rows)} checks that must pass, ")
    assert ("Failures in" in said) == any(row.status in (FAILED, BROKEN) for row in rows)


def test_the_figure_has_a_row_for_each_comparison(tmp_path):
    result = load(small().write(tmp_path / "run.json"))
    data = _times(result, "run")
    rows = {(group.title, item.label): item for group in data.groups for item in group.items}
    assert [group.title for group in data.groups] == list(BOXES)
    assert len(rows) == sum(len(group.items) for group in data.groups) == 20
    item = rows["cornell_open", "sorting_by_depth: material, depth=4"]
    assert (round(item.ratio.value, 9), item.word) == (3, SLOWER)
    assert {item.word for item in rows.values()} <= {FASTER, SLOWER, SAME, UNSURE}


def test_too_many_comparisons_are_drawn_as_means(tmp_path):
    builder = Builder()
    builder.study("compaction")
    for depth in range(1, MOST_ROWS // 2 + 2):
        for choice, ms in (("none", 2.0), ("scatter", 2.0 * depth), ("gather", 4.0)):
            builder.cell("compaction", ms_per_spp=ms, depth=depth, axes={"compaction": choice})
    data = _times(load(builder.write(tmp_path / "run.json")), "run")
    (group,) = data.groups
    depths = MOST_ROWS // 2 + 1
    assert [item.label for item in group.items] == [f"scatter ×{depths}", f"gather ×{depths}"]
    mean = math.exp(sum(math.log(depth) for depth in range(1, depths + 1)) / depths)
    assert group.items[0].ratio.value == pytest.approx(mean, rel=1e-12)
    assert group.items[1].word == SLOWER


def test_a_mean_with_a_withheld_verdict_is_unsure(tmp_path):
    builder = Builder()
    builder.study("compaction")
    for depth in range(1, MOST_ROWS + 2):
        busy = 5 if depth == 3 else 0
        builder.cell("compaction", ms_per_spp=2.0, depth=depth)
        builder.cell("compaction", ms_per_spp=4.0, depth=depth, axes={"compaction": "scatter"}, contended=busy)
    ((item,),) = (group.items for group in _times(load(builder.write(tmp_path / "run.json")), "run").groups)
    assert (round(item.ratio.value, 9), item.word) == (2, UNSURE)


@pytest.mark.parametrize("way", [forest.draw, forest.draw_narrow])
def test_both_figures_can_be_read(tmp_path, way):
    data = _times(load(small().write(tmp_path / "run.json")), "run")
    with style.applied():
        check_legible(way(data), way.__name__)


# --- in a page --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    from ptbench.cli.main import main

    folder = tmp_path_factory.mktemp("report")
    assert main(["report", str(small().write(folder / "quick.json")), "--out", str(folder / "out")]) == 0
    return folder / "out"


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    program = find_chromium()
    if program is None:
        pytest.skip("no Chromium here (Debian package chromium)")
    with browser(program, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def test_the_page_opens_with_them(page):
    text = (page / "report.md").read_text(encoding="utf-8")
    sections = [line for line in text.splitlines() if line.startswith("## ")]
    assert sections[:2] == ["## Contents", "## What was found"]
    assert (
        text.index("20 comparisons of times") < text.index("figures/quick_overview_times.svg") < text.index('glance"')
    )


def test_tables_of_results_are_folded(page):
    html = (page / "report.html").read_text(encoding="utf-8")
    results = html[html.index('<section id="results">') : html.index('<section id="scenes">')]
    assert results.count("<table") == results.count("<details>") > 4
    text = (page / "report.md").read_text(encoding="utf-8")
    assert text.count("<details>") == text.count("</details>") > 4


def shown(chromium) -> list[float]:
    """The overview's natural width, the width it is shown with, the page's."""
    return chromium.evaluate(
        "(() => { const image = document.querySelector('figure.fitting img');"
        " return [image.naturalWidth, image.getBoundingClientRect().width, document.documentElement.scrollWidth]; })()"
    )


def test_a_narrow_screen_gets_a_figure_of_its_own(page, chromium):
    chromium.open(page / "report.html", 375, mobile=True)
    natural, width, whole = shown(chromium)
    assert width <= natural <= 375
    assert whole <= 375
    # What was found stands on the first screen: the contents above it are folded.
    assert chromium.evaluate("document.querySelector('#findings p').getBoundingClientRect().top") < 400
    assert chromium.evaluate("document.querySelector('nav details').open") is False
    chromium.open(page / "report.html", 1280)
    assert shown(chromium)[0] > 600
    assert chromium.evaluate("document.querySelector('nav details').open") is True


def test_paper_gets_the_wide_figure_and_whole_tables(page, chromium):
    def paper(width: int) -> None:
        chromium.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)

    chromium.open(page / "report.html", 1280)
    chromium.call("Emulation.setEmulatedMedia", media="print")
    try:
        chromium.evaluate("dispatchEvent(new Event('beforeprint'))")
        paper(688)  # A4 less its margins, in CSS pixels
        natural, width, _ = shown(chromium)
        assert natural > 600
        assert width <= 688
        # Those that are not printed across fit between the margins.
        assert chromium.evaluate(
            "Array.from(document.querySelectorAll('table:not(.wide)')).every((table) =>"
            " table.getBoundingClientRect().right <= document.documentElement.clientWidth)"
        )
        # The others have a page of 277 mm.
        paper(1047)
        assert chromium.evaluate(
            "Array.from(document.querySelectorAll('table.wide')).every((table) =>"
            " table.getBoundingClientRect().right <= document.documentElement.clientWidth)"
        )
    finally:
        chromium.call("Emulation.setEmulatedMedia", media="")
