"""What a run says at its end is what pages say; files that hold no comparisons are judged when they are read."""

from __future__ import annotations

import copy
import json

import pytest
from builder import Builder

from ptbench.errors import InputError
from ptbench.io.asked import figure_of
from ptbench.io.results import load
from ptbench.io.validate import validate
from ptbench.studies.disturbed import CONTENDED, THROTTLED
from ptbench.studies.questions import question_of
from ptbench.studies.rows import measure

STUDY = "compaction"


def _compared(
    *, n: int = 9, ratio: float = 0.5, noise: float = 0.002, clock: float = 3690.0, contended: int = 0
) -> dict:
    builder = Builder()
    builder.study(STUDY)
    builder.cell(STUDY, ms_per_spp=4.0, noise=noise)
    builder.cell(
        STUDY,
        ms_per_spp=4.0 * ratio,
        n=n,
        noise=noise,
        clock_mhz=clock,
        contended=contended,
        axes={"compaction": "thrust_remove_if"},
    )
    return builder.document()


def _with(document: dict, **facts) -> dict:
    """The document with one comparison, of its second cell against its first."""
    document = copy.deepcopy(document)
    first, second = (cell["cell"] for cell in document["ptbench"]["cells"])
    comparison = {
        "study": STUDY,
        "cell": second,
        "baseline": first,
        "ratio": 0.5,
        "interval": [0.49, 0.52],
        "word": "FASTER",
        "reason_code": "",
        "in_time": "FASTER",
        "in_cycles": "FASTER",
    }
    document["ptbench"]["comparisons"] = [comparison | facts]
    return document


@pytest.fixture
def row(tmp_path):
    def second_row(document: dict):
        path = tmp_path / "result.json"
        path.write_text(json.dumps(document))
        result = load(path)
        return measure(result, result.studies[0])[1]

    return second_row


def test_the_files_interval_and_word_are_told(row):
    told = row(_with(_compared(), interval=[0.3, 1.4], word="SAME", in_time="SAME", in_cycles="SAME"))
    assert (told.ratio.value, told.ratio.low, told.ratio.high, told.ratio.n) == (0.5, 0.3, 1.4, 9)
    assert (told.verdict.word, told.verdict.said) == ("SAME", "")


def test_a_file_without_comparisons_is_judged_by_the_same_rule(row):
    told = row(_compared())
    assert told.verdict.word == "FASTER"
    assert told.ratio.low != 0.3


def test_a_comparison_that_the_file_lacks_is_told_as_none(row):
    document = _with(_compared())
    document["ptbench"]["comparisons"] = []
    assert row(document).ratio is None
    none = {"ratio": None, "interval": None, "word": None, "in_time": None, "in_cycles": None}
    told = row(_with(_compared(), **none, reason_code="baseline_not_measured"))
    assert told.verdict.reason == "the baseline compaction=none has no times (ok)"
    told = row(_with(_compared(), **none, baseline=None, reason_code="no_baseline"))
    assert told.verdict.reason == "no cell with compaction=none and all else equal"


# What the file says for a document, and what the rule says of that document: the same verdict to the last word.
SAID = {
    "faster": (_compared(), {}),
    "few samples": (
        _compared(n=3),
        {"word": "UNSURE", "reason_code": "few_samples", "in_time": "UNSURE", "in_cycles": "UNSURE"},
    ),
    "wide": (
        _compared(ratio=1.01, noise=0.01),
        {"ratio": 1.01, "word": "UNSURE", "reason_code": "wide", "in_time": "UNSURE", "in_cycles": "UNSURE"},
    ),
    "clocks": (
        _compared(clock=2 * 3690.0),
        {"word": "UNSURE", "reason_code": "clocks_differed", "in_time": "FASTER", "in_cycles": "SAME"},
    ),
    "contended": (_compared(contended=9), {"word": "UNSURE", "reason_code": "contended"}),
    "clock unknown": (_compared(clock=0.0), {"in_cycles": None}),
}


@pytest.mark.parametrize("name", SAID)
def test_the_reason_is_told_as_the_rule_tells_it(name, row):
    document, facts = SAID[name]
    by_rule = row(document)
    ends = [by_rule.ratio.low, by_rule.ratio.high]
    told = row(_with(document, interval=ends, **({"ratio": by_rule.ratio.value} | facts)))
    assert (told.verdict, told.ratio) == (by_rule.verdict, by_rule.ratio)


def test_a_quota_is_told(row):
    told = row(_with(_compared(), word="UNSURE", reason_code="throttled"))
    assert (told.verdict.reason, told.verdict.withheld) == (THROTTLED, "FASTER")
    assert row(_with(_compared(), word="UNSURE", reason_code="contended")).verdict.reason == CONTENDED


@pytest.mark.parametrize(
    ("facts", "complaint"),
    [
        ({"ratio": 0.6}, "ratio: found 0.6 of the cell"),
        ({"study": "none"}, 'study: found "none"'),
        ({"cell": "none"}, 'cell: found "none"'),
        ({"baseline": "none"}, 'baseline: found "none"'),
        ({"interval": [0.6, 0.5]}, "interval: found "),
        ({"interval": [0.6]}, "interval: found "),
        ({"word": "GOOD"}, 'word: found "GOOD"'),
        ({"word": None}, "word: found null"),
        ({"reason_code": "mood"}, 'reason_code: found "mood"'),
    ],
)
def test_a_comparison_that_cannot_be_is_refused(facts, complaint, row):
    with pytest.raises(InputError, match="comparisons") as error:
        row(_with(_compared(), **facts))
    assert complaint in str(error.value)


def test_validate_knows_comparisons(tmp_path):
    path = tmp_path / "result.json"
    document = _with(_compared(), ratio=0.6)
    path.write_text(json.dumps(document))
    assert not [line for line in validate(path) if "comparisons" in line and "0.6" not in line]
    document["ptbench"]["comparisons"][0]["mood"] = 1
    path.write_text(json.dumps(document))
    assert [line for line in validate(path) if "mood" in line]


@pytest.mark.parametrize(
    ("compares", "along", "figure"),
    [
        ("live_paths", "", "remaining_paths"),
        ("sorting", "", "sorting"),
        ("sorting", "depth", "scaling_by_depth"),
        ("compaction", "depth", "scaling_by_depth"),
        ("sorting", "materials", "scaling_by_materials"),
        ("block", "", "block"),
        ("", "", ""),
    ],
)
def test_the_figure_is_chosen_by_what_is_compared(compares, along, figure):
    assert figure_of(compares, along, is_convergence=False) == figure
    assert figure_of("", "", is_convergence=True) == "convergence"


def test_a_study_along_something_compares_what_it_names(tmp_path):
    """Two axes vary; a file that names a figure leaves open which of them is meant."""
    builder = Builder()
    builder.study(STUDY, figure="scaling_by_depth")
    for compaction in ("none", "thrust_remove_if"):
        for layout in ("aos", "soa"):
            for depth in (4, 8):
                builder.cell(STUDY, depth=depth, axes={"compaction": compaction, "layout": layout})
    document = builder.document()
    path = tmp_path / "result.json"

    def asked(study: dict) -> str:
        document["ptbench"]["studies"] = [{"name": STUDY, "title": "T"} | study]
        path.write_text(json.dumps(document))
        result = load(path)
        return question_of(result, result.studies[0]).axis

    assert asked({"figure": "scaling_by_depth"}) == "compaction"
    assert asked({"compares": "layout", "along": "depth", "type": "time"}) == "layout"
