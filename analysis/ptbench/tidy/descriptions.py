"""Descriptions of the columns in tables of result files: for Parquet, and as the page docs/columns.md.

The page is written by `python3 -m ptbench.tidy.descriptions > docs/columns.md`.
"""

import sys

from ptbench.tidy.columns import CATEGORY, COLUMNS, FLAG, FROM_FILES, GROUPS, INTEGER, NUMBER, TEXT

_TYPES = {CATEGORY: "text", TEXT: "text", INTEGER: "whole number", NUMBER: "number", FLAG: "true, false"}
_HEAD = """# Every column of flat tables

Written by `python3 -m ptbench.tidy.descriptions` from the package's own tables; [results.md](results.md) is the guide.
The same tables are the data frames of `ptbench.frames`. A value that a file does not have is empty in CSV and null in
Parquet.
"""


def meaning_of(column: str) -> str:
    """The meaning of a column, including columns that are named by the files."""
    if column in COLUMNS:
        return COLUMNS[column][1]
    for stands_for, prefix in FROM_FILES.items():
        if prefix and column.startswith(prefix):
            return f"{column.removeprefix(prefix)}: {COLUMNS[stands_for][1]}"
    return "the variant's choice on this axis"


def page() -> str:
    """The page on all tables and columns, as Markdown."""
    parts = [_HEAD]
    for table, groups in GROUPS.items():
        columns = {name: kind for group in groups for name, kind in group.items()}
        lines = [f"| {_shown(name)} | {_TYPES[kind]} | {COLUMNS[name][1]} |\n" for name, kind in columns.items()]
        parts += [f"\n## {table}\n\n| column | type | meaning |\n|---|---|---|\n", *lines]
    return "".join(parts)


def _shown(name: str) -> str:
    if name not in FROM_FILES:
        return f"`{name}`"
    return f"`{FROM_FILES[name]}NAME`" if FROM_FILES[name] else "an axis"


if __name__ == "__main__":
    sys.stdout.write(page())
