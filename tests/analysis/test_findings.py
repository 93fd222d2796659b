"""Pages of findings: every number from a result, every verdict the data's, nothing typed by hand, nothing too old."""

import gzip
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from builder import Builder
from conftest import COMMITTED, PACKAGE
from stability_builder import FLOAT, StabilityBuilder

from ptbench.errors import FindingError
from ptbench.findings import commits
from ptbench.findings import page as pages
from ptbench.findings.command import House, findings
from ptbench.findings.overview import overview_of
from ptbench.findings.page import read_page, render, too_old, typed_by_hand
from ptbench.findings.source import Source, kinds
from ptbench.findings.sources.suite import SuiteSource
from ptbench.studies.selection import parsed

ROOT = Path(__file__).resolve().parents[2]
HOUSE = House(COMMITTED)
TEMPLATES = sorted(path.stem for path in HOUSE.templates.glob("*.md"))
SOURCE = {"compaction": {"file": "nvidia-h200/compaction.json", "where": "arithmetic=exact", "kernels_behind": 1000}}
CELL = '"study=wavefront scene=cornell_open layout=aos compaction=thrust_remove_if"'


def result_of(summary: Path) -> Path | None:
    """The result file that a folder of figures is called by; None: it is called by something else."""
    stem = summary.parents[2] / summary.parent.name
    return next((file for file in (stem.with_suffix(".json"), stem.with_suffix(".json.gz")) if file.exists()), None)


def summaries() -> list[Path]:
    """The summaries of suites' runs: those of other records name no commit."""
    all_of_them = sorted(HOUSE.results.glob("*/figures/*/summary.md"))
    return [path for path in all_of_them if result_of(path) is not None and "\n- ptbench: " in path.read_text()]


def test_summaries_are_found():
    assert len(summaries()) > 20


def template(folder: Path, text: str, **head) -> Path:
    path = folder / "page.md"
    head = {"title": "Page", "sources": SOURCE, **head}
    path.write_text(f"---\n{json.dumps(head, indent=1)}\n---\n{text}", encoding="utf-8")
    return path


def rendered(folder: Path, text: str, **head) -> str:
    return render(read_page(template(folder, text, **head)), HOUSE.results)


@pytest.mark.parametrize("name", TEMPLATES)
def test_committed_pages_are_what_their_results_say(name):
    page = read_page(HOUSE.templates / f"{name}.md")
    target = HOUSE.target(page.template)
    assert target.read_text(encoding="utf-8") == render(page, HOUSE.results), "run python3 -m ptbench findings"
    assert typed_by_hand(page) == []
    assert too_old(page, HOUSE.results, ROOT) == []


def page_of_a_commit(folder: Path, commit: str, allowed: int = 1000):
    """A page of one result that is said to be measured at `commit`, and the folder of results it lies in."""
    result = json.loads(gzip.decompress((HOUSE.results / f"{SOURCE['compaction']['file']}.gz").read_bytes()))
    result["context"]["ptbench.git_sha"] = commit
    (folder / "small.json").write_text(json.dumps(result), encoding="utf-8")
    sources = {"small": {"file": "small.json", "kernels_behind": allowed}}
    return read_page(template(folder, "", sources=sources)), folder


def in_git(repository: Path, *arguments: str) -> str:
    who = ["-c", "user.name=t", "-c", "user.email=t@t"]
    return subprocess.run(
        ["git", "-C", str(repository), *who, *arguments], check=True, capture_output=True, text=True
    ).stdout.strip()


def repository_of_two_changes(folder: Path) -> tuple[Path, str]:
    """A repository whose kernels changed twice since the commit that is returned."""
    (folder / "kernels").mkdir(parents=True)
    in_git(folder.parent, "init", "-q", str(folder))
    for change in range(3):
        (folder / "kernels/a.h").write_text(f"{change}", encoding="utf-8")
        in_git(folder, "add", "-A")
        in_git(folder, "commit", "-q", "-m", f"{change}")
    return folder, in_git(folder, "rev-parse", "HEAD~2")


def test_a_result_ages_with_the_commits_to_the_kernels(tmp_path):
    repository, first = repository_of_two_changes(tmp_path / "repository")
    page, results = page_of_a_commit(tmp_path, first, allowed=2)
    assert too_old(page, results, repository) == []
    page, results = page_of_a_commit(tmp_path, first, allowed=1)
    assert ["2 commits to kernels/" in fault for fault in too_old(page, results, repository)] == [True]


