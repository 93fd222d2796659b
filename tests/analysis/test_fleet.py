"""A suite on several GPUs: what each rule predicts of made kernels, exactly, and of the GPUs that were measured."""

import importlib.util
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from compare_builder import other_machine, run_again, wavefront_by_depth, written
from conftest import RESULTS, ROOT, stored_text

from ptbench.cli.main import main
from ptbench.errors import InputError
from ptbench.extras.fleet.evidence import NEAR, OWN, evidence_of, times_of
from ptbench.extras.fleet.fleet import fleet_of
from ptbench.extras.fleet.gpus import Gpu, gpu_of_result, gpu_of_sheet, known_gpus
from ptbench.extras.fleet.model import EXPOSED, PIPES, RULES, SHARES, KernelTime, bound_of, predicted
from ptbench.extras.fleet.text import sections
from ptbench.extras.fleet.verdicts import crossover, verdict_pairs
from ptbench.io.inspection import load_inspected
from ptbench.io.results import load_kept
from ptbench.io.validate import complaints

H200, H100 = RESULTS / "nvidia-h200", RESULTS / "nvidia-h100"
PAIR = [H200 / "schedulers_a7e8939.json", H100 / "schedulers_a7e8939.json"]
COUNTERS = H200 / "inspect_cornell_open_45_schedulers.json"
ONE = Gpu("one", "9.0", 100, 1000.0, 1000.0, 1 << 20, "made", {"issue": 4.0, "fma": 4.0, "alu": 2.0, "xu": 0.5})
SLOW_MEMORY = replace(ONE, gb_per_second=500.0)
HALF = replace(ONE, multiprocessors=50)
HALF_FMA = replace(ONE, per_clock={**ONE.per_clock, "fma": 2.0})
NEAREST, CORE, BANDWIDTH = RULES[3:]


def kernel(time=1.0, **shares) -> KernelTime:
    return KernelTime("kernel", time, {"issue": 0.0, "fma": 0.0, "alu": 0.0, "xu": 0.0, "memory": 0.0} | shares)


@pytest.mark.parametrize(
    ("shares", "other", "rule", "ratio"),
    [
        ({"issue": 0.5, "memory": 0.5}, SLOW_MEMORY, SHARES, 0.5 * 2 + 0.5),
        ({"issue": 0.5, "memory": 0.25}, HALF, SHARES, 0.25 + 0.75 * 2),
        ({"issue": 0.5, "memory": 1.25}, SLOW_MEMORY, SHARES, 2.0),
        # The fma pipe at half the instructions a clock is nearer than issue then: 0.5 becomes 1.0, over 0.75 before.
        ({"issue": 0.75, "fma": 0.5}, HALF_FMA, SHARES, 1.0 / 0.75),
        ({"issue": 0.75, "fma": 0.25}, HALF_FMA, SHARES, 1.0),
        ({}, HALF, SHARES, 2.0),
        # Both busy half of the time, a quarter of it at once: memory alone has a quarter of the other three.
        ({"issue": 0.5, "memory": 0.5}, SLOW_MEMORY, EXPOSED, 1 + 1 / 3),
        ({"issue": 0.0, "memory": 0.5}, SLOW_MEMORY, EXPOSED, 1.5),
        ({"issue": 0.5, "memory": 1.25}, SLOW_MEMORY, EXPOSED, 2.0),
        ({"issue": 1.5, "memory": 0.5}, SLOW_MEMORY, EXPOSED, 1.0),
        ({"issue": 1.5, "memory": 1.0}, SLOW_MEMORY, EXPOSED, 2.0),
        ({"issue": 0.5, "memory": 0.0}, HALF, EXPOSED, 2.0),
        # A cache as near as can be does not hide the memory behind it; a pipe does.
        ({"issue": 0.5, "l2": 1.0, "memory": 0.5}, SLOW_MEMORY, EXPOSED, 1.0),
        ({"issue": 0.5, "l2": 1.0, "memory": 0.5}, SLOW_MEMORY, PIPES, 1 + 1 / 3),
        ({"issue": 0.5, "memory": 0.5}, SLOW_MEMORY, PIPES, 1 + 1 / 3),
        ({"issue": 0.5, "memory": 0.375}, SLOW_MEMORY, NEAREST, 1.0),
        ({"issue": 0.5, "memory": 0.625}, SLOW_MEMORY, NEAREST, 2.0),
        ({"issue": 0.5, "memory": 0.625}, HALF, CORE, 2.0),
        ({"issue": 0.5, "memory": 0.625}, SLOW_MEMORY, BANDWIDTH, 2.0),
    ],
)
def test_a_kernel_scales_with_what_bounds_it(shares, other, rule, ratio):
    assert predicted([kernel(**shares)], 1.0, ONE, other, rule) == pytest.approx(ratio, rel=1e-15)
    assert predicted([kernel(**shares)], 1.0, ONE, ONE, rule) == 1.0


