"""`compare` of files of `ptbench stability`: what it says of rows whose status or numbers are others."""

from __future__ import annotations

import copy
import json
import math

import pytest
from builder import Builder
from conftest import RESULTS
from stability_builder import DOUBLE, FAST, FLOAT, MIXED, NAIVE, WAVEFRONT, StabilityBuilder

from ptbench.compare.stability.matching import compare_stability_files
from ptbench.compare.stability.text import stability_json, stability_sections
from ptbench.document.blocks import Bullets, Section


def before() -> StabilityBuilder:
    """A stability run with one row of each verdict, and two variants more that pass."""
    builder = StabilityBuilder().case("lamp").row(FLOAT, 2e-6).row(DOUBLE, 1e-7).row(NAIVE, 1.0).row(WAVEFRONT, 3e-7)
    builder.case("plates", "film").row(FLOAT, 2e-3, status="known limit", reason="24 bits").row(FAST, 5e-7)
    return builder.none(MIXED, reason="needs float").none(DOUBLE, "broken", "out of memory")


def changed_by(change) -> StabilityBuilder:
    builder = copy.deepcopy(before())
    builder.context |= {"ptbench.git_sha": "9876543210ab", "ptbench.cuda_mps": "true"}
    change(builder.rows)
    return builder


@pytest.fixture
def compared(tmp_path):
    def run(*builders: StabilityBuilder):
        return compare_stability_files([b.write(tmp_path / f"{i}.json") for i, b in enumerate(builders)])

    return run


def facts(found) -> dict:
    (comparison,) = stability_json(found)["comparisons"]
    return comparison


def section(found, start: str, whole: bool = True):
    return next(one for one in stability_sections(found, whole) if one.title.startswith(start))


def lists_of(one: Section) -> list[tuple[str, ...]]:
    return [block.items for block in one.blocks if isinstance(block, Bullets)]


def test_the_same_rows_in_another_order_have_no_change(compared):
    found = compared(before(), changed_by(lambda rows: rows.reverse()))
    assert [one.title for one in stability_sections(found, whole=True)] == ["Files", "B against A"]
    assert lists_of(section(found, "B against A"))[0] == (
        "8 rows (case, point, quantity, variant) are in both; 0 are in A alone, 0 in B alone.",
        "Another status have 0; of what must pass 0 fail in B that did not in A.",
        "Of 6 rows with numbers and the same status 6 measured the same value bit for bit; in exact arithmetic 5 of 5.",
    )
    assert section(found, "B against A").table.rows == (
        ("passed", "3", "3", "0"), ("failed that must pass", "1", "1", "0"), ("broken", "1", "1", "0"),
        ("known limit", "1", "1", "0"), ("failed that need not pass", "1", "1", "0"), ("n/a", "1", "1", "0"),
    )  # fmt: skip
    table = section(found, "Files").table
    assert [row[table.head.index("MPS")] for row in table.rows] == ["not told", "yes"]
    assert [row[table.head.index("git")] for row in table.rows] == ["0123abcd4567", "9876543210ab"]


def mend(rows: list[dict]) -> None:
    rows[0] |= {"status": "known limit", "reason": "walls are thin"}
    rows[2] |= {"status": "passed", "error": 1e-7}
    rows[3] |= {"status": "failed", "error": 4e-6}


def test_rows_of_another_status_are_listed_with_errors_and_reasons(compared):
    found = compared(before(), changed_by(mend))
    changes = section(found, "Rows of another status")
    assert changes.table.head == (
        "Case", "Point", "Variant", "Quantity", "A", "B", "Error A", "Error B", "Allowed A", "Allowed B", "Reason",
    )  # fmt: skip
    assert changes.table.rows == (
        ("S1 lamp", "a=0.1", "float", "radiance", "failed (must pass)", "known limit", "2e-6", "2e-6", "1e-6", "1e-6",
         "B: walls are thin"),
        ("S1 lamp", "a=0.1", "float naive", "radiance", "failed (need not pass)", "passed", "1", "1e-7", "1e-6", "1e-6",
         "—"),
        ("S1 lamp", "a=0.1", "wavefront", "radiance", "passed", "failed (must pass)", "3e-7", "4e-6", "1e-6", "1e-6",
         "—"),
    )  # fmt: skip
    # Of the families only the one that differs, and numbers of B only where they do.
    families = section(found, "Families whose tallies differ, A → B").table
    assert families.rows == (("cavities", "2", "1", "0", "0 → 1", "1 → 0", "0"),)
    assert section(found, "B against A").table.rows[3] == ("known limit", "1", "2", "+1")
    assert facts(found)["newly_failed"] == 1
    assert [(row["case"], row["reference"]["status"], row["other"]["status"]) for row in facts(found)["changed"]] == [
        ("lamp", "failed", "known limit"), ("lamp", "failed", "passed"), ("lamp", "passed", "failed"),
    ]  # fmt: skip


