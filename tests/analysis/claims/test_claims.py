"""The claims ledger: verdicts by their rule, order by git, exit codes, and the committed files and pages themselves."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from builder import Builder
from conftest import RESULTS, ROOT, committed
from convergence_builder import Law, rows_of_errors

from ptbench.claims.claim import Ledger, prediction_in, read_claim
from ptbench.claims.command import Call, claims, told_of
from ptbench.claims.evidence import evidence_of
from ptbench.claims.history import BY_DATE, LOOK_UP, REPEAT, TEST, UNCOMMITTED, UNKNOWN, Measured, order_of
from ptbench.claims.judging import (
    DOES_NOT,
    HOLDS,
    HOLDS_WHERE,
    LESS,
    MISSING,
    MORE,
    NOT_REACHED,
    OPEN,
    WITHDRAWN,
    WITHIN,
    judge,
)
from ptbench.errors import InputError
from ptbench.findings.page import Page, typed_by_hand
from ptbench.io.validate import SCHEMAS, schema, validate

CLAIM = {
    "schema": "ptbench-claim-1",
    "title": "Sorting",
    "claim": "Sorting makes it faster.",
    "number": {"text": "+20 %", "low": 1.2, "high": 1.2, "of": "rate with sorting over that without"},
    "source": {"authors": "A. One, B. Two, C. Three", "title": "T", "venue": "V", "year": 2010, "read": "memory",
               "where": ""},
    "theirs": {"hardware": "h", "scenes": "s"},
    "near": "It is near.",
    "rule": {"low": 1.1, "high": None, "because": "half of it"},
    "prediction": {"because": "because"},
}  # fmt: skip
SIDES = ("below", "theirs", "above")
EARLY, PREDICTED, LATE = "2025-03-01T10:00:00+00:00", "2025-03-01T12:00:00+00:00", "2025-03-01T14:00:00+00:00"


def condition(index: int, side: str, **more) -> dict:
    cell = f"wavefront sorting=bucket scene=box_{index}"
    return {"name": f"box {index}", "side": side, "cell": cell, "over": f"wavefront scene=box_{index}",
            "predicted": [1.0, 1.5], **more}  # fmt: skip


def experiment(conditions: list[dict], statistic: str = "speed_up", **more) -> dict:
    return {"suite": "sorts", "backend": "cuda", "seconds": 5, "statistic": statistic, "axis": "scene",
            **more, "conditions": conditions}  # fmt: skip


class House:
    """A checkout of one claim in a folder of its own, with or without git."""

    def __init__(self, root: Path) -> None:
        self.root, self.ledger = root, Ledger(root)
        self.file = root / "claims" / "sorting.json"
        self.result = root / "results" / "nvidia-h200" / "claims" / "sorts.json"
        (root / "claims" / "suites").mkdir(parents=True)
        self.result.parent.mkdir(parents=True)
        shutil.copytree(ROOT / "docs" / "templates" / "claims", self.ledger.templates)
        self.suite(1)

    def suite(self, studies: int) -> None:
        (self.root / "claims" / "suites" / "sorts.json").write_text(json.dumps({"name": "sorts", "studies": [studies]}))

    def claim(self, about: dict | None = None, **changes) -> House:
        self.file.write_text(json.dumps({**CLAIM, "experiment": about, **changes} if about else {**CLAIM, **changes}))
        return self

    def measured(self, speed_ups: list[float], date: str = LATE, sha: str = "0123abcd4567", **cell) -> House:
        """Each box takes 2 ms without sorting."""
        builder = Builder("sorts").on_gpu().study("sorts", "sorting")
        builder.context |= {"date": date, "ptbench.git_sha": sha}
        for index, speed_up in enumerate(speed_ups):
            builder.cell("sorts", f"box_{index}", 2.0, noise=0.0, **cell)
            builder.cell("sorts", f"box_{index}", 2.0 / speed_up, noise=0.0, axes={"sorting": "bucket"}, **cell)
        builder.write(self.result)
        return self

    def git(self, *arguments: str, date: str = PREDICTED) -> str:
        who = {f"GIT_{role}_{key}": value for role in ("AUTHOR", "COMMITTER")
               for key, value in (("NAME", "n"), ("EMAIL", "n@n"), ("DATE", date))}  # fmt: skip
        answer = subprocess.run(["git", "-C", str(self.root), *arguments], capture_output=True, text=True, check=True,
                                env={**os.environ, **who, "GIT_CONFIG_GLOBAL": os.devnull})  # fmt: skip
        return answer.stdout.strip()

    def commit(self, date: str = PREDICTED) -> str:
        if not (self.root / ".git").exists():
            self.git("init", "-q")
        self.git("add", "claims", "docs")
        self.git("commit", "-q", "--allow-empty", "-m", "m", date=date)
        return self.git("rev-parse", "HEAD")

    def read(self):
        return read_claim(self.file, self.ledger.folder)

    def evidence(self):
        (only,) = evidence_of(self.read(), self.root / "results")
        return only

    def verdict(self):
        return judge(self.read(), self.evidence())

    def order(self, date: str, sha: str = "0" * 40, machine: str = "box"):
        return order_of(self.ledger, self.read(), machine, Measured(sha, date))


@pytest.fixture
def house(tmp_path) -> House:
    return House(tmp_path)


def boxes(sides: tuple[str, ...] = SIDES) -> dict:
    return experiment([condition(index, side) for index, side in enumerate(sides)])


@pytest.mark.parametrize(
    ("sides", "speed_ups", "word"),
    [
        (SIDES, [1.1, 1.25, 4.0], HOLDS),
        (SIDES, [1.0, 1.25, 1.5], HOLDS_WHERE),
        (SIDES, [1.25, 0.5, 0.5], HOLDS_WHERE),
        (SIDES, [0.5, 1.0, 1.0625], DOES_NOT),
        (("below", "theirs", "theirs"), [0.5, 1.0, 1.0625], NOT_REACHED),
        (("theirs", "above", "above"), [0.5, 1.0, 1.0625], NOT_REACHED),
    ],
)
def test_a_verdict_follows_from_its_conditions(house, sides, speed_ups, word):
    verdict = house.claim(boxes(sides)).measured(speed_ups).verdict()
    assert verdict.word == word
    assert [one.found.estimate.value for one in verdict.judged] == speed_ups
    assert verdict.held == [f"box {index}" for index, speed_up in enumerate(speed_ups) if speed_up >= 1.1]


def test_a_verdict_says_why_it_was_not_reached(house):
    house.claim(boxes(("below", "theirs"))).measured([0.5, 1.0])
    assert house.verdict().reason.endswith("theirs were not approached from two sides")
    house.measured([0.5, 1.0], contended=9, device_share=0.5)
    assert house.verdict().word == NOT_REACHED
    assert {one.word for one in house.verdict().judged} == {OPEN}


def test_a_condition_has_its_own_rule_where_it_says_so(house):
    ends = [[None, 0.9], [1.5, 2.0], [1.25, 1.25]]
    conditions = [condition(index, side, claimed=ends[index]) for index, side in enumerate(SIDES)]
    verdict = house.claim(experiment(conditions)).measured([1.25, 1.25, 1.25]).verdict()
    assert [one.word for one in verdict.judged] == [MORE, LESS, WITHIN]


def test_an_interval_across_a_limit_is_open_and_a_missing_cell_has_no_number(house):
    house.claim(boxes())
    builder = Builder("sorts").on_gpu().study("sorts", "sorting")
    for scene, speed_up in (("box_0", 1.1), ("box_1", 1.25)):
        builder.cell("sorts", scene, 2.0, noise=0.01)
        builder.cell("sorts", scene, 2.0 / speed_up, noise=0.01, axes={"sorting": "bucket"})
    builder.write(house.result)
    verdict = house.verdict()
    assert [one.word for one in verdict.judged] == [OPEN, WITHIN, MISSING]
    assert "no cell is" in verdict.judged[2].found.doubt


def test_a_prediction_is_right_where_the_number_lies_in_it(house):
    verdict = house.claim(boxes()).measured([0.5, 1.25, 2.0]).verdict()
    assert [one.foreseen for one in verdict.judged] == [False, True, False]
    assert verdict.foreseen == (1, 3)


def test_scenes_together_are_a_geometric_mean(house):
    together = condition(0, "theirs", cell="wavefront sorting=bucket scene=*", over="wavefront scene=*")
    verdict = house.claim(experiment([together])).measured([0.5, 2.0, 8.0]).verdict()
    assert verdict.judged[0].found.estimate.value == pytest.approx(2.0, abs=1e-12)


def test_other_statistics(house):
    time = house.claim(experiment([condition(0, "theirs")], "time")).measured([2.0]).verdict()
    assert time.judged[0].found.estimate.value == 0.5
    alive = condition(0, "theirs", cell="wavefront scene=box_0")
    house.claim(experiment([alive], "alive_after_7")).measured([2.0], live_paths=[1000, 9, 8, 7, 6, 5, 4, 250])
    assert house.verdict().judged[0].found.estimate.value == 0.25
    unknown = house.claim(experiment([condition(0, "theirs")], "bytes")).measured([2.0]).verdict()
    assert unknown.judged[0].word == MISSING


@pytest.mark.parametrize(
    ("statistic", "expected"),
    [("variance", 4.0), ("efficiency", 8.0), ("rmse", 2.0), ("slope", -1.0), ("veach_bound", 0.25 / (0.25 + 0.5))],
)
def test_statistics_of_error_are_those_of_the_law(house, statistic, expected):
    """On the law itself: sigma² 1 without and 0.25 with sorting, in half the time; the reference's mean square is 1."""
    over = "wavefront scene=box_0;wavefront sorting=bucket scene=box_0" if statistic == "veach_bound" else None
    about = experiment([condition(0, "theirs", **({"over": over} if over else {}))], statistic, spp_at=16)
    house.claim(about)
    builder = Builder("sorts").on_gpu().study("sorts", "convergence")
    builder.studies[0]["type"] = "convergence"
    for sorting, sigma2, ms in (("none", 1.0, 2.0), ("bucket", 0.25, 1.0)):
        spps = [2**power for power in range(7)]
        reference = {
            "name": "r",
            "kind": "closed_form",
            "scene": "box_0",
            "formula": "0",
            "mean_square": 1.0,
            "variance": 0.0,
        }
        about = {"checkpoints": spps, "reference": reference, "independent_samples": True}
        axes = {"sorting": sorting}
        cell = builder.cell("sorts", "box_0", ms, spp=64, noise=0.0, n=8, axes=axes, convergence=about)
        rows = [row for row in builder.rows if row["run_name"] == cell["cell"] and "pt_seed" in row]
        for row in rows:
            errors = rows_of_errors(Law(sigma2=sigma2, noisy=False), 1, spps)
            row["pt_checkpoints"] = [{**error, "wall_ms": ms * error["spp"]} for error in errors]
    builder.write(house.result)
    (one,) = house.verdict().judged
    assert one.found.estimate is not None, one.found.doubt
    assert np.allclose([one.found.estimate.value, one.found.estimate.low, one.found.estimate.high], expected, rtol=1e-9)


