"""Documents as Markdown; figures, pictures and raw rows of a report become files beside the page."""

import gzip
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

from ptbench.document.blocks import (
    Block,
    Bullets,
    Download,
    Facts,
    Folded,
    Heading,
    Image,
    Lines,
    Paragraph,
    Pictures,
    Section,
)
from ptbench.document.table import Table
from ptbench.io.files import make_folder, one_line, write_whole

FIGURES, SCENES, DATA = "figures", "scenes", "data"
_CODE = re.compile(r"(`[^`]+`)")


# A function that turns plain text into Markdown: `one_line` for texts of ptbench, `escaped` for texts out of files.
Written = Callable[[str], str]


def markdown_page(title: str, sections: Iterable[Section]) -> str:
    """A Markdown page of our own texts, which need no escaping; ends with one line break."""
    return _joined([f"# {title}", "", *_sections(sections, 2, one_line)])


def markdown(lines: Lines) -> str:
    """A summary as Markdown; ends with one line break."""
    return _joined([text for line in lines for text in ([line] if isinstance(line, str) else table_lines(line))])


def report_page(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """A report as Markdown, with escaped texts, a table of contents and images in files beside the page."""
    lines = [f"# {escaped(title)}", "", escaped(subtitle), "", "## Contents", "", *_contents(sections, ""), ""]
    return _joined([*lines, *_sections(sections, 2, escaped)])


def table_lines(table: Table, written: Written = one_line) -> list[str]:
    """The Markdown lines of a table."""
    sides = ("---:" if is_number else "---" for is_number in table.numeric)
    return [_row(table.head), _row(sides), *(_row(map(written, row)) for row in table.rows)]


def escaped(text: str) -> str:
    """Escapes HTML in a text outside `code`, and joins its lines, as a line break could start a heading."""
    parts = _CODE.split(one_line(text))
    return "".join(part if part.startswith("`") else part.replace("&", "&amp;").replace("<", "&lt;") for part in parts)


def _joined(lines: Iterable[str]) -> str:
    return "\n".join(lines).rstrip() + "\n"


def _row(values: Iterable[str]) -> str:
    # A compiler message in a table may hold anything; a pipe or a line break in it would end the table's cell.
    return "| " + " | ".join(one_line(value).replace("|", "\\|") for value in values) + " |"


def linked_files(folder: Path, sections: Sequence[Section]) -> Iterator[tuple[Path, bytes]]:
    """The files that a Markdown report links to, with their bytes."""
    for block in _blocks(sections):
        if isinstance(block, Image):
            yield folder / FIGURES / block.name, block.data
        elif isinstance(block, Pictures):
            for image, _ in block.items:
                yield folder / SCENES / image.name, image.data
        elif isinstance(block, Download):
            yield folder / DATA / block.name, gzip.decompress(block.compressed)


def write_files(files: Sequence[tuple[Path, bytes]]) -> None:
    """Writes each file atomically, and makes its folder."""
    for target, data in files:
        make_folder(target.parent)
        write_whole(target, lambda path, data=data: path.write_bytes(data) and None)


def _blocks(sections: Sequence[Section]) -> Iterator[Block]:
    for section in sections:
        yield from section.blocks
        yield from _blocks(section.children)


def _contents(sections: Sequence[Section], indent: str) -> list[str]:
    lines = []
    for section in sections:
        lines.append(f"{indent}- [{_label(section.title)}](#{section.anchor})")
        lines += _contents(section.children, indent + "  ")
    return lines


def _label(text: str) -> str:
    return re.sub(r"([\[\]\\])", r"\\\1", escaped(text))


def _sections(sections: Iterable[Section], level: int, written: Written) -> Iterator[str]:
    for section in sections:
        if section.anchor:
            # Explicit anchors are written, as Markdown renderers derive theirs from headings in different ways.
            yield from (f'<a id="{section.anchor}"></a>', "")
        yield from (f"{'#' * level} {written(section.title)}", "")
        for block in section.blocks:
            yield from (*_block(block, level + 1, written), "")
        yield from _sections(section.children, level + 1, written)


def _block(block: Block, level: int, written: Written) -> list[str]:
    match block:
        case Paragraph(text):
            return [written(text)]
        case Bullets(items):
            return [f"- {written(item)}" for item in items]
        case Facts(rows):
            return [f"- {name}: {written(text)}" for name, text in rows]
        case Heading(text):
            return [f"{'#' * min(level, 6)} {written(text)}"]
        case Table():
            return table_lines(block, written)
        case Folded(label, table):
            summary = f"<details><summary>{written(label).replace('`', '')}</summary>"
            return [summary, "", *table_lines(table, written), "", "</details>"]
        case Image():
            return [_image(block, FIGURES)]
        case Pictures(items):
            return [line for image, text in items for line in (_image(image, SCENES), "", written(text), "")][:-1]
        case Download():
            file = f"{DATA}/{block.name}"
            return [f"- [{block.name}]({quote(file)}): {block.rows} rows, one {block.about}"]
    raise TypeError(f"no Markdown for {type(block).__name__}")


def _image(image: Image, folder: str) -> str:
    # The alternative text is only the figure's title, because the figure contains its caption.
    title = image.alt.partition(". ")[0]
    return f"![{_label(title)}]({quote(f'{folder}/{image.name}')})"
