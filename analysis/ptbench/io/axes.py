"""The axes as the program has them: axes.json is what `build/ptbench list axes --json` prints.

A test holds the two equal. `python -m ptbench.io.axes` writes what the schema of result files says of axes anew.
"""

import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FILE = Path(__file__).with_name("axes.json")
SCHEMA = Path(__file__).parents[1] / "schema" / "ptbench-common.schema.json"


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


def write_schema() -> None:
    """Writes the axes into the schema that others refer to, a line each."""
    lines = [f"        {json.dumps(name)}: {json.dumps(value)}" for name, value in schema_properties().items()]
    text = SCHEMA.read_text(encoding="utf-8")
    properties = re.compile(r'(?<=\n    "axes": \{\n)(.*?"properties": \{\n).*?(\n      \},\n)', re.DOTALL)
    changed = properties.sub(lambda found: found[1] + ",\n".join(lines) + found[2], text, count=1)
    SCHEMA.write_text(changed, encoding="utf-8")


if __name__ == "__main__":
    write_schema()
