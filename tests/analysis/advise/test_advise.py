"""advise: forecasts of a known law, what is told where nothing is near, and the check of its own advice."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from builder import Builder
from conftest import ROOT

from ptbench.errors import InputError
from ptbench.extras.advise.advice import advise_on, lines_of, models_of, settings_of
from ptbench.extras.advise.check import GOOD, NOT_GOOD, OPEN, closest, judged
from ptbench.extras.advise.command import machine_of
from ptbench.extras.advise.evidence import DECISIONS, SCHEDULE, choice_text, read_book
from ptbench.extras.advise.features import Content, Features, content_of, distance, features_of
from ptbench.extras.advise.mapped import whole_book
from ptbench.extras.advise.model import model_of
from ptbench.extras.maps.definition import read_map
from ptbench.extras.maps.measuring import Sheet, write_sheet
from ptbench.io.results import load
from ptbench.program import Program

NONE = frozenset()
QUEUE = {"integrator": "wavefront"}


def scene_json(name: str, materials: int = 2) -> dict:
    """A lamp and boxes, each of a material of its own."""
    names = {f"m{index}": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]} for index in range(materials)}
    objects = [{"shape": "box", "material": material, "scale": 2} for material in names]
    lamp = {"shape": "quad", "material": "lamp", "scale": [3, 1, 2]}
    return {"name": name, "max_depth": 8, "materials": {"lamp": {"type": "emitter", "radiance": [1, 1, 1]}, **names},
            "objects": [lamp, *objects]}  # fmt: skip


class House:
    """A checkout with scenes of few features and one machine's results."""

    def __init__(self, root: Path) -> None:
        self.root, self.results = root, root / "results"
        (root / "scenes").mkdir(parents=True)
        self.folder = self.results / "nvidia-h200"
        self.folder.mkdir(parents=True)

    def scene(self, name: str, materials: int) -> Path:
        path = self.root / "scenes" / f"{name}.json"
        path.write_text(json.dumps(scene_json(name, materials)))
        return path

    def book(self, backend: str = "cuda"):
        return read_book(self.root, self.results, "nvidia-h200", backend)

    def measured(self, times: dict[str, dict[str, float]], name: str = "schedulers") -> Builder:
        """A result file of these ms, by scene and integrator; a scene's name ends with its number of materials."""
        builder = Builder(name).on_gpu().study("integrators", "integrator")
        for scene, of in times.items():
            self.scene(scene, int(scene.rpartition("_")[2]))
            for integrator, ms in of.items():
                builder.cell("integrators", scene, ms, noise=0.0, axes={"integrator": integrator},
                             live_paths=[100, 50, 25, 25])  # fmt: skip
        builder.write(self.folder / f"{name}.json")
        return builder


@pytest.fixture
def house(tmp_path) -> House:
    return House(tmp_path)


def features(materials: int, depth: int = 8, triangles: int = 0) -> Features:
    return Features(Content(materials + 1, materials + 1, 1, 1, 0.1), triangles, depth, 0.25, 40000)


def advised_on(house: House, wanted: Features):
    book = house.book()
    return advise_on(models_of(book), wanted, NONE, book.baselines)


# A kernel wins with few materials and loses with many.
LAW = {
    "box_1": {"wavefront": 4.0, "megakernel": 1.0, "persistent": 2.0},
    "box_2": {"wavefront": 4.0, "megakernel": 1.0, "persistent": 2.0},
    "box_64": {"wavefront": 4.0, "megakernel": 8.0, "persistent": 2.0},
    "box_60": {"wavefront": 4.0, "megakernel": 8.0, "persistent": 2.0},
}


def test_content_is_what_the_file_says(house):
    content = content_of(house.scene("box_3", 3))
    lamp, boxes = 6.0, 3 * 6 * 4.0
    assert content == Content(objects=4, materials=4, kinds=1, lamps=1, lamp_share=lamp / (lamp + boxes))


def test_instances_count_as_the_copies_that_they_stand_for(house):
    path = house.root / "scenes" / "many.json"
    about = scene_json("many", 1)
    about["objects"][1]["instances"] = {"generate": "sphereflake", "levels": 2}
    path.write_text(json.dumps(about))
    assert content_of(path).objects == 1 + 1 + 9 + 81
    about["objects"][1]["instances"] = {"generate": "field", "side": 7, "spacing": 1}
    path.write_text(json.dumps(about))
    assert content_of(path).objects == 1 + 49


