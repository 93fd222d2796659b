"""Passports: the answers of two runs, side by side, and what is refused."""

from __future__ import annotations

import json

import pytest
from builder import Builder

from ptbench.errors import InputError
from ptbench.extras.passport.answers import NO_PAIR, answers_of
from ptbench.extras.passport.passport import load_passport
from ptbench.io.validate import validate
from ptbench.stats.estimates import interval_of_ratio

CPU = {
    "threads": 2,
    "copies": [{"bytes_per_thread": 16384, "gb_per_s": 200.0}, {"bytes_per_thread": 67108864, "gb_per_s": 20.0}],
    "gflops": 100.0,
    "atomics_per_s": 5e7,
    "fork_join_us": 3.0,
}


def run(times: dict[str, float], noise: float = 0.002, **context: str) -> dict:
    """A result of the suite `passport` in one scene: ms by "AXIS CHOICE"; a study is named as the axis it compares."""
    builder = Builder("passport")
    builder.context |= {"ptbench.program_hash": 16 * "0"} | context
    for name in dict.fromkeys(name.split()[0] for name in times):
        builder.studies.append({"name": name, "compares": name, "title": ""})
    for name, ms in times.items():
        axis, choice = name.split()
        builder.cell(axis, "box", ms, noise=noise, axes={axis: choice})
    return builder.document()


def passport(folder, *runs: dict, apart: int = 100, **fields: object):
    """A passport of two runs, the seeds of whose samples lie `apart`."""
    for row in runs[1]["benchmarks"] if len(runs) == 2 else ():
        if "pt_seed" in row:
            row["pt_seed"] += apart
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


def test_a_run_that_is_unsure_says_why_in_times_as_fast(tmp_path):
    faster, near = ({"sorting none": 2.0, "sorting bucket": ms} for ms in (1.0, 1.96))
    (answer,) = answers_of(load_passport(passport(tmp_path, run(faster), run(near, noise=0.02))))
    assert answer.word == "UNSURE"
    ratio = answer.sides[1].ratio
    assert ratio.low < 1 < ratio.high
    assert answer.reason == f"the interval {interval_of_ratio(ratio)} reaches both sides of a limit"


def test_a_side_that_one_run_lacks_is_told(tmp_path):
    whole = {"sorting none": 2.0, "sorting bucket": 1.0}
    (answer,) = answers_of(load_passport(passport(tmp_path, run(whole), run({"sorting none": 2.0}))))
    assert (answer.sides, answer.reason) == (None, NO_PAIR)


def test_a_champion_that_failed_in_the_other_run_gives_way(tmp_path):
    """`bucket` was the best sort of the first run, and the second run has no time for it."""
    first = {"sorting none": 3.0, "sorting thrust_sort_by_key": 2.0, "sorting bucket": 1.0}
    second = {"sorting none": 3.0, "sorting thrust_sort_by_key": 2.0}
    (answer,) = answers_of(load_passport(passport(tmp_path, run(first), run(second))))
    assert answer.word == "FASTER"
    assert "thrust_sort_by_key" in answer.sides[1].choice


def test_embree_is_no_tree_of_ptbench(tmp_path):
    times = {"accelerator bvh2": 2.0, "accelerator bvh8": 1.5, "accelerator embree": 1.0}
    (answer,) = answers_of(load_passport(passport(tmp_path, run(times), run(times))))
    assert "bvh8" in answer.sides[1].choice


def test_machines_stand_side_by_side(tmp_path, analysis):
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    file = passport(tmp_path, run(times), run(times))
    page = tmp_path / "page.md"
    code, _, said = analysis("passport", file, file, "--out", page)
    assert code == 0, said
    text = page.read_text(encoding="utf-8")
    assert text.count("| FASTER | 2.00 |") == 2
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
    for key in ("ptbench.program_hash", "ptbench.machine", "host_name", "ptbench.threads"):
        runs = [run(times, **{key: digit}) for digit in "12"]
        with pytest.raises(InputError, match=f'{key}: found "2", allowed: "1", as in run 0'):
            load_passport(passport(tmp_path, *runs))
    with pytest.raises(InputError, match="found seed 1 in both, allowed: two runs with seeds of their own"):
        load_passport(passport(tmp_path, run(times), run(times), apart=0))
    without = run(times)
    del without["context"]["host_name"]
    with pytest.raises(InputError, match="host_name: found nothing, allowed: this key is required"):
        load_passport(passport(tmp_path, run(times), without))


def test_validate_holds_each_run_to_its_own_samples(tmp_path, monkeypatch):
    monkeypatch.setattr("ptbench.io.validate.complaints", lambda *_: [])  # the builder's files are an older program's
    times = {"sorting none": 2.0, "sorting bucket": 1.0}
    file = passport(tmp_path, run(times), run(times))
    assert validate(file) == []
    document = json.loads(file.read_text(encoding="utf-8"))
    del document["runs"][1]["benchmarks"][0]
    file.write_text(json.dumps(document), encoding="utf-8")
    assert any("$.runs[1]" in line for line in validate(file))
