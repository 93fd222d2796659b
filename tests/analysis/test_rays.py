"""Files of `ptbench rays` and of a peer: read, as rows, drawn, and as pages ask them."""

from __future__ import annotations

import copy
import json
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import RESULTS, ROOT, committed
from convergence_builder import Law, convergence_cell, convergence_study, on_gpu
from legibility import check_legible

import ptbench
from ptbench.cli.main import main
from ptbench.errors import FindingError, InputError, NotDrawable
from ptbench.figures import rays_by_triangles, series, style
from ptbench.findings.page import read_page, render
from ptbench.findings.source import source_of
from ptbench.findings.sources.rays import RaysFolder
from ptbench.io.nodes import read_json
from ptbench.io.rays import is_peer, is_rays, load_rays_folder, peer_of, rays_of
from ptbench.io.validate import complaints

FOLDER = RESULTS / "nvidia-h200" / "rays"
MESHES = ("sphere_262k", "sphere_2M", "sphere_8M", "tori_262k", "tori_4M")
CHECK = FOLDER / "check.json"


def written(folder: Path, name: str, value: dict) -> Path:
    path = folder / name
    path.write_text(json.dumps(value), encoding="utf-8")
    return path


def ours(mesh: str = "tori_4M") -> dict:
    return committed(f"nvidia-h200/rays/ptbench_{mesh}.json")


def theirs(mesh: str = "tori_4M") -> dict:
    return committed(f"nvidia-h200/rays/optix_{mesh}.json")


@pytest.mark.parametrize("mesh", MESHES)
def test_rows_are_the_batches_of_the_file(mesh):
    raw = ours(mesh)
    rows = ptbench.load(FOLDER / f"ptbench_{mesh}.json").rows()
    batches = [(tree, batch) for tree in raw["meshes"][0]["trees"] for batch in tree["batches"]]
    assert len(rows) == len(batches) > 0
    for row, (tree, batch) in zip(rows, batches, strict=True):
        for name in ("class", "kernel", "query", "nodes_per_ray", "triangles_per_ray"):
            assert row[name] == batch[name]
        for name in ("accelerator", "builder", "sah_cost", "node_bytes", "build_ms", "encode_ms"):
            assert row[name] == tree[name]
        assert (row["mesh"], row["triangles"]) == (mesh, raw["meshes"][0]["triangles"])
        # The file's own rate is that of the median time, and so is that of an odd number of rates.
        assert row["giga_rays_per_second"] == pytest.approx(batch["grays_per_s"], rel=1e-12)
        assert row["giga_rays_per_second_low"] <= row["giga_rays_per_second"] <= row["giga_rays_per_second_high"]
        built = tree.get("device_build_ms")
        assert row.get("device_build_ms") == (None if built is None else float(np.median(built)))


def test_the_peers_files_are_found_by_their_meshes():
    files, peers = load_rays_folder(FOLDER)
    assert sorted(peer.mesh for peer in peers) == sorted(MESHES)
    assert {peer.name for peer in peers} == {"optix"}
    assert {mesh.name for file in files for mesh in file.meshes} > set(MESHES)
    batch = next(peer for peer in peers if peer.mesh == "tori_4M").batches[0]
    assert float(np.median(batch.giga_rays_per_second)) == pytest.approx(theirs()["batches"][0]["grays_per_s"])


def test_kinds_are_told_apart():
    assert (is_rays(read_json(CHECK)), is_peer(read_json(CHECK))) == (True, False)
    peer = read_json(FOLDER / "optix_tori_4M.json")
    assert (is_rays(peer), is_peer(peer)) == (False, True)


