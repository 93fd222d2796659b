"""JSON values that know their file and path, so that every error message can name both."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.files import LARGEST_RESULT, read_stored


def shown(value: object, *, whole: bool = False) -> str:
    """A JSON value as one line of text, abbreviated unless `whole`."""
    text = json.dumps(value, ensure_ascii=False)
    return text if whole or len(text) <= 60 else text[:57] + "..."


class Node:
    """A JSON value with its file and path, for error messages."""

    __slots__ = ("_key", "_place", "file", "value")

    def __init__(self, file: Path, value: object, place: str | Node = "$", key: str | int = ""):
        """Makes a node; `place` is its JSON path, or the node of the object or array that contains it at `key`."""
        # A JSON path is computed only when needed: there are millions of nodes, and few appear in messages.
        self.file, self.value, self._place, self._key = file, value, place, key

    @property
    def place(self) -> str:
        """The JSON path of the value, such as "$.benchmarks[3].name"."""
        if isinstance(self._place, Node):
            key = f"[{self._key}]" if isinstance(self._key, int) else f".{self._key}"
            self._place = self._place.place + key
        return self._place

    def wrong(self, allowed: str) -> InputError:
        """The error for a bad value, with what was found and what is `allowed`."""
        return bad_value(self.file, self.place, shown(self.value), allowed)

    def need(self, key: str) -> Node:
        """The node of a required key; raises InputError if the key is missing."""
        fields = self.fields()
        if key not in fields:
            raise bad_value(self.file, f"{self.place}.{key}", "nothing", "this key is required")
        return Node(self.file, fields[key], self, key)

    def maybe(self, key: str) -> Node | None:
        """The node of an optional key; None where it is missing or null."""
        value = self.fields().get(key)
        return None if value is None else Node(self.file, value, self, key)

    def fields(self) -> dict:
        """The value as an object; raises InputError for anything else."""
        if not isinstance(self.value, dict):
            raise self.wrong("an object")
        return self.value

    def items(self) -> Iterator[Node]:
        """The nodes of an array; raises InputError for anything else."""
        if not isinstance(self.value, list):
            raise self.wrong("an array")
        return (Node(self.file, item, self, index) for index, item in enumerate(self.value))

    def text(self) -> str:
        """The value as a string; raises InputError for anything else."""
        if not isinstance(self.value, str):
            raise self.wrong("a string")
        return self.value

    def name(self) -> str:
        """The value as a non-empty string; raises InputError for anything else."""
        if not self.text():
            raise self.wrong("a string that is not empty")
        return self.text()

    def one_of(self, choices: tuple[str, ...]) -> str:
        """The value if it is among `choices`; raises InputError for anything else."""
        if self.value not in choices:
            raise self.wrong(" or ".join(shown(choice) for choice in choices))
        return self.value

    def number(self, *, above_zero: bool = False, signed: bool = False) -> float:
        """The value as a finite number, at least 0 unless `signed`; raises InputError for anything else."""
        allowed = "a finite number" + ("" if signed else " above 0" if above_zero else " of at least 0")
        value = self._finite(allowed)
        if (value < 0 and not signed) or (above_zero and value == 0):
            raise self.wrong(allowed)
        return value

    def integer(self, minimum: int = 0) -> int:
        """The value as an integer of at least `minimum`; raises InputError for anything else."""
        # Google Benchmark writes every counter as a double, so that 4.0 counts as the integer 4.
        allowed = f"an integer of at least {minimum}"
        value = self._finite(allowed)
        if value != int(value) or value < minimum:
            raise self.wrong(allowed)
        # An integer is kept as it is, because a 64-bit seed exceeds a double's precision.
        return self.value if isinstance(self.value, int) else int(value)

    def _finite(self, allowed: str) -> float:
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            raise self.wrong(allowed)
        try:
            value = float(self.value)
        except OverflowError:  # an integer of hundreds of digits exceeds the range of a double
            value = math.inf
        if not math.isfinite(value):
            raise self.wrong(allowed)
        return value

    def texts(self) -> dict[str, str]:
        """The value as an object of strings, by key; raises InputError for anything else."""
        return {key: Node(self.file, value, self, key).text() for key, value in self.fields().items()}

    def integers(self) -> dict[str, int]:
        """The value as an object of integers, by key; raises InputError for anything else."""
        return {key: Node(self.file, value, self, key).integer() for key, value in self.fields().items()}

    def optional_numbers(self, key: str) -> dict[str, float]:
        """The numbers of at least 0 in an optional key's object, by their keys; empty where the key is missing."""
        node = self.maybe(key)
        return {} if node is None else {name: node.need(name).number() for name in node.fields()}

    def optional_text(self, key: str, default: str = "") -> str:
        """The string of an optional key, or `default`; raises InputError for anything else."""
        node = self.maybe(key)
        return default if node is None else node.text()

    def optional_integer(self, key: str) -> int | None:
        """The integer of an optional key, or None; raises InputError for anything else."""
        node = self.maybe(key)
        return None if node is None else node.integer()

    def optional_number(self, key: str) -> float | None:
        """The number of at least 0 of an optional key, or None; raises InputError for anything else."""
        node = self.maybe(key)
        return None if node is None else node.number()