def test_a_commit_that_the_history_has_not_must_be_named_as_lost(tmp_path):
    repository, first = repository_of_two_changes(tmp_path / "repository")
    lost = "0123456789" * 4
    page, results = page_of_a_commit(tmp_path, lost, allowed=1)
    (fault,) = too_old(page, results, repository)
    assert "commit 0123456, which the history does not have" in fault
    (results / "lost_commits.json").write_text(json.dumps({lost: {"within": first, "why": "a test"}}), encoding="utf-8")
    assert ["2 commits to kernels/" in fault for fault in too_old(page, results, repository)] == [True]
    source = SuiteSource(results, "small.json")
    assert f"commit 0123456 ([lost](../../results/lost_commits.json), part of {first[:7]})" in source.provenance


def test_films_of_an_older_program_are_compared_cell_by_cell(tmp_path):
    text = gzip.decompress((HOUSE.results / "nvidia-h200/first_bounce_e3d4f13.json.gz").read_bytes()).decode()
    hashes = [cell["film_hash"] for cell in json.loads(text)["ptbench"]["cells"]]
    (tmp_path / "one_other.json").write_text(text.replace(hashes[3], "0123456789abcdef"), encoding="utf-8")
    newer = SuiteSource(HOUSE.results, "nvidia-h200/first_bounce.json")
    others = hashes.count(hashes[3])
    assert 0 < others < 48
    assert newer.films_of(SuiteSource(tmp_path, "one_other.json")) == (48 - others, 48)
    with pytest.raises(FindingError, match="no cell in common"):
        newer.films_of(SuiteSource(HOUSE.results, "nvidia-h200/scaling.json"))


@pytest.mark.parametrize("summary", summaries(), ids=lambda path: "/".join(path.parts[-4:-1:2]))
def test_committed_summaries_are_of_the_results_beside_them(summary):
    """The tables and figures of a folder were drawn from the file that lies there, not from one that it replaced."""
    result = result_of(summary)
    content = gzip.decompress(result.read_bytes()) if result.suffix == ".gz" else result.read_bytes()
    context = json.loads(content)["context"]
    line = rf"^- ptbench: .*git {context['ptbench.git_sha']}.*, {re.escape(context['date'])}$"
    assert re.search(line, summary.read_text(), re.MULTILINE)


def test_the_committed_overview_is_what_its_results_say(capsys):
    assert findings(COMMITTED, ["overview"], check=True) == 0, capsys.readouterr().out


def test_a_number_is_its_cells(tmp_path):
    text = rendered(tmp_path, f"{{{{ compaction.ratio({CELL}, over='compaction=none') }}}}")
    source = SuiteSource(HOUSE.results, SOURCE["compaction"]["file"], "arithmetic=exact")
    cell = source.cell("study=wavefront scene=cornell_open layout=aos compaction=thrust_remove_if")
    base = source.cell("study=wavefront scene=cornell_open layout=aos")
    assert (cell.axes["compaction"], base.axes["compaction"]) == ("thrust_remove_if", "none")
    ratio = sorted(cell.ms_per_spp)[4] / sorted(base.ms_per_spp)[4]  # medians of nine
    assert text.split()[0] == f"{ratio:.3f}"


def test_rays_are_counted_over_the_time_that_is_told():
    source = SuiteSource(HOUSE.results, SOURCE["compaction"]["file"], "arithmetic=exact")
    words = "study=wavefront scene=cornell_open layout=aos"
    cell = source.cell(words)
    assert float(source.rays(words)) == sorted(one.rays / one.wall_ms / 1e6 for one in cell.samples)[4]
    assert all(one.device_ms < one.wall_ms for one in cell.samples)  # over which it would be more


@pytest.mark.parametrize("word", ["FASTER", "SAME", "UNSURE"])
def test_a_verdict_that_the_data_contradict_is_no_page(tmp_path, word):
    with pytest.raises(FindingError, match=f"so SLOWER, where the page says {word}"):
        rendered(tmp_path, f"{{{{ compaction.ratio({CELL}, over='compaction=none').must_be('{word}', 'pays') }}}}")
    said = rendered(tmp_path, f"{{{{ compaction.ratio({CELL}, over='compaction=none').must_be('SLOWER', 'costs') }}}}")
    assert said == "costs"


