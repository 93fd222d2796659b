"""What a document is made of. Texts may hold `code` and **bold**, nothing else.

Reports have files' own texts, which their writers escape.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from ptbench.document.table import Table


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of text."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of texts."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Facts:
    """Names and what is said of them."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Folded:
    """A table under a line that opens it: long ones would bury what follows. In print it is open."""

    label: str
    table: Table


@dataclass(frozen=True)
class Image:
    """A figure's file: `name` has its ending, `alt` says what is to be seen. Sizes in CSS pixels.

    `narrow` is the same drawn for a narrow screen, which a page with room for the other does not show.
    """

    name: str
    data: bytes
    alt: str
    width: int
    height: int
    narrow: Image | None = None

    @property
    def media_type(self) -> str:
        """As HTTP calls it."""
        return {"svg": "image/svg+xml", "png": "image/png", "jpg": "image/jpeg"}[self.name.rpartition(".")[2]]


@dataclass(frozen=True)
class Pictures:
    """Small images in rows, each with its caption."""

    items: tuple[tuple[Image, str], ...]


@dataclass(frozen=True)
class Download:
    """A table of raw rows: gzip-compressed CSV, named without ".gz"; `about` says what a row is."""

    name: str
    compressed: bytes
    rows: int
    about: str


@dataclass(frozen=True)
class Heading:
    """Within a section."""

    text: str


Block = Paragraph | Bullets | Facts | Table | Folded | Image | Pictures | Download | Heading


@dataclass(frozen=True)
class Section:
    """`anchor`, which links lead to, is unique in the page: letters, digits, hyphens; empty: there are no links."""

    title: str
    anchor: str = ""
    blocks: tuple[Block, ...] = ()
    children: tuple[Section, ...] = field(default=())

    @property
    def table(self) -> Table | None:
        """The first table of the section; None: it has none."""
        return next((block for block in self.blocks if isinstance(block, Table)), None)


def section(title: str, lines: Sequence[str] = (), table: Table | None = None, after: Sequence[str] = ()) -> Section:
    """Sentences, a table, and sentences after it."""
    blocks = (Bullets(tuple(lines)) if lines else None, table, Bullets(tuple(after)) if after else None)
    return Section(title, blocks=tuple(block for block in blocks if block is not None))


# A summary under way: lines of Markdown, and tables between them.
Lines = list["str | Table"]


def anchor_of(*parts: str) -> str:
    """The place in the page that a link leads to."""
    return "-".join(re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") or "x" for part in parts)


LONG_TABLE = 12  # rows; a longer one is folded


def shown_table(table: Table, label: str, *, fold: bool = False) -> Table | Folded | Facts:
    """The table, folded under `label` where it is long or with `fold`; of one row, its names and values."""
    count = len(table.rows)
    if fold or count > LONG_TABLE:
        return Folded(f"{label}, {count} row{'' if count == 1 else 's'}", table)
    return Facts(tuple(zip(table.head, table.rows[0], strict=True))) if count == 1 else table


def blocks_of(lines: Lines, label: str, *, skip_heading: bool = True, fold: bool = False) -> list[Block]:
    """A summary's section as blocks: its paragraphs, lists, headings and tables, which `fold` folds whatever they hold.

    Its own heading is left out.
    """
    blocks: list[Block] = []
    bullets: list[str] = []
    name = label
    for line in [*lines, ""]:
        if isinstance(line, str) and line.startswith("- "):
            bullets.append(line[2:])
            continue
        if bullets:
            blocks.append(Bullets(tuple(bullets)))
            bullets = []
        if isinstance(line, Table):
            blocks.append(shown_table(line, name, fold=fold))
        elif line.startswith("## ") and skip_heading:
            continue
        elif line.startswith("#"):
            name = line.lstrip("#").strip()
            blocks.append(Heading(name))
        elif line:
            blocks += [Paragraph(text) for text in line.split("\n\n")]
    return blocks