def test_kernels_count_by_their_time_and_the_hosts_part_stays():
    kernels = [kernel(3.0, memory=1.0, issue=0.5), kernel(1.0, issue=0.75)]
    assert predicted(kernels, 1.0, ONE, SLOW_MEMORY, SHARES) == (3 * 2 + 1) / 4
    assert predicted(kernels, 0.5, ONE, SLOW_MEMORY, SHARES) == 0.5 * 7 / 4 + 0.5
    bound, shares = bound_of(kernels)
    assert bound == "memory"
    assert (shares["memory"], shares["issue"]) == (0.75, (3 * 0.5 + 0.75) / 4)


def test_every_data_sheet_can_be_read_and_the_measured_gpus_are_as_their_files_say():
    assert all(gpu_of_sheet(model).rate("issue") > 0 for model in known_gpus())
    for file, model in zip(PAIR, ("h200", "h100"), strict=True):
        measured, sheet = gpu_of_result(load_kept(file)), gpu_of_sheet(model)
        assert (measured.multiprocessors, measured.clock_mhz, measured.l2_bytes, measured.per_clock) == (
            sheet.multiprocessors, sheet.clock_mhz, sheet.l2_bytes, sheet.per_clock,
        )  # fmt: skip
        assert round(measured.gb_per_second) == round(sheet.gb_per_second)


def test_counters_are_a_cells_own_whatever_launches_it_and_near_with_other_tunables_or_depth():
    entries = [entry for entry in load_inspected(COUNTERS) if entry.scene == "cornell_open_45"]
    cells = [cell for cell in load_kept(PAIR[0]).cells if cell.scene == "cornell_open_45" and cell.measured]
    by_kind = {cell.name: evidence_of(cell, entries) for cell in cells}
    own = {cell.variant for cell in cells if by_kind[cell.name] and by_kind[cell.name].kind == OWN}
    near = {cell.variant for cell in cells if by_kind[cell.name] and by_kind[cell.name].kind == NEAR}
    assert own == {"megakernel", "persistent", "wavefront"}
    assert {"persistent block=64", "persistent piece=4", "megakernel block=256"} <= near
    assert not any("packed" in variant for variant in own | near)
    (own_cell,) = [cell for cell in cells if cell.variant == "persistent"]
    as_graph = replace(own_cell, axes={**own_cell.axes, "launch": "graph"})
    assert evidence_of(as_graph, entries).kind == OWN
    fewer = tuple(replace(sample, rays=sample.rays / 2) for sample in own_cell.samples)
    assert evidence_of(replace(own_cell, samples=fewer), entries).kind == NEAR


