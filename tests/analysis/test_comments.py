"""Comments stand alone: an editor shows each without the declaration above it, so none begins as a fragment of that."""

from __future__ import annotations

import ast
import io
import re
import tokenize

import pytest
from conftest import ROOT

FOLDERS = ("kernels", "variants", "harness", "stability", "analysis", "tools")
C_FAMILY = (".h", ".cuh", ".cpp", ".cu", ".in")
# These always refer to what stands above: "Of a vector, by its number.", "The same, walks and all.", "Null: none.",
# "Its sign.", "By size: tiles.", "The program's."
FRAGMENT = re.compile(
    r"(?:And )?(?:Of|The same|Same|Likewise|Ditto|By selection|As above|As before|See above|Not so|Those of|That of"
    r"|Its|Their|It|They)\b"
    r"|(?:\w+ ){0,2}\w+'s\.$"
    r"|By [a-z][^.:;]{0,40}[:;]"
    r"|(?:And )?(?:Null|Empty)(?: where|:)"
)
# Where a file may have one: a file without is not parsed.
_CANDIDATE = re.compile(r'(?://[/!<]*|#|"""|\'\'\')\s*(?:' + FRAGMENT.pattern + ")")
# Strings and characters come first, so that "//" in them is no comment.
_TOKEN = re.compile(
    r'R"(?P<fence>[^()\\ ]{0,16})\(.*?\)(?P=fence)"|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)\''
    r"|/\*.*?\*/|//(?P<text>[^\n]*)",
    re.DOTALL,
)


def c_comments(text: str) -> list[tuple[int, int, bool, str]]:
    """Line, column, whether code stands before it, and the text of each // comment."""
    found = []
    for match in _TOKEN.finditer(text):
        if match["text"] is not None:
            start = match.start()
            column = start - (text.rfind("\n", 0, start) + 1)
            line = text.count("\n", 0, start) + 1
            is_behind_code = bool(text[start - column : start].strip())
            found.append((line, column, is_behind_code, match["text"].strip("/!< \t\\")))
    return found


def python_comments(text: str) -> list[tuple[int, int, bool, str]]:
    """Line, column, whether code stands before it, and the text of each # comment."""
    return [
        (token.start[0], token.start[1], bool(token.line[: token.start[1]].strip()), token.string.strip("#! \t"))
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    ]


def docstrings(text: str) -> list[tuple[int, str]]:
    found = []
    for node in ast.walk(ast.parse(text)):
        is_documented = isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef))
        if is_documented and (documentation := ast.get_docstring(node)):
            found.append((node.body[0].lineno, documentation))
    return found


def beginnings(comments: list[tuple[int, int, bool, str]]) -> list[tuple[int, str]]:
    """The first line of each block of comments, and comments behind code that are sentences (of a capital letter)."""
    found, before = [], (-1, -1)
    for line, column, is_behind_code, text in comments:
        is_sentence = not is_behind_code or text[:1].isupper()
        if before != (line - 1, column) and is_sentence:
            found.append((line, text))
        before = (line, column)
    return found


def fragments(text: str, suffix: str) -> list[tuple[int, str]]:
    if not _CANDIDATE.search(text):
        return []
    if suffix != ".py":
        blocks = beginnings(c_comments(text))
    elif "#" in text:
        blocks = beginnings(python_comments(text)) + docstrings(text)
    else:
        blocks = docstrings(text)
    return sorted((line, words) for line, words in blocks if FRAGMENT.match(words))


def test_no_comment_is_a_fragment():
    files = [file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*"))]
    files = [file for file in files if file.suffix in {*C_FAMILY, ".py"} and "__pycache__" not in file.parts]
    assert len(files) > 500
    found = [
        f"{file.relative_to(ROOT)}:{line}: {words}"
        for file in files
        for line, words in fragments(file.read_text(encoding="utf-8", errors="replace"), file.suffix)
    ]
    assert not found, "say what it is in a sentence that needs nothing above it:\n" + "\n".join(found)


@pytest.mark.parametrize(
    ("text", "suffix"),
    [
        ("// Of a vector, by its number.\nint a;", ".h"),
        ("    // The same, walks and all.\n    // In double.\n", ".cuh"),
        ("int b;\n// Likewise in single precision.", ".cpp"),
        ("// By selection: an index would be slow.", ".cu"),
        ("View a;  // Null: none.", ".h"),
        ("// Its sign.\nint sign();", ".h"),
        ("// The other scene's.\n", ".h"),
        ("# By size of the image; fewer samples: tiles.", ".py"),
        ("# Of them, those that agree.", ".py"),
        ('def f():\n    """The same as text."""\n', ".py"),
    ],
)
def test_fragments_are_found(text, suffix):
    assert len(fragments(text, suffix)) == 1


@pytest.mark.parametrize(
    ("text", "suffix"),
    [
        ("// The sum of both.\n// Of these one is 0.\n", ".h"),
        ("int count;  // of it", ".h"),
        ('const char* url = "// Of course";', ".cpp"),
        ('auto text = R"(\n// Of a scene\n)";', ".cpp"),
        ("// Offers a value.", ".h"),
        ("// The name is the scene's.", ".h"),
        ('text = "# Of course"', ".py"),
        ('def f():\n    """A sum.\n\n    Of both.\n    """\n', ".py"),
    ],
)
def test_sentences_are_not(text, suffix):
    assert fragments(text, suffix) == []