def test_a_baseline_that_the_page_describes_wrongly_is_no_page(tmp_path):
    ratio = "compaction.ratio('wavefront_fused study=fused_layout scene=cornell_open layout=packed', over='layout=aos')"
    assert rendered(tmp_path, f"{{{{ {ratio}.must_be_over('wavefront_fused') }}}}") == ""
    with pytest.raises(FindingError, match="its baseline is not layout=packed"):
        rendered(tmp_path, f"{{{{ {ratio}.must_be_over('wavefront_fused', 'layout=packed') }}}}")


def test_what_a_command_printed_is_shown_as_it_was(tmp_path):
    file = "intel-r-xeon-r-processor-2-threads/readme_run.txt"
    shown = rendered(tmp_path, "{{ run }}", sources={"run": {"file": file}})
    assert shown == (HOUSE.results / file).read_text(encoding="utf-8").rstrip("\n")


def test_ratios_between_unlike_films_are_marked():
    overview = overview_of(HOUSE.templates / "overview.json", HOUSE.results)
    marked = [line.label for area in overview.areas for line in area.lines if not all(line.same_films)]
    source = SuiteSource(HOUSE.results, "nvidia-h200/specialisation.json", "depth=8 resolution=800x800")
    cell = "megakernel study=megakernel scene=cornell_open_five specialisation=features"
    films = {source.cell(cell).film_hash, source.cell(cell.replace("features", "generic")).film_hash}
    six = "the same, six kinds of material"
    assert marked == [six, "what the scene has, over everything", six]
    assert len(films) == 2
    drawn = HOUSE.target(HOUSE.templates / "overview.md").with_suffix(".svg").read_text(encoding="utf-8")
    assert "pays *" in drawn


def test_a_cell_that_is_not_there_or_not_one_is_told(tmp_path):
    with pytest.raises(FindingError, match="no cell is"):
        rendered(tmp_path, "{{ compaction.ms('study=wavefront scene=cornell_open layout=aos depth=9') }}")
    with pytest.raises(FindingError, match=r"2 cells are .*scene \(cornell_open, cornell_closed\)"):
        rendered(tmp_path, "{{ compaction.ms('study=wavefront layout=soa') }}")
    with pytest.raises(FindingError, match="no cell has compactoin"):
        rendered(tmp_path, "{{ compaction.ms('compactoin=none') }}")
    with pytest.raises(FindingError, match="names layout twice"):
        parsed("layout=aos layout=soa")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("It takes 0.92 of the time.", ["0.92"]),
        ("It brings 8 % at depth 8.", ["8 %"]),
        ("All are SLOWER.", ["SLOWER"]),
        ("`--set a=0.03` at depth 8, [a](b_1.5.png)", []),
        ("It takes `0.92` of the time.", ["0.92"]),
        ("It takes 20 ms, 3 times as long, at 9 Grays/s.", ["20 ms", "3 times", "9 Grays/s"]),
        ("{{ compaction.ms('x') }} and {{ compaction.ms('x', 3) }}", []),
        ("{{ 0.02 }} and {% set a = '0.92' %}", ["0.02", "0.92"]),
        ("{% set edge = 256 / 65536 %}", []),
    ],
)
def test_what_is_typed_by_hand_is_found(tmp_path, text, found):
    assert typed_by_hand(read_page(template(tmp_path, text))) == found


def test_the_overviews_words_hold_no_number():
    def texts(value) -> list[str]:
        inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else []
        return [value] if isinstance(value, str) else [text for one in inside for text in texts(one)]

    head = json.loads((HOUSE.templates / "overview.json").read_text(encoding="utf-8"))
    assert [number for text in texts({**head, "sources": {}}) for number in pages.measured_in(text)] == []


def test_old_results_are_told(tmp_path, monkeypatch):
    page = read_page(template(tmp_path, "", sources={"a": {**SOURCE["compaction"], "kernels_behind": 7}}))
    monkeypatch.setattr(commits, "commits_since", lambda repository, commit: 7)
    assert too_old(page, HOUSE.results, ROOT) == []
    monkeypatch.setattr(commits, "commits_since", lambda repository, commit: 8)
    assert "8 commits to kernels/ and variants/ ago, the page allows 7" in too_old(page, HOUSE.results, ROOT)[0]


