"""Limits shared by the C++ program and this package: limits.json, from which CMake generates a C++ header."""

import json
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("limits.json")


@cache
def _limits() -> dict[str, dict]:
    return json.loads(FILE.read_text(encoding="utf-8"))


def limit(name: str) -> float | int:
    """The value of a limit; limits.json documents each by name."""
    return _limits()[name]["is"]


def limit_said(name: str) -> str:
    """The limit as a phrase, such as "a tenth"."""
    return _limits()[name]["said"]