def test_a_row_that_need_no_longer_pass_is_a_change(compared):
    found = compared(before(), changed_by(lambda rows: rows[1].update(must_pass=False)))
    (row,) = section(found, "Rows of another status").table.rows
    assert row[4:6] == ("passed (must pass)", "passed (need not pass)")


def test_values_that_changed_are_counted_bit_by_bit(compared):
    def move(rows: list[dict]) -> None:
        rows[1]["measured"] = math.nextafter(rows[1]["measured"], 3)
        rows[3]["measured"] *= 2
        rows[5]["measured"] = "nan"
        rows[4]["allowed"] *= 2

    found = compared(before(), changed_by(move))
    same = facts(found)["same_status"]
    assert same == {
        "with_numbers": 6, "bit_identical": 3, "with_numbers_exact": 5, "bit_identical_exact": 3,
        "largest_relative_change": "inf", "another_check": 1,
    }  # fmt: skip
    lines = lists_of(section(found, "B against A"))[0][2:]
    assert lines == (
        "Of 6 rows with numbers and the same status 3 measured the same value bit for bit; in exact arithmetic 3 of 5.",
        "The other 3 are of S1 lamp, S2 plates; the largest change is inf of the larger value (S2 plates a=0.1: "
        "radiance).",
        "The exact value or what is allowed is another in 1 of these rows, of S2 plates.",
    )
    without_nan = compared(before(), changed_by(lambda rows: rows[3].update(measured=2 * rows[3]["measured"])))
    assert facts(without_nan)["same_status"]["largest_relative_change"] == 0.5
    both = [changed_by(lambda rows: rows[5].update(measured="nan")) for _ in range(2)]
    assert facts(compared(*both))["same_status"]["bit_identical"] == 6
    signs = [changed_by(lambda rows, zero=zero: rows[5].update(measured=zero)) for zero in (0.0, -0.0)]
    assert facts(compared(*signs))["same_status"]["bit_identical"] == 5


def test_rows_of_one_file_are_counted_by_case(compared):
    def part(rows: list[dict]) -> None:
        rows[0]["point"]["a"] = 0.2
        rows[1]["quantity"] = "mean"
        del rows[6]

    found = compared(before(), changed_by(part))
    alone = section(found, "Rows that only one of A and B has").table
    assert alone.rows == (("S1 lamp", "2", "2"), ("S2 plates", "1", "0"))
    assert not facts(found)["changed"]
    assert [(row["of"], row["point"].get("a")) for row in facts(found)["alone"]].count(("other", 0.2)) == 1
    # A check that fails at a point that the reference lacks counts as newly failed.
    assert facts(found)["newly_failed"] == 1


def test_a_case_that_broke_is_held_against_its_quantities(compared):
    two = StabilityBuilder().case().row(FLOAT, 0, quantity="mean").row(FLOAT, 0, quantity="leaked").row(DOUBLE, 0)
    broke = StabilityBuilder().case().none(FLOAT, "broken", "out of memory").row(DOUBLE, 0)
    found = compared(two, broke)
    rows = section(found, "Rows of another status").table.rows
    assert [row[3:8] for row in rows] == [
        ("mean", "passed", "broken (must pass)", "0", "—"), ("leaked", "passed", "broken (must pass)", "0", "—"),
    ]  # fmt: skip
    assert not found.comparisons[0].alone
    assert facts(found)["newly_failed"] == 2
    assert facts(compared(broke, two))["newly_failed"] == 0


def test_rows_alike_are_paired_in_their_order(compared):
    builders = [StabilityBuilder().case().row(FLOAT, 0) for _ in range(2)]
    for builder in builders:
        builder.none(MIXED, reason="one").none(MIXED, reason="two")
    assert len(compared(*builders).comparisons[0].pairs) == 3
    del builders[1].rows[-1]
    found = compared(*builders)
    assert [in_reference for in_reference, _ in found.comparisons[0].alone] == [True]


def test_stdout_lists_some_changes_and_the_page_all(compared):
    one, other = StabilityBuilder().case(), StabilityBuilder().case()
    for a in range(1, 51):
        one.row(FLOAT, 0, a=a)
        other.row(FLOAT, 1, a=a)
    found = compared(one, other)
    brief = section(found, "Rows of another status", whole=False)
    assert len(brief.table.rows) == 40
    assert lists_of(brief)[-1] == ("And 10 more rows (--out and --json have all).",)
    assert len(section(found, "Rows of another status").table.rows) == 50


def test_three_files_are_held_against_the_first(compared):
    found = compared(before(), changed_by(mend), before())
    headings = [one.title for one in stability_sections(found, whole=True)]
    assert headings[1::3] == ["B against A", "C against A"]
    assert [one["other"] for one in stability_json(found)["comparisons"]] == [1, 2]


def test_another_seed_is_told(compared):
    other = before()
    other.context |= {"seed": 2, "quick": True, "ptbench.program_hash": "ff"}
    assert lists_of(section(compared(before(), other), "Files"))[-1] == (
        "What else differs between the files:", "program_hash: A unknown; B ff", "quick: A false; B true",
        "seed: A 1; B 2",
    )  # fmt: skip