def made_fleet(folder, factor: float, memory: float):
    """Eight cells on a GPU with half the memory's bandwidth that takes `factor` times as long; counters of `memory`."""
    document = wavefront_by_depth()
    slow = other_machine(run_again(document, factor), "slow", units=132, memory_clock=1600.5)
    entries, seen = [], set()
    for cell in document["ptbench"]["cells"]:
        # A file of counters says no depth: of one variant, the first cell's rays stand there.
        if (cell["scene"], cell["variant"]) in seen:
            continue
        seen.add((cell["scene"], cell["variant"]))
        rows = [row for row in document["benchmarks"] if row["run_name"] == cell["cell"] and "pt_rays" in row]
        shares = {"issue": 0.5, "fma": 0.25, "alu": 0.25, "xu": 0.0, "memory": memory}
        of_ray = dict.fromkeys(("warp_instructions", "thread_instructions", "memory_bytes"), 1.0)
        counters = {f"{name}_per_ray": value for name, value in of_ray.items()}
        counters |= {"achieved_occupancy": 0.5, "active_lanes": 32, "milliseconds": 1.0, "of_ceiling": shares}
        entries.append(
            {"scene": cell["scene"], "variant": cell["variant"], "axes": cell["axes"], "architecture": "sm_90",
             "kernels": [{"name": "k", "registers": 32, "occupancy": 1.0, "counters": counters}],
             "rays": float(np.median([row["pt_rays"] / row["pt_spp"] for row in rows])), "spp": 1,
             "ceilings": {"memory_gb_per_second": 4000.0}}
        )  # fmt: skip
    inspected = folder / "inspect.json"
    inspected.write_text(json.dumps(entries), encoding="utf-8")
    files = [written(document, folder / "first.json"), written(slow, folder / "slow.json")]
    return files, inspected


