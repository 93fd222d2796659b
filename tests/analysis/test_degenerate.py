"""Data that leave a figure nothing to scale by, all 0, all equal, one point: it is drawn, or one line says why not."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator

import pytest
from builder import Builder, agreeing, crossing, small
from conftest import run_analysis
from convergence_builder import Law, convergence_cell, convergence_study, on_gpu, without_checkpoints
from legibility import check_legible
from matplotlib.figure import Figure
from stability_builder import FLOAT, NAIVE, StabilityBuilder

from ptbench.errors import NotDrawable
from ptbench.extras.peers import figure as peers
from ptbench.figures import style
from ptbench.figures.registry import collect_study, draw, parts_of_study
from ptbench.figures.stability import heatmap, sweep
from ptbench.io.nodes import read_json
from ptbench.io.results import load, result_of
from ptbench.io.stability import Stability, is_stability, stability_of
from ptbench.plots.summary import summary

EXACT = Law(0, 0, noisy=False)
SPPS = [1, 2, 4, 8, 16]


def convergence(*laws: Law, scene: str = "cornell_open", builder: Builder | None = None, **fields) -> Builder:
    """A cell a law, the second with connections."""
    builder = builder or convergence_study(on_gpu())
    for index, law in enumerate(laws):
        axes = {"direct_light": "off" if index == 0 else "nee"}
        convergence_cell(builder, law, scene=scene, axes=axes, **{"spps": SPPS, "time_noise": 0.0, **fields})
    return builder


def samples(document: dict) -> list[dict]:
    return [row for row in document["benchmarks"] if row["run_type"] == "iteration"]


def equal_times(document: dict) -> None:
    for row in samples(document):
        row.update(real_time=8.0, pt_wall_ms=8.0, pt_device_ms=8.0, cpu_time=8.0)


def one_cell_a_study(document: dict) -> None:
    cells = document["ptbench"]["cells"]
    firsts = [
        next((cell["cell"] for cell in cells if study["name"] in cell["studies"]), "")
        for study in document["ptbench"]["studies"]
    ]
    document["ptbench"]["cells"] = [cell for cell in cells if cell["cell"] in firsts]
    document["benchmarks"] = [row for row in document["benchmarks"] if row["run_name"] in firsts]


def one_sample_a_cell(document: dict) -> None:
    document["benchmarks"] = [row | {"repetitions": 1} for row in samples(document) if row["repetition_index"] == 0]


def nothing_measured(document: dict) -> None:
    document["benchmarks"] = []
    for cell in document["ptbench"]["cells"]:
        cell.update(status="failed", reason="no device")


def no_cells(document: dict) -> None:
    document["benchmarks"] = document["ptbench"]["cells"] = []


def stability(*points: float, error: float = 0.0, allowed: float = 1e-6) -> StabilityBuilder:
    builder = StabilityBuilder().case()
    for point in points:
        for axes in (FLOAT, NAIVE):
            builder.row(axes, error, allowed, a=point)
    return builder


FILES: dict[str, Callable[[], dict]] = {
    "errors all 0": lambda: convergence(EXACT, EXACT).document(),
    "errors all 0, against a closed form": lambda: convergence(EXACT, closed_form=True).document(),
    "errors of one cell 0": lambda: convergence(Law(noisy=False), EXACT).document(),
    "errors of one scene 0": lambda: convergence(
        EXACT, EXACT, scene="furnace", builder=convergence(Law(noisy=False), Law(noisy=False))
    ).document(),
    "errors all equal": lambda: convergence(Law(0, 0.1, noisy=False), Law(0, 0.1, noisy=False)).document(),
    "one checkpoint": lambda: convergence(Law(), spps=[1]).document(),
    "one seed": lambda: convergence(Law(), seeds=1).document(),
    "stability: errors and bounds 0": lambda: stability(0.1, 0.01, allowed=0.0).document(),
    "stability: errors infinite": lambda: stability(0.1, 0.01, error=float("inf")).document(),
    "stability: one point": lambda: stability(0.1).document(),
    "stability: one point, at 0": lambda: stability(0.0, allowed=0.0).document(),
    "stability: no rows": lambda: StabilityBuilder().case().document(),
    "stability: no cases": lambda: StabilityBuilder().document(),
}


def changed(make: Callable[[], Builder], change: Callable[[dict], None]) -> dict:
    document = make().document()
    change(document)
    return agreeing(document)


for name, make in {"small": small, "crossing": crossing}.items():
    for change in (equal_times, one_cell_a_study, one_sample_a_cell, nothing_measured, no_cells):
        FILES[f"{name}: {change.__name__}"] = lambda make=make, change=change: changed(make, change)


# Pages are laid out and not written, which would take most of the time.
@pytest.mark.parametrize("name", FILES)
def test_figures_are_drawn_or_say_why_not(tmp_path, name):
    file = tmp_path / "result.json"
    file.write_text(json.dumps(FILES[name]()), encoding="utf-8")
    root = read_json(file)
    if is_stability(root):
        with style.applied():
            for page in pages_of(stability_of(root)):
                page.draw_without_rendering()
        return
    result = result_of(root)
    not_drawn = {}
    for study in result.studies:
        for part in parts_of_study(study):
            try:
                draw(collect_study(result, study, part)).draw_without_rendering()
            except NotDrawable as reason:
                not_drawn.setdefault(study.name, []).append(f"{part}: {reason}")
    for word in ("nan", "inf"):
        assert not re.search(rf"(?<![a-z]){word}(?![a-z])", summary(result, not_drawn, {}), re.IGNORECASE)


def pages_of(stability: Stability) -> Iterator[Figure]:
    for figure in (heatmap, sweep):
        try:
            pages = figure.collect(stability)
        except NotDrawable:
            continue
        for page in pages:
            yield figure.draw(page)


@pytest.mark.parametrize(
    "name", ["errors all 0", "errors of one scene 0", "small: nothing_measured", "small: no_cells"]
)
def test_commands_end_well(tmp_path, analysis, name):
    file = tmp_path / "result.json"
    file.write_text(json.dumps(FILES[name]()), encoding="utf-8")
    for command in ("plots", "report"):
        code, _, err = analysis(command, file, "--out", tmp_path / command)
        assert (code, err) == (0, "")


def collected(builder: Builder, folder, part: str = ""):
    result = load(builder.write(folder / "result.json"))
    return result.studies[0], collect_study(result, result.studies[0], part)


def test_errors_that_are_all_0_are_said_to_be(tmp_path):
    with pytest.raises(NotDrawable, match=r"^cornell_open: no error is above 0, and the axis is logarithmic$"):
        collected(convergence(EXACT, EXACT), tmp_path)


def test_a_line_without_an_error_is_named_and_not_drawn(tmp_path):
    _study, data = collected(convergence(Law(noisy=False), EXACT), tmp_path)
    page = draw(data)
    check_legible(page, "error_against_time")
    assert "nee\nno error above 0" in [text.get_text() for text in page.texts]


@pytest.mark.parametrize("part", ["", "time_to_error"])
def test_a_scene_without_errors_leaves_the_others_theirs(tmp_path, part):
    builder = convergence(EXACT, scene="furnace", builder=convergence(Law(noisy=False)))
    for cell in list(builder.cells):
        without_checkpoints(builder, cell, 2.0, spp=SPPS[-1], scene=cell["scene"])
    _study, data = collected(builder, tmp_path, part)
    assert "Not drawn, since no error is above 0: furnace." in data.caption
    assert len(draw(data).axes) == 1


def test_peers_without_noise_have_no_place_on_a_logarithmic_axis(monkeypatch):
    from types import SimpleNamespace

    def peer(variance: float):
        measured = SimpleNamespace(time=1.0, noise=SimpleNamespace(value=variance))
        return SimpleNamespace(name=str(variance), measured=measured, compares=True)

    assert [point.label for point in peers._points(SimpleNamespace(peers=[peer(0.0), peer(0.5)]))] == ["0.5"]
    monkeypatch.setattr(peers, "scenes_of", lambda _: [SimpleNamespace(name="a/black", peers=[peer(0.0)])])
    with pytest.raises(NotDrawable, match="with a variance above 0"):
        peers.collect({})


@pytest.mark.parametrize(("low", "high", "room"), [(1, 3, 0.2), (2, 2, 0.2), (-2, -2, 0.2), (0, 0, 0.1)])
def test_an_axis_of_one_value_has_room_too(low, high, room):
    assert style.room(low, high, 0.1) == pytest.approx(room)


def test_a_notebooks_backend_is_not_ours(tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    file = Builder().study("compaction").write(tmp_path / "result.json")
    said = run_analysis("plots", file, "--out", tmp_path / "figures")
    assert (said.returncode, said.stderr) == (0, "")
