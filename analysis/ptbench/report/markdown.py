"""A report as Markdown, with its figures, pictures and raw rows as files beside it."""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

from ptbench.io.files import make_folder, one_line, write_whole
from ptbench.report.blocks import Block, Bullets, Download, Facts, Folded, Heading, Image, Paragraph, Pictures, Section
from ptbench.tables import Table

FIGURES, SCENES, DATA = "figures", "scenes", "data"
_CODE = re.compile(r"(`[^`]+`)")


def markdown_page(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """The whole page, whose images lie beside it."""
    lines = [f"# {_text(title)}", "", _text(subtitle), "", "## Contents", "", *_contents(sections, ""), ""]
    for section in sections:
        lines += _section(section, 2)
    return "\n".join(lines).rstrip() + "\n"


def linked_files(folder: Path, sections: Sequence[Section]) -> Iterator[tuple[Path, bytes]]:
    """What the Markdown page links to."""
    for block in _blocks(sections):
        if isinstance(block, Image):
            yield folder / FIGURES / block.name, block.data
        elif isinstance(block, Pictures):
            for image, _ in block.items:
                yield folder / SCENES / image.name, image.data
        elif isinstance(block, Download):
            yield folder / DATA / block.name, gzip.decompress(block.compressed)


def write_files(files: Sequence[tuple[Path, bytes]]) -> None:
    """Each whole, in a folder that is made for it."""
    for target, data in files:
        make_folder(target.parent)
        write_whole(target, lambda path, data=data: path.write_bytes(data) and None)


def _blocks(sections: Sequence[Section]) -> Iterator[Block]:
    for section in sections:
        yield from section.blocks
        yield from _blocks(section.children)


def _text(text: str) -> str:
    """Marks of HTML are text here, but in code, where nothing is a mark. One line: a line break may begin a heading."""
    parts = _CODE.split(one_line(text))
    return "".join(part if part.startswith("`") else part.replace("&", "&amp;").replace("<", "&lt;") for part in parts)


def _contents(sections: Sequence[Section], indent: str) -> list[str]:
    lines = []
    for section in sections:
        lines.append(f"{indent}- [{_label(section.title)}](#{section.anchor})")
        lines += _contents(section.children, indent + "  ")
    return lines


def _label(text: str) -> str:
    return re.sub(r"([\[\]\\])", r"\\\1", _text(text))


def _section(section: Section, level: int) -> list[str]:
    # Renderers make anchors of headings each in its own way, and titles repeat: these are ours.
    lines = [f'<a id="{section.anchor}"></a>', "", f"{'#' * level} {_text(section.title)}", ""]
    for block in section.blocks:
        lines += [*_block(block, level + 1), ""]
    for child in section.children:
        lines += _section(child, level + 1)
    return lines


def _block(block: Block, level: int) -> list[str]:
    match block:
        case Paragraph(text):
            return [_text(text)]
        case Bullets(items):
            return [f"- {_text(item)}" for item in items]
        case Facts(rows):
            return [f"- {name}: {_text(text)}" for name, text in rows]
        case Heading(text):
            return [f"{'#' * min(level, 6)} {_text(text)}"]
        case Table():
            return _table(block)
        case Folded(label, table):
            return [
                f"<details><summary>{_text(label).replace('`', '')}</summary>",
                "",
                *_table(table),
                "",
                "</details>",
            ]
        case Image():
            return [_image(block, FIGURES)]
        case Pictures(items):
            return [line for image, text in items for line in (_image(image, SCENES), "", _text(text), "")][:-1]
        case Download():
            file = f"{DATA}/{block.name}"
            return [f"- [{block.name}]({quote(file)}): {block.rows} rows, one {block.about}"]
    raise TypeError(f"no Markdown for {type(block).__name__}")


def _table(table: Table) -> list[str]:
    rows = tuple(tuple(_text(cell) for cell in row) for row in table.rows)
    return Table(table.head, rows, table.numeric).markdown()


def _image(image: Image, folder: str) -> str:
    # The caption is in the figure; its title is enough here.
    title = image.alt.partition(". ")[0]
    return f"![{_label(title)}]({quote(f'{folder}/{image.name}')})"
