"""Limits that C++ and Python both judge by stand in one table, analysis/ptbench/io/limits.json, and nowhere else."""

import json
import re
from pathlib import Path

import pytest

from ptbench.io.limits import FILE, limit, limit_said

ROOT = Path(__file__).resolve().parents[2]
LIMITS = json.loads(FILE.read_text(encoding="utf-8"))
ROOMS = ("io", "stats", "studies", "compare", "convergence", "crosscheck", "report", "plots")
# Where samples are judged. A count (9 samples, 20 ms, 10,000 resamples) may be another thing's; a share may be, too,
# and then it stands in ELSE with what it is.
FILES = [
    *sorted((ROOT / "harness/bench").rglob("*.h")),
    *sorted((ROOT / "harness/bench").rglob("*.cpp")),
    *(ROOT / "harness/error" / f"same_mean.{ending}" for ending in ("h", "cpp")),
    *(file for room in ROOMS for file in (ROOT / "analysis/ptbench" / room).rglob("*.py")),
]
ELSE = {
    ("harness/bench/error_book.h", "0.05"): "of a cell's error that its reference may add",
    ("analysis/ptbench/stats/intervals.py", "0.01"): "the level of the test for outliers",
    ("analysis/ptbench/convergence/assessment.py", "0.01"): "the level of all verdicts on a file's errors",
    ("analysis/ptbench/convergence/assessment.py", "0.1"): "of an error, that a bias may hide in",
    ("analysis/ptbench/convergence/assessment.py", "0.9"): "a slope, below 0",
    ("analysis/ptbench/convergence/efficiency.py", "1e-3"): "of a squared error, to a plateau",
    ("analysis/ptbench/convergence/fit.py", "1e-3"): "of a mean, below which no logarithm is taken",
    ("analysis/ptbench/crosscheck/statistics.py", "0.01"): "the level of all tests of a call",
    ("analysis/ptbench/crosscheck/statistics.py", "0.9"): "the power of a test",
    ("harness/bench/take_sample.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/time_cells.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/decide.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/verify.cpp", "0.1"): "of a mean: how well it has to be known",
    ("harness/error/same_mean.cpp", "0.1"): "of a mean: how well it has to be known",
}
_NUMBER = re.compile(r"(?<![\w.])(?:\d+\.\d+(?:e-?\d+)?|\d+e-\d+)(?![\w.])")
_NAMED = re.compile(r"\b(fewest|minimum|least)\w*\s*(?::[^=]+)?=\s*(9|8|20|10_?000)\b", re.IGNORECASE)


def without_comments(file: Path) -> str:
    """The file without its docstrings and the lines that are comments."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".py":
        text = re.sub(r'"""(?s:.*?)"""', "", text)
    return re.sub(r"(?m)^\s*#.*" if file.suffix == ".py" else r"(?m)^\s*//.*", "", text)


def code_of(file: Path) -> str:
    """The file without its comments and texts."""
    text = re.sub(r'"(?:[^"\\\n]|\\.)*"', '""', without_comments(file))
    return re.sub(r"#.*" if file.suffix == ".py" else r"//.*", "", text)


def second_places(code: str) -> list[str]:
    """The numbers in it that are a limit's, as they are written."""
    shares = {entry["is"] for entry in LIMITS.values() if entry["is"] < 1}
    found = [number for number in _NUMBER.findall(code) if float(number) in shares]
    return found + [match[2] for match in _NAMED.finditer(code)]


def test_no_limit_stands_in_a_second_place():
    assert len(FILES) > 80
    found = {(file.relative_to(ROOT).as_posix(), number) for file in FILES for number in second_places(code_of(file))}
    assert found == set(ELSE)


@pytest.mark.parametrize(
    "line",
    [
        "constexpr double most_host_share = 0.02;",
        "MOST = 0.1",
        "if x > 1e-3 * y",
        "MINIMUM_SAMPLES = 9",
        "int fewest = 8;",
    ],
)
def test_a_second_place_is_found(line):
    assert second_places(line)


def test_what_is_none_is_left_alone():
    assert second_places("x = 0.5; y = 19; z = 0.025; MOST_SHOWN = 7; most = 90") == []


def test_a_limit_is_said_as_it_is():
    said = {name: entry["said"] for name, entry in LIMITS.items() if "said" in entry}
    assert said.keys() >= {"most_disturbed_share", "most_foreign_share"}
    shares = {"a tenth": 0.1, "a fifth": 0.2, "a twentieth": 0.05}
    for name, words in said.items():
        assert shares[words] == limit(name)
        assert limit_said(name) == words


def typed(text: str) -> list[str]:
    """The places in texts of code where a share of samples or of CPU time is typed instead of asked for."""
    return re.findall(r'"[^"\n]*\b(?:more than|over|at most) a (?:tenth|fifth|twentieth)\b[^"\n]*"', text)


def test_no_sentence_types_a_limit():
    assert typed('return "in more than a tenth of the samples";')
    assert typed('f"in more than {SAID} of the samples"') == []
    found = {(file.name, line) for file in FILES for line in typed(without_comments(file))}
    # The rule of a time to an error is about launches, and no limit is of those.
    assert {(name, line) for name, line in found if "a launch would be more than a twentieth" not in line} == set()


def test_every_limit_is_used_by_name():
    files = (file for room in ("harness", "analysis") for file in (ROOT / room).rglob("*.*"))
    code = "".join(file.read_text(encoding="utf-8") for file in files if file.suffix in (".py", ".cpp", ".h"))
    for name, entry in LIMITS.items():
        assert limit(name) == entry["is"]
        assert f"limits::{name}" in code or f'limit("{name}")' in code, name