def test_another_suites_result_is_looked_up_where_the_own_is_not_there(house):
    house.claim({**boxes(), "also": ["nothing", "sorting"]}).measured([1.25, 1.25, 1.25])
    other = house.root / "results" / "nvidia-h200" / "sorting.json"
    house.result.rename(other)
    assert (house.evidence().files, house.verdict().word) == (("nvidia-h200/sorting.json",), HOLDS)
    house.measured([1.0, 1.25, 1.25])
    assert (house.evidence().files, house.verdict().word) == (("nvidia-h200/claims/sorts.json",), HOLDS_WHERE)
    house.result.unlink()
    other.write_text(other.read_text().replace('"ptbench.backend": "cuda"', '"ptbench.backend": "cpu"'))
    assert evidence_of(house.read(), house.root / "results") == []


def test_near_theirs_without_a_number_is_not_reached(house):
    house.claim(boxes()).measured([1.25])
    assert house.verdict().word == NOT_REACHED
    assert house.verdict().reason == "1 of 1 conditions near theirs have no number"


def rays_claim(house: House, statistic: str, rows: list[dict], **more) -> House:
    about = {"rays": ["--mesh", "tori_4M"], "result": "two", "backend": "cuda", "seconds": 1, "statistic": statistic,
             "axis": "class", **more, "conditions": rows}  # fmt: skip
    return house.claim(about)


