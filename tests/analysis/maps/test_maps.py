"""Crossover maps: the line of a known field, resumption, definitions, scenes by rules, the page."""

from __future__ import annotations

import json
import math
import shutil
import sys
import tempfile
from pathlib import Path

import pytest
from builder import Builder
from conftest import COMMITTED, ROOT

from ptbench.errors import InputError
from ptbench.extras.maps.definition import STATISTICS, Definition, maps_in, read_map
from ptbench.extras.maps.measuring import BUDGET, SETTLED, Sheet, measured_by, refine, sheet_of, write_sheet
from ptbench.extras.maps.refining import ABOVE, BELOW, OPEN, Axis, brackets_of, next_cells, spans_of, verdict_of
from ptbench.extras.maps.scenes import RULES, balls, lamps, openness
from ptbench.io.validate import schema, validate
from ptbench.program import Program
from ptbench.stats.estimates import Estimate

MAP = {
    "schema": "ptbench-map-1", "title": "Sorting", "question": "When?", "backend": "cuda",
    "choice": {"axes": {"integrator": "wavefront", "sorting": "bucket"}},
    "over": {"axes": {"integrator": "wavefront", "sorting": "none"}},
    "x": {"label": "materials", "sets": "scene.materials", "from": 1, "to": 64, "cells": 3, "integer": True},
    "y": {"label": "cost", "sets": "tunable.shading_fmas", "from": 16, "to": 4096, "cells": 3, "integer": True},
    "scene": {"rule": "balls"}, "setting": {"resolution": [20, 20], "depth": 8, "spp": 2},
    "statistic": "time", "repetitions": 9, "bracket": 1.5, "budget_s": 600,
}  # fmt: skip
AXES = (Axis("x", 1.0, 1024.0, 5), Axis("y", 1.0, 1024.0, 5))


def field(x: float, y: float) -> float:
    """A ratio that is 1 on the line x^2 y = 4096 * 2: its place is known in every row and column."""
    return 8192.0 / (x * x * y)


def exact(ratio: float) -> Estimate:
    return Estimate(ratio, ratio, ratio, 9)


def refined(axes, bracket: float, noise: float = 0.0) -> dict:
    known = {}
    while places := next_cells(axes, known, bracket):
        ratio = field(*places[0])
        known[places[0]] = Estimate(ratio, ratio * math.exp(-noise), ratio * math.exp(noise), 9)
    return known


def line(along: int, at: float) -> float:
    return math.sqrt(8192 / at) if along == 0 else 8192 / at**2


def test_the_line_of_a_known_field_lies_in_every_bracket():
    known = refined(AXES, 1.2)
    spans = spans_of(AXES, known)
    # Every row has the line within its ends; of the columns those on which it is between 1 and 1024.
    crossed = {(0, at) for at in AXES[1].grid} | {(1, at) for at in AXES[0].grid if 1 < line(1, at) < 1024}
    assert {(one.along, one.at) for one in spans} == crossed
    for one in spans:
        assert one.low < line(one.along, one.at) < one.high
        assert one.width <= 1.2
        assert one.is_firm


def test_cells_are_spent_near_the_line():
    known = refined(AXES, 1.2)
    # A whole grid this fine would have a cell every factor of 1.2 along both axes.
    assert len(known) < 0.1 * (math.log(1024) / math.log(1.2)) ** 2
    beyond = [place for place in known if place not in {(x, y) for x in AXES[0].grid for y in AXES[1].grid}]
    near = [place for place in beyond if 1 / 64 < field(*place) < 64]
    assert len(near) > 0.9 * len(beyond)


def test_the_widest_bracket_comes_first_and_open_ones_last():
    known = {(x, y): exact(field(x, y)) for x in AXES[0].grid for y in AXES[1].grid}
    first = next_cells(AXES, known, 1.2)[0]
    assert first not in known
    widest = max(brackets_of(AXES, known), key=lambda one: one.width)
    assert AXES[widest.along].middle(widest.low, widest.high) == first[widest.along]
    row = AXES[1].grid[0]
    known[(AXES[0].grid[1], row)] = Estimate(1.0, 0.9, 1.1, 9)
    beside = [one for one in brackets_of(AXES, known) if not one.is_firm]
    assert beside
    assert all(AXES[0].grid[1] in (one.low, one.high, one.at) for one in beside)
    ordered = next_cells(AXES, known, 1.2)
    middles = [middle_of(one) for one in beside]
    assert {ordered.index(place) for place in middles if place in ordered} <= set(
        range(len(ordered) - len(beside), 999)
    )


