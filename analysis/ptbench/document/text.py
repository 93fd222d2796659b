"""Documents as text for a terminal, with wrapped sentences and aligned tables."""

import textwrap
from collections.abc import Iterable

from ptbench.document.blocks import Block, Bullets, Section
from ptbench.document.table import Table
from ptbench.io.files import one_line

_WIDTH = 118  # characters per line on a terminal; tables may be wider


def as_text(sections: Iterable[Section]) -> str:
    """A document as terminal text, wrapped and aligned; ends with one line break."""
    return "\n\n".join("\n".join(_lines(section)) for section in sections) + "\n"


def _lines(section: Section) -> Iterable[str]:
    yield section.title
    for index, block in enumerate(section.blocks):
        # A document has no blank line between a heading and the sentences below it.
        if index or isinstance(block, Table):
            yield ""
        yield from _block(block)


def _block(block: Block) -> Iterable[str]:
    match block:
        case Bullets(items):
            return (line for item in items for line in _wrapped(item))
        case Table():
            return aligned(block)
    raise TypeError(f"no text for {type(block).__name__}")


def _wrapped(line: str) -> list[str]:
    return textwrap.wrap(line, _WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def aligned(table: Table) -> Iterable[str]:
    """The lines of a table with its columns padded to equal width."""
    rows = [table.head, *(tuple(map(one_line, row)) for row in table.rows)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(table.head))]
    for row in rows:
        parts = [
            text.rjust(width) if is_number else text.ljust(width)
            for text, width, is_number in zip(row, widths, table.numeric, strict=True)
        ]
        yield "  ".join(parts).rstrip()