def rays_result(house: House, machine: str, factor: float) -> dict:
    """The committed file of that mesh, every time of it `factor` times as long."""
    document = committed("nvidia-h200/rays_accelerators/tori_4M.json")
    for mesh in document["meshes"]:
        for tree in mesh["trees"]:
            for batch in tree["batches"]:
                batch["ms"] = [factor * ms for ms in batch["ms"]]
    folder = house.root / "results" / machine / "claims"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "two.json").write_text(json.dumps(document))
    return document


def test_one_gpu_against_another_is_a_ratio_of_the_same_batch(house):
    row = condition(0, "theirs", cell="mesh=tori_4M class=diffuse_1 accelerator=bvh2 kernel=plain")
    row.pop("over")
    rays_claim(house, "speed_up", [row], machines=["fast", "slow"])
    assert evidence_of(house.read(), house.root / "results") == []
    rays_result(house, "fast", 1.0)
    rays_result(house, "slow", 2.0)
    (one,) = house.verdict().judged
    assert (one.found.estimate.value, house.evidence().files) == (2.0, ("fast/claims/two.json", "slow/claims/two.json"))


def test_a_withdrawn_claim_is_not_judged_whatever_was_measured(house):
    house.claim(boxes(), withdrawn="The scene is another.").measured([1.0, 1.25, 1.25])
    (told,) = told_of(house.ledger, house.read(), house.root / "results", {})
    assert (told.word, told.verdict.reason, told.evidence, told.figure) == (
        WITHDRAWN,
        "The scene is another.",
        None,
        "",
    )


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"ptbench.cuda_kernel_source_hash": "0123456789abcdef"}, "they are of several programs (f4cc677)"),
        ({"ptbench.git_dirty": "true"}, "f4cc677 had changes that were not committed"),
    ],
)
def test_two_gpus_by_two_programs_are_refused(house, changed, reason):
    row = condition(0, "theirs", cell="mesh=tori_4M class=diffuse_1 accelerator=bvh2 kernel=plain")
    row.pop("over")
    rays_claim(house, "speed_up", [row], machines=["fast", "slow"])
    rays_result(house, "fast", 1.0)
    document = rays_result(house, "slow", 1.0)
    document["context"] |= changed
    (house.root / "results/slow/claims/two.json").write_text(json.dumps(document))
    verdict = house.verdict()
    assert verdict.word == NOT_REACHED
    assert reason in verdict.reason
    assert [one.found.estimate for one in verdict.judged] == [None]


