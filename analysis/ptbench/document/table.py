"""Tables as values: one table becomes Markdown in a summary, text on a terminal and HTML in a report."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table of texts; `numeric` tells which columns hold numbers, for alignment and sorting."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: tuple[bool, ...]


def table_of(head: Sequence[str], rows: Iterable[Sequence[str]], numeric: Iterable[str] = ()) -> Table:
    """Makes a table; `numeric` names the columns that hold numbers."""
    names = set(numeric)
    return Table(tuple(head), tuple(tuple(row) for row in rows), tuple(name in names for name in head))