def test_an_overview_of_old_results_is_told(monkeypatch, capsys):
    monkeypatch.setattr(commits, "commits_since", lambda repository, commit: 10**6)
    assert findings(COMMITTED, ["overview"], check=True) == 1
    assert (
        "overview.json: compaction (nvidia-h200/compaction.json) was measured 1000000 commits"
        in capsys.readouterr().out
    )


def test_commits_are_counted_in_git(tmp_path):
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git checkout")
    assert commits.commits_since(ROOT, "HEAD") == 0
    assert commits.commits_since(ROOT, "0" * 40) is None


def test_withdrawn_verdicts_have_no_ratio(tmp_path):
    head = {"sources": {"direct": {"file": "nvidia-h200/direct_light.json", "kernels_behind": 1000}}}
    with pytest.raises(FindingError, match="no page may give this ratio"):
        rendered(
            tmp_path,
            "{{ direct.ratio('persistent scene=cornell_open direct_light=nee', over='direct_light=off') }}",
            **head,
        )


def machine(folder: Path, name: str, **context: str) -> None:
    """A result of one cell; `context` is another machine's or another program's."""
    builder = Builder("small").on_gpu()
    builder.study("small", "integrator")
    builder.cell("small", ms_per_spp=1.0)
    builder.context |= {f"ptbench.{key}": value for key, value in context.items()}
    builder.write(folder / f"{name}.json")


@pytest.mark.parametrize(
    ("there", "reason"),
    [
        ({}, ""),
        ({"cuda_device": "B"}, ""),
        ({"cuda_kernel_source_hash": "2"}, ""),
        ({"cuda_device": "B", "cuda_kernel_source_hash": "2"}, "they are of several programs"),
        ({"cuda_device": "B", "git_dirty": "true"}, "had changes that were not committed"),
    ],
)
def test_two_machines_by_two_programs_are_no_page(tmp_path, there, reason):
    """One machine may be asked what another program changed, one program what another machine does."""
    usual = {"cuda_device": "A", "cuda_kernel_source_hash": "1", "git_dirty": "false"}
    machine(tmp_path, "here", **usual)
    machine(tmp_path, "there", **{**usual, **there})
    here, other = SuiteSource(tmp_path, "here.json"), SuiteSource(tmp_path, "there.json")
    if not reason:
        assert [one.number for one in here.common(other)] == [1.0]
        return
    for asked in (here.common, here.mean_over):
        with pytest.raises(FindingError, match=f"cannot be compared as machines: .*{reason}"):
            asked(other)


@pytest.mark.parametrize("suite", ["builders", "traversal", "subsurface_sampling"])
def test_a_fleet_of_two_programs_is_no_page(tmp_path, suite):
    about = {"file": f"nvidia-h200/{suite}.json", "against": [f"nvidia-h100/{suite}.json"], "kernels_behind": 1000}
    with pytest.raises(FindingError, match="cannot be compared as machines: they are of several programs"):
        rendered(tmp_path, "{{ two.mean }}", sources={"two": about})


def test_rays_of_two_programs_are_no_page(tmp_path):
    folders = {name: {"file": f"nvidia-{name}/rays_accelerators", "kernels_behind": 1000} for name in ("h200", "h100")}
    with pytest.raises(FindingError, match="cannot be compared as machines: they are of several programs"):
        rendered(tmp_path, "{{ h200.ratios_over('kernel=plain', h100) }}", sources=folders)


# --- kinds of sources ---


def test_a_kind_of_source_is_added_by_one_file(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "ptbench", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "ptbench/findings/sources/odd.py").write_text(
        "from ptbench.findings.source import Source\n"
        "class OddSource(Source, form='ptbench-odd-1'):\n"
        "    @property\n"
        "    def count(self):\n        return self._value['count']\n"
    )
    (tmp_path / "odd.json").write_text(json.dumps({"schema": "ptbench-odd-1", "count": 7}))
    template(
        tmp_path,
        "{{ odd.count }} of {{ said('a.b') }}",
        sources={"odd": {"file": "odd.json"}, "said": {"file": "said.json"}},
    )
    (tmp_path / "said.json").write_text(json.dumps({"a": {"b": "eight"}}))
    code = (
        "from pathlib import Path; from ptbench.findings.page import read_page, render; "
        "print(render(read_page(Path('page.md')), Path('.')), end='')"
    )
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], cwd=tmp_path, capture_output=True, text=True,
                          check=False, env={**os.environ, "PYTHONPATH": str(tmp_path)})  # fmt: skip
    assert (done.stdout, done.stderr) == ("7 of eight", "")