def test_bytes_are_exact_and_a_batch_is_over_another(house):
    words = "mesh=tori_4M accelerator={} part=nodes"
    row = condition(0, "theirs", cell=words.format("cwbvh"), over=words.format("bvh2"))
    rays_claim(house, "bytes", [row])
    trees = {tree["accelerator"]: tree for tree in rays_result(house, "nvidia-h200", 1.0)["meshes"][0]["trees"]}
    (one,) = house.verdict().judged
    expected = trees["cwbvh"]["node_bytes"] / trees["bvh2"]["node_bytes"]
    assert (one.found.estimate.low, one.found.estimate.value, one.found.estimate.high) == (expected,) * 3
    batch = "mesh=tori_4M class=diffuse_1 accelerator={} kernel=plain"
    rays_claim(house, "speed_up", [condition(0, "theirs", cell=batch.format("cwbvh"), over=batch.format("bvh2"))])
    times = [
        np.median(next(b["ms"] for b in trees[name]["batches"] if (b["class"], b["kernel"]) == ("diffuse_1", "plain")))
        for name in ("bvh2", "cwbvh")
    ]
    assert house.verdict().judged[0].found.estimate.value == times[0] / times[1]


# --- which came first ---


def test_how_a_study_is_shown_is_no_part_of_its_prediction():
    claim = (ROOT / "claims" / "veach_1995_power.json").read_text(encoding="utf-8")

    def predicted(**study) -> str:
        return prediction_in(claim, json.dumps({"name": "s", "studies": [{"name": "a", "axes": {}, **study}]}))

    assert predicted(figure="bars") == predicted(compares="choices", along="depth") == predicted() != ""
    assert predicted(spp=64) != predicted()


