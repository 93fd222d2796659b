"""The errors at the end of `ptbench run` are those of the pages: both are held to tests/support/run_errors.json.

tests/unit/comparisons_test.cpp holds the program's C++ to the same file. `python3 tests/analysis/test_run_errors.py`
(with PYTHONPATH=analysis) writes it anew where the rule or the results have changed.
"""

import json
from pathlib import Path

from conftest import COMMITTED, rows_by_file

from ptbench.convergence.assessment import assess
from ptbench.convergence.efficiency import baseline_among, by_place
from ptbench.convergence.last_errors import ERRORS, last_errors
from ptbench.io.results import load_kept

ROOT = Path(__file__).parents[2]
EXPECTED = ROOT / "tests/support/run_errors.json"
RESULTS = ["results/amd-epyc-2-threads/convergence.json"]


def _rows(file):
    """Study, a cell's place in the file and its baseline's; of each metric the mean error and the efficiency."""
    result = load_kept(COMMITTED / file)
    place = {cell.name: index for index, cell in enumerate(result.cells)}
    assessed = assess(result)
    rows = []
    for study in result.studies:
        members = [assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed]
        for group in by_place(members).values():
            baseline = baseline_among(result, group)
            errors = last_errors(group)
            for one in group:
                own, base = errors[one.cell.name], errors[baseline.cell.name]
                row = [study.name, place[one.cell.name], place[baseline.cell.name]]
                for metric in ERRORS:
                    efficiency = own.efficiency(base, metric) if one is not baseline else None
                    told = [efficiency.value, efficiency.low, efficiency.high] if efficiency else [None] * 3
                    row += [own.mean(metric), *told]
                rows.append(row)
    return rows


def test_the_committed_errors_are_pythons():
    assert EXPECTED.read_text() == rows_by_file(RESULTS, _rows), (
        "write it anew: PYTHONPATH=analysis python3 tests/analysis/test_run_errors.py"
    )


def test_one_metric_may_prefer_what_the_other_does_not():
    rows = [row for rows in json.loads(EXPECTED.read_text()).values() for row in rows if row[4] and row[8]]
    assert any(row[4] > 2 * row[8] or row[8] > 2 * row[4] for row in rows)


if __name__ == "__main__":
    EXPECTED.write_text(rows_by_file(RESULTS, _rows))
