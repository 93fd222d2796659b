"""The `plots` command: files, output, summary, exit codes."""

from __future__ import annotations

import json
import subprocess

import pytest
from builder import Builder, small
from conftest import run_analysis

from ptbench.io.results import load
from ptbench.plots.command import default_folder

NAMES = ("remaining_paths", "sorting_by_depth", "first_bounce_by_depth", "compaction", "integrator")


def table_rows(summary: str) -> list[list[str]]:
    """The cells of every line of the studies' tables: those that start with a variant's name."""
    studies = summary.partition("## Where the time goes")[0]
    return [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in studies.splitlines()
        if line.startswith(("| wave", "| depth_first"))
    ]


def test_every_figure_is_written_and_named(quick_run):
    done, folder = quick_run
    assert (done.returncode, done.stderr) == (0, "")
    expected = [folder / f"{name}.{kind}" for name in NAMES for kind in ("png", "svg")] + [folder / "summary.md"]
    assert done.stdout.splitlines() == ["disturbed: 0 of 288 samples", *map(str, expected)]
    assert sorted(folder.iterdir()) == sorted(expected)
    for path in expected:
        assert path.stat().st_size > 1000
        if path.suffix == ".png":
            assert path.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
        if path.suffix == ".svg":
            assert path.read_text().rstrip().endswith("</svg>")


def test_png_is_200_dpi(quick_run):
    data = (quick_run[1] / "compaction.png").read_bytes()
    per_metre = int.from_bytes(data[data.index(b"pHYs") + 4 :][:4], "big")
    assert per_metre == round(200 / 0.0254)


def test_the_same_file_gives_the_same_bytes(quick_run, tmp_path):
    _, folder = quick_run
    done = run_analysis("plots", folder.parent.parent / "quick.json", "--out", tmp_path / "again", hash_seed=2)
    assert done.returncode == 0
    for path in folder.iterdir():
        assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes(), path.name


def test_the_default_folder_is_of_the_suite_and_no_two_files_share_it(tmp_path):
    def folder(suite: str, file: str):
        return default_folder(load(Builder(suite).write(tmp_path / file))).relative_to(tmp_path).as_posix()

    assert folder("quick", "quick.json") == "figures/quick"
    assert folder("quick", "monday.json") == "figures/quick-monday"
    assert folder("", "mine.json") == "figures/mine"
    assert folder("../../up", "x.json") == "figures/_.._up-x"


def test_summary_has_a_row_a_cell_with_numbers_and_verdicts(quick_run):
    summary = (quick_run[1] / "summary.md").read_text()
    rows = table_rows(summary)
    # The three unsorted cells of each scene answer two studies, so they stand in both tables.
    assert len(rows) == 2 + 12 + 12 + 8 + 4
    scatter = next(r for r in rows if "compaction=scatter" in r[0] and r[1] == "cornell_closed")
    # 4 x 40000 rays in 4.32 ms: 37.04 million a second.
    assert scatter[1:10] == ["cornell_closed", "8", "200x200", "cpu", "4", "9", "4.320", "[4.255, 4.514]", "37.04"]
    assert scatter[10] == "0.900"
    assert scatter[12] == "FASTER"
    partition = next(r for r in rows if "compaction=thrust_partition" in r[0])
    assert (partition[10], partition[12]) == ("1.400", "SLOWER")
    assert next(r for r in rows if r[0] == "wavefront")[12] == "baseline"
    remove = next(r for r in rows if r[0] == "wavefront compaction=thrust_remove_if")
    assert "\nAll rows: layout=soa.\n" in summary
    assert remove[12] == "UNSURE"
    assert "reaches both sides of a 1 % limit" in remove[13]
    assert "With at least 9 samples on both sides" in summary
    assert "Baseline: compaction=none, all else equal." in summary
    assert "## Not applicable\n\nNone.\n" in summary
    assert "## Failed\n\nNone.\n" in summary


def damaged(tmp_path) -> Builder:
    """Failed, skipped, interrupted and baseless cells, too few samples, a low clock, studies without a figure."""
    builder = (
        Builder("rough").study("compaction").study("sorting_by_depth").study("mystery", "pie_chart").study("empty")
    )
    builder.context["ptbench.status"] = "interrupted"
    builder.cell("compaction", n=9, low_clock=1)
    builder.cell("compaction", n=5, axes={"compaction": "few"}, ms_per_spp=1.0)
    builder.cell("compaction", n=3, axes={"compaction": "broken"}, error="CUDA error 700 | illegal\naddress")
    builder.cell("compaction", n=2, axes={"compaction": "cut"}, status="interrupted", reason="signal 2")
    builder.cell("compaction", "alone", n=9, axes={"compaction": "few"}, unfinished_walks=7)
    builder.cell("sorting_by_depth", n=2, axes={"sorting": "material", "layout": "x"}, error="out of memory")
    builder.cell("mystery", axes={"layout": "y"})
    builder.skip("compaction", "cornell_open", "needs a GPU", {"compaction": "warp"})
    return builder