def test_a_program_with_the_prediction_in_its_history_tested_it(house):
    house.claim(boxes())
    first = house.commit(PREDICTED)
    later = house.commit(PREDICTED)
    order = house.order(LATE, later)
    assert (order.grade, order.predicted) == (TEST, first)
    assert house.order(LATE, "f" * 40).grade == BY_DATE
    assert "a look-up, not a test" in house.order(EARLY, later).said
    assert house.order(EARLY, later).grade == LOOK_UP


def test_what_a_prediction_was_read_off_is_repeated_there_and_tested_elsewhere(house):
    house.claim(boxes(), seen=["box"])
    house.commit(PREDICTED)
    later = house.commit(PREDICTED)
    repeated = house.order(LATE, later)
    assert (repeated.grade, repeated.is_test) == (REPEAT, False)
    assert "a repeat, not a test" in repeated.said
    assert house.order(LATE, later, machine="bag").grade == TEST


@pytest.mark.parametrize("changed", ["claim", "rule", "prediction", "suite", "condition"])
def test_an_edited_prediction_is_as_old_as_the_edit(house, changed):
    house.claim(boxes())
    house.commit(EARLY)
    assert house.order(PREDICTED).grade == BY_DATE
    edits = {
        "claim": {"claim": "Sorting makes it much faster."},
        "rule": {"rule": {"low": 1.0, "high": None, "because": "half of it"}},
        "prediction": {"prediction": {"because": "of what was seen"}},
    }
    if changed == "suite":
        house.suite(2)
    elif changed == "condition":
        house.claim(experiment([condition(0, "theirs", predicted=[1.2, 1.3])]))
    else:
        house.claim(boxes(), **edits[changed])
    assert house.order(PREDICTED).grade == UNCOMMITTED
    edit = house.commit(LATE)
    assert (house.order(PREDICTED).grade, house.order(PREDICTED).predicted) == (LOOK_UP, edit)


def test_what_is_no_prediction_may_be_edited(house):
    house.claim(boxes())
    first = house.commit(EARLY)
    house.claim({**boxes(), "seconds": 9}, near="It is nearer.", title="Sorts", afterwards="No bound.")
    assert house.order(PREDICTED).predicted == first
    house.commit(LATE)
    assert (house.order(PREDICTED).grade, house.order(PREDICTED).predicted) == (BY_DATE, first)


def test_without_git_nobody_knows(house):
    assert house.claim(boxes()).order(LATE).grade == UNKNOWN


# --- the command ---


