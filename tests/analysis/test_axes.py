"""The axes as Python and the schemas have them are those that their folders describe, and so are the features."""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from ptbench.io import axes
from ptbench.io.axes import FILE, known_axes, schema_properties
from ptbench.io.schema_lists import FEATURES, SCHEMA, schema_features, write_schema

ROOT = Path(__file__).resolve().parents[2]
HEADERS = {path.parent.name: path.read_text(encoding="utf-8") for path in (ROOT / "variants").glob("*/axis.h")}


def fact(axis: str, key: str) -> str:
    found = re.search(rf'^    \.{key} = "?([^"]*?)"?,$', HEADERS[axis], re.MULTILINE)
    return found[1] if found else ""


def test_every_folder_with_an_axis_is_known_in_its_order():
    assert list(known_axes()) == sorted(HEADERS, key=lambda axis: int(fact(axis, "order")))


def test_facts_are_those_of_the_headers():
    for name, axis in known_axes().items():
        assert axis.what == fact(name, "what")
        assert (axis.since, axis.as_before) == (fact(name, "since"), fact(name, "as_before"))
        assert [axis.decides_error, axis.decides_samples] == [
            fact(name, key) == "true" for key in ("decides_error", "decides_samples")
        ]


def test_what_every_variant_was_is_a_choice():
    for name, axis in known_axes().items():
        stems = {file.name.split(".")[0] for file in (ROOT / "variants" / name).iterdir()}
        # The choices of `devices` are numbers: one.cpp has "1".
        assert axis.as_before in {"", "1"} | stems


def test_the_schema_says_of_axes_what_they_say():
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))["$defs"]["axes"]
    assert list(schema["properties"].items()) == list(schema_properties().items())


def test_the_schema_has_the_features_of_the_program():
    """A material or a shape is a feature by its line in the list of its kind, and no other file names it."""
    feature = json.loads(SCHEMA.read_text(encoding="utf-8"))["$defs"]["feature"]
    assert feature["enum"] == schema_features()
    assert len(set(schema_features())) == len(schema_features())


@pytest.mark.parametrize("line", [r'\n        "layout": [^\n]*', r' "principled",'])
def test_the_schema_is_written_anew(tmp_path, monkeypatch, line):
    before = SCHEMA.read_text(encoding="utf-8")
    stale = tmp_path / SCHEMA.name
    stale.write_text(re.sub(line, "", before), encoding="utf-8")
    assert stale.read_text(encoding="utf-8") != before
    monkeypatch.setattr("ptbench.io.schema_lists.SCHEMA", stale)
    write_schema()
    assert stale.read_text(encoding="utf-8") == before


@pytest.mark.parametrize("file", [FILE, FEATURES], ids=lambda file: file.stem)
def test_the_file_is_as_the_program_prints_it(file):
    text = file.read_text(encoding="utf-8")
    assert text == json.dumps(json.loads(text), indent=1) + "\n"


def test_an_axis_is_a_constant():
    assert [getattr(axes, name.upper()) for name in known_axes()] == list(known_axes())


@pytest.mark.parametrize("constant", ["INTEGRATR", "integrator", "Integrator"])
def test_a_misspelled_axis_fails(constant):
    with pytest.raises(AttributeError, match=rf"^ptbench\.io\.axes: found {constant}, allowed: the names of axes"):
        getattr(axes, constant)


