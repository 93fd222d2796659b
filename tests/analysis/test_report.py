"""The report: what the files say is on the page, nothing else is asked for, and nothing in a file becomes markup."""

from __future__ import annotations

import base64
import csv
import gzip
import io
import json
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
from browser import browser, find_chromium
from builder import Builder, small
from convergence_builder import convergence_cell, convergence_study, on_gpu
from stability_builder import large
from test_convergence_figures import with_images

from ptbench.cli.main import main
from ptbench.report import command
from ptbench.report.html import inline

HOSTILE = "<script>alert(1)</script>\"&'|`"


class Reader(HTMLParser):
    """All tags with their attributes, and what stands between them; which tags are open at the end."""

    VOID = ("meta", "link", "img", "wbr", "br", "source")

    def __init__(self, text: str):
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.open: list[str] = []
        self.texts: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.texts.append(data)

    @property
    def text(self) -> str:
        return "".join(self.texts)


def read_html(folder: Path) -> Reader:
    return Reader((folder / "report.html").read_text(encoding="utf-8"))


def downloads(reader: Reader) -> dict[str, list[dict[str, str]]]:
    """The raw rows in the page, by the file's name."""
    found = {}
    for tag, attributes in reader.tags:
        if tag == "a" and "download" in attributes:
            packed = base64.b64decode(attributes["href"].removeprefix("data:application/gzip;base64,"))
            text = gzip.decompress(packed).decode()
            found[attributes["download"]] = list(csv.DictReader(io.StringIO(text, newline="")))
    return found


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    """The folder of a report of all kinds of files, among them what is hostile, failed and left out."""
    folder = tmp_path_factory.mktemp("everything")
    timed = small()
    timed.study(f"study {HOSTILE}", "compaction", f"Title {HOSTILE}")
    for choice, ms in (("none", 3.0), ("scatter", 6.0)):
        cell = timed.cell("compaction", HOSTILE, ms, axes={"compaction": choice}, contended=2, low_clock=1)
        cell["studies"].append(f"study {HOSTILE}")
    # A table that is long enough to be folded.
    timed.study("blocks", "integrator")
    for index in range(14):
        axes = {"integrator": f"integrator_{index}"}
        timed.cell(
            "blocks", "cornell_open", 2 + 7 * index % 11 + index / 100, axes=axes, error="no time" * (index == 3)
        )
    timed.cell("compaction", "broken", error=f"the film differs {HOSTILE}", n=2)
    timed.skip("compaction", "cornell_open", f"needs a queue {HOSTILE}", {"compaction": "gather"})
    timed.context["ptbench.git_dirty"] = "true"
    timed.write(folder / "quick.json")
    converging = convergence_study(on_gpu())
    convergence_cell(converging)
    convergence_cell(converging, axes={"integrator": "megakernel"}, ms_per_spp=1.0)
    with_images(converging, folder)
    converging.write(folder / "convergence.json")
    large(cases=8, points=2).write(folder / "stability.json")
    (folder / "other.json").write_text("[1, 2]")
    assert main(["report", str(folder), "--out", str(folder / "report")]) == 0
    return folder / "report"


def test_the_page_asks_for_nothing(everything):
    reader = read_html(everything)
    assert reader.open == []
    for tag, attributes in reader.tags:
        for name in ("src", "href", "srcset", "poster", "data", "action"):
            value = attributes.get(name)
            assert value is None or value.startswith("data:") or (tag == "a" and value.startswith("#")), (tag, value)
        assert not any(name.startswith("on") for name in attributes)
    text = (everything / "report.html").read_text()
    style = text[text.index("<style>") : text.index("</style>")]
    assert "url(" not in style
    assert "@import" not in style
    assert "@font-face" not in style
    assert sum(tag == "script" for tag, _ in reader.tags) == 1


