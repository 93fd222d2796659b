"""Disturbed runs: no noise floor comes from them, a gate does not pass on them, and every headline counts them."""

from __future__ import annotations

import copy
import json

import pytest
from builder import small
from compare_builder import other_machine, other_program, run_again, wavefront_by_depth, written

from ptbench.compare.compared import compare_files
from ptbench.io.results import load
from ptbench.studies.disturbed import CONTENDED, THROTTLED, disturbance_of, doubt_of
from ptbench.studies.notes import notes_of
from ptbench.studies.rows import measure


@pytest.fixture(scope="module")
def base() -> dict:
    return wavefront_by_depth()


def disturbed(document: dict, samples: int = 10**6, key: str = "pt_contended") -> dict:
    """The first so many samples of every cell flagged, and made as late as a busy host makes them."""
    document = copy.deepcopy(document)
    for row in document["benchmarks"]:
        if "pt_wall_ms" in row and row["repetition_index"] < samples:
            row[key] = 1
            if key == "pt_contended":
                row["pt_device_ms"] = 0.5 * row["pt_wall_ms"]
    return document


def test_the_headline_counts_each_sample_once(base, tmp_path):
    document = disturbed(disturbed(base, 2), 3, "pt_low_clock")
    found = disturbance_of(load(written(document, tmp_path / "a.json")).cells)
    assert str(found) == "24 of 72 samples (contended 16, low clock 24)"
    assert found.is_too_much
    assert str(disturbance_of(load(written(base, tmp_path / "b.json")).cells)) == "0 of 72 samples"


def test_samples_that_a_quota_held_up_are_told(base, tmp_path):
    """Samples that a quota held up are contended, whoever else ran, and named as throttled."""
    document = disturbed(base, 2)
    for row in document["benchmarks"]:
        if row.get("pt_contended") == 1:
            row |= {"pt_throttled_periods": row["repetition_index"], "pt_throttled_ms": 3.5}
    result = load(written(document, tmp_path / "a.json"))
    found = disturbance_of(result.cells)
    assert str(found) == "16 of 72 samples (contended 16, 8 of them by a CPU quota, low clock 0)"
    assert doubt_of(result.cells) == THROTTLED
    study = result.studies[0]
    told = "9 of 36 samples while other processes took over a tenth of the CPU or a quota was used up (4), kept"
    assert any(note.full.startswith(told) for note in notes_of(result, study, measure(result, study)))
    assert doubt_of(load(written(disturbed(base, 2), tmp_path / "b.json")).cells) == CONTENDED


def test_a_tenth_is_not_too_much(tmp_path):
    builder = small()
    for index, row in enumerate(row for row in builder.rows if "pt_wall_ms" in row):
        row["pt_contended"] = float(index % 10 == 0)
    found = disturbance_of(load(builder.write(tmp_path / "a.json")).cells)
    assert (found.samples, found.disturbed) == (288, 29)
    assert found.is_too_much
    for row in builder.rows:
        if row.get("pt_contended"):
            row["pt_contended"] = 0.0
            break
    assert not disturbance_of(load(builder.write(tmp_path / "b.json")).cells).is_too_much


@pytest.mark.parametrize(("waits", "expected"), [(0, 0), (1, 72)])
def test_a_gpu_that_waits_for_a_busy_host_is_disturbed(base, tmp_path, waits, expected):
    """A GPU's clock goes on while it waits for the host, so device time is no evidence of an undisturbed render."""
    document = copy.deepcopy(base)
    for row in document["benchmarks"]:
        if "pt_wall_ms" in row:
            row.update(pt_contended=1, pt_device_ms=row["pt_wall_ms"], pt_host_waits=waits)
    assert disturbance_of(load(written(document, tmp_path / "a.json")).cells).disturbed == expected


