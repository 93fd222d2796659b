"""A report as one self-contained HTML page, which includes style, script, images and raw rows."""

import base64
import re
from collections.abc import Iterable, Sequence
from html import escape

from ptbench.document.blocks import (
    Block,
    Bullets,
    Download,
    Facts,
    Folded,
    Heading,
    Image,
    Paragraph,
    Pictures,
    Section,
)
from ptbench.document.table import Table
from ptbench.io.files import package_file

_INLINE = re.compile(r"`([^`]+)`|\*\*(.+?)\*\*")
# Words long enough to be broken inside, so that a long name does not widen the HTML page.
_LONG_WORD = re.compile(r"[^\s<>&;]{24,}")
_LONG_TEXT = 44  # length in characters from which the texts of a table's column are broken into lines
_WIDE = 11  # number of columns from which on a table is printed in landscape
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src data:"


def html_page(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """The report as a whole HTML page without external resources."""
    style = package_file("report", "style.css").read_text(encoding="utf-8")
    script = package_file("report", "script.js").read_text(encoding="utf-8")
    body = "".join(_section(section, 2) for section in sections)
    # The content security policy forbids the page to load anything.
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<title>{escape(title)}</title>
<link rel="icon" href="data:,">
<style>
{style}</style>
</head>
<body>
<header>
<h1>{escape(title)}</h1>
<p>{escape(subtitle)}</p>
</header>
<nav aria-label="Contents">
<details>
<summary>Contents</summary>
{_contents(sections)}</details>
</nav>
<main>
{body}</main>
<script>
{script}</script>
</body>
</html>
"""


def inline(text: str) -> str:
    """A block's text as HTML, with code and bold parts marked up and long names breakable."""
    parts, end = [], 0
    for match in _INLINE.finditer(text):
        parts.append(_breakable(text[end : match.start()]))
        tag, inside = ("code", match[1]) if match[1] is not None else ("strong", match[2])
        parts.append(f"<{tag}>{_words(inside) if tag == 'code' else _breakable(inside)}</{tag}>")
        end = match.end()
    return "".join([*parts, _breakable(text[end:])])


def _words(code: str) -> str:
    """Inline code as HTML whose words do not break, as a line that ends after a hyphen would suggest another option."""
    words = code.split(" ")
    if len(words) == 1:
        return _breakable(code)
    return " ".join(f"<span>{_breakable(word)}</span>" for word in words)


def _breakable(text: str) -> str:
    return _LONG_WORD.sub(lambda word: re.sub(r"([._/:+,=-])(?=[^._/:+,=-])", r"\1<wbr>", word[0]), escape(text))


def _contents(sections: Sequence[Section], depth: int = 3) -> str:
    if not sections or depth == 0:
        return ""
    items = ""
    for section in sections:
        link = f'<a href="#{section.anchor}">{_breakable(section.title)}</a>'
        items += f"<li>{link}{_contents(section.children, depth - 1)}</li>\n"
    return f"<ol>\n{items}</ol>\n"


def _section(section: Section, level: int) -> str:
    inside = "".join(_block(block, level + 1) for block in section.blocks)
    inside += "".join(_section(child, level + 1) for child in section.children)
    return f'<section id="{section.anchor}">\n<h{level}>{_breakable(section.title)}</h{level}>\n{inside}</section>\n'


def _block(block: Block, level: int) -> str:
    match block:
        case Paragraph(text):
            return f"<p>{inline(text)}</p>\n"
        case Bullets(items):
            return "<ul>\n" + "".join(f"<li>{inline(item)}</li>\n" for item in items) + "</ul>\n"
        case Facts(rows):
            inside = "".join(f"<dt>{escape(name)}</dt><dd>{inline(text)}</dd>\n" for name, text in rows)
            return f'<dl class="facts">\n{inside}</dl>\n'
        case Heading(text):
            return f"<h{min(level, 6)}>{_breakable(text)}</h{min(level, 6)}>\n"
        case Table():
            return _table(block)
        case Folded(label, table):
            return f"<details>\n<summary>{inline(label)}</summary>\n{_table(table)}</details>\n"
        case Image():
            return _figure(block)
        case Pictures(items):
            shown = (
                f"<figure>{_image(image)}<figcaption>{inline(text)}</figcaption></figure>" for image, text in items
            )
            return f'<div class="pictures">\n{"".join(shown)}</div>\n'
        case Download():
            return _download(block)
    raise TypeError(f"no HTML for {type(block).__name__}")


def _figure(image: Image) -> str:
    if image.narrow is None:
        return f'<figure class="scroll" tabindex="0">{_image(image)}</figure>\n'
    narrow = image.narrow
    # Print media are narrow in CSS pixels but can show the wide image, hence the media type `screen`.
    source = (
        f'<source media="screen and (max-width: 44rem)" srcset="{_data(narrow.media_type, narrow.data)}" '
        f'width="{narrow.width}" height="{narrow.height}">'
    )
    return f'<figure class="fitting"><picture>{source}{_image(image)}</picture></figure>\n'


def _image(image: Image) -> str:
    return (
        f'<img src="{_data(image.media_type, image.data)}" alt="{escape(image.alt)}" '
        f'width="{image.width}" height="{image.height}">'
    )


def _data(media_type: str, data: bytes) -> str:
    return f"data:{media_type};base64,{base64.b64encode(data).decode()}"


def _table(table: Table) -> str:
    sides = [
        ' class="number"' if is_number else ' class="text"' if _is_long(table, column) else ""
        for column, is_number in enumerate(table.numeric)
    ]
    head = "".join(
        f'<th scope="col"{side}><button type="button">{escape(name) or "&nbsp;"}</button></th>'
        for name, side in zip(table.head, sides, strict=True)
    )
    rows = "".join(_row(row, sides) for row in table.rows)
    label = escape("Table: " + ", ".join(table.head[:3]))
    kind = ' class="wide"' if len(table.head) >= _WIDE else ""
    # A scrollable box needs a tab stop to be reachable by keyboard.
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{label}"><table{kind}>\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )


def _is_long(table: Table, column: int) -> bool:
    """Whether a column's texts are long enough to wrap; short columns stay on one line."""
    return any(len(row[column]) > _LONG_TEXT for row in table.rows)


def _row(cells: Iterable[str], sides: Sequence[str]) -> str:
    return "<tr>" + "".join(map(_cell, cells, sides)) + "</tr>\n"


def _cell(text: str, side: str) -> str:
    # Each word of a number gets its own span, so that "1.2e-6" is not broken after its hyphen.
    inside = (
        " ".join(f"<span>{escape(word)}</span>" for word in text.split()) if "e-" in text and "number" in side else ""
    )
    return f"<td{side}>{inside or inline(text)}</td>"


def _download(download: Download) -> str:
    data = _data("application/gzip", download.compressed)
    kib = max(1, round(len(download.compressed) / 1024))
    # The table's link is to a gzip file; with JavaScript, the page turns that into a link to plain CSV.
    return (
        f'<p><a class="csv" download="{escape(download.name)}.gz" href="{data}">{escape(download.name)}.gz</a>: '
        f"{download.rows} rows, one {escape(download.about)}; {kib} KiB, compressed by gzip.</p>\n"
    )