@pytest.mark.parametrize(("factor", "verdict"), [(4 / 3, "reached"), (1.2, "missed")])
def test_a_fleet_is_predicted_and_held_to_its_aim(tmp_path, capsys, factor, verdict):
    files, inspected = made_fleet(tmp_path, factor, memory=0.5)
    (other,) = fleet_of(files, [inspected]).others
    assert len(other.predictions) == 8
    assert not other.unpredicted
    own = [one for one in other.predictions if one.is_own]
    assert len(own) == 4  # of each variant and scene one depth
    for one in own:
        device = one.cell.device_share
        assert one.ratios[SHARES.name] == pytest.approx(device * 1.5 + 1 - device, rel=1e-12)
        assert one.ratios[EXPOSED.name] == pytest.approx(device * 4 / 3 + 1 - device, rel=1e-12)
        assert one.error() == pytest.approx(one.ratios[EXPOSED.name] / one.row.ratio.value - 1)
    out = tmp_path / "out"
    assert main(["fleet", *map(str, files), "--inspect", str(inspected), "--gpu", "t4", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert f"of the variants: {verdict}" in said
    assert "GeForce" not in said
    assert "Tesla T4" in said
    assert {path.name for path in out.iterdir()} == {"fleet.md", "predicted_B.png", "predicted_B.svg"}


def test_counters_of_another_gpu_are_refused(capsys):
    call = ["fleet", str(PAIR[1]), str(PAIR[0]), "--inspect", str(COUNTERS)]
    assert main(call) == 2
    error = capsys.readouterr().err
    assert "found 4095, allowed: 1676 to 3352" in error
    assert error.count("\n") == 1


def test_bad_calls_say_what_is_allowed(tmp_path, capsys):
    assert main(["fleet", str(PAIR[0])]) == 2
    assert "two or more" in capsys.readouterr().err
    assert main(["fleet", *map(str, PAIR), "--gpu", "voodoo"]) == 2
    assert 'found "voodoo", allowed: t4, a100-40gb' in capsys.readouterr().err
    document = other_machine(run_again(wavefront_by_depth()), "future")
    document["context"]["ptbench.cuda_compute_capability"] = "99.0"
    with pytest.raises(InputError, match=r"found 99\.0, allowed: 7\.5, 8\.0"):
        fleet_of([written(wavefront_by_depth(), tmp_path / "a.json"), written(document, tmp_path / "b.json")], [])


def test_the_measured_gpus_turn_one_groups_order():
    fleet = fleet_of(PAIR, [COUNTERS])
    (other,) = fleet.others
    assert len(other.comparison.rows) == 71
    groups = [group for group in fleet.compared.rankings if group.changes]
    assert [(group.scene, len(group.changes)) for group in groups] == [("cornell_open_45", 4)]
    gpus = (fleet.first, other.gpu)
    for change in groups[0].changes:
        at = crossover(groups[0], change, gpus)
        assert other.gpu.gb_per_second < at.low <= at.value <= at.high < fleet.first.gb_per_second
    said = {section.title: section for section in sections(fleet, whole=True)}
    assert len(said["Where the order turns"].table.rows) == 4
    pairs = verdict_pairs(other.comparison)
    assert sum(pair.is_decided for pair in pairs) > 20
    changed = [pair for pair in pairs if pair.is_changed]
    assert all(pair.first.verdict.word != pair.other.verdict.word for pair in changed)


def cell_taking(ms: float):
    return SimpleNamespace(ms_per_spp=np.full(9, ms), samples=range(9))


def test_two_variants_cross_at_the_bandwidth_where_their_lines_over_its_reciprocal_meet():
    # Time is a + b / B: 2 + 1000 / B against 1 + 2000 / B are equal at B = 1000, between 500 and 2000.
    one, two = replace(ONE, gb_per_second=500.0), replace(ONE, gb_per_second=2000.0)
    lines = [(2.0, 1000.0), (1.0, 2000.0)]
    cells = tuple(tuple(cell_taking(a + b / gpu.gb_per_second) for gpu in (one, two)) for a, b in lines)
    change = SimpleNamespace(ahead=0, behind=1, at=0, turned_at=1)
    at = crossover(SimpleNamespace(cells=cells), change, (one, two))
    assert (at.value, at.low, at.high) == (1000.0, 1000.0, 1000.0)
    assert crossover(SimpleNamespace(cells=cells), change, (one, replace(two, multiprocessors=132))) is None


def test_counters_of_libraries_kernels_are_merged_as_the_program_counts_its_own(tmp_path):
    spec = importlib.util.spec_from_file_location("merge_counters", ROOT / "tools/fleet/merge_counters.py")
    merge = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(merge)
    names = ["Kernel Name", *merge._SUMS.values(), *merge._SHARES.values()]
    units = ["", "nsecond", *[""] * (len(names) - 2)]
    # Times of 1 us and 3 us; 4000 and 12000 warps' instructions, and as many bytes of memory.
    rows = [[f"void cub::Sweep<1>(int, {n})", f"{n},000", *["4000"] * 8, *["50"] * 6] for n in (1, 1, 2)]
    rows.append(["next_bounce", "5000", *["1"] * 8, *["1"] * 6])
    lines = ["==PROF== words", *(",".join(f'"{field}"' for field in row) for row in (names, units, *rows))]
    (tmp_path / "csv").mkdir()
    (tmp_path / "csv" / "queue-0.csv").write_text("\n".join(lines), encoding="utf-8")
    entry = json.loads(stored_text(COUNTERS).replace("_a_", "_per_"))[0]
    entry |= {"kernels": [{**entry["kernels"][0], "name": "next_bounce"}], "rays": 1000}
    for name in entry["ceilings"]:
        entry["ceilings"][name] = 10.0  # 1e9 a second
    (tmp_path / "inspect_queue.json").write_text(json.dumps([entry]), encoding="utf-8")
    (merged,) = merge.merged(tmp_path)
    assert merged["caches"] == "kept"
    (other,) = merged["other_kernels"]
    assert other["name"] == "void cub::Sweep<1>"
    counters = other["counters"]
    assert (counters["launches"], counters["milliseconds"]) == (3, pytest.approx(4e-3))
    assert counters["warp_instructions_per_ray"] == pytest.approx(12.0)
    # 12000 in 4 us are 3e9 a second, of 1e10.
    assert counters["of_ceiling"]["issue"] == pytest.approx(0.3)
    assert counters["of_ceiling"]["l2"] == counters["l2_hit_rate"] == pytest.approx(0.5)
    assert list(complaints([merged], "inspect")) == []
    (tmp_path / "merged.json").write_text(json.dumps([merged]), encoding="utf-8")
    (read,) = load_inspected(tmp_path / "merged.json")
    assert [kernel.name for kernel in read.others] == ["void cub::Sweep<1>"]
    assert [kernel.name for kernel in times_of(read)] == ["next_bounce", "void cub::Sweep<1>"]
