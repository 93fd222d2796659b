"""Tables as values, so that one table is Markdown in a summary and HTML in a report."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ptbench.io.files import one_line


@dataclass(frozen=True)
class Table:
    """Texts in rows; `numeric` says by column which are numbers, for alignment and sorting."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: tuple[bool, ...]

    def markdown(self) -> list[str]:
        """The lines of the table."""
        sides = table_line("---:" if is_number else "---" for is_number in self.numeric)
        return [table_line(self.head), sides, *map(table_line, self.rows)]


def table_of(head: Sequence[str], rows: Iterable[Sequence[str]], numeric: Iterable[str] = ()) -> Table:
    """`numeric` names the columns that are numbers."""
    names = set(numeric)
    return Table(tuple(head), tuple(tuple(row) for row in rows), tuple(name in names for name in head))


# A section under way: lines of Markdown, and tables between them.
Lines = list["str | Table"]


def markdown(lines: Lines) -> str:
    """The page; ends with one line break."""
    texts = [text for line in lines for text in ([line] if isinstance(line, str) else line.markdown())]
    return "\n".join(texts).rstrip() + "\n"


def table_line(values: Iterable[str]) -> str:
    """A row of texts as one line of Markdown."""
    # A message from a compiler may hold anything; a pipe or a line break would end the table's cell.
    return "| " + " | ".join(one_line(value).replace("|", "\\|") for value in values) + " |"
