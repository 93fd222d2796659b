"""One render on many GPUs, simulated: shares, messages and times by hand, the parts from files, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import RESULTS, ROOT

from ptbench.cli.main import main
from ptbench.errors import InputError
from ptbench.extras.simulate.model import (
    BANDS,
    DYNAMIC,
    PARTITIONS,
    SAMPLES,
    TILES,
    Case,
    Cost,
    Network,
    added_up_ms,
    chunks_of,
    efficiency,
    finer,
    gathered_ms,
    of_blocks,
    of_samples,
    times_ms,
)
from ptbench.extras.simulate.parts import parts_of, read_work, reduction_ms
from ptbench.extras.simulate.study import device_checks, study_of
from ptbench.extras.simulate.work import blocks_of, counting
from ptbench.io.results import load_kept

FREE = Network("free", 0.0, 1e30)
# A message takes 1 ms, and a million pixels' film another 24.
NETWORK = Network("made", 1.0, 1.0)
WORK = np.array([[1.0, 2.0], [3.0, 2.0]])
ONES = np.ones((1, 2))


def test_samples_are_dealt_out_once_and_evenly():
    for spp in (1, 3, 16, 1000):
        for ranks in (1, 2, 3, 7, 64):
            counts = np.round(of_samples(spp, ranks) * spp).astype(int)
            assert counts.sum() == spp
            assert counts.max() - counts.min() <= 1


def test_chunks_hand_out_every_sample_once():
    for spp in (1, 16, 1000, 65536):
        for ranks in (2, 3, 64, 1024):
            chunks = chunks_of(spp, ranks)
            assert sum(chunks) == spp
            assert chunks == sorted(chunks, reverse=True) or spp % 16


def test_blocks_go_in_turn_or_in_a_row():
    assert of_blocks(WORK, 2, TILES).tolist() == [(1 + 3) / 8, (2 + 2) / 8]
    assert of_blocks(WORK, 2, BANDS).tolist() == [(1 + 2) / 8, (3 + 2) / 8]
    for partition in (TILES, BANDS):
        for ranks in (1, 3, 4, 9):
            assert of_blocks(WORK, ranks, partition).sum() == pytest.approx(1, abs=1e-15)
    assert finer(WORK, 2).shape == (4, 4)
    assert of_blocks(finer(WORK, 2), 2, BANDS).tolist() == [3 / 8, 5 / 8]


@pytest.mark.parametrize(
    ("ranks", "tree", "halves"), [(2, 1 + 24, 2 + 24), (4, 2 + 48, 4 + 36), (5, 3 + 72, 6 + 38.4), (8, 3 + 72, 6 + 42)]
)
def test_films_are_added_up_by_the_shorter_way(ranks, tree, halves):
    assert added_up_ms(NETWORK, ranks, 1_000_000) == pytest.approx(min(tree, halves), rel=1e-14)
    assert added_up_ms(NETWORK, 1, 1_000_000) == gathered_ms(NETWORK, 1, 1_000_000) == 0
    messages = 3 if ranks > 4 else ranks // 2
    assert gathered_ms(NETWORK, ranks, 1_000_000) == pytest.approx(messages + 24 * (ranks - 1) / ranks, rel=1e-14)


def test_times_are_those_of_the_slowest_and_of_the_film():
    cost = Cost(2.0, 8.0)  # 2 ms a render, and 8 ms a million samples of pixels
    case = Case(1_000_000, 3, 2, SAMPLES)
    assert times_ms(case, WORK, cost, NETWORK, ONES).tolist() == pytest.approx([2 + 2 * 8 + 25])
    assert times_ms(case, WORK, cost, NETWORK, np.array([[4.0, 1.0]])).tolist() == pytest.approx([4 * (2 + 8) + 25])
    bands = replace(case, partition=BANDS)
    assert times_ms(bands, WORK, cost, FREE, ONES).tolist() == pytest.approx([2 + 24 * 5 / 8])
    # Eight samples go as 2, 1, 1, 1, 1, 1 and 1, each with a launch: 18, then 10 ms. Both have four samples; the first
    # three launches, the second four.
    turn = Case(1_000_000, 8, 2, DYNAMIC)
    assert chunks_of(8, 2) == [2, 1, 1, 1, 1, 1, 1]
    assert times_ms(turn, WORK, cost, FREE, ONES).tolist() == pytest.approx([4 * 10])
    # The first takes three times as long, 54 ms for two samples: meanwhile the second has five and begins the last.
    assert times_ms(turn, WORK, cost, FREE, np.array([[3.0, 1.0]])).tolist() == pytest.approx([6 * 10])
    # A message of 1 ms a chunk, and one and the film at the end.
    assert times_ms(turn, WORK, cost, NETWORK, ONES).tolist() == pytest.approx([4 * 11 + 25])
    # A rank without samples neither starts nor counts.
    idle = Case(1_000_000, 1, 2, SAMPLES)
    assert times_ms(idle, WORK, cost, FREE, np.array([[100.0, 1.0]])).tolist() == pytest.approx([10.0])


@pytest.mark.parametrize("partition", PARTITIONS)
def test_one_gpu_is_as_efficient_as_itself(partition):
    case = Case(640_000, 16, 1, partition)
    assert efficiency(case, WORK, Cost(1.0, 5.0), NETWORK, np.ones((1, 1))).tolist() == pytest.approx([1.0])


def test_even_work_without_cost_is_perfectly_efficient():
    for partition in PARTITIONS:
        case = Case(640_000, 16, 4, partition)
        assert efficiency(case, np.ones((4, 4)), Cost(0.0, 5.0), FREE, np.ones((1, 4))).tolist() == pytest.approx([1.0])


def test_a_scene_that_counts_rays_has_no_colours_left():
    scene = json.loads((ROOT / "scenes" / "cornell_open.json").read_text(encoding="utf-8"))
    counted = counting(scene)
    assert counted["environment"] == [1, 1, 1]
    assert counted["materials"]["light"]["radiance"] == [1, 1, 1]
    assert counted["materials"]["red"] == {"type": "diffuse", "albedo": [1, 1, 1], "emission": [1, 1, 1]}
    assert scene["materials"]["red"]["albedo"] != [1, 1, 1]
    scene["materials"]["red"] = {"type": "subsurface"}
    with pytest.raises(InputError, match=r"the material red \(subsurface\), allowed: diffuse, mirror"):
        counting(scene)


def test_the_committed_map_counts_the_rays_that_the_gpu_counted():
    work, scene = read_work(RESULTS / "simulation/parts/work_cornell_open.json")
    assert work.shape == (50, 50)
    assert 1 <= work.min() <= work.max() <= 8
    cell = next(
        cell
        for cell in load_kept(RESULTS / "nvidia-h200/schedulers_a7e8939.json").cells
        if cell.scene == scene and cell.variant == "persistent" and cell.depth == 8
    )
    rays_per_path = cell.samples[0].rays / cell.samples[0].paths
    assert work.mean() == pytest.approx(rays_per_path, rel=1e-3)


def test_blocks_are_means_and_must_fit():
    image = np.arange(16.0).reshape(4, 4)
    assert blocks_of(image, 2).tolist() == [[2.5, 4.5], [10.5, 12.5]]
    with pytest.raises(InputError, match="found 4x4 pixels, allowed: multiples of 3"):
        blocks_of(image, 3)


def test_results_of_ranks_can_be_read():
    result = load_kept(RESULTS / "simulation/parts/reduction_2_ranks.json")
    assert result.about("rank_hosts").count(",") == 1
    assert all(ranks == 2 for ranks, _ in reduction_ms(result, 5.0))
    with pytest.raises(InputError, match="no pt_reduce_ms up to 5"):
        reduction_ms(load_kept(RESULTS / "nvidia-h200/schedulers_a7e8939.json"), 5.0)


def test_the_same_parts_give_the_same_numbers():
    parts = parts_of(RESULTS)
    small = replace(parts, definition={**parts.definition, "ranks": [1, 2, 64], "spp": [16, 4096], "sides": [800]})
    one, two = study_of(small), study_of(small)
    assert one.efficiencies == two.efficiencies
    assert all(one.efficiencies[partition, 4096, 1].value > 0.99 for partition in PARTITIONS)
    for partition in PARTITIONS:
        values = [one.efficiencies[partition, 4096, count].value for count in (1, 2, 64)]
        assert values == sorted(values, reverse=True)


def test_several_gpus_are_held_against_what_was_measured():
    parts = parts_of(RESULTS)
    cell = next(
        cell
        for cell in load_kept(RESULTS / "nvidia-h200/scaling.json").cells
        if cell.scene == parts.work_scene
        and cell.axes["integrator"] == "persistent"
        and cell.resolution == (1024, 1024)
    )
    axes = {**cell.axes, "devices": "2", "partition": "samples"}
    # A third faster than one: 0.75 of the time is 1 / (2 x 0.75) of the efficiency.
    samples = tuple(replace(sample, wall_ms=0.75 * sample.wall_ms) for sample in cell.samples)
    (point,) = device_checks(parts, (cell, replace(cell, axes=axes, samples=samples)))
    assert point.measured == pytest.approx(1 / 1.5)
    assert 0 < point.said < 1
    assert device_checks(parts, (cell, replace(cell, axes=axes, scene="other"))) == ()


def test_the_command_writes_a_page_and_a_figure_or_says_what_is_missing(tmp_path, capsys):
    definition = json.loads((ROOT / "analysis/ptbench/extras/simulate/thousand.json").read_text(encoding="utf-8"))
    definition |= {"ranks": [1, 2, 4], "spp": [16], "sides": [800], "trials": 20}
    file = tmp_path / "few.json"
    file.write_text(json.dumps(definition), encoding="utf-8")
    call = ["simulate", "--definition", str(file), "--results", str(RESULTS), "--out", str(tmp_path / "out")]
    assert main(call) == 0
    assert "Not checked: any network between hosts" in capsys.readouterr().out
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"simulation.md", "efficiency.png", "efficiency.svg"}
    assert main(["simulate", "--results", str(tmp_path)]) == 2
    assert "no such file" in capsys.readouterr().err
    assert main(["simulate", "--work", str(ROOT / "scenes/cornell_open.json")]) == 2
    assert "found no --out" in capsys.readouterr().err