@pytest.mark.parametrize("key", ["pt_contended", "pt_low_clock"])
def test_a_noise_file_of_disturbed_samples_is_refused(base, analysis, tmp_path, key):
    files = [written(base, tmp_path / "a.json"), written(other_program(run_again(base)), tmp_path / "b.json")]
    noise = written(disturbed(run_again(base, 3.58), key=key), tmp_path / "n.json")
    code, out, err = analysis("compare", *files, "--noise", noise)
    kinds = "CPU: 72, a low clock: 0" if key == "pt_contended" else "CPU: 0, a low clock: 72"
    assert (code, out) == (2, "")
    assert err == (
        f"python3 -m ptbench: {noise}: --noise: found 72 of 72 samples disturbed (other processes took the {kinds}), "
        "allowed: at most 7, a tenth; what befell the machine is no noise of the program's runs\n"
    )


def test_a_noise_file_with_a_few_disturbed_samples_is_used(base, analysis, tmp_path):
    files = [written(base, tmp_path / "a.json"), written(other_program(run_again(base)), tmp_path / "b.json")]
    document = run_again(base, 17 / 16)
    next(row for row in document["benchmarks"] if "pt_wall_ms" in row)["pt_low_clock"] = 1
    code, out, _ = analysis("compare", *files, "--noise", written(document, tmp_path / "n.json"))
    assert code == 0
    assert "Noise floor of nvidia-h200: 6.25 %" in out


def test_a_floor_of_disturbed_files_is_not_used_and_that_is_told(base, analysis, tmp_path):
    """A, the same program on a busy machine, and another program that takes 3 % more time."""
    documents = base, disturbed(run_again(base, 3.58)), run_again(other_program(base), 1.03)
    files = [written(document, tmp_path / f"{index}.json") for index, document in enumerate(documents)]
    found = compare_files(files)
    assert found.floors == ()
    assert found.comparisons[1].threshold == 0.01
    code, out, _ = analysis("compare", *files)
    text = " ".join(out.split())
    assert code == 0
    assert (
        "Not used for a noise floor, because more than a tenth of the samples were disturbed: "
        f"{files[1]}: 72 of 72 samples (contended 72, low clock 0) disturbed."
    ) in text
    assert "Noise floor of nvidia-h200" not in text
    assert "B: disturbed: 72 of 72 samples (contended 72, low clock 0)." in text
    assert "A: disturbed: 0 of 72 samples." in text


def test_above_a_fourth_there_is_no_floor_and_no_verdict(base, compared_files, analysis, tmp_path):
    """Samples that nothing disturbed as far as anybody knows, and yet one program took 3.58 times as long."""
    files = compared_files(base, run_again(base, 3.58), run_again(other_program(base), 2.0))
    found = compare_files(files)
    one = found.comparisons[1]
    assert (one.floors, one.threshold, one.count("UNSURE")) == ((), 0.01, 8)
    assert {row.verdict.withheld for row in one.rows} == {"SLOWER"}
    assert "differ by 258 %, above 25 %" in one.rows[0].verdict.reason
    assert one.time.verdict.word == "UNSURE"
    assert analysis("compare", *files, "--fail-on", "slower")[0] == 1
    code, out, err = analysis("compare", files[0], files[2], "--noise", files[1])
    assert (code, out) == (2, "")
    assert err == (
        f"python3 -m ptbench: {files[1]}: --noise: found runs of one program that differ by 258 %, allowed: at most "
        "25 %; by such a floor a program that takes a fourth more time would be the SAME\n"
    )
    # 25 % and a little is above 25 % as printed, too; below it the floor holds.
    _, _, err = analysis("compare", files[0], files[2], "--noise", compared_files(run_again(base, 1.2503))[0])
    assert "differ by 25.03 %" in err
    assert analysis("compare", files[0], files[2], "--noise", compared_files(run_again(base, 1.2497))[0])[0] == 0


@pytest.fixture
def compared_files(tmp_path):
    def write(*documents: dict) -> list:
        start = len(list(tmp_path.glob("f*.json")))
        return [written(document, tmp_path / f"f{start + index}.json") for index, document in enumerate(documents)]

    return write


