"""The axes of a variant as ptbench has them: axes.json is the output of `build/ptbench list axes --json`.

`./run lists` writes the file, and a test checks it. Every axis is a constant of this module with its name in capitals,
as in `from ptbench.io.axes import SORT_KEY`, which is "sort_key": a misspelled name cannot be imported.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("axes.json")


@dataclass(frozen=True)
class Axis:
    """An axis of a variant; variants/axis.h documents its fields."""

    name: str
    what: str
    decides_error: bool
    decides_samples: bool
    since: str = ""  # commit that introduced the axis; empty: every result file has it
    as_before: str = ""  # choice that files without the axis imply; may be empty


@cache
def known_axes() -> dict[str, Axis]:
    """Every axis by name, in the order in which variants' names list them."""
    return {facts["name"]: Axis(**facts) for facts in json.loads(FILE.read_text(encoding="utf-8"))}


def __getattr__(constant: str) -> str:
    """The name of an axis by its constant; Python calls this for names that the module does not define (PEP 562)."""
    name = constant.lower()
    if constant.isupper() and name in known_axes():
        return name
    raise AttributeError(f"{__name__}: found {constant}, allowed: the names of axes.json in capitals")


def described(axis: Axis) -> str:
    """The description of an axis in a schema."""
    text = f"{axis.what[0].upper()}{axis.what[1:]}."
    return f"{text} Since commit {axis.since}; before, `{axis.as_before}`." if axis.since else text


def schema_properties() -> dict[str, dict[str, str]]:
    """The JSON Schema properties for the choice on each axis."""
    return {name: {"$ref": "#/$defs/choice", "description": described(axis)} for name, axis in known_axes().items()}