# Files and folders in which the word of a key stands as text nonetheless: what it means there, or why it is spelled.
OTHER_MEANINGS = {
    "harness/interchange/": "elements of Mitsuba's files",
    "harness/cli/new_command.cpp": "what `ptbench new` makes",
    "harness/cli/list_json.cpp": "a field of what `list` prints",
    "harness/cli/list_text.cpp": "a field of what `list` prints",
    "harness/rays/leak_study.cpp": "fields and columns of ray files",
    "harness/rays/ray_counters.cpp": "fields and columns of ray files",
    "harness/rays/ray_study.cpp": "fields and columns of ray files",
    "harness/scene/instances.cpp": "levels of a sphereflake",
    "variants/bvh/encoding.h": "levels of a tree",
    "variants/cuda/wavefronts.cpp": "a stage of a render",
    "variants/descriptor.cpp": "a feature of a kernel",
    "variants/integrator/wavefront.h": "a stage of a render",
    "variants/integrator/wavefront_fused.cuh": "the name of a kernel",
    "analysis/examples/": "columns of tables, as a script of one's own reads them",
    "analysis/ptbench/claims/evidence.py": "fields of ray files",
    "analysis/ptbench/compare/rays.py": "fields of ray files",
    "analysis/ptbench/extras/advise/features.py": "levels of a sphereflake",
    "analysis/ptbench/extras/simulate/parts.py": "a field of thousand.json",
    "analysis/ptbench/extras/simulate/source.py": "a field of thousand.json",
    "analysis/ptbench/findings/sources/rays.py": "fields of ray files",
    "analysis/ptbench/io/older.py": "axes as older files spell them, whatever they are called today",
    "analysis/ptbench/io/rays.py": "fields of ray files",
    "analysis/ptbench/studies/gpu.py": "the name of a kernel",
    "analysis/ptbench/submit/options.py": "Slurm's option --partition",
    "analysis/ptbench/tidy/columns.py": "columns of ray tables",
    "analysis/ptbench/tidy/rows.py": "columns of ray tables",
    "tools/film_hashes.py": "command-line words of a tool that runs without the package",
    "tools/imports/survey.py": "command-line words of a tool that runs without the package",
    "tools/neighbours.py": "command-line words of a tool that runs without the package",
    "tools/peers/cycles_peer.py": "an element of Mitsuba's files",
    "cmake/build_info.cmake": "folders whose sources decide the image",
    "cmake/cuda.cmake": "folders whose sources are embedded or use CUB",
    "cmake/variants.cmake": "folders whose sources are compiled or listed in a way of their own",
}
C_FAMILY = (".h", ".cpp", ".cu", ".cuh")
# The suffixes of the files that are searched, by folder.
SEARCHED = {
    **dict.fromkeys(("kernels", "variants", "harness", "stability"), C_FAMILY),
    **dict.fromkeys(("analysis", "tools"), (".py",)),
    "cmake": (".cmake",),
}


def strings_of_python(code: str) -> Iterator[str]:
    """Every string in Python code, f-strings in their constant parts, except docstrings."""
    nodes = list(ast.walk(ast.parse(code)))
    docstrings = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


def keys_in(file: Path, keys: list[str]) -> set[str]:
    """The keys of axes that a file spells as text, except in comments."""
    code = file.read_text(encoding="utf-8")
    key = "|".join(keys)
    if file.suffix == ".py":
        # As a whole string, or before an equals sign as in "--axis layout=soa".
        spelled = re.compile(rf"\A(?:{key})\Z|\b(?:{key})(?==)")
        return {word for text in strings_of_python(code) for word in spelled.findall(text)}
    if file.suffix == ".cmake":
        return set(re.findall(rf"\b(?:{key})\b", re.sub(r"#.*", "", code)))
    return set(re.findall(rf'"({key})"', re.sub(r"//.*", "", code)))


def keys_as_text(root: Path, keys: list[str]) -> dict[str, set[str]]:
    """The keys of axes that stand as text in each file outside the axis's own folder."""
    found: dict[str, set[str]] = {}
    for folder, suffixes in SEARCHED.items():
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in suffixes:
                name = file.relative_to(root).as_posix()
                if others := {key for key in keys_in(file, keys) if not name.startswith(f"variants/{key}/")}:
                    found[name] = others
    return found


def test_no_file_outside_its_folder_spells_an_axis():
    """Code that means an axis says axes::KEY in C++ (variants/axes.h) and imports KEY of ptbench.io.axes in Python."""
    spelled = keys_as_text(ROOT, list(known_axes()))
    assert {file for file in spelled if not file.startswith(tuple(OTHER_MEANINGS))} == set()
    assert [place for place in OTHER_MEANINGS if not any(file.startswith(place) for file in spelled)] == []


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("harness/render/renderer.cpp", 'f("sorting");  // "layout"'),
        ("analysis/ptbench/plots/rows.py", 'cell.axes["sorting"]  # "layout"'),
        ("analysis/ptbench/plots/rows.py", 'def f():\n    """layout=soa"""\n    return f"{cell.axes[\'sorting\']}"'),
        ("analysis/ptbench/plots/rows.py", 'call = ["--axis", f"sorting={choice}", "a layout", "relayout=1"]'),
        ("tools/fleet/run.py", 'words = "wavefront sorting=none"'),
        ("cmake/tests.cmake", "file(GLOB sorts variants/sorting/*.cpp)  # layout\nset(layout_headers a)"),
    ],
)
def test_an_axis_that_is_spelled_is_found(tmp_path, file, text):
    for name, code in {file: text, "variants/sorting/bucket.cpp": '"sorting"', "tools/build.py": "sorting = 1"}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(code + "\n", encoding="utf-8")
    assert keys_as_text(tmp_path, ["sorting", "layout"]) == {file: {"sorting"}}
