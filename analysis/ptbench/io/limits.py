"""The limits that the program and this package both judge by: limits.json, of which CMake makes a header for C++."""

import json
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("limits.json")


@cache
def _limits() -> dict[str, dict]:
    return json.loads(FILE.read_text(encoding="utf-8"))


def limit(name: str) -> float | int:
    """The limit of that name; limits.json says what it is of."""
    return _limits()[name]["is"]


def limit_said(name: str) -> str:
    """The limit as sentences have it: "a tenth"."""
    return _limits()[name]["said"]
