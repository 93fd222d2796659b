"""Files without comparisons are judged as the program judges a run: both are held to tests/support/run_verdicts.json.

tests/unit/comparisons_test.cpp holds the program's C++ to the same pairs, ratios and words.
`python3 tests/analysis/test_run_verdicts.py` (with PYTHONPATH=analysis) writes it anew where the rule or the results
have changed.
"""

import json
from pathlib import Path

from conftest import COMMITTED, rows_by_file

from ptbench.io.results import load_kept
from ptbench.studies.questions import question_of
from ptbench.studies.rows import baseline_of, measure

ROOT = Path(__file__).parents[2]
EXPECTED = ROOT / "tests/support/run_verdicts.json"
RESULTS = [f"results/amd-epyc-2-threads/{name}.json" for name in ("quick", "schedulers", "specialisation", "packet")]


def _pairs(file):
    """Study, the places of a cell and of its baseline in the file, ratio, interval, verdict: a row a compared cell."""
    result = load_kept(COMMITTED / file)
    place = {cell.name: index for index, cell in enumerate(result.cells)}
    pairs = []
    for study in result.studies:
        question = question_of(result, study)
        for row in measure(result, study):
            if row.ratio is not None:
                baseline = baseline_of(row.cell, result.cells_of(study), question)
                numbers = [row.ratio.value, row.ratio.low, row.ratio.high]
                pairs.append([study.name, place[row.cell.name], place[baseline.name], *numbers, row.verdict.word])
    return pairs


def test_the_committed_verdicts_are_pythons():
    assert EXPECTED.read_text() == rows_by_file(RESULTS, _pairs), (
        "write it anew: PYTHONPATH=analysis python3 tests/analysis/test_run_verdicts.py"
    )


def test_every_verdict_is_among_them():
    words = {pair[-1] for pairs in json.loads(EXPECTED.read_text()).values() for pair in pairs}
    assert words >= {"FASTER", "SLOWER", "UNSURE"}


if __name__ == "__main__":
    EXPECTED.write_text(rows_by_file(RESULTS, _pairs))