def test_a_committed_verdict_that_no_longer_follows_is_an_error(house, capsys):
    house.claim(boxes()).measured([1.25, 1.25, 1.25])
    house.commit()
    assert claims(Call(house.root, write=True)) == 0
    assert claims(Call(house.root, check=True)) == 0
    house.measured([1.0, 1.25, 1.25])
    assert claims(Call(house.root)) == 1
    assert "sorting on nvidia-h200: holds is committed, its data say holds only where" in capsys.readouterr().out
    house.result.unlink()
    assert claims(Call(house.root)) == 1
    assert "its data are gone (nvidia-h200/claims/sorts.json)" in capsys.readouterr().out


def test_a_prediction_edited_after_its_verdict_is_an_error(house, capsys):
    house.claim(boxes()).measured([1.25, 1.25, 1.25])
    house.commit(PREDICTED)
    assert claims(Call(house.root, write=True)) == 0
    house.claim(experiment([condition(i, side, predicted=[1.2, 1.3]) for i, side in enumerate(SIDES)]))
    house.git("commit", "-qam", "m", date="2025-03-02T00:00:00+00:00")
    assert claims(Call(house.root)) == 1
    assert "committed as test by dates, git says look-up" in capsys.readouterr().out


def test_a_copy_without_history_keeps_what_git_said(house):
    house.claim(boxes()).measured([1.25, 1.25, 1.25])
    house.commit()
    claims(Call(house.root, write=True))
    shutil.rmtree(house.root / ".git")
    assert claims(Call(house.root, check=True)) == 0


def test_what_a_reader_measures_changes_no_committed_page(house):
    house.claim(boxes())
    house.commit()
    claims(Call(house.root, write=True))
    house.measured([1.25, 1.25, 1.25])
    assert claims(Call(house.root, check=True)) == 0


def test_pages_say_the_numbers_and_are_checked(house, capsys):
    house.claim(boxes(), afterwards="It had no bound.").measured([1.0, 1.25, 1.5])
    house.commit()
    claims(Call(house.root, write=True))
    page = (house.ledger.pages / "sorting.md").read_text(encoding="utf-8")
    assert "## NVIDIA H200: holds only where" in page
    assert "\nWritten after the run: It had no bound.\n" in page
    assert "| box 1 | theirs | at least 1.1 | 1 to 1.5 | 1.25 | holds |" in page
    assert "| box 0 | below | at least 1.1 | 1 to 1.5 | 1.00 | less |" in page
    table = (house.ledger.pages / "README.md").read_text(encoding="utf-8")
    assert "A. One et al. 2010*" in table
    assert "](overview.svg)" in table
    assert "Sorting (NVIDIA H200)" in (house.ledger.pages / "overview.svg").read_text(encoding="utf-8")
    tally = "1 of 1 near theirs, 1 of 2 elsewhere (1 below the rule)"
    assert f"| NVIDIA H200 | **holds only where** | {tally} | 3 of 3 | test by dates |" in table
    (house.ledger.pages / "old.md").write_text("x")
    (house.ledger.pages / "sorting.md").write_text(page.replace("1.25", "1.35"))
    capsys.readouterr()
    assert claims(Call(house.root, check=True)) == 1
    said = capsys.readouterr().out
    assert "old.md: no claim has it" in said
    assert "sorting.md: not what claims and results say" in said


def test_a_verdict_on_data_that_were_there_first_is_marked(house, capsys):
    house.claim(boxes()).measured([1.25, 1.25, 1.25], date=EARLY)
    house.commit(PREDICTED)
    claims(Call(house.root, write=True))
    said = capsys.readouterr().out
    assert "sorting: holds (no test) on NVIDIA H200" in said
    assert "prediction is later than the data: a look-up, not a test" in said
    table = (house.ledger.pages / "README.md").read_text(encoding="utf-8")
    assert "**holds (no test)**" in table
    assert "measured after their predictions" not in table
    house.measured([1.25, 1.25, 2.0])
    claims(Call(house.root, write=True))
    table = (house.ledger.pages / "README.md").read_text(encoding="utf-8")
    assert "Of 3 numbers that were measured after their predictions, 2 lie" in table