def test_every_link_has_its_target(everything):
    tags = read_html(everything).tags
    anchors = [attributes["id"] for _, attributes in tags if "id" in attributes]
    assert len(anchors) == len(set(anchors))
    links = [attributes["href"][1:] for tag, attributes in tags if tag == "a" and attributes["href"].startswith("#")]
    assert set(links) <= set(anchors)
    page = (everything / "report.md").read_text()
    for target in re.findall(r"\]\(([^)#]+)\)", page):
        assert (everything / target).is_file(), target
    for target in re.findall(r"\]\(#([^)]+)\)", page):
        assert f'<a id="{target}"></a>' in page


def test_what_a_file_says_is_text(everything):
    reader = read_html(everything)
    assert f"needs a queue {HOSTILE}" in reader.text
    assert f"the film differs {HOSTILE}" in reader.text
    assert f"Title {HOSTILE}" in reader.text
    page = (everything / "report.md").read_text()
    outside_code = re.sub(r"`[^`\n]*`", "", page)
    assert "<script" not in outside_code
    assert "&lt;script>" in page


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("`a b` and **c**", "<code><span>a</span> <span>b</span></code> and <strong>c</strong>"),
        ("<b> & `<i>`", "&lt;b&gt; &amp; <code>&lt;i&gt;</code>"),
        ("one ` and ** alone", "one ` and ** alone"),
        ("wavefront.none.none.material.off", "wavefront.<wbr>none.<wbr>none.<wbr>material.<wbr>off"),
    ],
)
def test_inline(text, html):
    assert inline(text) == html


def test_a_cell_is_held_to_the_rule_of_its_kind(tmp_path, analysis):
    """8 seeds are enough for a verdict on errors, and too few samples for one on times."""
    builder = convergence_study(on_gpu())
    convergence_cell(builder, seeds=8)
    convergence_cell(builder, seeds=7, axes={"integrator": "megakernel"})
    builder.cell(None, "cornell_open", n=8)
    assert analysis("report", builder.write(tmp_path / "mixed.json"), "--out", tmp_path / "out")[0] == 0
    page = (tmp_path / "out/report.md").read_text()
    assert "| mixed | cells with fewer than 9 samples, too few for a verdict on times | 1 | 3 cells |" in page
    assert "| mixed | cells with fewer than 8 seeds, too few for every verdict on errors | 1 | 3 cells |" in page


def test_what_was_left_out_is_told(everything):
    text = read_html(everything).text
    assert "quick: built with uncommitted changes" in text
    assert "quick: 2 failed" in text
    assert "samples at a low clock, kept" in text
    assert "samples while other processes used the host, kept" in text
    assert "no result files, so not here: other.json" in text
    assert "checkpoint_cost: no cell was also run without checkpoints" in text
    assert "ptbench has no such light" in text
    assert "scenes without a picture" in text
    assert "--binary" in text


def test_verdicts_are_those_of_the_data(everything):
    text = read_html(everything).text
    # scatter takes 0.9 of the time in two scenes and 2 of it in the third, where the machine was busy: no verdict.
    assert "Held against compaction=none, all else equal: 7 comparisons, 2 FASTER, 2 SLOWER, 3 UNSURE." in text
    assert "scatter: FASTER in 2 of 3, 0.900 [" in text
    assert f"UNSURE in 1 of 3, 2.000 [1.922, 2.090] ({HOSTILE})" in text
    assert "thrust_partition: SLOWER in 2 of 2, 1.400 [" in text


def test_all_figures_are_there_and_the_same_beside_the_markdown_page(everything):
    pictures = [attributes for tag, attributes in read_html(everything).tags if tag == "img"]
    files = [*(everything / "figures").iterdir(), *(everything / "scenes").glob("*.jpg")]
    assert len(pictures) == len(files) >= 12
    inside = {base64.b64decode(picture["src"].partition("base64,")[2]) for picture in pictures}
    assert inside == {file.read_bytes() for file in files}
    assert all(picture["alt"] for picture in pictures)