# The gate


def gate(out: str) -> str:
    return next(line for line in out.splitlines() if line.startswith("--fail-on "))


def test_a_gate_does_not_pass_on_disturbed_files(base, compared_files, analysis):
    files = compared_files(base, disturbed(run_again(other_program(base), 4.27)))
    code, out, _ = analysis("compare", *files, "--fail-on", "slower")
    assert code == 1
    assert gate(out) == (
        "--fail-on slower: NOT JUDGED, which fails: 0 of 8 cells SLOWER; UNSURE are 8 (8: other processes took CPU "
        "time during more than a tenth of the samples); by their times alone 8 of these would be SLOWER; all cells "
        f"UNSURE in {files[1]}."
    )
    mean = next(line for line in out.splitlines() if line.startswith("Geometric mean in time"))
    assert "4.270 [" in mean
    assert "UNSURE (other processes took CPU" in " ".join(out.split())


def test_one_disturbed_cell_that_would_be_slower_fails_the_gate(base, compared_files, analysis):
    other = run_again(other_program(base))
    name = other["ptbench"]["cells"][0]["cell"]
    for row in other["benchmarks"]:
        if row["run_name"] == name and "pt_wall_ms" in row:
            for key in ("pt_wall_ms", "pt_end_to_end_ms", "real_time"):
                row[key] *= 2
            row["pt_contended"] = 1
    files = compared_files(base, other)
    code, out, _ = analysis("compare", *files, "--fail-on", "slower")
    assert (code, gate(out).split(":")[1]) == (1, " NOT JUDGED, which fails")
    assert "by their times alone 1 of these would be SLOWER" in gate(out)
    assert "all cells UNSURE" not in gate(out)
    # Disturbed and not slower even so: the gate has its answer.
    for row in other["benchmarks"]:
        if row["run_name"] == name and "pt_wall_ms" in row:
            row["pt_wall_ms"] /= 4
            row["pt_device_ms"] /= 4
    code, out, _ = analysis("compare", files[0], compared_files(other)[0], "--fail-on", "slower")
    assert (code, gate(out).split(":")[1]) == (0, " passed")
    assert "UNSURE are 1" in gate(out)


def test_the_gate_says_what_it_found(base, compared_files, analysis):
    a, same, slower = compared_files(base, run_again(other_program(base)), run_again(other_program(base), 2.0))
    code, out, _ = analysis("compare", a, slower, "--fail-on", "slower")
    assert (code, gate(out)) == (1, "--fail-on slower: FAILED: 8 of 8 cells SLOWER.")
    code, out, _ = analysis("compare", a, same, "--fail-on", "unmatched")
    assert (code, gate(out)) == (
        0,
        "--fail-on unmatched: passed: 0 of 8 cells of the reference have no partner.",
    )
    code, out, _ = analysis("compare", a, same)
    assert (code, "--fail-on" in out) == (0, False)


def test_a_gate_of_too_few_samples_does_not_pass(base, compared_files, analysis):
    other = run_again(other_program(base))
    other["benchmarks"] = [row for row in other["benchmarks"] if row.get("repetition_index", 0) < 5]
    for row in other["benchmarks"]:
        row["repetitions"] = 5
    code, out, _ = analysis("compare", *compared_files(base, other), "--fail-on", "slower")
    assert code == 1
    assert "NOT JUDGED, which fails: 0 of 8 cells SLOWER; UNSURE are 8 (8: too few samples); all cells" in gate(out)


def test_programs_are_told_too(base, compared_files, analysis, tmp_path):
    files = compared_files(base, disturbed(run_again(other_program(base), 4.27)))
    assert analysis("compare", *files, "--json", tmp_path / "c.json")[0] == 0
    found = json.loads((tmp_path / "c.json").read_text())
    assert found["files"][1]["disturbed"] == {"samples": 72, "disturbed": 72, "contended": 72, "low_clock": 0}
    pair = found["comparisons"][0]["pairs"][0]
    assert (pair["verdict"], pair["withheld"]) == ("UNSURE", "SLOWER")
    assert found["comparisons"][0]["geometric_mean"]["time"]["withheld"] == "SLOWER"


