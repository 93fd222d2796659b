"""The axes as the program has them: axes.json is what `build/ptbench list axes --json` prints.

A test holds the two equal, and `./run lists` writes the file.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("axes.json")


@dataclass(frozen=True)
class Axis:
    """One axis; variants/axis.h says what its members mean."""

    name: str
    what: str
    decides_error: bool
    decides_samples: bool
    since: str = ""  # the commit that brought it; empty: every result file has it
    as_before: str = ""  # what every variant was until then


@cache
def known_axes() -> dict[str, Axis]:
    """Every axis by its name, in the order in which a variant's name spells them."""
    return {facts["name"]: Axis(**facts) for facts in json.loads(FILE.read_text(encoding="utf-8"))}


def described(axis: Axis) -> str:
    """What a schema says of an axis."""
    text = f"{axis.what[0].upper()}{axis.what[1:]}."
    return f"{text} Since commit {axis.since}; before, `{axis.as_before}`." if axis.since else text


def schema_properties() -> dict[str, dict[str, str]]:
    """The choice on each axis as JSON Schema has it."""
    return {name: {"$ref": "#/$defs/choice", "description": described(axis)} for name, axis in known_axes().items()}