def test_a_distance_is_counted_in_units():
    names = ("depth", "materials")
    assert distance(features(1, 8), features(1, 8), names) == 0
    # One doubling of depth is one unit; materials are counted with the lamp's.
    assert distance(features(3, 7), features(3, 15), ("depth",)) == 1


def test_a_cells_length_is_its_segments_over_the_most_that_there_may_be(house):
    house.measured({"box_1": {"wavefront": 1.0}})
    (cell,) = load(house.folder / "schedulers.json").cells
    assert features_of(cell, content_of(house.root / "scenes/box_1.json")).length == (1 + 0.5 + 0.25 + 0.25) / 8


def test_ratios_are_of_cells_that_differ_in_the_decision_only(house):
    house.measured(LAW)
    points = house.book().points[SCHEDULE]
    assert {(point.scene, point.choice): point.ratio.value for point in points} == {
        (scene, (("integrator", name),)): ms / 4.0 for scene, of in LAW.items() for name, ms in of.items()
        if name != "wavefront"
    }  # fmt: skip


def test_what_was_not_run_beside_the_reference_is_chained_in_the_same_scene(house):
    house.measured({"box_1": {"wavefront": 4.0, "persistent": 2.0}})
    house.measured({"box_1": {"persistent": 20.0, "megakernel": 5.0}, "box_2": {"persistent": 1.0, "megakernel": 1.0}},
                   "others")  # fmt: skip
    found = {(p.scene, p.choice[0][1]): (p.ratio.value, p.by_way_of) for p in house.book().points[SCHEDULE]}
    assert found == {("box_1", "persistent"): (0.5, ""),
                     ("box_1", "megakernel"): (0.125, "integrator=persistent")}  # fmt: skip


def test_disturbed_and_injected_cells_and_scenes_without_a_file_say_nothing(house):
    builder = house.measured({"box_1": {"wavefront": 4.0, "persistent": 2.0}})
    builder.cell("integrators", "gone", 4.0, live_paths=[4, 2])
    builder.cell("integrators", "box_1", 1.0, axes={"integrator": "megakernel"}, live_paths=[4, 2], contended=9,
                 device_share=0.5)  # fmt: skip
    builder.cell("integrators", "box_1", 1.0, axes={"integrator": "megakernel"}, live_paths=[4, 2],
                 tunables={"shading_fmas": 64})  # fmt: skip
    builder.write(house.folder / "schedulers.json")
    book = house.book()
    assert [point.choice[0][1] for point in book.points[SCHEDULE]] == ["persistent"]
    assert book.without == ("gone",)


def test_advice_follows_the_near_scenes(house):
    house.measured(LAW)
    for materials, best, ratio in ((1, "megakernel", 0.25), (62, "persistent", 0.5)):
        advised = advised_on(house, features(materials))
        assert settings_of(advised) == {"integrator": best}
        schedule = advised[0]
        assert schedule.forecasts[0].ratio == pytest.approx(ratio, rel=0.15)
        assert schedule.forecasts[0].low < ratio < schedule.forecasts[0].high
        assert not schedule.is_far


def test_leaving_a_scene_out_tells_the_error(house):
    house.measured(LAW)
    decision = DECISIONS[0]
    trial = model_of(decision, house.book().points[SCHEDULE]).trial
    assert (trial.scenes, trial.forecasts, trial.settings, trial.good) == (4, 8, 4, 4)
    # The other scene of each pair says all but the whole; the far pair has 8 times the ratio.
    assert 1 < trial.factor < 8


def test_one_scene_overrules_nothing(house):
    house.measured({"box_1": {"wavefront": 4.0, "persistent": 2.0}})
    advised = advised_on(house, features(1))
    assert advised[0].pick == ()
    assert "one scene only" in "\n".join(lines_of(advised, features(1)))


def test_what_does_not_apply_is_not_advised(house):
    house.measured(LAW)
    book = house.book()
    barred = frozenset({("integrator", "megakernel")})
    advised = advise_on(models_of(book), features(1), barred, book.baselines)
    assert settings_of(advised)["integrator"] == "persistent"