def test_others_results_are_looked_up_and_contradict_nothing(house, tmp_path, capsys):
    house.claim(boxes()).measured([1.25, 1.25, 1.25])
    house.commit()
    claims(Call(house.root, write=True))
    others = tmp_path / "others"
    shutil.copytree(house.root / "results", others)
    capsys.readouterr()
    shutil.rmtree(house.root / "results")
    assert claims(Call(house.root, ("sorting",), results=others)) == 0
    assert "sorting: holds on NVIDIA H200" in capsys.readouterr().out


def test_what_is_run_is_run_once_into_its_place(house, tmp_path):
    """A program that says where it would write stands for ptbench."""
    house.claim(boxes())
    house.commit()
    house.measured([1.25, 1.25, 1.25])
    measured = tmp_path / "measured.json"
    house.result.rename(measured)
    program = tmp_path / "ptbench"
    program.write_text(
        '#!/bin/sh\n[ "$1" = machine ] && { echo nvidia-h200; exit 0; }\n'
        f'echo "$@" >> {tmp_path}/calls\nfor last; do :; done\ncp {measured} "$last"\n'
    )
    program.chmod(0o755)
    for _ in range(2):
        assert claims(Call(house.root, binary=program, run=True)) == 0
    assert house.verdict().word == HOLDS
    (call,) = (tmp_path / "calls").read_text().splitlines()
    suite = house.root / "claims" / "suites" / "sorts.json"
    assert call == f"run --suite {suite} --resume --untuned --backend cuda --out {house.result}"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"colour": 1}, "found the key"),
        ({"rule": {"low": "1", "high": None, "because": "x"}}, r"\$.rule.low: found"),
        ({"not_reached": "x"}, "found"),
        ({"experiment": experiment([condition(0, "theirs"), condition(0, "above")])}, "each name once"),
        ({"experiment": experiment([condition(0, "theirs", predicted=[2, 1])])}, r"allowed: \[low, high\]"),
        ({"experiment": experiment([condition(0, "theirs", over="a=1 a=2")])}, "names a twice"),
        ({"experiment": {**boxes(), "suite": "others"}}, "a file in claims/suites"),
        ({"experiment": experiment([condition(0, "near")])}, '"below" or "theirs" or "above"'),
    ],
)
def test_a_file_that_is_no_claim_is_one_clear_line(house, change, said, analysis):
    house.claim(boxes(), **change)
    with pytest.raises(InputError, match=said):
        house.read()
    code, _, error = analysis("claims", "--root", house.root)
    assert (code, error.count("\n")) == (2, 1)


def test_an_unknown_name_is_one_clear_line(house, analysis):
    house.claim(boxes())
    code, _, error = analysis("claims", "sortin", "--root", house.root)
    assert (code, error.count("\n")) == (2, 1)
    assert "allowed: sorting" in error


# --- what is committed ---


def test_committed_claims_are_as_their_schema_says():
    files = sorted((ROOT / "claims").glob("*.json"))
    assert len(files) >= 12
    assert {str(path): validate(path) for path in files if validate(path)} == {}
    assert (SCHEMAS / "ptbench-claim.schema.json").is_file()
    for node in (schema("claim"), *schema("claim")["$defs"].values()):
        for key, field in node.get("properties", {}).items():
            assert "description" in field or "$ref" in field, key


def test_every_suite_belongs_to_a_claim():
    used = {one.experiment.suite for one in Ledger(ROOT).claims() if one.experiment is not None}
    assert used - {""} == {path.stem for path in (ROOT / "claims" / "suites").glob("*.json")}


def test_committed_verdicts_and_pages_follow_from_their_data(capsys):
    assert claims(Call(ROOT, check=True)) == 0, capsys.readouterr().out


