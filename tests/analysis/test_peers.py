"""`peers` with programs that act as renderers: what is measured, what is compared, and what is refused a ratio."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from builder import small
from conftest import ROOT
from peers_fakes import Fakes

from ptbench.crosscheck.renders import WHEEL
from ptbench.errors import FindingError, NotDrawable
from ptbench.extras.peers import figure
from ptbench.extras.peers.document import Peer, scenes_of
from ptbench.extras.peers.process import PeerFailed, Talker
from ptbench.extras.peers.source import PeersSource
from ptbench.extras.peers.statistics import Measured, by_round, variance_of_seeds
from ptbench.extras.peers.wanted import mitsubas, own_variants
from ptbench.findings.page import read_page, render
from ptbench.findings.source import source_of
from ptbench.io.validate import complaints, validate
from ptbench.report.sources import find_sources

BINARY = ROOT / "build/ptbench"
TEMPLATE = ROOT / "docs/templates/peers.md"


@pytest.fixture
def fakes(tmp_path) -> Fakes:
    return Fakes(tmp_path)


def named(document: dict, name: str):
    (scene,) = scenes_of(document)
    return scene, next(peer for peer in scene.peers if peer.name == name)


def test_all_are_timed_by_turns_and_compared(fakes, capsys):
    assert fakes.call("--mitsuba", "good_rgb", "--mitsuba", "good_rgb:bsdf") == 0
    text = capsys.readouterr().out
    document = fakes.document
    assert document["complete"]
    assert validate(fakes.out) == []
    scene, peer = named(document, "Mitsuba good_rgb path")
    # 8 ms of kernels a sample over 2 ms, although the wall says 100.
    assert scene.time_over(peer).value == pytest.approx(4)
    assert scene.time_over(named(document, "Mitsuba good_rgb bsdf")[1]).value == pytest.approx(16)
    # Four times the variance, four times the time.
    cost = scene.cost_over(peer)
    assert cost.low < 16 < cost.high
    assert "8.00 [8.00, 8.00]" in text
    by_round = [
        [one.name for one in sorted(scene.peers, key=lambda one, at=at: one.value["samples"][at]["order"])]
        for at in range(3)
    ]
    assert all(sorted(order) == sorted(by_round[0]) for order in by_round)
    assert len({tuple(order) for order in by_round}) > 1
    assert peer.value["about"] == {"version": "3.9.1", "variant": "good_rgb"}
    assert peer.value["load_ms"] == 12.5


def test_a_render_takes_about_what_it_should(fakes):
    fakes.call("--mitsuba", "good_rgb", "--render-ms", "100")
    spp = {peer["name"]: peer["spp"] for peer in fakes.document["scenes"][0]["peers"]}
    assert spp == {"lights": 64, "chance": 256, "Mitsuba good_rgb path": 16}


def test_a_picture_that_differs_has_no_ratio(fakes, capsys):
    assert fakes.call("--mitsuba", "wrong_rgb") == 1
    scene, peer = named(fakes.document, "Mitsuba wrong_rgb path")
    assert peer.verdict == "differs"
    assert peer.has_times
    assert scene.time_over(peer) is None
    assert scene.cost_over(peer) is None
    row = next(line for line in capsys.readouterr().out.splitlines() if "wrong_rgb" in line)
    assert row.split()[-3:] == ["—", "—", "differs"]


def test_a_picture_that_is_too_noisy_to_tell_has_none_either(fakes):
    assert fakes.call("--mitsuba", "noisy_rgb") == 1
    scene, peer = named(fakes.document, "Mitsuba noisy_rgb path")
    assert peer.verdict == "too weak"
    assert scene.time_over(peer) is None


@pytest.mark.parametrize(
    ("variant", "reason"),
    [
        ("dying_rgb", "LLVM ERROR: Cannot select: fminimum"),
        ("late_rgb", "CUDA_ERROR_OUT_OF_MEMORY"),
        ("faulty_rgb", "a picture with 256 pixels that are infinite or no number"),
    ],
)
def test_a_peer_that_fails_says_why_and_the_others_go_on(fakes, variant, reason):
    assert fakes.call("--mitsuba", variant, "--mitsuba", "good_rgb") == 1
    scene, peer = named(fakes.document, f"Mitsuba {variant} path")
    assert peer.verdict.startswith("failed: ")
    assert peer.verdict.endswith(reason)
    assert scene.time_over(peer) is None
    assert scene.time_over(named(fakes.document, "Mitsuba good_rgb path")[1]) is not None
    assert list(complaints(fakes.document, "peers")) == []


def test_a_variant_that_does_not_apply_is_told(fakes):
    assert fakes.call("--mitsuba", "none", "--variant", "trees:accelerator=absent") == 1
    assert named(fakes.document, "trees")[1].verdict == "failed: n/a: accelerator=absent"


def test_an_unfinished_run_goes_on(fakes, capsys):
    assert fakes.call("--mitsuba", "good_rgb") == 0
    whole = fakes.document
    rest = json.loads(json.dumps(whole)) | {"complete": False}
    for peer in rest["scenes"][0]["peers"]:
        peer["samples"] = [sample for sample in peer["samples"] if sample["round"] < 3]
    rest["scenes"][0]["peers"][0]["samples"][0]["ms"] = 77.0
    fakes.out.write_text(json.dumps(rest), encoding="utf-8")
    capsys.readouterr()
    assert fakes.call("--mitsuba", "good_rgb") == 2
    assert "--resume or --overwrite" in capsys.readouterr().err
    assert fakes.call("--mitsuba", "none", "--resume") == 2
    assert "found another mitsuba" in capsys.readouterr().err
    assert fakes.call("--mitsuba", "good_rgb", "--resume") == 0
    document = fakes.document
    assert document["complete"]
    assert document["scenes"][0]["peers"][0]["samples"][0]["ms"] == 77.0
    for peer, before in zip(document["scenes"][0]["peers"], whole["scenes"][0]["peers"], strict=True):
        assert peer["picture"] == before["picture"]
        assert [sample["round"] for sample in peer["samples"]] == [1, 2, 3]
        assert [sample["order"] for sample in peer["samples"]] == [sample["order"] for sample in before["samples"]]
    capsys.readouterr()
    assert fakes.call("--mitsuba", "good_rgb", "--resume") == 2
    assert "a complete file" in capsys.readouterr().err
    assert fakes.call("--mitsuba", "good_rgb", "--overwrite") == 0


def refusal(fakes: Fakes, capsys, *arguments: str, scene: str = "box") -> str:
    assert fakes.call(*arguments, scene=scene) == 2
    assert not fakes.out.exists()
    return capsys.readouterr().err.splitlines()[-1]


def test_wrong_calls_are_one_line(fakes, capsys):
    assert "allowed: VARIANT, VARIANT:path|bsdf" in refusal(fakes, capsys, "--mitsuba", "cuda_ad_rgb:fast")
    assert "allowed: NAME:AXIS=CHOICE" in refusal(fakes, capsys, "--variant", "fast")
    assert "allowed: NAME=COMMAND" in refusal(fakes, capsys, "--program", "A")
    assert "found lights twice" in refusal(fakes, capsys, "--variant", "lights:direct_light=nee")
    assert "from 2 to 1000" in refusal(fakes, capsys, "--rounds", "1")
    assert "no such file, allowed: an unfinished file" in refusal(fakes, capsys, "--resume")


def test_a_missing_wheel_is_one_line_that_says_what_to_install(fakes, capsys):
    fakes.python.write_text(f'#!/bin/sh\nexec {sys.executable} -S -E -I "$@"\n')
    line = refusal(fakes, capsys, "--mitsuba", "scalar_rgb")
    assert line.startswith("ptbench: Mitsuba 3 is not installed (")
    assert f"{fakes.python} -m pip install {WHEEL}" in line


def test_a_scene_that_mitsuba_lacks_is_measured_without_it(fakes):
    assert fakes.call("--mitsuba", "good_rgb", scene="fog") == 1
    scene, peer = named(fakes.document, "Mitsuba good_rgb path")
    assert scene.value["not_in_mitsuba"] == ["$.materials.wax: found subsurface, allowed: another material"]
    assert peer.verdict == "failed: Mitsuba has no such scene"
    assert named(fakes.document, "chance")[1].compares


def test_a_program_that_renders_a_picture_a_call_is_a_peer(fakes, tmp_path):
    # What is rendered here by ptbench's stand-in could be any program.
    call = f"{fakes.ptbench} render --direct direct_light=nee_mis --spp {{spp}} --seed {{seed}} --out {{out}}"
    adapter = f"{sys.executable} {ROOT}/tools/peers/command_peer.py"
    pattern = r"\"render_seconds\": ([0-9.]+), "
    program = f"student:nee_mis={adapter} --ms '{pattern}' -- {call}"
    silent = f"silent={adapter} --ms 'took (.*) ms' -- {call}"
    assert fakes.call("--mitsuba", "none", "--program", program, "--program", silent) == 1
    scene, peer = named(fakes.document, "student")
    assert (peer.verdict, peer.kind, peer.estimator) == ("agrees", "program", "nee_mis")
    assert peer.value["about"]["program"] == "ptbench"
    # The program prints seconds where milliseconds were asked for.
    assert scene.time_over(peer).value == pytest.approx(1e-3)
    assert "printed nothing like took" in named(fakes.document, "silent")[1].verdict


def test_an_answer_that_is_none_ends_the_peer():
    talker = Talker([sys.executable, "-c", "print('hello'); input(); print('[1]')"], 60)
    with pytest.raises(PeerFailed, match="answered 'hello', which is no JSON object"):
        talker.ask(do="about")
    talker.close()


def test_a_renderer_that_hangs_is_ended():
    talker = Talker([sys.executable, "-c", "import time; time.sleep(600)"], 0.2)
    with pytest.raises(PeerFailed, match="ended with exit code -9"):
        talker.ask(do="about")
    talker.close()


def test_variance_is_that_of_one_sample():
    random = np.random.default_rng(1)
    images = random.normal(1.0, 0.5 / 8, size=(6, 64, 64, 3))
    assert np.mean(variance_of_seeds(images, 64)) == pytest.approx(0.25, rel=0.02)


def test_a_round_counts_once():
    samples = [{"round": 2, "ms": ms, "spp": 2} for ms in (6.0, 2.0, 4.0)] + [{"round": 1, "ms": 3.0, "spp": 1}]
    assert by_round(samples).tolist() == [3.0, 2.0]


def sample(ms: float, device_ms: float | None, foreign_cpu_ms: float | None) -> dict:
    return {"ms": ms, "wall_ms": ms, "device_ms": device_ms, "foreign_cpu_ms": foreign_cpu_ms}


def test_other_processes_disturb_a_gpu_only_where_the_host_was_late():
    alone, shared, unknown = sample(200, 200, 0), sample(200, 199, 90), sample(200, None, None)
    late = sample(200, 150, 90)
    value = {"samples": [alone, shared, unknown, late]}
    assert Peer(value, on_gpu=False).disturbed == 3
    assert Peer(value, on_gpu=True).disturbed == 1


def test_cost_is_variance_times_time():
    base = Measured(np.full(9, 2.0), np.full(8, 0.5))
    peer = Measured(np.full(9, 6.0), np.full(8, 0.25))
    assert peer.time_over(base).value == 3
    ratio = peer.cost_over(base)
    assert (ratio.value, ratio.low, ratio.high) == (1.5, 1.5, 1.5)


def test_what_is_timed_by_default():
    names = [one.name for one in own_variants("cpu", 1)]
    assert names == ["bvh8 nee_mis", "bvh8 off", "embree_native nee_mis", "embree_native off"]
    boxes = own_variants("cpu", 0)
    assert [one.name for one in boxes[:2]] == ["packet nee_mis projected", "packet nee_mis"]
    assert "light_sampling=projected" in boxes[0].axes
    assert [one.estimator for one in own_variants("cuda", 0)] == ["nee_mis", "nee_mis", "off"]
    for meshes, is_by_tree in ((1, False), (10_000, True)):
        for one in own_variants("cuda", meshes):
            assert "accelerator=cwbvh" in one.axes
            assert ("levels=two_level" in one.axes) == is_by_tree
            assert any(axis.startswith("traversal=") for axis in one.axes)
    queues = [[one.name for one in own_variants("cuda", meshes) if "queue" in one.name] for meshes in (0, 1, 16, 17)]
    assert queues == [[], *[["queue nee_mis projected", "queue off"]] * 2, []]
    on_gpu = mitsubas([], "cuda", Path("python3"))
    assert [one.name for one in on_gpu] == [
        "Mitsuba cuda_ad_rgb path", "Mitsuba cuda_ad_rgb bsdf", "Mitsuba cuda_ad_rgb path evaluated",
    ]  # fmt: skip
    assert mitsubas(["none"], "cuda", Path("python3")) == []


def test_the_page_and_its_figure_are_made_of_the_file(fakes, analysis):
    results = fakes.folder / "results"
    fakes.out = results / "nvidia-h200" / "peers.json"
    assert fakes.call("--mitsuba", "good_rgb", "--mitsuba", "wrong_rgb") == 1
    text = render(read_page(TEMPLATE), results)
    assert "| Mitsuba wrong_rgb path | 8.00 [8.00, 8.00] |" in text
    assert "- box: Mitsuba wrong_rgb path: differs" in text
    assert "`box`: Mitsuba good_rgb path at " in text
    assert "Not measured yet: a machine on which nothing else ran" in text
    code, out, _ = analysis("plots", fakes.out)
    assert code == 0
    drawn = results / "nvidia-h200/figures/peers/variance_by_time.svg"
    assert str(drawn) in out
    assert "good_rgb" in drawn.read_text(encoding="utf-8")
    # A peer without a ratio is no point of the figure.
    assert "wrong_rgb" not in drawn.read_text(encoding="utf-8")
    source = source_of(results, {"file": "nvidia-h200/peers.json"})
    assert isinstance(source, PeersSource)
    assert str(source.time_over("box", "Mitsuba good_rgb path")) == "4.00"
    with pytest.raises(FindingError, match="no ratio of Mitsuba wrong_rgb path in box may be given: differs"):
        source.cost_over("box", "Mitsuba wrong_rgb path")
    # Four times the time at four times the variance.
    assert source.must_lead(10, "Far ahead.") == "Far ahead."
    with pytest.raises(FindingError, match=r"costs are not 20 times ptbench's; the page says: Farther\."):
        source.must_lead(20, "Farther.")
    unfinished = results / "unfinished.json"
    unfinished.write_text(json.dumps(fakes.document | {"complete": False}), encoding="utf-8")
    with pytest.raises(FindingError, match="an unfinished run"):
        source_of(results, {"file": "unfinished.json"})


def test_nothing_to_compare_is_not_drawn(fakes):
    fakes.call("--mitsuba", "none", "--aim", "0")
    document = fakes.document
    document["scenes"][0]["peers"] = document["scenes"][0]["peers"][1:]
    with pytest.raises(NotDrawable):
        figure.collect(document)


def test_it_needs_nothing_that_draws_or_checks_schemas(fakes):
    hidden = "matplotlib", "jsonschema", "referencing", "PIL", "jinja2"
    code = f"import sys; sys.modules.update(dict.fromkeys({hidden!r})); from ptbench.cli.main import main; "
    code += "sys.exit(main(sys.argv[1:]))"
    call = [sys.executable, "-c", code, "peers", "box", "--binary", fakes.ptbench, "--python", fakes.python]
    call += ["--variant", "lights:direct_light=nee_mis", "--mitsuba", "good_rgb", "--rounds", "2", "--seeds", "2"]
    call += ["--resolution", "16x16", "--aim", "100", "--out", fakes.out]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "analysis")}
    done = subprocess.run(list(map(str, call)), capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    assert fakes.document["complete"]


def test_a_real_mitsuba_takes_part(tmp_path, capsys, monkeypatch):
    python = os.environ.get("PTBENCH_MITSUBA_PYTHON", sys.executable)
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"no run beside Mitsuba 3: {python} -m pip install {WHEEL}")
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    monkeypatch.setenv("PTBENCH_HOME", str(ROOT))
    fakes = Fakes(tmp_path)
    fakes.ptbench, fakes.python = BINARY, Path(python)
    small = ["--mitsuba", "scalar_rgb", "--rounds", "2", "--spp", "32", "--render-ms", "1", "--aim", "100"]
    assert fakes.call(*small, scene="cornell_open") == 0, capsys.readouterr()
    scene, peer = named(fakes.document, "Mitsuba scalar_rgb path")
    assert peer.verdict == "agrees"
    assert scene.time_over(peer).value > 0
    assert validate(fakes.out) == []


def test_a_report_of_its_folder_passes_it_over(fakes):
    fakes.out = fakes.folder / "results" / "peers.json"
    assert fakes.call("--mitsuba", "good_rgb") == 0
    result = small().write(fakes.folder / "results" / "quick.json")
    found = find_sources([fakes.folder / "results"])
    assert (found.paths, found.passed_over) == ((result,), (fakes.out,))