def read_json(path: Path, largest: int = LARGEST_RESULT) -> Node:
    """Parses JSON strictly: NaN, Infinity, lone surrogates and duplicate keys are errors, unlike in Python's parser.

    For FILE.json, FILE.json.gz is read where only that exists (`read_stored`).
    """

    def refuse(constant: str) -> None:
        raise bad_value(path, "a value", constant, "finite numbers only")

    try:
        path, data = read_stored(path, largest)
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise bad_value(path, f"byte {error.start}", "bytes that are not UTF-8", "JSON in UTF-8") from error
    try:
        value, key_twice = parse(text, refuse)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno} column {error.colno}"
        raise bad_value(path, place, f"no valid JSON ({error.msg})", "one complete JSON value") from error
    except (RecursionError, ValueError) as error:
        raise bad_value(path, "the file", "JSON nested too deeply or a number too long", "plain JSON") from error
    if key_twice is not None:
        raise bad_value(path, *key_twice)
    if _HALF_ESCAPED.search(text) and (half := _half_of_a_character(value)):
        raise bad_value(path, "a string", f"half of a character ({half})", "whole characters")
    return Node(path, value)


class _Ambiguous:
    """The placeholder that an object with a duplicate key is parsed to."""

    def __init__(self, key: str):
        self.key = key


def parse(text: str, refuse: Callable[[str], object]) -> tuple[object, tuple[str, str, str] | None]:
    """Parses JSON: (the value, and for a duplicate key its place, what was found and what is allowed, else None)."""
    ambiguous = []

    def object_of(members: list[tuple[str, object]]) -> object:
        value = dict(members)
        if len(value) == len(members):
            return value
        keys = [key for key, _ in members]
        ambiguous.append(_Ambiguous(next(key for key in keys if keys.count(key) > 1)))
        return ambiguous[-1]

    value = json.loads(text, parse_constant=refuse, object_pairs_hook=object_of)
    return value, _key_twice(value, "$") if ambiguous else None


def _key_twice(value: object, place: str) -> tuple[str, str, str] | None:
    if isinstance(value, _Ambiguous):
        return place, f"the key {shown(value.key)} twice", "once"
    if isinstance(value, dict):
        items = ((f"{place}.{key}", item) for key, item in value.items())
    elif isinstance(value, list):
        items = ((f"{place}[{index}]", item) for index, item in enumerate(value))
    else:
        return None
    return next((found for where, item in items if (found := _key_twice(item, where)) is not None), None)


# Matches one half of a surrogate pair written as an escape, "\ud800" to "\udfff"; valid halves come in pairs.
_HALF_ESCAPED = re.compile(r"\\u[dD][89a-fA-F]")


def _half_of_a_character(value: object) -> str:
    """The first lone surrogate in the strings of a value, escaped; empty: there is none."""
    try:
        json.dumps(value, ensure_ascii=False).encode("utf-8")
    except UnicodeEncodeError as error:
        return f"\\u{ord(error.object[error.start]):04x}"
    return ""
