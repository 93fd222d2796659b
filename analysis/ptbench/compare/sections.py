"""A report of headings, lines and tables, as plain text for a terminal and as Markdown."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

from ptbench.io.files import one_line
from ptbench.tables import table_line

_WIDTH = 118  # of lines on a terminal; tables may be wider


@dataclass(frozen=True)
class Table:
    """Texts in rows; `numeric` names the columns that are numbers."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Section:
    """A heading, sentences, a table, and sentences after it."""

    heading: str
    lines: tuple[str, ...] = ()
    table: Table | None = None
    after: tuple[str, ...] = ()


def as_text(sections: Iterable[Section]) -> str:
    """The sections for a terminal, wrapped and aligned; ends with one line break."""
    blocks = []
    for section in sections:
        lines = [section.heading, *_wrapped(section.lines)]
        if section.table is not None:
            lines += ["", *_aligned(section.table)]
        if section.after:
            lines += ["", *_wrapped(section.after)]
        blocks.append("\n".join(lines))
    return "\n\n".join(blocks) + "\n"


def _wrapped(lines: Iterable[str]) -> Iterable[str]:
    for line in lines:
        yield from textwrap.wrap(line, _WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def as_markdown(title: str, sections: Iterable[Section]) -> str:
    """The sections as one page; ends with one line break."""
    lines = [f"# {title}", ""]
    for section in sections:
        lines += [f"## {section.heading}", ""]
        lines += [f"- {one_line(line)}" for line in section.lines] + ([""] if section.lines else [])
        if section.table is not None:
            lines += [*table_markdown(section.table), ""]
        lines += [f"- {one_line(line)}" for line in section.after] + ([""] if section.after else [])
    return "\n".join(lines).rstrip() + "\n"


def table_markdown(table: Table) -> list[str]:
    """The lines of a table."""
    sides = table_line("---:" if name in table.numeric else "---" for name in table.columns)
    return [table_line(table.columns), sides, *map(table_line, table.rows)]


def _aligned(table: Table) -> list[str]:
    rows = [table.columns, *(tuple(map(one_line, row)) for row in table.rows)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(table.columns))]
    aligned = []
    for row in rows:
        parts = [
            text.rjust(width) if name in table.numeric else text.ljust(width)
            for text, width, name in zip(row, widths, table.columns, strict=True)
        ]
        aligned.append("  ".join(parts).rstrip())
    return aligned
