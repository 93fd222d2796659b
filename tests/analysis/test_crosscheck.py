"""The cross-check's statistics on made images: equal means pass, planted biases are found at the stated power."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from ptbench.cli.main import main
from ptbench.crosscheck import command, renders
from ptbench.crosscheck.command import _wanted
from ptbench.crosscheck.document import AGREES, DIFFERS, REFUSED, WEAK, Checked, as_json, as_scene, as_text, spp_of
from ptbench.crosscheck.renders import WHEEL, CannotExport, Images, Settings, export, render_here, shipped_scenes
from ptbench.crosscheck.statistics import LEVEL_OF_A_CALL, POWER, block_means, compare, family_of
from ptbench.errors import InputError
from ptbench.io.validate import complaints
from ptbench.program import Program

SEEDS = 8
SHAPE = (32, 32, 3)
BINARY = ROOT / "build/ptbench"


def picture(random: np.random.Generator) -> np.ndarray:
    """Means of pixels, between 1 and 3 and with blocks apart."""
    return 1 + 2 * random.random(SHAPE)


def rendered(random: np.random.Generator, mean: np.ndarray, spread: float = 0.5, seeds: int = SEEDS) -> np.ndarray:
    """Images whose pixels are skewed as rendered ones are: gamma distributed."""
    shape = 1 / spread**2
    return random.gamma(shape, size=(seeds, *mean.shape)) / shape * mean


def found(trials: int, bias: np.ndarray | float, seed: int, test: str, spread: float = 0.5) -> int:
    """In how many of the trials that test tells the biased renderer apart."""
    random = np.random.default_rng(seed)
    mean = picture(random)
    pairs = ((rendered(random, mean), rendered(random, mean * (1 + bias), spread)) for _ in range(trials))
    return sum(getattr(compare(here, there), test).differs for here, there in pairs)


def test_equal_renderers_are_told_apart_as_seldom_as_stated():
    random = np.random.default_rng(1)
    mean = picture(random)
    told = sum(compare(rendered(random, mean), rendered(random, mean, 1.0)).differs for _ in range(200))
    # 200 at 1 %: more than 7 has a probability of 0.1 %.
    assert told <= 7
    assert LEVEL_OF_A_CALL == 0.01


def test_scenes_of_one_call_share_the_probability():
    random = np.random.default_rng(9)
    mean = picture(random)
    images = rendered(random, mean), rendered(random, mean)
    alone, of_fifty = compare(*images), compare(*images, family=family_of(50))
    # Sidak: 1 - (1 - p)^50 is LEVEL_OF_A_CALL.
    assert 1 - (1 - family_of(50)) ** 50 == pytest.approx(LEVEL_OF_A_CALL)
    assert family_of(1) == pytest.approx(LEVEL_OF_A_CALL)
    for test in ("image", "blocks", "pixels"):
        limits = [getattr(one, test).limit_p for one in (of_fifty, alone)]
        assert limits[0] == pytest.approx(limits[1] / 50, rel=0.01)
        assert getattr(of_fifty, test).sees > getattr(alone, test).sees


def test_pixels_of_equal_renderers_have_no_z_on_average():
    random = np.random.default_rng(1)
    mean = np.ones((128, 128, 3))
    pairs = ((rendered(random, mean, 2.0, seeds=4), rendered(random, mean, 2.0, seeds=4)) for _ in range(20))
    z = np.array([compare(here, there).pixels.z for here, there in pairs])
    # The mean of 20 standard normal numbers is beyond 0.7 once in 600. Weights that know a pixel's own noise give 1.4.
    assert abs(z.mean()) < 0.7


@pytest.mark.parametrize(("test", "seed"), [("image", 2), ("blocks", 3), ("pixels", 4)])
def test_a_bias_is_found_at_the_stated_power(test, seed):
    random = np.random.default_rng(seed)
    mean = picture(random)
    stated = getattr(compare(rendered(random, mean), rendered(random, mean)), test).sees
    if test == "image":
        bias = stated
    elif test == "blocks":
        # All blocks could be the one that is found: so one alone has it, all its channels.
        bias = np.zeros(SHAPE)
        bias[8:16, 16:24] = stated
    else:
        # Of equal size everywhere, up and down in turn: no block has a bias.
        rows, columns = np.indices(SHAPE[:2])
        bias = (stated * mean.mean() * np.where((rows + columns) % 2, 1.0, -1.0))[..., None] / mean
    told = found(60, bias, seed + 10, test)
    # 60 at 90 %: fewer than 44 has a probability below 1 in 10,000. At half the bias fewer than half are found.
    assert told >= 44
    assert POWER == 0.9
    assert found(60, 0.5 * bias, seed + 20, test) < told


def test_a_bias_of_pixels_is_seen_in_no_block():
    rows, columns = np.indices(SHAPE[:2])
    bias = 0.2 * np.where((rows + columns) % 2, 1.0, -1.0)[..., None]
    assert found(20, bias, 5, "pixels") == 20
    assert found(20, bias, 5, "image") == 0


def test_pictures_without_noise_may_differ_by_rounding_only():
    still = np.ones((SEEDS, 16, 16, 3))
    assert not compare(still, still * (1 + 5e-6)).differs
    assert compare(still, still * (1 + 5e-4)).differs
    one = still.copy()
    one[:, 3, 5, 1] *= 1.001
    result = compare(still, one)
    assert result.pixels.still_beyond == 1
    assert result.differs
    assert not compare(still, one, allowed=0.01).differs


def test_an_allowance_is_no_difference_and_is_counted_as_unseen():
    random = np.random.default_rng(6)
    mean = picture(random)
    here, there = rendered(random, mean, 0.05), rendered(random, mean * 1.02, 0.05)
    assert compare(here, there).image.differs
    assert not compare(here, there, allowed=0.03).differs
    assert compare(here, there, allowed=0.03).image.sees > 0.03


def test_black_pictures_agree():
    black = np.zeros((2, 8, 8, 3))
    assert not compare(black, black).differs
    lit = black.copy()
    lit[:, 1, 1] = 1
    assert compare(black, lit).differs


def test_blocks_are_means_of_their_pixels():
    images = np.arange(2 * 16 * 8 * 3, dtype=float).reshape(2, 16, 8, 3)
    assert block_means(images)[1, 1, 0, 2] == images[1, 8:, :, 2].mean()


def test_a_histogram_counts_every_pixel_that_has_noise():
    random = np.random.default_rng(7)
    mean = picture(random)
    pixels = compare(rendered(random, mean), rendered(random, mean)).pixels
    assert sum(pixels.histogram) == 32 * 32 * 3
    assert sum(pixels.expected) == pytest.approx(32 * 32 * 3)
    assert pixels.histogram[5] == pytest.approx(pixels.expected[5], rel=0.1)


ASKED = {"scenes": ["a", "b", "c", "d"], "backend": "", "axes": [], "spp": 4, "spp_here": None, "most_spp": 1,
         "first_seed": 1, "aim": 0.005}  # fmt: skip


def settings() -> Settings:
    return Settings(BINARY, Path(sys.executable), "auto", "", (), SEEDS, 1, 4, (32, 32), None, 1.0)


def checked(spread: float, bias: float) -> Checked:
    random = np.random.default_rng(8)
    mean = picture(random)
    about = {"scene_hash": "0123456789abcdef", "variant": "depth_first", "depth": 8, "render_seconds": 1.5}
    here = Images(rendered(random, mean, spread), about)
    there = Images(rendered(random, mean * (1 + bias), spread), {"seconds": 2.5})
    return Checked("small", settings(), compare(here.images, there.images), 0.005, here, there)


def test_verdicts_and_the_file():
    refused = Checked("glass", settings(), None, 0.005, reasons=("$.camera.jitter: found false",))
    all_of_them = [checked(0.02, 0), checked(0.02, 0.05), checked(2, 0), refused]
    assert [one.verdict for one in all_of_them] == [AGREES, DIFFERS, WEAK, REFUSED]
    context = {"date": "2026-11-23T02:00:00+0000", "ptbench.version": "ptbench 1", "ptbench.machine": "m"}
    context |= {"mitsuba.version": "3.9.1", "mitsuba.variant": "scalar_rgb"}
    scenes = [as_scene(one) for one in all_of_them]
    document = json.loads(json.dumps(as_json(scenes, settings(), context, 0.0, ASKED), allow_nan=False))
    assert list(complaints(document, "crosscheck")) == []
    text = as_text(document["scenes"], settings(), 0.005)
    assert [line.split("  ")[-1].strip() for line in text[1:5]] == [AGREES, DIFFERS, WEAK, REFUSED]
    assert text[-1] == "glass: $.camera.jitter: found false"


def test_a_weak_scene_is_rendered_again_with_what_the_aim_needs():
    weak = checked(2, 0)
    needed = 1.5 * 4 * (weak.comparison.image.sees / 0.005) ** 2
    assert needed <= _wanted(weak, 1 << 30) < 2 * needed
    assert _wanted(weak, 64) == 64
    assert _wanted(checked(0.02, 0), 1 << 30) == 0
    assert _wanted(checked(0.02, 0.05), 1 << 30) == 0


def test_a_scene_that_asks_for_depth_gets_it_unless_another_reason_stands():
    deep = "$.materials.wax: found subsurface at depth 8, allowed: --depth 1000 or more, where paths have no end"
    assert CannotExport([deep, deep]).depth == 1000
    assert CannotExport([deep, "$.camera.jitter: found false, allowed: true"]).depth == 0
    assert CannotExport([]).depth == 0


def test_a_scene_is_rendered_until_it_sees_the_aim_each_time_by_other_seeds(stand_ins, tmp_path, monkeypatch):
    asked = []
    random = np.random.default_rng(11)
    mean = picture(random)

    def noisy(settings: Settings, spread: float) -> np.ndarray:
        # Much less noise is promised by the first images than the next ones have.
        return rendered(random, mean, spread if len(asked) < 3 else 0.01, seeds=settings.seeds)

    def here(_, settings: Settings, *__: object, **___: object) -> Images:
        asked.append((settings.spp, settings.first_seed))
        about = {"scene_hash": "0123456789abcdef", "variant": "depth_first", "depth": 8, "render_seconds": 1.5}
        return Images(noisy(settings, 0.5), about)

    monkeypatch.setattr(command, "render_here", here)
    monkeypatch.setattr(command, "render_there", lambda _, settings, __: Images(noisy(settings, 0.5), {"seconds": 1}))
    call = ["crosscheck", "a", *stand_ins, "--seeds", "4", "--spp", "4"]
    assert main([*call, "--most-spp", "100000000"]) == 0
    assert [seed for _, seed in asked] == [1, 5, 9]
    assert asked[0][0] == 4 < asked[1][0] < asked[2][0]
    asked.clear()
    # The most is rendered once, and found too weak.
    assert main([*call, "--most-spp", "8"]) == 1
    assert asked == [(4, 1), (8, 5)]


def test_samples_here_may_be_others_than_there(stand_ins, tmp_path, monkeypatch):
    asked = []
    random = np.random.default_rng(12)
    mean = picture(random)

    def images(about: dict):
        def render(_, settings: Settings, *__: object, **___: object) -> Images:
            asked.append((settings.spp_here, settings.spp, settings.first_seed))
            return Images(rendered(random, mean, 0.5, seeds=settings.seeds), about)

        return render

    about = {"scene_hash": "0123456789abcdef", "variant": "depth_first", "depth": 8, "render_seconds": 1.5}
    monkeypatch.setattr(command, "render_here", images(about))
    monkeypatch.setattr(command, "render_there", images({"seconds": 1}))
    file = tmp_path / "crosscheck.json"
    call = ["crosscheck", "a", *stand_ins, "--seeds", "4", "--out", str(file)]
    assert main([*call, "--spp", "4", "--spp-here", "10", "--most-spp", "8", "--first-seed", "101"]) == 1
    # A second time with as many times more of each.
    assert asked == [(10, 4, 101)] * 2 + [(20, 8, 105)] * 2
    (scene,) = json.loads(file.read_text())["scenes"]
    assert [scene["spp_here"], scene["spp"]] == [20, 8]
    assert spp_of(scene) == "20 here, 8 there"
    assert list(complaints(json.loads(file.read_text()), "crosscheck")) == []
    assert main([*call, "--spp", "4"]) == 1
    (scene,) = json.loads(file.read_text())["scenes"]
    assert "spp_here" not in scene
    assert spp_of(scene) == "4"


def test_each_renderer_takes_its_own_samples(monkeypatch, tmp_path):
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    few = replace(settings(), axes=("direct_light=off",), seeds=2)
    paths = [
        render_here("edge", replace(few, spp_here=here), tmp_path, has_meshes=False).about["paths"]
        for here in (None, 3)
    ]
    assert paths == [32 * 32 * 4, 32 * 32 * 3]


@pytest.mark.parametrize(
    ("pixel", "faults", "said"),
    [
        (np.nan, {}, "ptbench's image, seed 1: found 1 pixels that are infinite or no number"),
        (np.inf, {}, "ptbench's image, seed 1: found 1 pixels that are infinite or no number"),
        (1.0, {"nonfinite": 3}, "ptbench's image, seed 1: found faulty samples {'nonfinite': 3}"),
        (1.0, {"saturated": 1}, "ptbench's image, seed 1: found faulty samples {'saturated': 1}"),
    ],
)
def test_faulty_pictures_are_not_compared(monkeypatch, tmp_path, pixel, faults, said):
    image = np.ones((*SHAPE[:2], 3))
    image[2, 3, 1] = pixel
    monkeypatch.setattr(renders, "read_pfm", lambda _: image)
    about = json.dumps({"render_seconds": 1, "nonfinite": 0, "negative": 0, "saturated": 0} | faults)
    done = subprocess.CompletedProcess([], 0, about, "")
    monkeypatch.setattr(Program, "called", lambda *_: done)
    with pytest.raises(InputError) as error:
        render_here("edge", settings(), tmp_path, has_meshes=False)
    assert said in str(error.value)
    if not faults:
        monkeypatch.setattr(renders, "_worker", lambda *_: {"seconds": 1})
        with pytest.raises(InputError) as error:
            renders.render_there(tmp_path / "scene.xml", settings(), tmp_path)
        assert said.replace("ptbench's", "Mitsuba's") in str(error.value)


def refusal(capsys, *arguments: str) -> str:
    try:
        code = main(["crosscheck", *arguments], "ptbench")
    except SystemExit as error:
        code = error.code
    assert code == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_wrong_calls_are_one_line(capsys):
    assert "multiples of 8" in refusal(capsys, "edge", "--resolution", "30x32")
    assert "from 2 to 1000" in refusal(capsys, "edge", "--seeds", "1")
    assert "a percentage from 0 to 100" in refusal(capsys, "edge", "--aim", "x")
    assert refusal(capsys, "edge", "--binary", "nope") == (
        "ptbench: nope: --binary: found no such file, allowed: the ptbench program"
    )


def test_a_missing_wheel_is_one_line_that_says_what_to_install(capsys, tmp_path):
    # A Python without site packages has none.
    bare = tmp_path / "python"
    bare.write_text(f'#!/bin/sh\nexec {sys.executable} -S -E -I "$@"\n')
    bare.chmod(0o755)
    program = tmp_path / "ptbench"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    line = refusal(capsys, "edge", "--binary", str(program), "--python", str(bare))
    assert line.startswith("ptbench: Mitsuba 3 is not installed (")
    assert f"{bare} -m pip install {WHEEL}" in line


def test_all_are_the_scenes_by_name_and_those_of_folders():
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    names = shipped_scenes(Program(BINARY))
    folders = {"environments/environment_sun", "textures/textures", "scaling/materials_08", "meshes/teapot_room"}
    assert {"cornell_open"} | folders <= set(names)
    assert not [name for name in names if name.startswith(("suites", "stability"))]


@pytest.fixture
def stand_ins(tmp_path, monkeypatch):
    """A program and a Mitsuba that make grey pictures; the calls of both are kept."""
    program = tmp_path / "ptbench"
    program.write_text(
        f"#!{sys.executable}\n"
        "import json, sys\n"
        "word, rest = sys.argv[1], sys.argv[2:]\n"
        f"open({str(tmp_path / 'calls')!r}, 'a').write(word + ' ' + ' '.join(rest) + '\\n')\n"
        "print({'--version': 'ptbench 1', 'machine': 'm', 'export': ''}.get(word, ''))\n"
    )
    program.chmod(0o755)
    images = np.ones((2, 8, 8, 3))
    about = {"scene_hash": "0123456789abcdef", "variant": "depth_first", "depth": 8, "render_seconds": 1.5}
    module = "ptbench.crosscheck.command."
    monkeypatch.setattr(module + "mitsuba_version", lambda _: {"version": "3.9.1", "variant": "llvm_ad_rgb"})
    monkeypatch.setattr(module + "has_meshes", lambda _: False)
    monkeypatch.setattr(module + "render_here", lambda *_, **__: Images(images, about))
    monkeypatch.setattr(module + "render_there", lambda *_: Images(images, {"seconds": 2.5}))
    return ["--binary", str(program), "--seeds", "2", "--resolution", "8x8", "--out", str(tmp_path / "found.json")]


def test_an_unfinished_file_is_gone_on_with(stand_ins, tmp_path):
    found, calls = tmp_path / "found.json", tmp_path / "calls"
    assert main(["crosscheck", "a", "b", *stand_ins]) == 0
    whole = json.loads(found.read_text())
    assert list(complaints(whole, "crosscheck")) == []
    assert (whole["settings"]["family"], whole["settings"]["family_scenes"]) == (LEVEL_OF_A_CALL, 2)
    found.write_text(json.dumps(whole | {"scenes": whole["scenes"][:1]}))
    calls.unlink()
    assert main(["crosscheck", "a", "b", *stand_ins, "--resume"]) == 0
    resumed = json.loads(found.read_text())
    assert resumed["scenes"] == whole["scenes"]
    assert list(complaints(resumed, "crosscheck")) == []
    assert [line.split()[1] for line in calls.read_text().splitlines() if line.startswith("export")] == ["b"]


@pytest.mark.parametrize(
    ("scenes", "other", "said"),
    [
        (["a", "b"], ["--depth", "3"], "$.settings.depth: found null, allowed: 3"),
        (["a", "b"], ["--spp", "64"], "$.call.spp: found"),
        (["a", "b"], ["--spp-here", "64"], "$.call.spp_here: found null, allowed: 64"),
        (["a", "b"], ["--first-seed", "101"], "$.call.first_seed: found 1, allowed: 101"),
        (["a", "b"], ["--aim", "10"], "$.call.aim: found 0.005, allowed: 0.1"),
        (["a", "b"], ["--most-spp", "7"], "$.call.most_spp: found"),
        (["a", "b"], ["--axis", "direct_light=nee"], '$.call.axes: found [], allowed: ["direct_light=nee"]'),
        (["c", "d"], [], '$.call.scenes: found ["a", "b"], allowed: ["c", "d"]'),
    ],
)
def test_a_file_of_another_call_is_not_gone_on_with(stand_ins, tmp_path, capsys, scenes, other, said):
    assert main(["crosscheck", "a", "b", *stand_ins]) == 0
    kept = (tmp_path / "found.json").read_bytes()
    capsys.readouterr()
    assert main(["crosscheck", *scenes, *stand_ins, "--resume", *other]) == 2
    assert said in capsys.readouterr().err
    assert (tmp_path / "found.json").read_bytes() == kept


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--resolution", "48x64"], "--resolution: found 48x64, allowed: multiples of 32 with scalar_rgb"),
        (["--resolution", "1024x1024", "--first-seed", "4095"], "found 4096 as the last seed, allowed: below 4096"),
        (["--resolution", "1024x1024", "--first-seed", "4094"], None),
        (["--resolution", "32x64"], None),
    ],
)
def test_seeds_that_would_share_random_numbers_are_refused(stand_ins, capsys, monkeypatch, given, said):
    peer = {"version": "3.9.1", "variant": "scalar_rgb"}
    monkeypatch.setattr("ptbench.crosscheck.command.mitsuba_version", lambda _: peer)
    assert main(["crosscheck", "a", *stand_ins, *given]) == (0 if said is None else 2)
    assert said is None or said in capsys.readouterr().err


def test_a_file_of_something_else_is_not_gone_on_with(stand_ins, tmp_path, capsys):
    (tmp_path / "found.json").write_text("[]")
    assert main(["crosscheck", "a", *stand_ins, "--resume"]) == 2
    assert "$: found list, allowed: a file of crosscheck" in capsys.readouterr().err


def test_several_scenes_at_a_time_are_written_in_the_order_asked_for(stand_ins, tmp_path, monkeypatch):
    names = ["a", "b", "c", "d"]
    waited = threading.Barrier(4)
    there = command.render_there

    def together(*arguments: object) -> Images:
        # Passed only where all four are being rendered.
        waited.wait(timeout=20)
        return there(*arguments)

    monkeypatch.setattr(command, "render_there", together)
    assert main(["crosscheck", *names, *stand_ins, "--jobs", "4"]) == 0
    found = json.loads((tmp_path / "found.json").read_text())
    assert [scene["scene"] for scene in found["scenes"]] == names


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_a_scene_that_fails_does_not_lose_the_others(stand_ins, tmp_path, capsys, monkeypatch, jobs):
    here = command.render_here

    def failing(scene: str, *arguments: object, **named: object) -> Images:
        if scene == "b":
            raise InputError("out of memory")
        return here(scene, *arguments, **named)

    monkeypatch.setattr(command, "render_here", failing)
    assert main(["crosscheck", "a", "b", "c", *stand_ins, "--jobs", jobs]) == 2
    assert capsys.readouterr().err.splitlines()[-1].endswith("ptbench: b: out of memory")
    found = json.loads((tmp_path / "found.json").read_text())
    assert [scene["scene"] for scene in found["scenes"]] == ["a", "c"]
    # The scenes share the family's probability with the one that failed, too.
    assert found["settings"]["family_scenes"] == 3


def test_meshes_on_a_gpu_go_through_the_tree_that_is_built_there(tmp_path):
    program = tmp_path / "ptbench"
    program.write_text(f'#!/bin/sh\necho "$@" > {tmp_path / "call"}\nexit 1\n')
    program.chmod(0o755)
    for backend, tree in (("cuda", "cwbvh --axis builder=hploc"), ("cpu", "bvh8"), ("", "bvh8")):
        asked = replace(settings(), binary=program, backend=backend)
        with pytest.raises(InputError):
            render_here("room", asked, tmp_path, has_meshes=True)
        call = (tmp_path / "call").read_text()
        assert f"--axis accelerator={tree} --axis levels=two_level" in call


def test_the_wheel_is_the_extra_of_the_package():
    assert f'crosscheck = ["{WHEEL}"]' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


# Together a few seconds: a shape, a material, a lamp or a camera of each kind.
SMALL = {
    "ball_glass": 24,
    "ball_mirror": 8,
    "caustic": 24,
    "cornell_open": 16,
    "cornell_open_45": 16,
    "dof_focus_8_7": 16,
    "edge": 8,
    "jitter_on": 8,
    "many_lights": 16,
    "motion_off": 8,
    "scenes/meshes/icosphere_room.json": 8,
    # Absorption, tints, an environment, turned boxes and meshes of glass, a lamp that is a mesh; surfaces that reflect
    # and emit on both sides, a lens, instances.
    "tests/analysis/crosscheck_scenes/odd_glass.json": 8,
    "tests/analysis/crosscheck_scenes/odd_lamps.json": 16,
    # Bodies that scatter, with and without a boundary that refracts.
    "tests/analysis/crosscheck_scenes/odd_bodies.json": 32,
    # An image all round, turned.
    "scenes/environments/environment_sun.json": 16,
    "scenes/meshes/sphereflake_room.json": 8,
}


@pytest.fixture(scope="module")
def mitsuba() -> str:
    """A Python that has the wheel: this one, or the one that PTBENCH_MITSUBA_PYTHON names."""
    python = os.environ.get("PTBENCH_MITSUBA_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"no cross-check with Mitsuba 3: {python} -m pip install {WHEEL}")
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    return python


@pytest.mark.parametrize("scene", SMALL)
def test_small_scenes_agree_with_mitsuba(scene, mitsuba, capsys, monkeypatch):
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    monkeypatch.chdir(ROOT)
    call = ["crosscheck", scene, "--binary", str(BINARY), "--python", mitsuba, "--backend", "cpu"]
    # Few samples: whether they differ by several per cent.
    code = main([*call, "--variant", "scalar_rgb", "--resolution", "32x32", "--spp", str(SMALL[scene]), "--aim", "100"])
    assert code == 0, capsys.readouterr().out


def test_a_scale_reaches_the_program_with_every_digit(monkeypatch, tmp_path):
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    xml = export("edge", replace(settings(), scale=2.0**-19), tmp_path).read_text(encoding="utf-8")
    assert 'origin="0, 0, 3.814697265625e-06"' in xml


def test_a_wrong_picture_is_told_apart(mitsuba, capsys, monkeypatch):
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    monkeypatch.chdir(ROOT)
    call = ["crosscheck", "ball_mirror", "--binary", str(BINARY), "--python", mitsuba, "--backend", "cpu"]
    small = ["--variant", "scalar_rgb", "--resolution", "32x32", "--spp", "16", "--aim", "100"]
    # The dimmer of two depths: what the program is asked for, and not the file.
    monkeypatch.setattr("ptbench.crosscheck.command.export", _deeper)
    assert main([*call, *small, "--depth", "2"]) == 1
    assert " differs" in capsys.readouterr().out


def test_an_environment_turned_otherwise_is_told_apart(mitsuba, capsys, monkeypatch):
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    monkeypatch.chdir(ROOT)
    call = ["crosscheck", "environments/environment_sun", "--binary", str(BINARY), "--python", mitsuba]
    small = ["--backend", "cpu", "--variant", "scalar_rgb", "--resolution", "32x32", "--spp", "16", "--aim", "100"]
    # The sky's sun is elsewhere: 30 degrees the other way.
    monkeypatch.setattr("ptbench.crosscheck.command.export", _turned)
    assert main([*call, *small]) == 1
    assert " differs" in capsys.readouterr().out


def _turned(scene: str, asked: Settings, folder: Path) -> Path:
    xml = export(scene, asked, folder)
    text = xml.read_text(encoding="utf-8")
    assert 'angle="30"' in text
    xml.write_text(text.replace('angle="30"', 'angle="-30"'), encoding="utf-8")
    return xml


def _deeper(scene: str, asked: Settings, folder: Path) -> Path:
    try:
        return export(scene, replace(asked, depth=3), folder)
    except CannotExport as error:
        raise AssertionError(error.reasons) from error
