"""The blocks that a document consists of. Their texts may contain `code` and **bold**, and no other markup.

Reports contain texts of result files, which the writers of the output formats escape.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from ptbench.document.table import Table


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of a document."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A bullet list of a document."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Facts:
    """A list of names, each with its value."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Folded:
    """A table that unfolds on a click, so that long ones do not bury what follows; open in print."""

    label: str
    table: Table


@dataclass(frozen=True)
class Image:
    """A figure's file: `name` with extension, `alt` text for readers who cannot see it. Sizes in CSS pixels.

    `narrow` is the figure drawn for a narrow screen; a page shows one of the two drawings.
    """

    name: str
    data: bytes
    alt: str
    width: int
    height: int
    narrow: Image | None = None

    @property
    def media_type(self) -> str:
        """The image's media type as in HTTP."""
        return {"svg": "image/svg+xml", "png": "image/png", "jpg": "image/jpeg"}[self.name.rpartition(".")[2]]


@dataclass(frozen=True)
class Pictures:
    """Small images in rows, each with a caption."""

    items: tuple[tuple[Image, str], ...]


@dataclass(frozen=True)
class Download:
    """A downloadable table of raw rows: gzip-compressed CSV, named without ".gz"; `about` says what a row is."""

    name: str
    compressed: bytes
    rows: int
    about: str


@dataclass(frozen=True)
class Heading:
    """A heading within a section."""

    text: str


Block = Paragraph | Bullets | Facts | Table | Folded | Image | Pictures | Download | Heading


@dataclass(frozen=True)
class Section:
    """A section with its title. `anchor` is unique in the page: letters, digits, hyphens; empty: no links."""

    title: str
    anchor: str = ""
    blocks: tuple[Block, ...] = ()
    children: tuple[Section, ...] = field(default=())

    @property
    def table(self) -> Table | None:
        """The first table of the section; None if there is no table."""
        return next((block for block in self.blocks if isinstance(block, Table)), None)


def section(title: str, lines: Sequence[str] = (), table: Table | None = None, after: Sequence[str] = ()) -> Section:
    """Makes a section of bulleted sentences, a table, and bulleted sentences after it."""
    blocks = (Bullets(tuple(lines)) if lines else None, table, Bullets(tuple(after)) if after else None)
    return Section(title, blocks=tuple(block for block in blocks if block is not None))


# A summary that is being written: lines of Markdown, with tables between them.
Lines = list["str | Table"]


def anchor_of(*parts: str) -> str:
    """The anchor of a place in a page, made of the words in `parts`."""
    return "-".join(re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") or "x" for part in parts)


LONG_TABLE = 12  # most rows of a table that is shown unfolded


def shown_table(table: Table, label: str, *, fold: bool = False) -> Table | Folded | Facts:
    """A table as a block: folded under `label` if long or with `fold`; a single row becomes a list of facts."""
    count = len(table.rows)
    if fold or count > LONG_TABLE:
        return Folded(f"{label}, {count} row{'' if count == 1 else 's'}", table)
    return Facts(tuple(zip(table.head, table.rows[0], strict=True))) if count == 1 else table


def blocks_of(lines: Lines, label: str, *, skip_heading: bool = True, fold: bool = False) -> list[Block]:
    """A section of a summary as blocks: paragraphs, lists, headings and tables; `fold` folds all tables.

    The section's own heading is left out with `skip_heading`.
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