def test_raw_rows_read_back_as_what_was_written(everything):
    found = downloads(read_html(everything))
    assert set(found) == {
        "quick.samples.csv.gz",
        "convergence.samples.csv.gz",
        "convergence.checkpoints.csv.gz",
        "stability.checks.csv.gz",
    }
    raw = json.loads((everything.parent / "quick.json").read_text())
    expected = [
        (row["run_name"], row["repetition_index"], row["pt_wall_ms"])
        for row in raw["benchmarks"]
        if row["run_type"] == "iteration" and "pt_wall_ms" in row
    ]
    rows = found["quick.samples.csv.gz"]
    timed = [(row["cell"], int(row["repetition"]), float(row["wall_ms"])) for row in rows if not row["error"]]
    assert sorted(timed) == sorted(expected)
    assert [row["error"] for row in rows if row["error"]] == ["no time"] * 9 + [f"the film differs {HOSTILE}"] * 2
    checkpoints = sum(len(row.get("pt_checkpoints", ())) for row in _rows(everything, "convergence"))
    assert len(found["convergence.checkpoints.csv.gz"]) == checkpoints
    checks = json.loads((everything.parent / "stability.json").read_text())["rows"]
    assert len(found["stability.checks.csv.gz"]) == len(checks)
    for name, content in found.items():
        beside = (everything / "data" / name.removesuffix(".gz")).read_text()
        assert list(csv.DictReader(io.StringIO(beside, newline=""))) == content


def _rows(everything: Path, name: str) -> list[dict]:
    return json.loads((everything.parent / f"{name}.json").read_text())["benchmarks"]


STAND_IN = """#!{python} -S
import json, sys
scene = sys.argv[sys.argv.index("--scene") + 1]
open({calls!r}, "a").write(scene + "\\n")
if "cornell_closed" in scene or "--axis" in sys.argv:
    sys.exit("no such scene")
with open({picture!r}, "rb") as source, open(sys.argv[sys.argv.index("--out") + 1], "wb") as target:
    target.write(source.read())
print(json.dumps({{"scene_hash": {scene_hash!r}, "nonfinite": 0, "negative": 0, "unfinished_walks": 0}}))
"""


def stand_in(folder: Path, scene_hash: str) -> Path:
    import matplotlib.image
    import numpy as np

    matplotlib.image.imsave(folder / "source.png", np.full((8, 8, 3), 0.5))
    path = folder / "ptbench"
    names = {"calls": str(folder / "calls"), "picture": str(folder / "source.png")}
    path.write_text(STAND_IN.format(python=sys.executable, scene_hash=scene_hash, **names))
    path.chmod(0o755)
    return path


def test_scenes_are_rendered_once_and_failures_told(tmp_path, analysis):
    file = small().write(tmp_path / "quick.json")
    binary = stand_in(tmp_path, "0123456789abcdef")
    for _ in range(2):
        code, out, _ = analysis("report", file, "--out", tmp_path / "out", "--binary", binary, "--side", 8)
        assert code == 0
        assert "scene without a picture: cornell_closed: not rendered: no such scene" in out
    # Once with light sampling, which this program cannot do, and once without; the second report asks for nothing.
    assert (tmp_path / "calls").read_text().split().count("cornell_open") == 2
    assert "rendered at 8×8, 16 spp" in read_html(tmp_path / "out").text
    assert len(list((tmp_path / "out/scenes").glob("*.jpg"))) == 1


def test_a_kept_picture_that_is_none_any_more_is_rendered_again(tmp_path, analysis):
    file = small().write(tmp_path / "quick.json")
    binary = stand_in(tmp_path, "0123456789abcdef")
    call = ("report", file, "--out", tmp_path / "out", "--binary", binary, "--side", 8)
    assert analysis(*call)[0] == 0
    (kept,) = (tmp_path / "out/scenes/rendered").glob("*.jpg")
    kept.write_bytes(b"\xff\xd8 cut off")
    assert analysis(*call)[0] == 0
    assert len(kept.read_bytes()) > 100


def test_another_scene_of_the_same_name_is_not_shown(tmp_path, analysis):
    file = small().write(tmp_path / "quick.json")
    code, out, _ = analysis("report", file, "--out", tmp_path / "out", "--binary", stand_in(tmp_path, "another"))
    assert code == 0
    assert "cornell_open: the program's scene of that name is another one, of hash another" in out
    assert not list((tmp_path / "out/scenes").glob("*.jpg"))


