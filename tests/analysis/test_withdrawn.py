"""A withdrawn verdict is never met without its withdrawal: in outputs of every command, and on every page."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from builder import Builder
from conftest import COMMITTED, RESULTS, ROOT
from convergence_builder import Law, convergence_cell, convergence_study, on_gpu

from ptbench.errors import InputError
from ptbench.io.nodes import read_json
from ptbench.io.results import load
from ptbench.studies.rows import measure
from ptbench.studies.withdrawn import FILE, among, between, concerning, is_marked, withdrawals, withdrawals_of

PAGES = [
    COMMITTED / "README.md",
    *sorted((COMMITTED / "docs").glob("*.md")),
    *sorted((COMMITTED / "docs/findings").glob("*.md")),
    *sorted(RESULTS.glob("*/figures/**/*.md")),
]
_COST = re.compile(
    r"\b(cost|costs|dear|dearer|cheap|cheaper|pays?|gains?|efficien\w+|times as (long|dear)|slower|faster|ms/spp)\b",
    re.I,
)


def connections(backend: str = "cuda") -> Builder:
    """A study of direct light in which a connection makes a sample nine times as dear."""
    builder = Builder("lights")
    builder = builder.on_gpu() if backend == "cuda" else builder
    builder.study("lights", "direct_light")
    for choice, ms in (("off", 0.05), ("nee", 0.27), ("nee_mis", 0.44), ("final_bounce", 0.06)):
        builder.cell("lights", ms_per_spp=ms, axes={"direct_light": choice})
    return builder


def converging() -> Builder:
    builder = convergence_study(on_gpu(), "lights")
    for choice, ms in (("off", 0.05), ("nee_mis", 0.44)):
        convergence_cell(builder, Law(noisy=False), study="lights", ms_per_spp=ms, axes={"direct_light": choice})
    return builder


def test_the_file_is_sound_and_its_numbers_are_those_of_the_committed_source():
    for entry in withdrawals():
        assert bool(entry.bound) == bool(entry.source) == bool(entry.bound_is)
        if entry.source:
            source = json.loads((ROOT / entry.source).read_text())["prototype"]["cornell_open"]
            assert entry.bound == {choice: source[f"{choice}_over_off"] for choice in entry.choices}
            for choice in entry.choices:
                assert source[f"{choice}_over_off"] == pytest.approx(source[choice] / source["off"], abs=0.005)
    assert {backend for entry in withdrawals() for backend in entry.backends} == {"cpu", "cuda"}


def boxes(scene: str, backend: str = "cuda") -> Builder:
    """A queue with and without a sort, and one kernel, in one box."""
    builder = Builder("boxes")
    builder = builder.on_gpu() if backend == "cuda" else builder
    builder.study("boxes", "sorting")
    for axes in ({}, {"sorting": "bucket"}, {"integrator": "persistent"}, {"integrator": "regroup"}):
        builder.cell("boxes", scene, ms_per_spp=1.0, axes={"integrator": "wavefront", **axes})
    return builder


@pytest.mark.parametrize(
    ("scene", "backend", "is_withdrawn"),
    [("cornell_open_five", "cuda", True), ("cornell_open_five", "cpu", False), ("cornell_open", "cuda", False)],
)
def test_in_a_withdrawn_scene_it_concerns_whatever_the_choice_is_held_against(tmp_path, scene, backend, is_withdrawn):
    result = load(boxes(scene, backend).write(tmp_path / "r.json"))
    plain, sorted_, persistent, regroup = result.cells
    count = int(is_withdrawn)
    assert len(between(plain, sorted_)) == len(between(persistent, sorted_)) == len(between(plain, regroup)) == count
    assert between(persistent, regroup) == between(plain, plain) == ()
    assert len(among([plain, sorted_])) == count
    assert among([persistent, regroup]) == ()
    (row,) = [row for row in measure(result, result.studies[0]) if row.cell is sorted_]
    assert is_marked(row.verdict.note) == is_withdrawn


def test_a_broken_file_is_one_line(tmp_path):
    entries = json.loads(FILE.read_text())
    del entries[0]["reason"]
    (tmp_path / "w.json").write_text(json.dumps(entries))
    with pytest.raises(InputError, match=r"w\.json: \$\[0\]\.reason: found nothing, allowed: this key is required"):
        withdrawals_of(read_json(tmp_path / "w.json"))


@pytest.mark.parametrize("backend", ["cpu", "cuda"])
def test_it_concerns_pairs_that_differ_in_the_choice(tmp_path, backend):
    off, nee, mis, final = load(connections(backend).write(tmp_path / "r.json")).cells
    assert len(between(off, nee)) == len(between(mis, off)) == len(between(nee, mis)) == len(between(final, mis)) == 1
    assert between(off, final) == between(mis, mis) == ()
    assert len(among([off, nee, mis])) == 1
    assert among([off, final]) == among([mis, mis]) == ()
    assert len(concerning([mis])) == 1
    assert backend in among([off, mis])[0].backends


def test_ways_to_sample_a_light_that_are_not_dear_are_spared(tmp_path):
    builder = connections()
    for choice in ("nee", "nee_mis"):
        builder.cell("lights", ms_per_spp=0.1, axes={"direct_light": choice, "light_sampling": "projected"})
    off, nee, _, _, near, _ = load(builder.write(tmp_path / "r.json")).cells
    assert between(off, near) == among([off, near]) == concerning([near]) == ()
    # Beside one of solid angles it is withdrawn, in whichever order they stand.
    assert len(among([off, near, nee])) == len(among([nee, near, off])) == 1
    told = among([off, nee])[0]
    for text in (told.short, told.full):
        assert "of direct_light=nee,nee_mis, except with light_sampling=area,projected,auto: the cost" in text


def test_the_verdict_carries_it_on_its_line(tmp_path):
    result = load(connections().write(tmp_path / "r.json"))
    rows = measure(result, result.studies[0])
    notes = {row.cell.axes["direct_light"]: row.verdict.note for row in rows if row.verdict}
    assert notes["nee_mis"] == "withdrawn: the cost of direct_light=nee,nee_mis is the implementation's"
    assert notes["final_bounce"] == ""


@pytest.mark.parametrize("builder", [connections, converging])
def test_summary_report_and_captions_carry_it(tmp_path, analysis, builder):
    file = builder().write(tmp_path / "r.json")
    code, out, _ = analysis("plots", file, "--out", tmp_path / "figures")
    assert code == 0
    subject = "verdicts on the time and efficiency of direct_light=nee,nee_mis, except with light_sampling="
    assert f"note: lights: withdrawn: {subject}" in out
    bound = "bound: 1.54 (nee), 1.60 (nee_mis) times the time of off"
    summary = (tmp_path / "figures" / "summary.md").read_text()
    assert summary.count(bound) == 2  # the file's head, and beneath the study's table
    assert "What stays valid: variances" in summary
    figures = list((tmp_path / "figures").glob("*.svg"))
    assert figures
    for figure in figures:
        assert "Withdrawn: verdicts on the time and efficiency" in " ".join(
            re.findall(r"<text[^>]*>([^<]*)</text>", figure.read_text())
        )
    assert analysis("report", file, "--out", tmp_path / "report")[0] == 0
    page = (tmp_path / "report" / "report.md").read_text()
    assert bound in page[: page.index("## Machines")]
    assert page.count(bound) >= 3
    assert "(withdrawn" in page


def test_an_efficiency_carries_it_on_its_line(tmp_path, analysis):
    file = converging().write(tmp_path / "r.json")
    assert analysis("plots", file, "--out", tmp_path / "figures")[0] == 0
    rows = [line for line in (tmp_path / "figures" / "summary.md").read_text().splitlines() if "(withdrawn)" in line]
    assert [row.split("|")[1].strip() for row in rows] == ["nee_mis", "nee_mis"]  # by the fit, at the last checkpoint
    assert analysis("report", file, "--out", tmp_path / "report")[0] == 0
    assert re.search(r"lower: `nee_mis` 0\.\d+ .*\(withdrawn\)", (tmp_path / "report" / "report.md").read_text())


def test_explain_and_compare_carry_it(tmp_path, analysis):
    file = connections().write(tmp_path / "r.json")
    names = ("off.off.pcg4d", "nee_mis.off.pcg4d")
    code, out, _ = analysis("explain", file, *names, "--out", tmp_path / "explained")
    assert code == 0
    assert "(withdrawn: the cost of direct_light=nee,nee_mis is the implementation's)" in out
    assert "- Withdrawn: verdicts on the time and efficiency" in out
    other = connections()
    for row in other.rows:
        if "pt_timestamp" in row:
            row["pt_timestamp"] += 86400.0
    code, out, _ = analysis("compare", file, other.write(tmp_path / "s.json"))
    assert code == 0
    assert " ".join(out.split()).count("Withdrawn: verdicts on the time and efficiency") == 2


def test_a_file_without_such_cells_says_nothing_of_it(tmp_path, analysis):
    builder = Builder().on_gpu().study("lights", "direct_light")
    for choice in ("off", "final_bounce"):
        builder.cell("lights", axes={"direct_light": choice})
    code, out, _ = analysis("plots", builder.write(tmp_path / "r.json"), "--out", tmp_path / "figures")
    assert code == 0
    assert "ithdrawn" not in out + (tmp_path / "figures" / "summary.md").read_text()


def _is_spared(page: Path) -> bool:
    """Whether it is the summary of a result file of which nothing is withdrawn."""
    named = re.search(r"^- Result file: (\S+)$", page.read_text(encoding="utf-8"), re.M)
    return bool(named) and not concerning(load(page.parents[2] / named[1]).cells)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(COMMITTED)))
def test_a_page_that_tells_what_connections_cost_tells_the_withdrawal(page):
    text = page.read_text(encoding="utf-8")
    names_a_cost = re.search(r"\bnee_mis\b", text) and _COST.search(text) and "/figures/stability/" not in str(page)
    if names_a_cost and not _is_spared(page):
        assert re.search(r"withdrawn", text, re.I), f"{page}: names nee_mis and a cost"
        bound = "1.54" in text or "1.55" in text or "findings/error_against_time.md" in text
        of_a_cpu = "/results/" in str(page) and "/nvidia-" not in str(page)
        assert bound or of_a_cpu or page.name == "result-fields.md", page


def test_a_summary_is_spared_where_its_cells_are():
    assert _is_spared(RESULTS / "nvidia-h200/figures/mesh_convergence/summary.md")
    assert not _is_spared(RESULTS / "nvidia-h200/figures/connections/summary.md")
    assert not _is_spared(ROOT / "docs/findings/meshes.md")


def test_the_pages_that_must_carry_it_are_among_them():
    told = [page for page in PAGES if re.search(r"withdrawn", page.read_text(encoding="utf-8"), re.I)]
    names = {str(page.relative_to(COMMITTED)) for page in told}
    pages = ("faq.md", "method.md", "add_an_estimator.md", "reference.md", "findings/error_against_time.md")
    assert {f"docs/{page}" for page in pages} <= names
    assert {f"results/{m}/figures/convergence/summary.md" for m in ("nvidia-h200", "amd-epyc-2-threads")} <= names
    # The README says nothing of their cost, and the page of findings nothing before the withdrawal.
    assert not re.search(r"`nee", (ROOT / "README.md").read_text(encoding="utf-8"))
    page = (ROOT / "docs/findings/error_against_time.md").read_text(encoding="utf-8")
    assert not re.search(r"`nee(_mis)?`[^|\n]*(efficiency|times as)", page[: page.index("> **Withdrawn**")])
