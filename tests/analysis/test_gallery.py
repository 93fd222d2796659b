"""The gallery, with a stand-in for `ptbench render` that notes how it was called."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest
from conftest import PACKAGE

from ptbench.gallery.command import load_spec, packed, sheet_dpi

DEFAULT_SPEC = PACKAGE / "gallery.json"

STAND_IN = """#!{python} -S
import json, os, sys
with open(os.path.join(os.path.dirname(__file__), "calls"), "a") as calls:
    calls.write(json.dumps(sys.argv[1:]) + "\\n")
scene = sys.argv[sys.argv.index("--scene") + 1]
if scene == "broken":
    sys.stderr.write("loading\\nptbench: broken.json: $.camera: found nothing\\n")
    sys.exit(2)
report = {{"mean_rgb": [0, 0, 0], "film_hash": "0", "nonfinite": 0, "negative": 0, "paths": 1, "rays": 1,
          "unfinished_walks": 5 if scene == "foggy" else 0, "seconds": 0.1}}
if scene != "pictureless":
    with open({picture!r}, "rb") as source, open(sys.argv[sys.argv.index("--out") + 1], "wb") as target:
        target.write(source.read())
print("no JSON" if scene == "chatty" else json.dumps(report))
"""


@pytest.fixture
def binary(tmp_path):
    import matplotlib.image
    import numpy as np

    picture = tmp_path / "source.png"
    matplotlib.image.imsave(picture, np.full((4, 4, 3), 0.5))
    path = tmp_path / "ptbench"
    path.write_text(STAND_IN.format(python=sys.executable, picture=str(picture)))
    path.chmod(0o755)
    return path


def spec_of(tmp_path, *scenes: str, **row) -> Path:
    path = tmp_path / "spec.json"
    pictures = [{"label": scene, "scene": scene} for scene in scenes]
    path.write_text(json.dumps({"rows": [{"title": "Row", "pictures": pictures, **row}]}))
    return path


def test_the_default_gallery_has_every_picture_of_the_texts():
    _, rows = load_spec(DEFAULT_SPEC)
    scenes = [picture.scene for row in rows for picture in row.pictures]
    assert set(scenes) == {
        *(f"ball_{surface}" for surface in ("diffuse", "mirror", "glass")),
        *(f"dof_focus_{distance}" for distance in ("7_6", "8_7", "12_6", "15")),
        *(f"dof_aperture_{radius}" for radius in ("0_5", "1", "2")),
        *(f"{what}_{state}" for what in ("jitter", "motion") for state in ("off", "on")),
        *(f"subsurface_{shape}_{state}" for shape in ("ball", "box") for state in ("off", "on")),
        *(f"cornell_{box}" for box in ("open", "closed", "open_five", "closed_five")),
        "final_light",
    }
    light = next(row for row in rows if row.title == "Final-bounce light")
    assert [picture.axes for picture in light.pictures] == [{"direct_light": "off"}, {"direct_light": "final_bounce"}]
    jitter = next(row for row in rows if row.title.startswith("Anti-aliasing"))
    assert jitter.pixels
    assert jitter.resolution[0] < 100
    assert len({picture.file_name for row in rows for picture in row.pictures}) == 24


def test_pictures_and_sheet_are_written(tmp_path, binary, analysis):
    spec = spec_of(tmp_path, "ball", "foggy", resolution=[8, 8], pixels=True)
    out = tmp_path / "out"
    code, said, err = analysis("gallery", "--binary", binary, "--spec", spec, "--out", out, "--spp", 16)
    assert (code, err) == (0, "")
    names = ["ball.png", "foggy.png", "gallery.webp"]
    assert said.splitlines() == [str(out / name) for name in names]
    assert sorted(path.name for path in out.iterdir()) == names
    calls = [json.loads(line) for line in (tmp_path / "calls").read_text().splitlines()]
    assert [call[:7] for call in calls] == [
        ["render", "--scene", scene, "--spp", "16", "--resolution", "8x8"] for scene in ("ball", "foggy")
    ]


@pytest.mark.parametrize("name", ["ball.png", "gallery.webp"])
def test_what_is_no_regular_file_is_not_replaced(tmp_path, binary, analysis, name):
    out = tmp_path / "out"
    out.mkdir()
    os.mkfifo(out / name)
    code, _, err = analysis("gallery", "--binary", binary, "--spec", spec_of(tmp_path, "ball"), "--out", out)
    assert code == 2
    assert err.endswith(
        f"{out / name}: output file: found no regular file (a device, a pipe or a socket), "
        "allowed: a file, new or regular\n"
    )
    assert (out / name).is_fifo()


def test_axes_and_resolution_reach_the_binary(tmp_path, binary, analysis):
    spec = tmp_path / "spec.json"
    picture = {"label": "on", "scene": "final_light", "axes": {"direct_light": "final_bounce"}}
    spec.write_text(json.dumps({"title": "T", "rows": [{"title": "Light", "pictures": [picture]}]}))
    out = tmp_path / "out"
    code, _, _ = analysis("gallery", "--binary", binary, "--spec", spec, "--out", out, "--resolution", "30x20")
    assert code == 0
    call = json.loads((tmp_path / "calls").read_text())
    assert call[call.index("--axis") + 1] == "direct_light=final_bounce"
    assert call[call.index("--resolution") + 1] == "30x20"
    assert (out / "final_light-direct_light_final_bounce.png").exists()


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ("broken", "broken (Row, broken): broken.json: $.camera: found nothing\n"),
        ("chatty", "chatty (Row, chatty): no JSON summary on stdout"),
        ("pictureless", "pictureless (Row, pictureless): no picture that can be read"),
    ],
)
def test_a_failed_render_is_told_and_the_others_still_shown(tmp_path, binary, analysis, scene, message):
    spec, out = spec_of(tmp_path, scene, "ball"), tmp_path / "out"
    code, _, err = analysis("gallery", "--binary", binary, "--spec", spec, "--out", out)
    assert code == 1
    assert err.startswith(message)
    assert err.count("\n") == 1
    assert sorted(path.name for path in out.iterdir()) == ["ball.png", "gallery.webp"]


def test_the_sheet_names_counters_and_failures(binary, tmp_path):
    from ptbench.figures import style
    from ptbench.gallery.command import draw_sheet, render

    _, rows = load_spec(spec_of(tmp_path, "ball", "foggy", "broken"))
    shown = [[render(binary, picture, 16, (8, 8), tmp_path) for picture in rows[0].pictures]]
    assert [rendered.remarks for rendered in shown[0]] == [(), ("unfinished walks 5",), ()]
    with style.applied():
        figure = draw_sheet("Sheet", rows, shown, 16, (8, 8))
    captions = [text.get_text().replace("\n", " ") for text in figure.texts]
    for caption in ("ball (16 spp)", "foggy (16 spp); unfinished walks 5", "broken: failed", "Row", "Sheet"):
        assert caption in captions
    assert "$.camera: found" in figure.axes[2].texts[0].get_text().replace("\n", " ")


def test_neighbours_share_a_line_while_they_fit():
    assert packed([3, 2, 4, 3, 2, 2, 2, 2, 4]) == [[0], [1], [2], [3], [4, 5], [6, 7], [8]]


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({}, "$.rows: found nothing, allowed: this key is required"),
        ({"rows": []}, "$.rows: found [], allowed: at least one row"),
        ({"rows": [{"title": "a", "pictures": []}]}, "$.rows[0].pictures: found [], allowed: 1 to 4 pictures"),
        (
            {"rows": [{"title": "a", "picture": []}]},
            "$.rows[0].picture: found an unknown key, allowed: title, pictures,",
        ),
        (
            {"rows": [{"title": "a", "pictures": [{"label": "b", "scene": 3}]}]},
            "$.rows[0].pictures[0].scene: found 3, allowed: a string",
        ),
        (
            {"rows": [{"title": "a", "pictures": [{"label": "b", "scene": "c"}], "pixels": 1}]},
            "$.rows[0].pixels: found 1, allowed: true or false",
        ),
        (
            {"rows": [{"title": "a", "pictures": [{"label": "b", "scene": "c"}], "resolution": [3]}]},
            "$.rows[0].resolution: found [3], allowed: [width, height]",
        ),
    ],
)
def test_bad_gallery_files(tmp_path, binary, analysis, spec, message):
    path = tmp_path / "spec.json"
    path.write_text(json.dumps(spec))
    code, out, err = analysis("gallery", "--binary", binary, "--spec", path, "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert err.startswith(f"python3 -m ptbench: {path}: {message}")
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_binary_that_is_not_there_or_cannot_run(tmp_path, analysis):
    plain = tmp_path / "plain"
    plain.write_text("no program")
    for path, found in ((tmp_path / "none", "no such file"), (plain, "a file that cannot be run")):
        code, _, err = analysis("gallery", "--binary", path, "--out", tmp_path / "out")
        assert code == 2
        assert err == f"python3 -m ptbench: {path}: --binary: found {found}, allowed: the ptbench program\n"


@pytest.mark.parametrize(("side", "dpi"), [(64, 128), (256, 128), (300, 150), (800, 200)])
def test_a_sheet_has_its_pictures_pixels_and_enough_for_letters(side, dpi):
    assert sheet_dpi((side, side)) == dpi