def test_it_says_where_nothing_is_near(house):
    house.measured(LAW)
    far = features(1, triangles=1 << 22)
    text = "\n".join(lines_of(advised_on(house, far), far))
    assert "NO MEASUREMENT IS NEAR" in text
    assert "most of it in triangles" in text
    assert "NO MEASUREMENT" not in "\n".join(lines_of(advised_on(house, features(2)), features(2)))


def test_decisions_without_data_say_so_and_trees_are_for_meshes(house):
    house.measured(LAW)
    lines = list(lines_of(advised_on(house, features(1)), features(1)))
    assert "sampler: nothing was measured there" in lines
    assert not [line for line in lines if line.startswith("accelerator")]


def test_a_choice_is_told_as_the_program_takes_it():
    assert choice_text((("layout", "soa"), ("block", "64")), DECISIONS[0]) == "integrator=wavefront layout=soa block=64"


def map_in(house: House, name: str, machine: str, **run) -> None:
    """A committed map, every cell of whose coarse grid has the same run."""
    sheet = Sheet(read_map(ROOT / "maps" / f"{name}.json"))
    counts = {"segments": 2.0, "triangles": 0, "depth": 4, "pixels": 256}
    sheet.runs = {"a": {"seconds": 1.0, "failed": "", "disturbed": False, **counts, **run}}
    sheet.cells = {(x, y): "a" for x in sheet.definition.axes[0].grid for y in sheet.definition.axes[1].grid}
    write_sheet(sheet, house.results / machine / "maps" / f"{name}.json")


def test_maps_are_measurements_too(house):
    house.measured(LAW)
    times = {"choice_ms": [1.0] * 9, "over_ms": [4.0] * 9}
    map_in(house, "compaction", "nvidia-h200", **times)
    map_in(house, "sorting", "nvidia-h200", **times)  # its shading has a cost put in
    map_in(house, "regeneration", "nvidia-h200", **times)  # over no reference
    map_in(house, "connections_cpu", "another", ratio={"value": 0.5, "low": 0.4, "high": 0.6, "n": 9})
    map_in(house, "compaction_cpu", "another", **times)
    book = whole_book(house.root, house.results, "nvidia-h200", "cuda")
    found = {name: {(point.choice, point.ratio.value, point.file) for point in points}
             for name, points in book.points.items() if points and name != SCHEDULE}  # fmt: skip
    assert found == {
        "compaction of a queue": {((("compaction", "cub_select_flagged"),), 0.25, "nvidia-h200/maps/compaction.json")},
        "direct light": {((("direct_light", "nee"),), 0.5, "another/maps/connections_cpu.json")},
    }
    point = book.points["direct light"][0]
    assert point.features.content.lamps == 1
    assert (point.features.depth, point.features.length, point.setting) == (4, 0.5, "depth 4, 16x16")


def cells_of(times: dict[str, float], noise: float = 0.0):
    builder = Builder("advice").on_gpu().study("advice", "integrator")
    for integrator, ms in times.items():
        builder.cell("advice", "s", ms, noise=noise, axes={"integrator": integrator})
    return builder


@pytest.mark.parametrize(
    ("times", "word"),
    [
        ({"persistent": 1.0, "wavefront": 2.0}, GOOD),
        ({"persistent": 1.04, "megakernel": 1.0}, GOOD),
        ({"persistent": 1.06, "megakernel": 1.0}, NOT_GOOD),
    ],
)
def test_the_check_is_within_five_per_cent_of_the_best(tmp_path, times, word):
    cells = load(cells_of(times).write(tmp_path / "a.json")).cells
    checked = judged(cells, {"integrator": "persistent"})
    assert (checked.word, checked.measured) == (word, len(times))


def test_what_may_be_the_best_is_near_the_least_time(tmp_path):
    builder = cells_of({"persistent": 1.4, "megakernel": 1.0, "megakernel_regen": 1.29, "wavefront": 1.31})
    # Faster than its plain namesake, which only the choices that nobody named tell apart.
    builder.cell("advice", "s", 1.1, noise=0.0, axes={"integrator": "wavefront", "layout": "soa"})
    cells = load(builder.write(tmp_path / "a.json")).cells
    plain = [{"integrator": one} for one in ("persistent", "megakernel", "megakernel_regen", "wavefront")]
    soa = {"integrator": "wavefront", "layout": "soa"}
    absent = {"integrator": "wavefront_fused"}
    # The first is the advised one, and stays.
    assert closest(cells, [*plain, soa, absent]) == (*plain[:3], soa)