# ---- The command ----


def test_stdout_page_and_json_say_the_same(analysis, tmp_path):
    files = [before().write(tmp_path / "a.json"), changed_by(mend).write(tmp_path / "b.json")]
    out_folder = tmp_path / "out"
    code, out, err = analysis("compare", *files, "--out", out_folder, "--json", tmp_path / "c.json")
    assert (code, err) == (0, "")
    assert out.splitlines()[-2:] == [str(tmp_path / "c.json"), str(out_folder / "compare.md")]
    assert [path.name for path in out_folder.iterdir()] == ["compare.md"]
    page = (out_folder / "compare.md").read_text()
    assert page.startswith("# Stability files compared\n")
    for text in (out, page):
        assert "8 rows (case, point, quantity, variant) are in both" in text
        assert "B: walls are thin" in text
    document = json.loads((tmp_path / "c.json").read_text())
    assert document["files"][1]["tallies"]["known limit"] == 2
    assert document["files"][0]["families"]["cavities"]["failed that must pass"] == 1


def test_gates(analysis, tmp_path):
    a = before().write(tmp_path / "a.json")
    good = changed_by(lambda rows: rows[0].update(status="passed", error=0)).write(tmp_path / "good.json")
    bad = changed_by(lambda rows: rows[3].update(status="failed", error=1)).write(tmp_path / "bad.json")
    naive = changed_by(lambda rows: rows[5].update(status="failed", error=1)).write(tmp_path / "naive.json")
    less = changed_by(lambda rows: rows.pop()).write(tmp_path / "less.json")
    expected = {  # failed, different, unmatched
        a: (0, 0, 0), good: (0, 1, 0), bad: (1, 1, 0), naive: (0, 1, 0), less: (0, 0, 1),
    }  # fmt: skip
    for path, codes in expected.items():
        found = tuple(
            analysis("compare", a, path, "--fail-on", what)[0] for what in ("failed", "different", "unmatched")
        )
        assert found == codes, path
    _, out, _ = analysis("compare", a, bad, "--fail-on", "failed", "--fail-on", "different")
    assert out.splitlines()[-2:] == [
        "--fail-on failed: FAILED: 1 rows that must pass fail and did not in the reference.",
        "--fail-on different: FAILED: 1 of 8 rows have another status.",
    ]


def test_a_wrong_call_is_one_line_and_writes_nothing(analysis, tmp_path):
    a = before().write(tmp_path / "a.json")
    stranger = StabilityBuilder().case("elsewhere").row(FLOAT, 0).write(tmp_path / "stranger.json")
    builder = Builder().study("s", "depth")
    builder.cell("s", "box", 1.0)
    result = builder.write(tmp_path / "result.json")
    bad = changed_by(lambda rows: rows[0].update(status="fine")).write(tmp_path / "bad.json")
    calls = {
        f"{result}: found no file of `ptbench stability`, allowed: one, as {a} is": (a, result),
        f"{a}: found a file of `ptbench stability`, allowed: a result file of `ptbench run`": (result, a),
        "found one result file": (a,),
        '$.rows[0].status: found "fine", allowed: "passed"': (a, bad),
        f"--fail-on: slower: found files of `ptbench stability` ({a}), allowed: different, unmatched, failed": (
            a, a, "--fail-on", "slower",
        ),
        "--noise: found files of `ptbench stability`": (a, a, "--noise", a),
        "--films-may-differ: found files of `ptbench stability`": (a, a, "--films-may-differ"),
        "--fail-on failed: found result files of `ptbench run`": (result, result, "--fail-on", "failed"),
        f"{stranger}: found no row to hold against one of {a}": (a, stranger),
    }  # fmt: skip
    out_folder = tmp_path / "out"
    for expected, arguments in calls.items():
        code, out, err = analysis("compare", *arguments, "--out", out_folder, "--json", out_folder / "c.json")
        assert (code, out) == (2, ""), expected
        assert expected in err
        assert err.count("\n") == 1
        assert not out_folder.exists()


def test_many_cases_are_named_in_part(compared):
    one, other = StabilityBuilder(), StabilityBuilder()
    for index in range(10):
        one.case(f"case{index}").row(FLOAT, 0)
        other.case(f"case{index}").row(FLOAT, 1e-7)
    lines = lists_of(section(compared(one, other), "B against A"))[0]
    assert "S8 case7 and 2 more; the largest change" in lines[3]


def test_the_cpu_against_the_h200():
    """The variants that both have; nothing that must pass fails on either."""
    files = [RESULTS / machine / "stability.json" for machine in ("nvidia-h200", "amd-epyc-2-threads")]
    (against,) = compare_stability_files(files).comparisons
    assert {pair.one.axes["integrator"] for pair in against.pairs} >= {"audited", "wavefront"}
    assert not [
        row for file in (against.reference, against.other) for row in file.rows if row.must_pass and row.is_failure
    ]