# Headlines


def test_plots_and_report_count_them_at_the_top(tmp_path, analysis):
    builder = small()
    rows = [row for row in builder.rows if "pt_wall_ms" in row]
    rows[0]["pt_contended"] = rows[1]["pt_contended"] = rows[2]["pt_low_clock"] = 1.0
    file = builder.write(tmp_path / "quick.json")
    told = "3 of 288 samples (contended 2, low clock 1)"
    code, out, _ = analysis("plots", file, "--out", tmp_path / "figures")
    assert (code, out.splitlines()[0]) == (0, f"disturbed: {told}")
    assert f"- Disturbed: {told}\n" in (tmp_path / "figures" / "summary.md").read_text()
    assert analysis("report", file, "--out", tmp_path / "report")[0] == 0
    page = (tmp_path / "report" / "report.md").read_text()
    glance = page[page.index("## At a glance") : page.index("## Machines")]
    assert told in glance


# Clocks that are not known


def without_clocks(document: dict) -> dict:
    document = copy.deepcopy(document)
    for row in document["benchmarks"]:
        for end in ("before", "after"):
            row.pop(f"pt_clock_mhz_{end}", None)
        if "pt_wall_ms" in row:
            row["pt_clock_unknown"] = 1.0
    return document


def test_without_clocks_the_verdict_is_one_in_time_and_says_so(base, compared_files, analysis):
    # At half the clock in twice the time the cycles are the same: with clocks there is a veto.
    other = run_again(other_program(base), 2.0, clock=0.5)
    files = compared_files(base, other, without_clocks(other))
    assert compare_files(files[:2]).comparisons[0].count("UNSURE") == 8
    one = compare_files([files[0], files[2]]).comparisons[0]
    assert one.count("SLOWER") == 8
    assert one.rows[0].remarks[0] == "cycles not compared: the clock is unknown"
    _, out, _ = analysis("compare", files[0], files[2])
    text = " ".join(out.split())
    assert "SLOWER (cycles not compared: the clock is unknown in 8 pairs)" in text
    assert "none, no pair has it (cycles not compared: the clock is unknown); left out: 8." in text


def test_between_machines_cycles_never_veto_so_nothing_is_said(base, compared_files):
    other = without_clocks(other_machine(run_again(base, 2.0), "b"))
    (one,) = compare_files(compared_files(base, other)).comparisons
    assert one.count("SLOWER") == 8
    assert not any("clock is unknown" in remark for row in one.rows for remark in row.remarks)


def test_plots_report_and_explain_say_that_the_clock_is_unknown(tmp_path, analysis):
    builder = small()
    for row in builder.rows:
        row.pop("pt_clock_mhz_before", None)
        row.pop("pt_clock_mhz_after", None)
    file = builder.write(tmp_path / "quick.json")
    code, out, _ = analysis("plots", file, "--out", tmp_path / "figures")
    assert code == 0
    assert "clock unknown: 8 of 8 cells whose clock is unknown: judged in time alone, cycles not compared" in out
    summary = (tmp_path / "figures" / "summary.md").read_text()
    assert "| SLOWER | cycles not compared: the clock is unknown |" in summary
    assert analysis("report", file, "--out", tmp_path / "report")[0] == 0
    page = (tmp_path / "report" / "report.md").read_text()
    assert "(cycles not compared: the clock is unknown)" in page
    assert "samples whose clock is unknown" in page
    names = ("none.none.off.off.soa", "thrust_partition")
    code, out, _ = analysis("explain", file, *names, "--scene", "cornell_open", "--out", tmp_path / "explained")
    assert code == 0
    assert "(cycles not compared: the clock is unknown)" in out