def test_no_two_kinds_of_source_have_one_form():
    def another():
        class Leaks(Source, form="ptbench-leaks-1"):
            pass

    assert kinds()["ptbench-leaks-1"].__name__ == "LeaksSource"
    with pytest.raises(TypeError, match="two kinds of source for ptbench-leaks-1: LeaksSource and Leaks"):
        another()
    assert kinds()["ptbench-leaks-1"].__name__ == "LeaksSource"


def test_a_source_without_a_line_says_so_where_a_page_asks_for_it(tmp_path):
    (tmp_path / "said.txt").write_text("said\n")
    page = read_page(template(tmp_path, "{{ said.provenance }}", sources={"said": {"file": "said.txt"}}))
    with pytest.raises(FindingError, match=r"said\.txt: such a file has no line in a list of sources"):
        render(page, tmp_path)


def test_the_command_says_what_is_wrong(capsys):
    from ptbench.cli.main import main

    assert main(["findings", "--root", str(ROOT), "--check", "compactoin"]) == 2
    assert "page: found compactoin, allowed: README, compaction, " in capsys.readouterr().err
    assert main(["findings", "--root", str(ROOT / "scenes")]) == 2
    assert "found no template, allowed: the root of a checkout as --root" in capsys.readouterr().err
    assert main(["findings", "--root", str(ROOT), "--check", "compaction"]) == 0


def test_a_page_that_does_not_match_is_told(tmp_path, capsys):
    (tmp_path / "docs").mkdir()
    shutil.copytree(HOUSE.templates, tmp_path / "docs/templates")
    (tmp_path / "results").symlink_to(HOUSE.results)
    (tmp_path / "docs/findings").mkdir()
    assert findings(tmp_path, ["compaction"], check=True) == 1
    assert "compaction.md: not what its template and results say" in capsys.readouterr().out
    assert findings(tmp_path, ["compaction"], check=False) == 0
    assert findings(tmp_path, ["compaction"], check=True) == 0


def gpu_tests_in(folder: Path, failed: int) -> Path:
    context = {
        "ptbench.git_sha": "0" * 40,
        "ptbench.git_dirty": "false",
        "ptbench.machine": "nvidia-h100",
        "date": "now",
    }
    counts = {"passed": 12, "failed": failed, "skipped": 1, "seconds": 3.5, "failures": []}
    programs = {"gate_test": counts, "graph_test": counts}
    document = {"schema": "ptbench-gpu-tests-1", "context": context, "seconds": 9.0, "programs": programs}
    (folder / "gpu_tests.json").write_text(json.dumps(document))
    return folder


def test_a_page_tells_the_gpu_tests_and_none_that_failed(tmp_path):
    sources = {"tests": {"file": "gpu_tests.json", "kernels_behind": 0}}
    text = "{{ tests.must_not_fail('All pass') }}: {{ tests.count('passed') }} on {{ tests.machine }}"
    page = read_page(template(tmp_path, text, sources=sources))
    assert render(page, gpu_tests_in(tmp_path, failed=0)) == "All pass: 24 on nvidia-h100"
    assert "which the history does not have" in too_old(page, tmp_path, ROOT)[0]
    again = tmp_path / "again"
    again.mkdir()
    with pytest.raises(FindingError, match="2 failed"):
        render(page, gpu_tests_in(again, failed=1))


@pytest.mark.parametrize(("second", "missing"), [(["dusk", "dawn"], ""), (["dusk"], "dawn")])
def test_two_runs_share_all_stiff_cases_or_the_page_fails(tmp_path, second, missing):
    StabilityBuilder().case("lamp").row(FLOAT, error=0.0).case("dusk").case("dawn").write(tmp_path / "one.json")
    builder = StabilityBuilder()
    for case in second:
        builder.case(case).row(FLOAT, error=0.0)
    builder.write(tmp_path / "two.json")
    sources = {"one": {"file": "one.json"}, "two": {"file": "two.json"}}
    page = read_page(template(tmp_path, '{{ one.cover_all(two, "All are there") }}', sources=sources))
    if missing:
        with pytest.raises(FindingError, match=f"no rows of {missing}; the page says: All are there"):
            render(page, tmp_path)
    else:
        assert render(page, tmp_path) == "All are there"