def test_a_damaged_file_is_drawn_as_far_as_it_goes_and_nothing_is_silent(tmp_path, analysis):
    code, out, err = analysis("plots", damaged(tmp_path).write(tmp_path / "rough.json"))
    folder = tmp_path / "figures" / "rough"
    assert (code, err) == (0, "")
    assert sorted(path.name for path in folder.iterdir()) == ["compaction.png", "compaction.svg", "summary.md"]
    lines = out.splitlines()
    variant = "wavefront/compaction:broken"
    for expected in (
        "not drawn: sorting_by_depth: no cell has times:",
        'not drawn: mystery: no figure is called "pie_chart"; there are remaining_paths, ',
        "not drawn: empty: no figure is called",
        "note: compaction: interrupted run: ",
        "note: compaction: n/a: warp in cornell_open: needs a GPU",
        f"note: compaction: failed: {variant}/scene:cornell_open/backend:cpu/200x200/depth:8/spp:4: "
        "CUDA error 700 | illegal address",
        "note: compaction: interrupted: 1 cell interrupted while measuring: wavefront/compaction:cut/",
        "note: compaction: few samples: 2 cells with fewer than 9 samples (no verdict): wavefront/compaction:few/",
        "note: compaction: low clock: 1 of 25 samples at a low clock, kept: wavefront/scene:",
        "note: compaction: unfinished_walks: 1 cell with unfinished walks: wavefront/compaction:few/",
    ):
        assert any(line.startswith(expected) for line in lines), expected

    summary = (folder / "summary.md").read_text()
    rows = {
        (row[0].partition("compaction=")[2] or "none", row[1]): row
        for row in table_rows(summary)
        if row[0].startswith("wavefront") and "layout" not in row[0] and "sorting" not in row[0]
    }
    assert rows["few", "cornell_open"][12:] == ["UNSURE", "n = 5, a verdict needs 9"]
    # A pipe would have ended the table's cell; it is escaped, so the row splits there and nowhere else.
    assert rows["broken", "cornell_open"][12:] == ["FAILED", "CUDA error 700 \\", "illegal address"]
    assert rows["broken", "cornell_open"][7] == "—"
    assert rows["cut", "cornell_open"][13].startswith("interrupted: signal 2")
    assert rows["none", "cornell_open"][12:] == ["baseline", "1 low-clock"]
    assert rows["few", "alone"][12:] == ["—", "no cell with compaction=none and all else equal; unfinished walks 7"]
    assert "INTERRUPTED" in summary
    assert "Not drawn: no cell has times" in summary
    assert "| compaction | cornell_open | wavefront compaction=warp | needs a GPU |" in summary
    assert f"- {variant}/scene:cornell_open" in summary


def test_a_verdict_needs_the_cycles_consent(tmp_path, analysis):
    builder = Builder("clocks").study("compaction")
    builder.cell("compaction", ms_per_spp=2.0, noise=0.001, clock_mhz=2000)
    # Half the time at twice the clock: the same work.
    builder.cell("compaction", ms_per_spp=1.0, noise=0.001, clock_mhz=4000, axes={"compaction": "boosted"})
    code, _, _ = analysis("plots", builder.write(tmp_path / "clocks.json"))
    assert code == 0
    row = table_rows((tmp_path / "figures/clocks/summary.md").read_text())[1]
    assert row[10] == "0.500"
    assert row[12:] == ["UNSURE", "FASTER in time but SAME in cycles: the clocks differed"]


def test_a_busy_machine_gives_no_verdict(tmp_path, analysis):
    builder = Builder("busy").study("compaction")
    builder.cell("compaction", ms_per_spp=2.0, noise=0.001)
    builder.cell("compaction", ms_per_spp=1.0, noise=0.001, axes={"compaction": "quick"}, contended=2)
    code, out, _ = analysis("plots", builder.write(tmp_path / "busy.json"))
    assert code == 0
    assert "contended: 2 of 18 samples while other processes took over a tenth of the CPU, kept" in out
    row = table_rows((tmp_path / "figures/busy/summary.md").read_text())[1]
    assert row[12:] == ["UNSURE", "other processes took CPU time during more than a tenth of the samples; 2 contended"]


