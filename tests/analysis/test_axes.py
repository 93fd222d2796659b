"""The axes as Python and the schemas have them are those that their folders describe, and so are the features."""

import json
import re
from pathlib import Path

import pytest

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
    axes = json.loads(SCHEMA.read_text(encoding="utf-8"))["$defs"]["axes"]
    assert list(axes["properties"].items()) == list(schema_properties().items())


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


# Where a key's word means something else than the axis, and what.
OTHER_MEANINGS = {
    "harness/interchange/": "elements of Mitsuba's files",
    "harness/templates/": "a folder, or a choice that `ptbench new` writes into it",
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
}


def keys_as_text(root: Path, axes: list[str]) -> dict[str, set[str]]:
    """The keys of axes that stand as text in each C++ or CUDA file outside the axis's own folder, but for comments."""
    found: dict[str, set[str]] = {}
    for floor in ("kernels", "variants", "harness", "stability"):
        for file in sorted((root / floor).rglob("*")):
            if file.suffix not in {".h", ".cpp", ".cu", ".cuh"}:
                continue
            name = file.relative_to(root).as_posix()
            code = re.sub(r"//.*", "", file.read_text(encoding="utf-8"))
            keys = {key for key in re.findall(r'"(\w+)"', code) if key in axes}
            if others := {key for key in keys if not name.startswith(f"variants/{key}/")}:
                found[name] = others
    return found


def test_no_file_outside_its_folder_spells_an_axis():
    """Code that means an axis says axes::KEY (variants/axes.h), which the compiler checks."""
    spelled = keys_as_text(ROOT, list(known_axes()))
    assert {file for file in spelled if not file.startswith(tuple(OTHER_MEANINGS))} == set()
    assert [place for place in OTHER_MEANINGS if not (ROOT / place).exists()] == []


def test_an_axis_that_is_spelled_is_found(tmp_path):
    for name in ("variants/sorting/bucket.cpp", "harness/render/renderer.cpp"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text('f("sorting");  // "layout"\n', encoding="utf-8")
    assert keys_as_text(tmp_path, ["sorting", "layout"]) == {"harness/render/renderer.cpp": {"sorting"}}