def middle_of(one) -> tuple[float, float]:
    middle = AXES[one.along].middle(one.low, one.high)
    return (middle, one.at) if one.along == 0 else (one.at, middle)


def test_open_cells_are_within_the_band():
    known = refined(AXES, 1.2, noise=0.5)
    for one in spans_of(AXES, known):
        assert one.low < line(one.along, one.at) < one.high
        assert not one.is_firm
        assert one.width > 1.2


def test_integers_end_where_none_is_between():
    axes = (Axis("x", 1.0, 16.0, 3, is_integer=True), AXES[1])
    known = {}
    while places := next_cells(axes, known, 1.0001):
        x = places[0][0]
        assert x == round(x)
        known[places[0]] = exact(2.5 / x)
        if len(known) > 200:  # the other axis never ends
            break
    (row, *_) = [one for one in spans_of(axes, known) if one.along == 0]
    assert (row.low, row.high) == (2.0, 3.0)


def test_verdicts():
    found = [verdict_of(one) for one in (exact(0.5), exact(2.0), exact(1.0), Estimate(0.5, None, None, 1), None)]
    assert found == [BELOW, ABOVE, OPEN, OPEN, None]


def definition(**changes) -> Definition:
    return read_map_of({**MAP, **changes})


def read_map_of(document: dict, folder: Path | None = None) -> Definition:
    with tempfile.TemporaryDirectory() as name:
        path = (folder or Path(name)) / "sorting.json"
        path.write_text(json.dumps(document))
        return read_map(path)


def law(asked: Definition, place: tuple[float, float]) -> float:
    """Over 1 where there are few materials and little cost."""
    return 128 / (place[0] * math.sqrt(place[1]))


class Machine:
    """Measures the law, or fails, and counts."""

    def __init__(self, **changes) -> None:
        self.places: list = []
        self.changes = changes

    def __call__(self, asked: Definition, place: tuple[float, float]) -> dict:
        self.places.append(place)
        ms = [law(asked, place)] * 9
        return {
            "seconds": 10.0,
            "failed": "",
            "disturbed": False,
            "choice_ms": ms,
            "over_ms": [1.0] * 9,
            **self.changes,
        }


def test_a_map_that_is_cut_short_goes_on_as_if_it_had_not_been(tmp_path):
    whole, file = Sheet(definition()), tmp_path / "sorting.json"
    once = Machine()
    refine(whole, once, 1e9)
    assert whole.ended == SETTLED
    parts = []
    for budget in (50, 120, 1e9):
        machine = Machine()
        sheet = sheet_of(definition(), file)
        refine(sheet, machine, budget, lambda sheet: write_sheet(sheet, file))
        parts.append(machine.places)
    assert [len(part) for part in parts[:2]] == [5, 7]
    assert [place for part in parts for place in part] == once.places
    assert json.loads(file.read_text())["cells"] == whole.document()["cells"]
    assert sheet_of(definition(), file).known == whole.known


def test_the_budget_ends_it():
    sheet = Sheet(definition())
    refine(sheet, Machine(), 35)
    assert (len(sheet.cells), sheet.ended, sheet.seconds) == (3, BUDGET, 30)


def test_disturbed_and_failed_runs_settle_nothing_and_are_measured_again():
    sheet = Sheet(definition())
    refine(sheet, Machine(disturbed=True), 1e9)
    assert len(sheet.cells) == 9
    assert spans_of(sheet.definition.axes, sheet.known) == []
    refine(sheet, Machine(failed="no"), 1e9)
    assert set(sheet.known.values()) == {None}
    machine = Machine()
    refine(sheet, machine, 1e9)
    assert len(machine.places) > 9
    assert spans_of(sheet.definition.axes, sheet.known)


