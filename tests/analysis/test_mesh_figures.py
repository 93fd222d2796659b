"""Figures of suites over meshes: time to an image by builder, one kernel against a queue by cost of shading."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from builder import Builder
from conftest import RESULTS, ROOT
from legibility import check_legible

from ptbench.errors import FindingError, NotDrawable
from ptbench.figures import integrator_by_cost, series, time_to_image
from ptbench.figures.registry import collect_study, draw, parts_of_study
from ptbench.figures.time_to_image import GPU_BUILDERS, Way, crossings, sibling_meshes, ways
from ptbench.findings.sources.suite import SuiteSource
from ptbench.findings.suite.builders import built, crossed
from ptbench.io.results import load, load_kept
from ptbench.stats.estimates import Estimate

BUILDERS = RESULTS / "nvidia-h200" / "builders.json"
MESHES = RESULTS / "nvidia-h200" / "meshes.json"
FACTS = {
    "triangles": 1280, "nodes": 99, "node_bytes": 990, "leaf_bytes": 10, "sah_cost": 31.5,
    "build_ms": 20.0, "encode_ms": 5.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def builders():
    return load_kept(BUILDERS)


def test_what_a_mesh_is_made_of_is_read(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction")["meshes"] = FACTS
    builder.cell("compaction", axes={"compaction": "scan"})
    with_mesh, without = load(builder.write(tmp_path / "a.json")).cells
    assert dataclasses.asdict(with_mesh.meshes) == FACTS
    assert without.meshes is None


def test_builders_on_the_gpu_are_cuda_programs():
    assert set(GPU_BUILDERS) == {path.name.split(".")[0] for path in (ROOT / "variants/builder").glob("*.cuda.cpp")}


def way(name: str, before: float, sample: float, spread: float = 0.0) -> Way:
    return Way("room", name, None, before, Estimate(sample, sample - spread, sample + spread, 9))


def test_ways_cross_where_their_times_are_equal():
    quick, good = way("quick", 10, 3), way("good", 110, 2)
    (one,) = crossings([good, quick])
    assert (one.sooner.label, one.later.label, one.spp) == ("quick", "good", 100)
    assert quick.time(100).value == good.time(100).value == 310
    assert crossings([quick, way("worse", 20, 3.5)]) == []  # never
    assert crossings([quick, way("equal", 20, 3)]) == []
    # Whose samples differ by less than their intervals do not cross: nobody knows which is faster.
    assert crossings([way("quick", 10, 3, 0.6), way("good", 110, 2, 0.6)]) == []


def test_only_those_who_lead_are_told():
    quick, good, best = way("quick", 10, 3), way("good", 110, 2), way("best", 1110, 1)
    never_first = way("never first", 120, 2.5)  # before quick from 220 spp on, when good is there already
    found = [(one.sooner.label, one.later.label, one.spp) for one in crossings([best, never_first, good, quick])]
    assert found == [("quick", "good", 100), ("good", "best", 1000)]


def test_a_line_is_build_and_encoding_and_samples(builders):
    study = builders.studies[0]
    data = time_to_image.collect(builders, study)
    found = ways(builders.cells, sibling_meshes(BUILDERS))
    by_label = {(one.scene, one.cell.axes["accelerator"], one.label): one for one in found}
    assert len(by_label) == len(found)
    for cell in builders.cells:
        (one,) = [w for w in found if w.cell is cell and "all on" not in w.label]
        assert one.before_ms == cell.meshes.build_ms + cell.meshes.encode_ms
        assert one.sample.value == pytest.approx(float(np.median(cell.ms_per_spp)))
    for panel in data.panels:
        place = tuple(panel.title.split(":")[0].split(", "))
        for line in panel.series:
            mine, base = by_label[(*place, line.label)], by_label[(*place, "sah_binned (CPU)")]
            assert line.values[6].value == pytest.approx(mine.time(64).value / base.time(64).value)
    assert sum(len(line.rings) for panel in data.panels for line in panel.series) == len(
        re.findall(r"is first from \d+ spp", data.caption)
    )


def test_the_gpus_own_way_is_that_of_the_same_mesh(builders):
    found = {one.scene: one for one in ways(builders.cells, sibling_meshes(BUILDERS)) if "all on the GPU" in one.label}
    assert set(found) == {"tori_262k_room", "tori_4m_room"}
    meshes = {mesh.name: mesh for mesh in sibling_meshes(BUILDERS)}
    (tree,) = [tree for tree in meshes["tori_4M"].trees if tree.builder == "hploc"]
    expected = float(np.median(tree.device_build_ms) + np.median(tree.device_encode_ms))
    assert found["tori_4m_room"].before_ms == pytest.approx(expected)
    # A mesh of that name with another number of triangles is another mesh.
    others = [dataclasses.replace(mesh, triangles=mesh.triangles + 1) for mesh in meshes.values()]
    assert [one for one in ways(builders.cells, others) if "all on the GPU" in one.label] == []


def test_studies_of_meshes_have_these_figures_too(builders):
    study = builders.studies[0]
    assert parts_of_study(study) == ("", "time_to_image")
    assert parts_of_study(dataclasses.replace(study, figure="shading_fmas")) == ("", "by_integrator")
    data = collect_study(builders, study, "time_to_image")
    check_legible(draw(data), "time_to_image")
    result = load_kept(MESHES)
    (costs,) = [one for one in result.studies if one.figure == "shading_fmas"]
    check_legible(draw(collect_study(result, costs, "by_integrator")), "by_integrator")


def test_one_kernel_against_a_queue_is_the_files(tmp_path):
    result = load_kept(MESHES)
    (study,) = [one for one in result.studies if one.figure == "shading_fmas"]
    data = integrator_by_cost.collect(result, study)
    assert [line.label.split()[0] for line in data.panels[0].series] == ["1280", "262k", "4.1M"]
    for line in data.panels[0].series:
        scene = line.label.partition("(")[2].rstrip(")")
        for cost, ratio in zip(line.xs, line.values, strict=True):
            times = {
                cell.axes["integrator"]: float(np.median(cell.ms_per_spp))
                for cell in result.cells_of(study)
                if cell.scene == scene and cell.tunables["shading_fmas"] == cost
            }
            assert ratio.value == pytest.approx(times["megakernel_regen"] / times["wavefront"])
    old = load_kept(RESULTS / "nvidia-h200/scaling.json")
    study = next(one for one in old.studies if one.figure == "scaling_by_shading_fmas")
    with pytest.raises(NotDrawable, match="no scene with a mesh"):
        integrator_by_cost.collect(old, study)
    with pytest.raises(NotDrawable, match="no scene has trees of two builders"):
        time_to_image.collect(old, study)


def test_a_page_asks_for_builders(builders):
    source = SuiteSource(RESULTS, "nvidia-h200/builders.json", "resolution=800x800 depth=8")
    rows = source.built("megakernel_regen scene=* accelerator=cwbvh builder=*")
    of_tree = [cell for cell in builders.cells if cell.axes["accelerator"] == "cwbvh"]
    assert len(rows) == len(ways(of_tree, sibling_meshes(BUILDERS)))
    base = [row for row in rows if row.is_baseline]
    assert [str(row.sah) for row in base] == ["1.00"] * len({row.scene for row in rows})
    found = [
        (one.scene, one.sooner, one.later)
        for one in source.crossings("megakernel_regen scene=* accelerator=cwbvh builder=*")
    ]
    assert ("teapot_room", "sah_binned (CPU)", "lbvh (CPU)") in found
    without = [one for one in ways(builders.cells) if one.cell.axes["builder"] != "sah_binned"]
    with pytest.raises(FindingError, match="no tree of sah_binned"):
        built(without)
    assert crossed([]) == []


def test_a_page_holds_files_of_two_machines_against_each_other():
    source = SuiteSource(RESULTS, "nvidia-h200/meshes.json")
    other = SuiteSource(RESULTS, "nvidia-h200/accelerators.json")
    ratios = source.common(other)
    names = {cell.name for cell in source.result.cells} & {cell.name for cell in other.result.cells}
    assert len(ratios) == len(names) > 0
    assert ratios.lowest.number <= float(source.mean_over(other)) <= ratios.highest.number
    with pytest.raises(FindingError, match="no cell in common"):
        source.common(SuiteSource(RESULTS, "nvidia-h200/first_bounce.json"))
    told = source.rows("integrators")
    assert {row.label for row in told if row.ratio is None} == {"wavefront"}
    assert source.rows("gone") == []


def test_lines_that_never_meet_have_no_crossing():
    assert series.crossing((1, 2), (3, 3)) is None
    assert series.crossing((1, 2), (1, 3)) is None
    assert series.crossing((1, 5), (3, 1)) == 2