def test_committed_results_that_answer_a_claim_have_a_committed_verdict():
    """Who measures for themselves changes no page; what is committed is on one."""
    ledger = Ledger(ROOT)
    recorded = json.loads(ledger.verdicts.read_text(encoding="utf-8"))
    missing = [
        (claim.name, one.files)
        for claim in ledger.claims()
        for one in evidence_of(claim, RESULTS)
        if one.machine not in recorded.get(claim.name, {})
    ]
    assert missing == [], "run python3 -m ptbench claims --write"


@pytest.mark.parametrize("name", ["README", "claim"])
def test_templates_hold_no_number(name):
    template = Ledger(ROOT).templates / f"{name}.md"
    assert typed_by_hand(Page(template, {}, template.read_text(encoding="utf-8"))) == []


def test_every_condition_names_cells_of_its_suite(tmp_path):
    """By the program's own plan; what is not spelled there is at its standard."""
    binary = ROOT / os.environ.get("PTBENCH_BUILD_DIR", "build") / "ptbench"
    if not binary.is_file():
        pytest.skip("needs build/ptbench")
    claimed = [one for one in Ledger(ROOT).claims() if one.experiment is not None and one.experiment.suite]
    suites: dict[str, set[str]] = {}
    for one in claimed:
        suites.setdefault(one.experiment.backend, set()).add(one.experiment.suite)
    plans = {key: plan for backend, names in suites.items()
             for key, plan in _planned(binary, backend, sorted(names), tmp_path).items()}  # fmt: skip
    missing = []
    for one in claimed:
        key = one.experiment.backend, one.experiment.suite
        for row in one.experiment.conditions:
            for selection in [row.cell, *filter(None, row.over.split(";"))]:
                words = {word if "=" in word else f"integrator={word}" for word in selection.split()}
                words = {word for word in words if not word.endswith("=*")}
                # A word may be a standard, which a cell's name does not spell; no more than these may be.
                if not any(words - cell <= _STANDARDS for cell in plans[key]):
                    missing.append(f"{one.name}: {selection}")
    assert missing == []


_STANDARDS = {"shading_fmas=0", "accelerator=brute_force", "traversal=while_while", "specialisation=features",
              "fetch_at=8", "short_entries=4", "shared_entries=8", "mis_exponent=2",
              "subsurface_sampling=classical"}  # fmt: skip


def _planned(binary: Path, backend: str, suites: list[str], folder: Path) -> dict[tuple[str, str], list[set[str]]]:
    """The words of each suite's cells.

    Those that take times are planned by one call, since each call reads its scenes, which have millions of triangles:
    a study has an spp of its own there, by which its cells are told from the others'.
    """
    plans: dict[tuple[str, str], list[set[str]]] = {(backend, suite): [] for suite in suites}
    together: list[dict] = []
    owners: dict[str, tuple[str, str]] = {}  # by the spp of the common call: the suite, and the study's own spp
    for suite in suites:
        path = ROOT / "claims" / "suites" / f"{suite}.json"
        studies = json.loads(path.read_text(encoding="utf-8"))["studies"]
        if any("type" in study for study in studies):
            plans[backend, suite] = _cells(binary, backend, path)
            continue
        for study in studies:
            spp = 16 * (1000 + len(together))
            owners[f"spp={spp}"] = suite, f"spp={study['spp']}"
            together.append({**study, "name": f"{suite}_{study['name']}", "spp": spp})
    if together:
        path = folder / f"{backend}.json"
        path.write_text(json.dumps({"name": "together", "repetitions": 1, "studies": together}), encoding="utf-8")
        for words in _cells(binary, backend, path):
            (tag,) = words & owners.keys()
            suite, spp = owners[tag]
            plans[backend, suite].append(words - {tag} | {spp})
    return plans


def _cells(binary: Path, backend: str, suite: Path) -> list[set[str]]:
    command = [binary, "run", "--suite", suite, "--backend", backend, "--dry-run"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    cells = [line.split("/") for line in listed if "/scene:" in line and not line.startswith("n/a")]
    return [{f"integrator={parts[0]}", *(part.replace(":", "=", 1) for part in parts[1:])} for parts in cells]
