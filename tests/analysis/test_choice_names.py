"""A choice is known to the others by its traits (variants/axes.h): nobody else compares its name with a literal."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import ROOT

from ptbench.io.axes import known_axes

FOLDERS = ("variants", "harness", "stability", "kernels")
SUFFIXES = {".cpp", ".h", ".cu", ".cuh", ".in"}
AXES = list(known_axes())
# Words that are names of choices and other things too: there only what is plainly a variant's choice counts.
ORDINARY = {
    "none",
    "off",
    "float",
    "double",
    "fast",
    "exact",
    "features",
    "stream",
    "graph",
    "ray",
    "material",
    "matrix",
}

_COMMENT = re.compile(r"//[^\n]*")
_AXIS = "|".join(AXES)
# variant[axes::sorting] == "none", "none" != variant["sorting"], and any name instead of the literal but that of
# another variant.
_CHOSEN = rf'\w+\[\s*(?:axes::|")(?:{_AXIS})"?\s*\]'
_COMPARED = re.compile(
    rf'{_CHOSEN}\s*[!=]=(?!\s*(?:\w+(?:\.|->))*\w+(?:\([^()]*\))?\[)|"\w*"\s*[!=]=\s*{_CHOSEN}'
    rf"|{_CHOSEN}\.(?:starts_with|ends_with|find|contains|compare)\("
)
# name == "thrust_remove_if": whatever variable holds the name.
_LITERAL = re.compile(r'[!=]=\s*"(\w+)"|"(\w+)"\s*[!=]=|\.(?:starts_with|ends_with|compare)\(\s*"(\w+)"')
# A name that was taken from a variant before: const std::string& chosen = variant[axes::sorting].
_TAKEN = re.compile(rf"\b(\w+) = {_CHOSEN};")


def choices() -> set[str]:
    return {file.stem for axis in AXES for file in (ROOT / "variants" / axis).iterdir()} - {"axis"}


def comparisons(text: str, own: str = "") -> list[str]:
    """The comparisons of a text with the name of a choice other than `own`."""
    text = _COMMENT.sub("", text)
    found = [match[0] for match in _COMPARED.finditer(text)]
    taken = {match[1] for match in _TAKEN.finditer(text)}
    for match in _LITERAL.finditer(text):
        name = match[1] or match[2] or match[3]
        before = re.search(r"(\w+)(?:\(\))? *$", text[: match.start()])
        is_taken = before is not None and (before[1] in taken or before[1] in AXES)
        if name in KNOWN and name != own and (is_taken or name not in ORDINARY):
            found.append(match[0])
    return found


KNOWN = choices()


def sources() -> list[Path]:
    files = (file for folder in FOLDERS for file in sorted((ROOT / folder).rglob("*")))
    return [file for file in files if file.suffix in SUFFIXES]


def test_nobody_compares_the_name_of_another_choice_with_a_literal():
    wrong = {}
    for file in sources():
        if found := comparisons(file.read_text(encoding="utf-8"), file.stem if file.parent.name in AXES else ""):
            wrong[str(file.relative_to(ROOT))] = found
    assert not wrong, "ask for a trait instead (variants/axes.h)"


@pytest.mark.parametrize(
    "line",
    [
        'if (variant[axes::compaction] != "none") {',
        'if (variant["compaction"] != "none") {',
        'if ("none" == variant["compaction"]) {',
        'for (auto racing : {"gap_fill"}) { if (variant["compaction"] == racing) {',
        'return task.variant["integrator"].starts_with("wavefront");',
        'const std::string& integrator = variant["integrator"]; return integrator != "none";',
        'if (name == "thrust_remove_if") {',
        'if (setting.precision == "double") {',
    ],
)
def test_comparisons_are_found(line):
    assert comparisons(line)


@pytest.mark.parametrize(
    "line",
    [
        '// variant["compaction"] != "none"',
        'if (variant["layout"] != plainest["layout"]) {',
        "if (variant[axes::layout] != plainest[axes::layout]) {",
        'const int keys = cell.variant["sort_key"] != other->variant["sort_key"];',
        'const bool same = task.variant["integrator"] == plainest_variant(task.backend)["integrator"];',
        'variant.set("arithmetic", "exact");',
        'if (kind == "none") {',
        "if (variant.compaction.compacts) {",
    ],
)
def test_other_lines_are_not(line):
    assert not comparisons(line)


def test_a_choice_may_name_itself():
    assert not comparisons('if (name == "gap_fill") {', own="gap_fill")
