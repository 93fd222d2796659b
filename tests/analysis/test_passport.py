"""Passports: the answers of two runs, side by side, and what is refused."""

from __future__ import annotations

import json

import pytest
from builder import Builder

from ptbench.errors import InputError
from ptbench.extras.passport.answers import answers_of
from ptbench.extras.passport.passport import load_passport
from ptbench.io.validate import validate

CPU = {
    "threads": 2,
    "copies": [{"bytes": 16384, "gb_per_s": 200.0}, {"bytes": 268435456, "gb_per_s": 20.0}],
    "gflops": 100.0,
    "atomics_per_s": 5e7,
    "fork_join_us": 3.0,
}


def run(times: dict[str, float], noise: float = 0.002, **context: str) -> dict:
    """A result of the suite `passport` in one scene: ms by "AXIS CHOICE"; a study is named as the axis it compares."""
    builder = Builder("passport")
    builder.context |= context
    for name in dict.fromkeys(name.split()[0] for name in times):
        builder.studies.append({"name": name, "compares": name, "title": ""})
    for name, ms in times.items():
        axis, choice = name.split()
        builder.cell(axis, "box", ms, noise=noise, axes={axis: choice})
    return builder.document()


def passport(folder, *runs: dict, **fields: object):
    file = folder / "passport.json"
    document = {"schema": "ptbench-passport-1", "chip": {"cpu": CPU}, "spp": {"compaction": 4}, "runs": list(runs)}
    file.write_text(json.dumps(document | fields), encoding="utf-8")
    return file


def test_the_best_of_each_side_are_chosen_in_one_run_and_compared_in_the_other(tmp_path):
    """In the first run `flagged` was lucky; the second run compares it, and the first run compares `remove_if`."""
    first = {"compaction none": 3.0, "compaction thrust_remove_if": 2.0, "compaction cub_select_flagged": 1.5}
    second = {"compaction none": 3.0, "compaction thrust_remove_if": 1.5, "compaction cub_select_flagged": 2.0}
    (answer,) = answers_of(load_passport(passport(tmp_path, run(first), run(second))))
    assert (answer.asked, answer.scene, answer.word, answer.reason) == ("Compact the queue?", "box", "FASTER", "")
    by_first, by_second = answer.sides
    assert "thrust_remove_if" in by_first.choice
    assert by_first.ratio.value == pytest.approx(1.5)
    assert "cub_select_flagged" in by_second.choice
    assert by_second.ratio.value == pytest.approx(1.5)


def test_a_queue_is_what_one_kernel_is_held_against(tmp_path):
    times = {"integrator wavefront": 3.0, "integrator wavefront_fused": 2.0, "integrator persistent": 1.0}
    (answer,) = answers_of(load_passport(passport(tmp_path, run(times), run(times))))
    assert answer.asked == "One kernel rather than a queue?"
    assert [side.ratio.value for side in answer.sides] == pytest.approx([2.0, 2.0])
    assert answer.sides[0].without.startswith("wavefront_fused")


def test_runs_that_disagree_say_so(tmp_path):
    faster, slower = ({"sorting none": 2.0, "sorting bucket": ms} for ms in (1.0, 3.0))
    (answer,) = answers_of(load_passport(passport(tmp_path, run(faster), run(slower))))
    assert (answer.word, answer.reason) == ("UNSURE", "the runs disagree: FASTER, SLOWER")


def test_a_run_that_is_unsure_says_why(tmp_path):
    """The interval of the second run reaches both sides of a limit."""
    faster, near = ({"sorting none": 2.0, "sorting bucket": ms} for ms in (1.0, 1.96))
    (answer,) = answers_of(load_passport(passport(tmp_path, run(faster), run(near, noise=0.02))))
    assert answer.word == "UNSURE"
    assert "reaches both sides of a 1 % limit" in answer.reason


def test_what_one_run_lacks_has_no_answer(tmp_path):
    whole = {"sorting none": 2.0, "sorting bucket": 1.0}
    assert answers_of(load_passport(passport(tmp_path, run(whole), run({"sorting none": 2.0})))) == []


def test_machines_stand_side_by_side(tmp_path, analysis):
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    file = passport(tmp_path, run(times), run(times))
    page = tmp_path / "page.md"
    code, _, said = analysis("passport", file, file, "--out", page)
    assert code == 0, said
    text = page.read_text(encoding="utf-8")
    assert text.count("| FASTER | 2.0 |") == 2
    assert "Sort the queue by material?" in text
    assert "16 KiB" in text


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"schema": "ptbench-peers-1"}, "$.schema: found "),
        ({"spp": {"compaction": 0}}, "$.spp.compaction: found 0, allowed: at least 1"),
        ({"chip": {}}, "$.chip.cpu: found nothing"),
        ({"runs": []}, "$.runs: found "),
    ],
)
def test_other_files_are_refused(tmp_path, fields, message):
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    file = passport(tmp_path, run(times), run(times), **fields)
    with pytest.raises(InputError) as refusal:
        load_passport(file)
    assert message in str(refusal.value)


def test_runs_of_other_suites_or_of_two_programs_are_refused(tmp_path):
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    other_suite = run(times, **{"ptbench.suite": "quick"})
    with pytest.raises(InputError, match="found the suite quick, allowed: a complete run of the suite passport"):
        load_passport(passport(tmp_path, run(times), other_suite))
    programs = [run(times, **{"ptbench.program_hash": 16 * digit}) for digit in "12"]
    with pytest.raises(InputError, match="found two programs, allowed: two runs of one program"):
        load_passport(passport(tmp_path, *programs))


def test_validate_holds_each_run_to_its_own_samples(tmp_path, monkeypatch):
    monkeypatch.setattr("ptbench.io.validate.complaints", lambda *_: [])  # the builder's files are an older program's
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    file = passport(tmp_path, run(times), run(times))
    assert validate(file) == []
    document = json.loads(file.read_text(encoding="utf-8"))
    del document["runs"][1]["benchmarks"][0]
    file.write_text(json.dumps(document), encoding="utf-8")
    assert any("$.runs[1]" in line for line in validate(file))