def test_times_to_an_image_share_their_run():
    about = {"statistic": "time to an image", "scene": {"rule": "balls", "materials": 2},
             "x": {"label": "samples", "sets": "samples", "from": 1, "to": 1024, "cells": 3}}  # fmt: skip
    sheet = Sheet(definition(**about))
    # 100 + 1 n against 0 + 2 n: equal at 100 samples, whatever the cost.
    machine = Machine(choice_ms=[1.0] * 9, over_ms=[2.0] * 9, choice_build_ms=100.0, over_build_ms=0.0)
    refine(sheet, machine, 1e9)
    assert len(machine.places) == 3
    rows = [one for one in spans_of(sheet.definition.axes, sheet.known) if one.along == 0]
    assert len(rows) == 3
    assert all(one.low < 100 < one.high and one.width <= 1.5 for one in rows)


def test_another_definition_does_not_go_on(tmp_path):
    sheet, file = Sheet(definition()), tmp_path / "sorting.json"
    refine(sheet, Machine(), 35)
    write_sheet(sheet, file)
    assert sheet_of(definition(budget_s=10, bracket=2.0), file).cells
    with pytest.raises(InputError, match="another definition than the map's file"):
        sheet_of(definition(repetitions=10), file)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"statistic": "speed"}, "statistic"),
        ({"scene": {"rule": "cubes"}}, 'found "cubes", allowed: balls'),
        ({"scene": {"rule": "lamps"}}, "the parameters of its rule"),
        ({"x": {**MAP["x"], "sets": "width"}}, r"\$.x.sets: found"),
        ({"x": {**MAP["x"], "sets": "samples"}}, 'with "statistic": "time to an image" only'),
        ({"x": {**MAP["x"], "sets": "side", "integer": False}}, 'side without "integer": true'),
        ({"x": {**MAP["x"], "sets": "spp", "from": 0.5}}, "from below 1, allowed: integers from 1"),
        ({"x": {**MAP["x"], "sets": "spp"}, "statistic": "time to an image"}, 'found "spp", allowed: "samples" with'),
        ({"x": {**MAP["x"], "from": 64}}, "a first value below the last"),
        ({"statistic": "variance at equal samples"}, "setting.reference"),
    ],
)
def test_a_wrong_definition_is_one_line(changes, message):
    with pytest.raises(InputError, match=message) as caught:
        definition(**changes)
    assert "\n" not in str(caught.value)


def test_the_schema_names_the_statistics():
    assert set(schema("map")["properties"]["statistic"]["enum"]) == set(STATISTICS)


def test_committed_maps_are_as_their_schema_says():
    found = maps_in(ROOT / "maps")
    assert {one["backend"] for one in found} == {"cpu", "cuda"}
    for one in found:
        assert one["budget_s"] <= 600
        places = [(x, y) for x in one.axes[0].grid for y in one.axes[1].grid]
        assert len(places) >= 16
        assert all(one.scene(place)["objects"] for place in (places[0], places[-1]))
        validate(ROOT / "maps" / f"{one.name}.json")


def test_balls_are_those_of_the_scaling_scenes():
    def spheres(scene: dict) -> list:
        return [one for one in scene["objects"] if one["shape"] == "sphere"]

    for count in (1, 4, 64):
        committed = json.loads((ROOT / f"scenes/scaling/materials_{count:02}.json").read_text())
        assert spheres(balls(count)) == spheres(committed)


def test_lamps_have_one_power_and_stay_apart():
    for count, size in ((1, 0.5), (5, 0.5), (64, 1.0)):
        scene = lamps(count, size)
        boxes = [one for one in scene["objects"] if one["material"] == "light"]
        assert len(boxes) == count
        assert scene["materials"]["light"]["radiance"][0] * count * size * size == pytest.approx(45)
        places = {(one["translate"][0], one["translate"][2]) for one in boxes}
        assert len(places) == count
        assert all(abs(value) + size / 2 <= 5 for place in places for value in place)


def test_a_room_opens_until_its_front_half_is_gone():
    assert len(openness(1.0)["objects"]) == 7
    widths = [openness(share)["objects"][-2]["scale"][0] for share in (0.1, 0.5)]
    assert widths == [9.0, 5.0]


def test_rules_name_scenes_apart():
    names = {RULES["lamps"](count, size)["name"] for count in (1, 2) for size in (0.25, 0.5)}
    assert len(names) == 4


