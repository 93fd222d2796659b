"""A page's view of a survey of imports, and how the survey counts."""

from __future__ import annotations

import importlib.util
import json
import sys
from collections import Counter
from pathlib import Path

import pytest

from ptbench.errors import FindingError
from ptbench.findings.source import source_of
from ptbench.findings.sources.imports import ImportsSource

ROOT = Path(__file__).parents[2]
TEXT = "MATERIAL 0\nRGB 1 1 1\n\nCAMERA\nRES 4 4\n\nOBJECT 0\n{}\nmaterial 0\n"
JSON = '{{"Materials": {{{}}}, "Camera": {{}}, "Objects": [{{{}}}]}}'


@pytest.fixture
def survey():
    spec = importlib.util.spec_from_file_location("survey", ROOT / "tools/imports/survey.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["survey"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["survey"]


def put(folder: Path, name: str, text: str) -> None:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def test_files_of_one_content_count_once_and_of_one_author_not_too_many(survey, tmp_path):
    put(tmp_path, "a/scenes/one.txt", TEXT.format("cube"))
    put(tmp_path, "b/one.txt", TEXT.format("cube"))
    put(tmp_path, "b/readme.txt", "no scene")
    for i in range(survey.MOST + 3):
        put(tmp_path, f"c/{i:02}.txt", TEXT.format("cube") + "//" * (i + 1))
    scenes, left_out = survey.scenes_in(tmp_path)
    assert Counter(scene.author for scene in scenes) == {"a": 1, "c": survey.MOST}
    assert left_out == {"same content as another": 1, f"beyond {survey.MOST} of one author": 3}


@pytest.mark.parametrize(
    ("text", "dialect", "needs"),
    [
        (TEXT.format("cube"), "text", []),
        (TEXT.format("mesh\nFILE a.obj"), "text", ["mesh"]),
        (TEXT.format("// mesh\ncube"), "text", []),
        (TEXT.format("cube") + "TEXTURE NULL\nNORMAL_MAP NULL\nusingProcTex 0\n", "text", []),
        (TEXT.format("cube") + "TEXTURE wood.jpg\n", "text", ["texture"]),
        (TEXT.format("implicit"), "text", ["procedural"]),
        (JSON.format("", '"TYPE": "sphere"'), "json", []),
        (JSON.format("", '"TYPE": "mesh"'), "json", ["mesh"]),
        (
            JSON.format('"a": {"TYPE": "Marble"}', '"TYPE": "gltf", "TEXTURE": "a"'),
            "json",
            ["mesh", "texture", "procedural"],
        ),
    ],
)
def test_what_a_scene_asks_for_is_told_from_its_own_words(survey, text, dialect, needs):
    assert survey.is_scene(text, dialect)
    assert survey.needs_of(text, dialect) == needs


def test_reasons_are_named_and_notes_are_none(survey):
    said = (
        'ptbench: a.txt:3: found "TEXTURE a.png", allowed: no image here (none)\n'
        'ptbench: a.txt:9: found "FILE b.obj", allowed: a mesh file that is there, beside this one or above\n'
        "ptbench: a.txt:4: note: X 0 is left out\nptbench: a.txt: 2 problems; no scene is written\n"
    )
    assert survey.reasons_of(said) == {"texture, bump or environment map", "mesh file that is not in the repository"}


@pytest.mark.parametrize(
    ("allowed", "lacks_a_mesh", "lacks_a_file"),
    [
        ("a mesh file that is there, beside this one", True, True),
        ("an image .png or .jpg that is there, beside this file", False, True),
        ("a library of materials that is there, beside the mesh", False, True),
        ("a mesh that can be read", False, False),
    ],
)
def test_a_file_that_is_missing_is_told_from_one_that_cannot_be_read(survey, allowed, lacks_a_mesh, lacks_a_file):
    reasons = survey.reasons_of(f'ptbench: a.txt:3: found "FILE a", allowed: {allowed}\n')
    scene = survey.Scene("a", Path("x"), "text", [], survey.REFUSED, reasons)
    assert (scene.lacks_a_mesh, scene.lacks_a_file) == (lacks_a_mesh, lacks_a_file)


def test_what_a_library_of_materials_says_is_the_meshs_own(survey):
    said = 'ptbench: a.txt:3: found "a.mtl line 5: norm b.png", allowed: no image here (none)\n'
    assert survey.reasons_of(said) == {"texture, bump or environment map"}
    said = 'ptbench: a.txt:3: found "a.mtl line 5: d 0.5", allowed: 1, or Tr 0\n'
    assert survey.reasons_of(said) == {"mesh with the materials of its own file"}


def page_source(survey, tmp_path) -> ImportsSource:
    def scene(outcome: str, needs: list[str], warnings: int = 0, reasons: tuple[str, ...] = ()):
        return survey.Scene("a", Path("x"), "text", needs, outcome, set(reasons), warnings)

    scenes = [
        scene(survey.IMPORTED, []),
        scene(survey.IMPORTED, [], warnings=2),
        scene(survey.REFUSED, ["mesh"], reasons=("mesh file that is not in the repository",)),
        scene(survey.REFUSED, ["texture"], reasons=("texture, bump or environment map",)),
    ]
    document = survey.document(scenes, Counter({"same content as another": 3}), Path("/bin/true"))
    (tmp_path / "imports.json").write_text(json.dumps(document), encoding="utf-8")
    found = source_of(tmp_path, {"file": "imports.json"})
    assert isinstance(found, ImportsSource)
    return found


def test_a_page_looks_up_the_counts(survey, tmp_path):
    source = page_source(survey, tmp_path)
    assert (source.authors, source.files(), source.came_through(), source.exact()) == (1, 4, 2, 1)
    assert source.share("text", "plain") == "100 %"
    assert source.share("all", "with_their_files") == "66.7 %"
    assert source.files("all", "with_their_meshes") == 3
    assert source.files("json", "mesh") == 0
    assert source.left_out == "3 (same content as another)"
    assert dict(source.reasons)["texture, bump or environment map"] == 1
    assert source.must_reach(1, "all", "plain", "all of them") == "all of them"
    with pytest.raises(FindingError, match=r"50.0 % come through"):
        source.must_reach(0.8, "all", "all", "most of them")