def test_a_disturbed_check_decides_nothing(tmp_path):
    builder = cells_of({})
    for integrator in ("persistent", "megakernel"):
        builder.cell("advice", "s", 1.0, axes={"integrator": integrator}, contended=9, device_share=0.5)
    cells = load(builder.write(tmp_path / "a.json")).cells
    assert judged(cells, {"integrator": "persistent"}).word == OPEN


def test_the_check_needs_times_of_the_advised(tmp_path):
    cells = load(cells_of({"megakernel": 1.0}).write(tmp_path / "a.json")).cells
    assert judged(cells, {"integrator": "persistent"}).ratio is None


def program_in(folder: Path, machine: str, result: Path | None = None) -> Program:
    """A program that knows one scene and has one result, whatever it is asked to run."""
    about = {"name": "box_1", "max_depth": 8, "resolution": [200, 200], "features": [], "not_applicable_on": {"cuda": {
        "integrator=megakernel": "no", "builder=embree": "no"}}}  # fmt: skip
    file = folder / "ptbench"
    file.write_text(
        f"#!{sys.executable}\nimport json, shutil, sys\n"
        f"if sys.argv[1] == 'machine': print({machine!r})\n"
        f"elif sys.argv[1] == 'list': print(json.dumps({{'scenes': [{about!r}]}}))\n"
        f"else: shutil.copy({str(result)!r}, sys.argv[sys.argv.index('--out') + 1])\n"
    )
    file.chmod(0o755)
    return Program(file)


def test_the_machine_is_a_folder_of_results(house):
    house.measured(LAW)
    program = program_in(house.root, "nvidia-h200")
    assert machine_of(house.results, program, None, cpu=False)[:2] == ("nvidia-h200", "cuda")
    assert machine_of(house.results, program, "H200", cpu=False)[0] == "nvidia-h200"
    with pytest.raises(InputError, match='found "a100", allowed: one of nvidia-h200, or a part'):
        machine_of(house.results, program, "a100", cpu=False)
    with pytest.raises(InputError, match="found no results of nvidia-b200, allowed: --gpu MODEL of nvidia-h200"):
        machine_of(house.results, program_in(house.root, "nvidia-b200"), None, cpu=False)


def test_the_whole_command(house, analysis, tmp_path):
    house.measured(LAW)
    probe = Builder("probe")
    probe.cell(None, "box_1", 1.0, n=1, axes={"integrator": "depth_first"}, live_paths=[100, 50, 25, 25])
    program = program_in(tmp_path, "nvidia-h200", probe.write(tmp_path / "probe.json"))
    call = ["advise", "box_1", "--root", house.root, "--binary", program.binary]
    code, out, err = analysis(*call)
    assert (code, err) == (0, "")
    assert "paths of 2 segments on average, 40000 pixels" in out
    assert "scheduler: integrator=persistent" in out  # the program says that megakernel does not apply
    assert "results/nvidia-h200/schedulers.json" in out
    assert "render --backend cuda" in out
    assert analysis("advise", "nothing", "--root", house.root, "--binary", program.binary)[0] == 2
    code, _, err = analysis("advise", "box_1", "--root", house.root, "--binary", tmp_path / "gone")
    assert (code, err.count("\n")) == (2, 1)


def test_measure_says_whether_the_advice_was_good(house, analysis, tmp_path):
    house.measured(LAW)
    result = cells_of({"persistent": 1.5, "wavefront": 1.0})
    result.cells[0]["instrumented"] = {"live_paths": [4, 2], "paths": 4, "spp": 1, "stage_ms": {}, "wall_ms": 1.0,
                                       "unaccounted_ms": 0.0}  # fmt: skip
    program = program_in(tmp_path, "nvidia-h200", result.write(tmp_path / "result.json"))
    code, out, _ = analysis("advise", "box_1", "--root", house.root, "--binary", program.binary, "--measure")
    assert code == 1
    assert "measured, scheduler: not within 5% of the best of 2: 1.500" in out