FAULTS = {
    "no_times": (lambda v: v["meshes"][0]["trees"][0]["batches"][0].update(ms=[]), r"batches\[0\]\.ms: found \[\]"),
    "zero": (lambda v: v["meshes"][0]["trees"][0]["batches"][0].update(ms=[0]), "a finite number above 0"),
    "class": (
        lambda v: v["meshes"][0]["trees"][0]["batches"][0].update({"class": "x"}),
        r'\.class: found "x", allowed: "primary"',
    ),
    "agree": (lambda v: v["meshes"][0]["ray_sets"][0].update(agree="yes"), r"\.agree: found .*allowed: true or false"),
    "triangles": (lambda v: v["meshes"][0].pop("triangles"), r"\.triangles: found nothing"),
    "schema": (lambda v: v.update(schema="ptbench-rays-9"), r'\$\.schema: found "ptbench-rays-9"'),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_wrong_is_told(tmp_path, fault):
    change, message = FAULTS[fault]
    value = ours()
    change(value)
    with pytest.raises(InputError, match=message):
        rays_of(read_json(written(tmp_path, "rays.json", value)))


def test_optix_alone_is_a_peer_beside_optix_through_mitsuba(tmp_path):
    value = theirs()
    version = value.pop("mitsuba")
    assert not is_peer(read_json(written(tmp_path, "nobody_tori_4M.json", value)))
    value["optix"] = "9.0.0"
    alone = read_json(written(tmp_path, "optix-alone_tori_4M.json", value))
    assert is_peer(alone)
    assert (peer_of(alone).name, peer_of(alone).by) == ("optix-alone", "9.0.0")
    assert peer_of(read_json(FOLDER / "optix_tori_4M.json")).by == f"through Mitsuba {version}"


def test_a_peers_file_under_another_name_is_refused(tmp_path):
    with pytest.raises(InputError, match="the mesh of the file's name"):
        peer_of(read_json(written(tmp_path, "optix_sphere_2M.json", theirs())))
    with pytest.raises(InputError, match="files of ptbench rays"):
        load_rays_folder(tmp_path)


def test_tables_are_of_their_kinds_of_file():
    with pytest.raises(InputError, match="of `ptbench rays`"):
        ptbench.load(RESULTS / "nvidia-h200/first_bounce.json").rows("rays")
    with pytest.raises(InputError, match="a result of `ptbench run`"):
        ptbench.load(CHECK).rows("cells")
    assert len(ptbench.load(CHECK).frame()) == len(ptbench.load(CHECK).rows("rays"))


# --- the figure ---


def test_lines_are_the_files_rates_and_the_peers():
    data = rays_by_triangles.collect(*load_rays_folder(FOLDER))
    assert [panel.title for panel in data.panels] == [
        f"{name}: {family}" for name in ("primary", "diffuse 1", "diffuse 3") for family in ("sphere", "tori")
    ]
    assert data.order[0] == "OptiX"
    (optix,) = [one for one in data.panels[1].series if one.label == "OptiX"]
    rates = [theirs(mesh)["batches"][0]["grays_per_s"] for mesh in ("tori_262k", "tori_4M")]
    assert [value.value for value in optix.values] == pytest.approx(rates)
    assert optix.xs == tuple(ours(mesh)["meshes"][0]["triangles"] for mesh in ("tori_262k", "tori_4M"))
    (plain,) = [one for one in data.panels[1].series if one.label == "cwbvh, plain"]
    tree = next(tree for tree in ours()["meshes"][0]["trees"] if tree["builder"] == "sah_binned")
    (batch,) = [b for b in tree["batches"] if (b["class"], b["kernel"]) == ("primary", "plain")]
    assert plain.values[1].value == pytest.approx(batch["grays_per_s"])


def test_the_page_is_legible():
    with style.applied():
        figure = series.draw(rays_by_triangles.collect(*load_rays_folder(FOLDER)))
    check_legible(figure, "rays")


def test_more_accelerators_are_more_lines(tmp_path):
    value = ours()
    for name in ("bvh2", "bvh4", "bvh8"):
        tree = copy.deepcopy(value["meshes"][0]["trees"][0])
        tree |= {"accelerator": name, "batches": [b for b in tree["batches"] if b["kernel"] == "plain"]}
        value["meshes"][0]["trees"].append(tree)
    assert list(complaints(value, "rays")) == []
    files = [rays_of(read_json(written(tmp_path, "rays.json", value)))]
    data = rays_by_triangles.collect(files, [])
    assert {"bvh2, plain", "bvh4, plain", "bvh8, plain", "cwbvh, persistent"} < set(data.order)
    with style.applied():
        check_legible(series.draw(data), "more")


def test_few_rays_are_no_rate():
    with pytest.raises(NotDrawable, match="or more"):
        rays_by_triangles.collect([rays_of(read_json(CHECK))], [])


def test_plots_of_a_folder_and_of_a_file(tmp_path, capsys):
    assert main(["plots", str(FOLDER), "--out", str(tmp_path / "all")]) == 0
    assert {path.name for path in (tmp_path / "all").iterdir()} == {
        "rays_by_triangles.png", "rays_by_triangles.svg", "summary.md",
    }  # fmt: skip
    page = (tmp_path / "all/summary.md").read_text(encoding="utf-8")
    batches = sum(len(tree.batches) for file in load_rays_folder(FOLDER)[0] for m in file.meshes for tree in m.trees)
    assert page.count("| persistent |") + page.count("| persistent_no_vote |") + page.count("| plain |") == batches
    assert main(["plots", str(CHECK), "--out", str(tmp_path / "one")]) == 0
    assert "not drawn: no mesh was traced by" in capsys.readouterr().out
    assert main(["plots", str(tmp_path / "one")]) == 2


@pytest.mark.parametrize(
    ("low", "high", "ticks"),
    [
        (0.9, 11, [1, 2, 5, 10]),
        (0.38, 1.15, [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1]),
        (0.5, 20000, [1, 10, 100, 1000, 10000]),
    ],
)
def test_ticks_are_round_and_within(low, high, ticks):
    assert series.ticks_between(low, high) == ticks


def test_counts_are_short():
    assert [series.count_text(count) for count in (1280, 36096, 262156, 2096716, 8386828)] == [
        "1280", "36.1k", "262k", "2.1M", "8.4M",
    ]  # fmt: skip


# --- files against each other ---


def slowed(tmp_path: Path, factor: float) -> Path:
    value = ours()
    for batch in value["meshes"][0]["trees"][0]["batches"]:
        batch["ms"] = [ms * factor for ms in batch["ms"]]
    value["meshes"][0]["trees"][0]["batches"][0]["checksum"] = "0" * 16
    value["meshes"][0]["trees"][1]["batches"].pop()
    return written(tmp_path, "slower.json", value)


def test_files_are_held_against_each_other(tmp_path, capsys):
    first, second = str(FOLDER / "ptbench_tori_4M.json"), str(slowed(tmp_path, 1.5))
    document = tmp_path / "out.json"
    assert main(["compare", first, second, "--json", str(document), "--out", str(tmp_path / "page")]) == 0
    text = capsys.readouterr().out
    assert "17 batches are in both; 1 are in A alone, 0 in B alone. The same hits, bit for bit, have 16." in text
    (comparison,) = json.loads(document.read_text(encoding="utf-8"))["comparisons"]
    by_tree = {name: [p for p in comparison["pairs"] if p["builder"] == name] for name in ("sah_binned", "hploc")}
    assert (by_tree["sah_binned"][0]["same_hits"], by_tree["sah_binned"][0]["ratio"]) == (False, None)
    assert [pair["ratio"]["value"] for pair in by_tree["sah_binned"][1:]] == pytest.approx([1.5] * 8)
    assert {pair["verdict"] for pair in by_tree["sah_binned"][1:]} == {"SLOWER"}
    assert {pair["ratio"]["value"] for pair in by_tree["hploc"]} == {1.0}
    assert "other hits" in (tmp_path / "page/compare.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("gate", "code"), [("slower", 1), ("different", 1), ("unmatched", 1), ("failed", 2)])
def test_gates_fail_on_what_they_name(tmp_path, gate, code):
    first, second = str(FOLDER / "ptbench_tori_4M.json"), str(slowed(tmp_path, 1.5))
    assert main(["compare", first, second, "--fail-on", gate]) == code
    assert main(["compare", first, first, "--fail-on", gate]) == (2 if gate == "failed" else 0)


def test_files_without_a_common_batch_are_refused(capsys):
    names = [str(FOLDER / f"ptbench_{mesh}.json") for mesh in ("tori_4M", "tori_262k")]
    assert main(["compare", *names]) == 2
    assert "allowed: a batch that" in capsys.readouterr().err
    assert main(["compare", names[0], str(RESULTS / "nvidia-h200/first_bounce.json")]) == 2


# --- pages ---


@pytest.fixture(scope="module")
def rays() -> RaysFolder:
    return RaysFolder(RESULTS, "nvidia-h200/rays")


def test_the_best_over_the_peer_is_the_files(rays):
    ratios = {one.of.split()[0]: one for one in rays.best_over_peer("diffuse_3")}
    assert set(ratios) == {f"mesh={mesh}" for mesh in MESHES}
    for mesh in MESHES:
        batches = [b for tree in ours(mesh)["meshes"][0]["trees"] for b in tree["batches"] if b["class"] == "diffuse_3"]
        best = max(batch["grays_per_s"] for batch in batches)
        (peer,) = [batch["grays_per_s"] for batch in theirs(mesh)["batches"] if batch["class"] == "diffuse_3"]
        assert ratios[f"mesh={mesh}"].number == pytest.approx(peer / best)


def test_a_bar_holds_with_all_of_the_interval(rays):
    ratios = rays.best_over_peer("diffuse_3")
    slowest = ratios.highest
    assert ratios.all_are_times(1 / slowest.estimate.high, "so") == "so"
    assert not slowest.is_times(1 / slowest.number)
    with pytest.raises(FindingError, match="times as fast, where the page says"):
        ratios.all_are_times(1 / slowest.number)


def test_most_is_more_than_half(rays):
    ratios = rays.ratios("class=diffuse_* kernel=persistent", over="kernel=plain")
    assert ratios.most_are("FASTER", "most") == "most"
    with pytest.raises(FindingError, match="0 of 20 are SLOWER"):
        ratios.most_are("SLOWER")
    with pytest.raises(FindingError, match="which is not above"):
        ratios.lowest.must_exceed(ratios.highest)
    assert ratios.highest.must_exceed(ratios.lowest, "more") == "more"


def test_selections_that_name_nothing_or_several_are_told(rays):
    with pytest.raises(FindingError, match="no batch is kernel=fast"):
        rays.traced("kernel=fast")
    with pytest.raises(FindingError, match="no batch has colour"):
        rays.traced("colour=red")
    with pytest.raises(FindingError, match="2 batches are"):
        rays.rate("mesh=tori_4M class=primary kernel=plain")
    with pytest.raises(FindingError, match="no build on the GPU"):
        rays.device_ms("tori_4M", "cwbvh", "sah_binned", "build")
    assert rays.rate_if("mesh=tori_4M class=primary kernel=none") == "—"


def folder_of(tmp_path: Path, our: dict, their: dict) -> RaysFolder:
    (tmp_path / "rays").mkdir()
    written(tmp_path / "rays", "ptbench_tori_4M.json", our)
    written(tmp_path / "rays", "optix_tori_4M.json", their)
    return RaysFolder(tmp_path, "rays")


def test_hits_apart_are_counted_and_limited(tmp_path):
    peer = theirs()
    assert folder_of(tmp_path, ours(), peer).hits_apart == sum(batch["hits_differ"] for batch in peer["batches"])
    peer["batches"][0]["hits_differ"] = 100
    written(tmp_path / "rays", "optix_tori_4M.json", peer)
    with pytest.raises(FindingError, match="hits differ from the peer's by 10"):
        _ = RaysFolder(tmp_path, "rays").hits_apart


def test_trees_whose_hits_differ_make_no_page(tmp_path):
    our = ours()
    our["meshes"][0]["ray_sets"][1]["agree"] = False
    with pytest.raises(FindingError, match="hits differ between trees of tori_4M"):
        folder_of(tmp_path, our, theirs())


def test_other_rays_than_the_peers_are_no_ratio(tmp_path):
    our = ours()
    our["meshes"][0]["ray_sets"][0]["rays"] //= 2
    folder = folder_of(tmp_path, our, theirs())
    with pytest.raises(FindingError, match="but the peer traced"):
        folder.best_over_peer("primary")


def test_a_batch_that_is_there_twice_is_told(tmp_path):
    folder_of(tmp_path, ours(), theirs())
    written(tmp_path / "rays", "ptbench_again.json", ours())
    with pytest.raises(FindingError, match="measured twice"):
        RaysFolder(tmp_path, "rays").best_over_peer("primary")


def test_a_source_may_wait_for_its_file(tmp_path):
    assert source_of(tmp_path, {"file": "nvidia-h100/rays", "optional": True}) is None
    with pytest.raises(InputError, match="no such file"):
        source_of(tmp_path, {"file": "nvidia-h100/meshes.json"})


def results_linked(folder, left_out):
    """The committed results under `folder`, but for those of these names."""
    for path in RESULTS.iterdir():
        if path.name == "nvidia-h200":
            (folder / path.name).mkdir(parents=True)
            for inner in path.iterdir():
                if inner.name not in left_out:
                    (folder / path.name / inner.name).symlink_to(inner)
        elif path.name not in left_out:
            (folder / path.name).symlink_to(path)
    return folder


# --- counters ---


def counters_of(lanes: float) -> dict:
    return {
        "launches": 1, "milliseconds": 2.5, "active_lanes": lanes, "warp_instructions_per_ray": 40,
        "thread_instructions_per_ray": 1000, "fma_per_ray": 10, "alu_per_ray": 20, "xu_per_ray": 1, "lsu_per_ray": 5,
        "fp64_per_ray": 0, "memory_bytes_per_ray": 64.5, "achieved_occupancy": 0.5, "l1_hit_rate": 0.75,
        "l2_hit_rate": 0.625, "memory_stalls": 0.25,
        "of_ceiling": {
            "issue": 0.5, "fma": 0.25, "alu": lanes / 32, "xu": 0.0, "l1": 0.375, "l2": 0.125, "memory": 0.0625,
        },
        "bound": "alu" if lanes > 16 else "issue",
    }  # fmt: skip


CEILINGS = {
    f"{name}_g_warp_instructions_per_second": 900.0 for name in ("issue", "fma", "alu", "xu")
} | {"memory_gb_per_second": 4000.0}  # fmt: skip


def counted(folder: Path) -> Path:
    """A file with counters: of every second batch, so that some have none."""
    value = ours() | {"ceilings": CEILINGS}
    for tree in value["meshes"][0]["trees"]:
        for i, batch in enumerate(tree["batches"][::2]):
            batch["counters"] = counters_of(8.0 + 3 * i)
    folder.mkdir(parents=True)
    return written(folder, "ptbench_tori_4M.json", value)


def test_counters_are_of_the_format(tmp_path):
    path = counted(tmp_path / "counted")
    value = json.loads(path.read_text(encoding="utf-8"))
    assert list(complaints(value, "rays")) == []
    value["meshes"][0]["trees"][0]["batches"][0]["counters"]["bound"] = "luck"
    del value["ceilings"]["issue_g_warp_instructions_per_second"]
    assert len(list(complaints(value, "rays"))) == 2
    with pytest.raises(InputError, match=r'counters\.bound: found "luck", allowed: "issue"'):
        rays_of(read_json(written(tmp_path, "wrong.json", value)))


def test_counters_are_read_told_and_drawn_as_a_table(tmp_path):
    path = counted(tmp_path / "counted")
    rows = ptbench.load(path).rows("rays")
    assert [row.get("active_lanes") for row in rows[:3]] == [8.0, None, 11.0]
    assert rows[0]["bound"] == "issue"
    assert main(["plots", str(path), "--out", str(tmp_path / "page")]) == 0
    page = (tmp_path / "page/summary.md").read_text(encoding="utf-8")
    line = next(line for line in page.splitlines() if "| 8.00 |" in line)
    assert line.endswith("| 1000 | 64.5 | 50 % | 50 % | 25 % | 38 % | 12 % | 6.2 % | 75 % | 62 % | 25 % | issue |")


def test_pages_ask_for_counters(tmp_path):
    counted(tmp_path / "counted")
    folder = RaysFolder(tmp_path, "counted")
    assert len(folder.counted) == sum(len(tree.batches[::2]) for tree in folder.meshes[0].trees)
    assert folder.counted[0].counters_row == (
        "8.00 | 1000 | 64.5 | 50 % | 50 % | 25 % | 38 % | 12 % | 6.2 % | 25 % | issue"
    )
    assert folder.nearest_ceiling == "issue or ALU, 50 % to 62 %"
    with pytest.raises(FindingError, match="no batch has counters"):
        _ = RaysFolder(RESULTS, "nvidia-h200/rays").counted
    with pytest.raises(FindingError, match="no counters"):
        _ = RaysFolder(RESULTS, "nvidia-h200/rays").traced()[0].counters_row


ROOMS = {
    "counted": "Lanes and the bound of batches: not measured yet",
    "levels": "The suite `levels`: not measured yet",
    "errors": "Next-event estimation over meshes (suite `mesh_convergence`): not measured yet",
    "cpu": "The suite `accelerators` on a CPU: not measured yet",
    "cpu_rays": "Batches of rays beside Embree on a CPU: not measured yet",
    "other_traversal": "Not measured yet: all of this is one model of GPU",
}


def errors_over_meshes(path: Path) -> None:
    """A result of the suite mesh_convergence: connections halve the variance and cost half as much again."""
    builder = convergence_study(on_gpu("mesh_convergence"), "direct_light_meshes")
    builder.axes |= {"arithmetic": "exact", "accelerator": "cwbvh", "light_sampling": "solid_angle"}
    builder.baselines |= builder.axes
    for scene in ("icosphere_room", "tori_4m_room"):
        for direct, law, ms in (("off", Law(0.5), 2.0), ("nee", Law(0.25), 3.0), ("nee_mis", Law(0.25), 3.0)):
            axes = {} if direct == "off" else {"direct_light": direct, "light_sampling": "auto"}
            convergence_cell(builder, law, study="direct_light_meshes", scene=scene, ms_per_spp=ms, axes=axes)
    builder.write(path)


def test_the_page_of_meshes_takes_what_is_there(tmp_path):
    optional = {
        "traversal.json.gz", "rays_accelerators", "rays_counters", "nvidia-h100", "amd-epyc-2-threads",
        "levels.json", "levels.json.gz", "mesh_convergence.json", "mesh_convergence.json.gz",
    }  # fmt: skip
    fewer = results_linked(tmp_path / "fewer", optional)
    more = results_linked(tmp_path / "more", optional - {"traversal.json.gz", "rays_accelerators"})
    h100, h200, cpu = (
        more / name for name in ("nvidia-h100", "nvidia-h200", "amd-epyc-2-threads")
    )  # fmt: skip
    h100.mkdir()
    cpu.mkdir()
    for name in ("accelerators.json.gz", "meshes.json.gz", "rays_accelerators"):
        (h100 / name).symlink_to(RESULTS / "nvidia-h200" / name)
    (h100 / "traversal.json.gz").symlink_to(RESULTS / "nvidia-h100/traversal.json.gz")  # with every tree's stacks
    for name in ("accelerators.json.gz", "rays_cpu.json.gz"):
        (cpu / name).symlink_to(RESULTS / "amd-epyc-2-threads" / name)
    (h100 / "levels.json.gz").symlink_to(RESULTS / "nvidia-h200/levels_sphereflake.json.gz")
    errors_over_meshes(h200 / "mesh_convergence.json")
    counted(h200 / "rays_counters")
    page = read_page(ROOT / "docs/templates/meshes.md")
    without, text, now = (render(page, results) for results in (fewer, more, RESULTS))
    headings = [re.findall("^## (.*)$", one, re.MULTILINE) for one in (without, text)]
    assert [one for one in headings[1] if one not in headings[0]] == ["Traversals"]
    for name, said in ROOMS.items():
        assert said in without, name
        assert said not in text, name
    assert "Not measured yet" in without
    assert "ot measured yet" not in text
    assert "| sphereflake_room | 200x200 | `bvh2` |" in text
    line = re.search(
        r"^\| tori_4m_room \| `nee_mis` \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \[.* FASTER", text, re.MULTILINE
    )
    assert [float(number) for number in line.groups()] == pytest.approx([2, 1.5, 4 / 3], rel=0.05)
    assert "In a queue there, warps that fetch rays take" in text
    assert "| tori_4M | primary | `cwbvh` | `persistent` |" in text
    assert "| mesh | builder | rays | `bvh2` | `bvh4` | `bvh8` | `cwbvh` |" in text
    assert re.search(r"^\| meshes, NVIDIA H200 \| 60 \| 1\.00 \[", text, re.MULTILINE)
    for one in (without, text, now):
        tables = re.findall(r"(?:^\|.*\n)+", one, re.MULTILINE)
        assert all(len({len(row.split("|")) for row in table.splitlines()}) == 1 for table in tables)
