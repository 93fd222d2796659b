"""Limits that C++ and Python both judge by stand in one table, analysis/ptbench/io/limits.json, and nowhere else."""

import json
import re
from pathlib import Path

import pytest

from ptbench.io.limits import FILE, limit

ROOT = Path(__file__).resolve().parents[2]
LIMITS = json.loads(FILE.read_text(encoding="utf-8"))
# Where samples are judged. A count (9 samples, 20 ms, 10,000 resamples) may be another thing's; a share may be, too,
# and then it stands in ELSE with what it is.
FILES = [
    *sorted((ROOT / "harness/bench").rglob("*.h")),
    *sorted((ROOT / "harness/bench").rglob("*.cpp")),
    *(
        file
        for room in ("io", "stats", "studies", "compare")
        for file in (ROOT / "analysis/ptbench" / room).rglob("*.py")
    ),
]
ELSE = {
    ("harness/bench/error_book.h", "0.05"): "of a cell's error that its reference may add",
    ("analysis/ptbench/stats/intervals.py", "0.01"): "the level of a test",
    ("analysis/ptbench/compare/match.py", "1e-3"): "the level of a family of tests",
    ("harness/bench/take_sample.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/time_cells.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/decide.cpp", "1e-3"): "seconds in a millisecond",
    ("harness/bench/verify_statistical.h", "1e-3"): "the level of a family of tests",
    ("harness/bench/verify.cpp", "0.1"): "of a mean: how well it has to be known",
}
_NUMBER = re.compile(r"(?<![\w.])(?:\d+\.\d+(?:e-?\d+)?|\d+e-\d+)(?![\w.])")
_NAMED = re.compile(r"\b(fewest|minimum|least)\w*\s*(?::[^=]+)?=\s*(9|8|20|10_?000)\b", re.IGNORECASE)


def code_of(file: Path) -> str:
    """The file without its comments and texts."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".py":
        text = re.sub(r'"""(?s:.*?)"""', "", text)
    text = re.sub(r'"(?:[^"\\\n]|\\.)*"', '""', text)
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


def test_every_limit_is_used_by_name():
    files = (file for room in ("harness", "analysis") for file in (ROOT / room).rglob("*.*"))
    code = "".join(file.read_text(encoding="utf-8") for file in files if file.suffix in (".py", ".cpp", ".h"))
    for name, entry in LIMITS.items():
        assert limit(name) == entry["is"]
        assert f"limits::{name}" in code or f'limit("{name}")' in code, name
