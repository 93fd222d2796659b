"""Generates the parts of the common schema that list ptbench's axes and scene features.

`./run lists` lets the program write axes.json and features.json, and then calls `python -m ptbench.io.schema_lists`.
"""

import json
import re
from pathlib import Path

from ptbench.io.axes import schema_properties

SCHEMA = Path(__file__).parents[1] / "schema" / "ptbench-common.schema.json"
FEATURES = Path(__file__).with_name("features.json")  # output of `build/ptbench list features --json`
FORMER_FEATURES = ("room",)  # feature names that occur only in files of earlier programs


def schema_features() -> list[str]:
    """All feature names that a file may contain: the program's, then those of earlier programs."""
    return [*json.loads(FEATURES.read_text(encoding="utf-8")), *FORMER_FEATURES]


def write_schema() -> None:
    """Writes the axes, one per line, and the features into the common schema."""
    axes = ",\n".join(f"        {json.dumps(key)}: {json.dumps(value)}" for key, value in schema_properties().items())
    text = SCHEMA.read_text(encoding="utf-8")
    text = _put(text, r'\n    "axes": \{\n.*?"properties": \{\n', axes, r"\n      \},\n")
    text = _put(text, r'\n    "feature": \{\n      "enum": ', json.dumps(schema_features()), r",\n")
    SCHEMA.write_text(text, encoding="utf-8")


def _put(text: str, before: str, part: str, behind: str) -> str:
    """Replaces what stands between the first matches of `before` and `behind` in `text` with `part`."""
    place = re.compile(f"({before}).*?({behind})", re.DOTALL)
    return place.sub(lambda found: found[1] + part + found[2], text, count=1)


if __name__ == "__main__":
    write_schema()