def test_a_scene_given_by_its_path_is_rendered_from_there(tmp_path, analysis):
    own = tmp_path / "mine.json"
    own.write_text("{}")
    builder = Builder().study("compaction")
    for choice in ("none", "scan"):
        builder.cell("compaction", "mine", axes={"compaction": choice}, scene_file=str(own))
    file = builder.write(tmp_path / "quick.json")
    binary = stand_in(tmp_path, "0123456789abcdef")
    code, out, _ = analysis("report", file, "--out", tmp_path / "out", "--binary", binary, "--side", 8)
    assert code == 0
    assert "scene without a picture" not in out
    assert set((tmp_path / "calls").read_text().split()) == {str(own)}
    assert len(list((tmp_path / "out/scenes").glob("*.jpg"))) == 1


def test_files_of_one_name_are_told_apart(tmp_path, analysis):
    for folder, machine in (("a", "one"), ("b", "two")):
        (tmp_path / folder).mkdir()
        builder = small()
        builder.context["ptbench.machine"] = machine
        builder.write(tmp_path / folder / "quick.json")
    files = [tmp_path / folder / "quick.json" for folder in ("a", "b", "a")]
    code, _, _ = analysis("report", *files, "--out", tmp_path / "out")
    assert code == 0
    reader = read_html(tmp_path / "out")
    assert "2 result files, from 2 machines (one, two)" in reader.text
    assert {"a_quick.samples.csv.gz", "b_quick.samples.csv.gz"} == set(downloads(reader))


@pytest.mark.parametrize("content", ["[1]", "{", '{"schema": "ptbench-stability-9"}'])
def test_a_broken_file_leaves_no_report(tmp_path, analysis, content):
    (tmp_path / "bad.json").write_text(content)
    code, _, err = analysis("report", tmp_path / "bad.json", "--out", tmp_path / "out")
    assert code == 2
    assert "bad.json: " in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("what", ["an empty folder", "no program"])
def test_bad_calls(tmp_path, analysis, what):
    file = small().write(tmp_path / "quick.json")
    (tmp_path / "empty").mkdir()
    wrong = [tmp_path / "empty"] if what == "an empty folder" else [file, "--binary", tmp_path / "nothing"]
    code, _, err = analysis("report", *wrong, "--out", tmp_path / "out")
    assert code == 2
    assert ("none a result" if what == "an empty folder" else "--binary: found no such file") in err
    assert not (tmp_path / "out").exists()


def test_files_that_are_read_by_several_processes_make_the_same_report(tmp_path, monkeypatch):
    for name in ("a", "b"):
        small().write(tmp_path / f"{name}.json")
    begun = []
    pool = command.ProcessPoolExecutor
    monkeypatch.setattr(command, "ProcessPoolExecutor", lambda *args, **more: begun.append(args) or pool(*args, **more))
    monkeypatch.setattr(command.os, "sched_getaffinity", lambda _: {0, 1})
    for out, worth in (("here", command.WORTH_PROCESSES), ("apart", 0)):
        monkeypatch.setattr(command, "WORTH_PROCESSES", worth)
        assert main(["report", str(tmp_path / "a.json"), str(tmp_path / "b.json"), "--out", str(tmp_path / out)]) == 0
        assert len(begun) == (out == "apart")
    for page in ("report.md", "report.html"):
        assert (tmp_path / "here" / page).read_bytes() == (tmp_path / "apart" / page).read_bytes()


# --- in a browser -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    program = find_chromium()
    if program is None:
        pytest.skip("no Chromium here (Debian package chromium)")
    with browser(program, tmp_path_factory.mktemp("profile")) as page:
        yield page


def test_the_page_in_a_browser(everything, chromium):
    chromium.open(everything / "report.html", 1280)
    assert chromium.complaints == []
    assert [url for url in chromium.requests if not url.startswith("data:")] == [
        (everything / "report.html").resolve().as_uri()
    ]
    sizes = chromium.evaluate("Array.from(document.images, (image) => [image.complete, image.naturalWidth])")
    assert len(sizes) >= 12
    assert all(complete and width > 1 for complete, width in sizes)