def test_the_summary_says_where_the_time_goes_and_what_is_missing(tmp_path, analysis):
    builder = Builder("stages").study("compaction")
    whole = builder.cell("compaction", live_paths=[10, 5])
    whole["instrumented"] |= {"stage_ms": {"intersect": 6.0, "shade": 3.9}, "wall_ms": 10.0}
    lossy = builder.cell("compaction", axes={"compaction": "lossy"}, live_paths=[10, 5])
    lossy["instrumented"] |= {"stage_ms": {"intersect": 6.0}, "wall_ms": 10.0}
    code, _, _ = analysis("plots", builder.write(tmp_path / "stages.json"))
    assert code == 0
    table = (tmp_path / "figures/stages/summary.md").read_text().partition("## Where the time goes")[2]
    assert "| cornell_open | 8 | 60.0 % | 39.0 % | 1.0 % |  |" in table
    assert "| cornell_open | 8 | 60.0 % | — | 40.0 % | stages do not add up to the wall time |" in table


def test_a_file_without_studies_still_gets_its_table(tmp_path, analysis):
    builder = Builder("")
    builder.cell(None)
    code, out, err = analysis("plots", builder.write(tmp_path / "mine.json"))
    assert (code, err) == (0, "")
    assert "has no studies" in out
    summary = (tmp_path / "figures/mine/summary.md").read_text()
    assert "## Cells of no study" in summary
    assert len(table_rows(summary)) == 1


def test_a_study_whose_cells_are_missing(tmp_path, analysis):
    code, out, _ = analysis("plots", Builder().study("compaction").write(tmp_path / "quick.json"))
    assert code == 0
    assert "not drawn: compaction: the file has no cell of this study" in out


def test_a_study_name_cannot_leave_the_folder(tmp_path, analysis):
    builder = Builder().study("../../evil", "compaction")
    builder.cell("../../evil")
    code, _, _ = analysis("plots", builder.write(tmp_path / "quick.json"), "--out", tmp_path / "a" / "b")
    assert code == 0
    assert sorted(path.name for path in (tmp_path / "a" / "b").iterdir()) == [
        "_.._evil.png",
        "_.._evil.svg",
        "summary.md",
    ]


def test_bad_input_is_one_line_exit_code_2_and_no_files(tmp_path):
    document = small().document()
    document["ptbench"]["cells"][3]["depth"] = "deep"
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(document))
    done: subprocess.CompletedProcess = run_analysis("plots", path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        f'python3 -m ptbench: {path}: $.ptbench.cells[3].depth: found "deep", allowed: an integer of at least 1\n'
    )
    assert list(tmp_path.iterdir()) == [path]


def test_an_output_folder_that_cannot_be_made(tmp_path, analysis):
    path = small().write(tmp_path / "quick.json")
    code, out, err = analysis("plots", path, "--out", path)
    assert (code, out) == (2, "")
    found = f"{path}: output folder: found a file, which is no folder, allowed: a folder that can be made"
    assert err == f"python3 -m ptbench: {found}\n"


def test_an_output_name_that_is_taken_by_a_folder_leaves_no_half_files(tmp_path, analysis):
    builder = Builder()
    builder.cell(None)
    (tmp_path / "out" / "summary.md").mkdir(parents=True)
    code, _, err = analysis("plots", builder.write(tmp_path / "x.json"), "--out", tmp_path / "out")
    assert code == 2
    assert "summary.md: output file: found a folder, allowed: a file, new or regular" in err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["summary.md"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "plots|report|compare|fleet|crosscheck|peers|explain|findings|claims|map|advise|gallery|flat|validate"),
        (["pie"], 'found the command "pie", allowed: plots, report, compare, '),
        (["plots"], "the following arguments are required: RESULT.json"),
        (["plots", "a.json", "--size", "3"], 'plots: found the option "--size", allowed: --help, --out'),
        (
            ["gallery", "--binary", "b", "--out", "o", "--spp", "0"],
            'argument --spp: found "0", allowed: an integer of at least 1',
        ),
        (
            ["gallery", "--binary", "b", "--out", "o", "--resolution", "200"],
            'argument --resolution: found "200", allowed: WIDTHxHEIGHT such as 200x200',
        ),
    ],
)
def test_wrong_calls_are_one_line_and_exit_code_2(analysis, arguments, message):
    code, out, err = analysis(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