def result_of_cell() -> Builder:
    builder = Builder("map_cell").on_gpu().study("cell", "sorting")
    builder.cell("cell", "balls_1", 3.0, noise=0.0)
    builder.cell("cell", "balls_1", 6.0, noise=0.0, axes={"sorting": "bucket"})
    return builder


def program_in(folder: Path, result: Path) -> Program:
    """Keeps the last suite and scene that it was called with, and has one result."""
    file = folder / "ptbench"
    file.write_text(
        f"#!{sys.executable}\nimport json, shutil, sys\n"
        "if sys.argv[1] == 'machine': print('nvidia-h200'); raise SystemExit\n"
        "named = dict(zip(sys.argv, sys.argv[1:]))\n"
        f"shutil.copy(named['--suite'], {str(folder / 'suite.json')!r})\n"
        f"shutil.copy({str(result)!r}, named['--out'])\n"
    )
    file.chmod(0o755)
    return Program(file)


def test_a_cell_is_a_small_suite_of_both_choices(tmp_path):
    program = program_in(tmp_path, result_of_cell().write(tmp_path / "result.json"))
    run = measured_by(program)(definition(), (4.0, 256.0))
    assert (run["choice_ms"], run["over_ms"], run["failed"]) == ([6.0] * 9, [3.0] * 9, "")
    (study,) = json.loads((tmp_path / "suite.json").read_text())["studies"]
    assert study["variants"] == [
        {"axes": {"integrator": ["wavefront"], "sorting": ["bucket"]}, "tunables": {"shading_fmas": [256]}},
        {"axes": {"integrator": ["wavefront"], "sorting": ["none"]}, "tunables": {"shading_fmas": [256]}},
    ]
    assert (study["depth"], study["spp"], study["resolution"]) == (8, 2, [20, 20])


def test_axes_of_the_image_and_its_samples():
    about = {
        "scene": {"rule": "balls", "materials": 2},
        "x": {"label": "side, pixels", "sets": "side", "from": 32, "to": 2048, "cells": 3, "integer": True},
        "y": {"label": "samples a pixel", "sets": "spp", "from": 4, "to": 64, "cells": 3, "integer": True},
    }
    study = definition(**about).study((256.0, 16.0), "scene")
    assert (study["depth"], study["spp"], study["resolution"]) == (8, 16, [256, 256])
    assert [one["axes"]["sorting"] for one in study["variants"]] == [["bucket"], ["none"]]


def test_the_whole_command(tmp_path, analysis):
    root = tmp_path / "house"
    (root / "maps").mkdir(parents=True)
    (root / "maps" / "sorting.json").write_text(json.dumps(MAP))
    shutil.copytree(ROOT / "docs/templates/maps", root / "docs/templates/maps")
    program = program_in(tmp_path, result_of_cell().write(tmp_path / "result.json"))
    call = ("map", "--root", root, "--binary", program.binary)
    code, out, _ = analysis(*call)
    assert (code, "sorting: not measured yet" in out) == (0, True)
    code, out, _ = analysis(*call, "--run", "--write")
    assert code == 0
    assert "9 cells: 9 above 1" in out
    assert "no row or column has cells on both sides of 1" in out
    page = (root / "docs/maps/README.md").read_text()
    assert "sorting_nvidia-h200.svg" in page
    assert "<svg" in (root / "docs/maps/sorting_nvidia-h200.svg").read_text()
    assert "was not measured yet" in page
    assert analysis(*call, "--check")[0] == 0
    advice = {"good": 45, "of": 50, "not_good": 4, "undecided": 1, "advised_from": "nvidia-h200"}
    (root / "results/nvidia-h200/advice.json").write_text(json.dumps(advice))
    assert analysis(*call, "--write")[0] == 0
    assert "within 5 % of the best on 45 of 50 scenes" in (root / "docs/maps/README.md").read_text()
    (root / "docs/maps/README.md").write_text("typed")
    assert analysis(*call, "--check")[0] == 1
    assert analysis("map", "gone", "--root", root)[0] == 2


def test_committed_pages_are_what_maps_and_results_say(analysis):
    code, out, _ = analysis("map", "--check", "--root", COMMITTED)
    assert (code, out.count("docs/maps")) == (0, 0)