def _mark_table(chromium, head: str) -> int:
    """Gives the first long folded table that has such a column the id "sorted", and opens it; the column's index."""
    return chromium.evaluate(
        "(() => { for (const table of document.querySelectorAll('details table')) {"
        " const names = Array.from(table.tHead.rows[0].cells, (cell) => cell.textContent);"
        f" if (table.tBodies[0].rows.length > 12 && names.includes({json.dumps(head)})) {{ table.id = 'sorted';"
        " table.closest('details').open = true;"
        f" return names.indexOf({json.dumps(head)}); }} }} return -1; }})()"
    )


def _column(chromium, column: int) -> list[str]:
    return chromium.evaluate(
        f"Array.from(document.getElementById('sorted').tBodies[0].rows, (row) => row.cells[{column}].textContent)"
    )


@pytest.mark.parametrize("way", ["mouse", "keyboard"])
def test_tables_sort(everything, chromium, way):
    chromium.open(everything / "report.html", 1280)
    column = _mark_table(chromium, "ms/spp")
    header = f"#sorted th:nth-child({column + 1})"
    before = _column(chromium, column)
    assert len(set(before)) > 5

    def sort() -> str | None:
        if way == "mouse":
            chromium.click(f"{header} button")
        else:
            chromium.evaluate(f"document.querySelector('{header} button').focus()")
            chromium.press("Enter")
        return chromium.evaluate(f"document.querySelector('{header}').getAttribute('aria-sort')")

    def numbers() -> list[float]:
        return [float(text) for text in _column(chromium, column) if text != "—"]

    expected = sorted(float(text) for text in before if text != "—")
    without = before.count("—")
    assert sort() == "ascending"
    assert numbers() == expected
    assert _column(chromium, column)[len(expected) :] == ["—"] * without
    assert sort() == "descending"
    assert numbers() == expected[::-1]
    assert _column(chromium, column)[len(expected) :] == ["—"] * without
    assert sort() is None
    assert _column(chromium, column) == before
    assert chromium.complaints == []


def test_a_header_is_reached_by_tab(everything, chromium):
    chromium.open(everything / "report.html", 1280)
    chromium.evaluate("document.querySelector('.scroll').focus()")
    chromium.press("Tab")
    assert chromium.evaluate("document.activeElement.tagName") == "BUTTON"


@pytest.mark.parametrize("width", [375, 1280])
def test_the_page_never_scrolls_sideways(everything, chromium, width):
    chromium.open(everything / "report.html", width, mobile=width < 500)
    chromium.evaluate("document.querySelectorAll('details').forEach((folded) => { folded.open = true; })")
    assert chromium.evaluate("document.documentElement.scrollWidth") <= width
    # And what is too wide for it is in a box that does.
    assert chromium.evaluate(
        "Array.from(document.querySelectorAll('table, figure img')).every((wide) =>"
        " wide.closest('.scroll, .pictures, .fitting') !== null)"
    )


def test_raw_rows_unpack_in_the_browser(everything, chromium):
    chromium.open(everything / "report.html", 1280)
    text = chromium.evaluate("unpack(document.querySelector('a.csv')).then((blob) => blob.text())")
    name = chromium.evaluate("document.querySelector('a.csv').textContent")
    assert text == (everything / "data" / name).read_text()


def test_print_opens_what_is_folded(everything, chromium, tmp_path):
    chromium.open(everything / "report.html", 1280)
    chromium.evaluate(
        "addEventListener('beforeprint', () => { window.folded = document.querySelectorAll("
        "'details:not([open])').length; })"
    )
    before = chromium.evaluate("document.querySelectorAll('details[open]').length")
    chromium.pdf(tmp_path / "report.pdf")
    assert chromium.evaluate("document.querySelectorAll('details').length") > before + 1
    assert chromium.evaluate("window.folded") == 0
    assert chromium.evaluate("document.querySelectorAll('details[open]').length") == before
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
