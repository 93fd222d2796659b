"""JSON values that know where they stand, so that every complaint about a file names the file and the place."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.files import LARGEST_RESULT, read_stored


def shown(value: object, *, whole: bool = False) -> str:
    """A JSON value as a short piece of one line, or as a long one."""
    text = json.dumps(value, ensure_ascii=False)
    return text if whole or len(text) <= 60 else text[:57] + "..."


class Node:
    """A JSON value that knows its file and its place, so that every complaint can name both."""

    __slots__ = ("_key", "_place", "file", "value")

    def __init__(self, file: Path, value: object, place: str | Node = "$", key: str | int = ""):
        """`place`: as it is to be told; or the object or the array that has the value at `key`."""
        # Almost no place is ever told, and there are millions: a text is made where one is.
        self.file, self.value, self._place, self._key = file, value, place, key

    @property
    def place(self) -> str:
        """The JSON path, "$.benchmarks[3].name"."""
        if isinstance(self._place, Node):
            key = f"[{self._key}]" if isinstance(self._key, int) else f".{self._key}"
            self._place = self._place.place + key
        return self._place

    def wrong(self, allowed: str) -> InputError:
        """The error that says what was found here and what is `allowed`."""
        return bad_value(self.file, self.place, shown(self.value), allowed)

    def need(self, key: str) -> Node:
        """The value of a key; raises InputError where there is none."""
        fields = self.fields()
        if key not in fields:
            raise bad_value(self.file, f"{self.place}.{key}", "nothing", "this key is required")
        return Node(self.file, fields[key], self, key)

    def maybe(self, key: str) -> Node | None:
        """The value of a key; None where there is none or null."""
        value = self.fields().get(key)
        return None if value is None else Node(self.file, value, self, key)

    def fields(self) -> dict:
        """The object; raises InputError for anything else."""
        if not isinstance(self.value, dict):
            raise self.wrong("an object")
        return self.value

    def items(self) -> Iterator[Node]:
        """The array's values; raises InputError for anything else."""
        if not isinstance(self.value, list):
            raise self.wrong("an array")
        return (Node(self.file, item, self, index) for index, item in enumerate(self.value))

    def text(self) -> str:
        """The string; raises InputError for anything else."""
        if not isinstance(self.value, str):
            raise self.wrong("a string")
        return self.value

    def name(self) -> str:
        """The string that is not empty; raises InputError for anything else."""
        if not self.text():
            raise self.wrong("a string that is not empty")
        return self.text()

    def one_of(self, choices: tuple[str, ...]) -> str:
        """The value, which is one of `choices`; raises InputError for anything else."""
        if self.value not in choices:
            raise self.wrong(" or ".join(shown(choice) for choice in choices))
        return self.value

    def number(self, *, above_zero: bool = False, signed: bool = False) -> float:
        """The finite number, of at least 0 unless `signed`; raises InputError for anything else."""
        allowed = "a finite number" + ("" if signed else " above 0" if above_zero else " of at least 0")
        value = self._finite(allowed)
        if (value < 0 and not signed) or (above_zero and value == 0):
            raise self.wrong(allowed)
        return value

    def integer(self, minimum: int = 0) -> int:
        """The integer of at least `minimum`; raises InputError for anything else."""
        # Google Benchmark writes every counter as a double: 4.0 is the integer 4.
        allowed = f"an integer of at least {minimum}"
        value = self._finite(allowed)
        if value != int(value) or value < minimum:
            raise self.wrong(allowed)
        # A seed of 64 bits is more than a double holds.
        return self.value if isinstance(self.value, int) else int(value)

    def _finite(self, allowed: str) -> float:
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            raise self.wrong(allowed)
        try:
            value = float(self.value)
        except OverflowError:  # an integer of hundreds of digits
            value = math.inf
        if not math.isfinite(value):
            raise self.wrong(allowed)
        return value

    def texts(self) -> dict[str, str]:
        """The object's strings by key; raises InputError for anything else."""
        return {key: Node(self.file, value, self, key).text() for key, value in self.fields().items()}

    def integers(self) -> dict[str, int]:
        """The object's integers by key; raises InputError for anything else."""
        return {key: Node(self.file, value, self, key).integer() for key, value in self.fields().items()}

    def optional_numbers(self, key: str) -> dict[str, float]:
        """The numbers of at least 0 of the key's object, by their keys; empty where there is none."""
        node = self.maybe(key)
        return {} if node is None else {name: node.need(name).number() for name in node.fields()}

    def optional_text(self, key: str, default: str = "") -> str:
        """The key's string, or `default`; raises InputError for anything else."""
        node = self.maybe(key)
        return default if node is None else node.text()

    def optional_integer(self, key: str) -> int | None:
        """The key's integer, or None; raises InputError for anything else."""
        node = self.maybe(key)
        return None if node is None else node.integer()

    def optional_number(self, key: str) -> float | None:
        """The key's number of at least 0, or None; raises InputError for anything else."""
        node = self.maybe(key)
        return None if node is None else node.number()


def read_json(path: Path, largest: int = LARGEST_RESULT) -> Node:
    """Parses strictly: Python's parser takes NaN, Infinity, halves of characters, and of a key's values the last.

    FILE.json.gz is read for FILE.json (read_stored).
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
    """What an object is read as that has a key twice."""

    def __init__(self, key: str):
        self.key = key


def parse(text: str, refuse: Callable[[str], object]) -> tuple[object, tuple[str, str, str] | None]:
    """(the JSON value, where an object has a key twice, what was found there and what is allowed; or None)."""
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


# Matches an escape of half a character; whole characters have two in a row.
_HALF_ESCAPED = re.compile(r"\\u[dD][89a-fA-F]")


def _half_of_a_character(value: object) -> str:
    """The first half of a character in the value's strings, escaped; empty: there is none."""
    try:
        json.dumps(value, ensure_ascii=False).encode("utf-8")
    except UnicodeEncodeError as error:
        return f"\\u{ord(error.object[error.start]):04x}"
    return ""
