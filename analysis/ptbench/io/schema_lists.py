"""The lists of the schema that files share, which follow from what the program says: its axes and its features.

`./run lists` has the program write axes.json and features.json, and then calls `python -m ptbench.io.schema_lists`.
"""

import json
import re
from pathlib import Path

from ptbench.io.axes import schema_properties

SCHEMA = Path(__file__).parents[1] / "schema" / "ptbench-common.schema.json"
FEATURES = Path(__file__).with_name("features.json")  # what `build/ptbench list features --json` prints
FORMER_FEATURES = ("room",)  # names that only files of earlier programs have


def schema_features() -> list[str]:
    """The names that a feature may have in a file: those of the program, then those of earlier ones."""
    return [*json.loads(FEATURES.read_text(encoding="utf-8")), *FORMER_FEATURES]


def write_schema() -> None:
    """Writes the axes, a line each, and the features into the schema that others refer to."""
    axes = ",\n".join(f"        {json.dumps(key)}: {json.dumps(value)}" for key, value in schema_properties().items())
    text = SCHEMA.read_text(encoding="utf-8")
    text = _put(text, r'\n    "axes": \{\n.*?"properties": \{\n', axes, r"\n      \},\n")
    text = _put(text, r'\n    "feature": \{\n      "enum": ', json.dumps(schema_features()), r",\n")
    SCHEMA.write_text(text, encoding="utf-8")


def _put(text: str, before: str, part: str, behind: str) -> str:
    """`text` with `part` between the first two places that look like `before` and `behind`."""
    place = re.compile(f"({before}).*?({behind})", re.DOTALL)
    return place.sub(lambda found: found[1] + part + found[2], text, count=1)


if __name__ == "__main__":
    write_schema()
