"""Data frames say what the result files say, row for row."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from builder import Builder, small
from conftest import PACKAGE, RESULTS
from convergence_builder import convergence_cell, convergence_study
from stability_builder import StabilityBuilder

from ptbench import frames
from ptbench.errors import InputError
from ptbench.io.nodes import read_json
from ptbench.io.results import load, load_kept
from ptbench.io.stability import stability_of

EXAMPLES = PACKAGE.parent / "examples"
COMMITTED = [
    RESULTS / "nvidia-h200" / "sorting.json",
    RESULTS / "amd-epyc-2-threads" / "schedulers.json",
    Path(__file__).parent / "parts_of_results" / "failed_cells.json",  # a part of a convergence suite on an H200
]


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_a_committed_file_comes_back_whole(path):
    result = load(path)
    samples, cells, stages = frames.samples(path), frames.cells(path), frames.stages(path)
    assert len(samples) == sum(len(cell.samples) + len(cell.errors) for cell in result.cells)
    assert list(cells["cell"]) == [cell.name for cell in result.cells]
    assert len(frames.not_applicable(path)) == len(result.not_applicable)
    medians = samples.groupby("cell", observed=True)["ms_per_spp"].median()
    by_cell = cells.set_index("cell")
    for cell in result.cells:
        expected = float(np.median(cell.ms_per_spp)) if cell.measured else math.nan
        assert medians[cell.name] == pytest.approx(expected, rel=0, abs=0, nan_ok=True)
        assert by_cell["median_ms_per_spp"][cell.name] == pytest.approx(expected, rel=0, abs=0, nan_ok=True)
        of_cell = stages[stages["cell"] == cell.name]
        assert dict(zip(of_cell["stage"], of_cell["stage_ms"], strict=True)) == cell.instrumented.stage_ms
        for axis, choice in cell.axes.items():
            assert by_cell[axis][cell.name] == choice


def test_columns_are_typed_and_named_with_their_units():
    frame = frames.samples(COMMITTED[0])
    for name in ("machine", "commit", "scene", "scene_hash", "backend", "variant", "compaction", "layout", "status"):
        assert isinstance(frame[name].dtype, pd.CategoricalDtype), name
    for name in ("wall_ms", "device_ms", "end_to_end_ms", "cpu_ms", "ms_per_spp", "clock_mhz_before", "rays"):
        assert frame[name].dtype == np.float64, name
        assert frame[name].notna().all(), name
    for name in ("depth", "spp", "width", "height", "repetition", "seed", "tunable_block", "launches"):
        assert frame[name].dtype == pd.Int64Dtype(), name
    assert frame["low_clock"].dtype == pd.BooleanDtype()
    assert (frame["ms_per_spp"] == frame["wall_ms"] / frame["spp"].astype(float)).all()


def test_what_failed_is_a_row_without_times(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    builder.cell("compaction", n=3, error="the device is gone", axes={"compaction": "scan"})
    # Timed before its films were found to differ.
    builder.cell("compaction", n=2, axes={"compaction": "scatter"}, status="failed", reason="film bits differ")
    file = builder.write(tmp_path / "quick.json")
    frame = frames.samples(file)
    assert len(frame) == 9 + 3 + 2
    failed = frame[frame["status"] == "failed"]
    assert list(failed["compaction"]) == ["scan"] * 3 + ["scatter"] * 2
    assert list(failed["reason"]) == ["the device is gone"] * 3 + ["film bits differ"] * 2
    assert list(failed["repetition"]) == [0, 1, 2, 0, 1]
    assert failed[["wall_ms", "ms_per_spp", "device_ms", "rays"]].isna().all(axis=None)
    cells = frames.cells(file)
    assert list(cells["status"]) == ["ok", "failed", "failed"]
    assert list(cells["failed_samples"]) == [0, 3, 0]
    assert list(cells["median_ms_per_spp"].isna()) == [False, True, True]
    assert list(frames.stages(file)["stage"].isna()) == [True] * 3  # no cell of these was instrumented


def test_files_of_two_machines_stand_under_each_other(tmp_path):
    old = small().write(tmp_path / "old.json")
    gpu = Builder("compaction").on_gpu().study("compaction")
    gpu.cell("compaction", tunables={"block": 512}, live_paths=[8, 4])
    new = gpu.write(tmp_path / "new.json")
    frame = frames.samples([old, new])
    assert len(frame) == len(frames.samples(old)) + len(frames.samples(new))
    assert list(frame["machine"].cat.categories) == ["amd-epyc-2-cores", "nvidia-h200"]
    assert frame["arithmetic"][frame["machine"] == "amd-epyc-2-cores"].isna().all()  # older than the axis
    assert set(frame["tunable_block"].dropna()) == {512}
    live = frames.live_paths([new])
    assert list(live["live_paths"]) == [8, 4]
    assert list(live["live_share"]) == [1.0, 0.5]
    kernels = frames.kernels(new).set_index("kernel")
    assert kernels["registers"]["shade_paths"] == 40
    assert kernels["local_bytes"]["shade_paths"] == 8


def test_curves_have_a_row_a_checkpoint(tmp_path):
    builder = convergence_study(Builder("convergence"))
    convergence_cell(builder, seeds=2, spps=[1, 2, 4], biases=["frozen camera rays"])
    convergence_cell(builder, seeds=1, spps=[1, 2], axes={"compaction": "scan"}, error="the device is gone")
    path = builder.write(tmp_path / "convergence.json")
    curves = frames.curves(path)
    assert list(curves["checkpoint_spp"].astype(object).where(curves["checkpoint_spp"].notna(), None)) == [
        *(1, 2, 4),
        *(1, 2, 4),
        None,
    ]
    assert list(curves["status"]) == ["ok"] * 6 + ["failed"]
    checkpoints = [checkpoint for sample in load(path).cells[0].samples for checkpoint in sample.checkpoints]
    assert list(curves["wall_ms"][:6]) == [checkpoint.times["wall_ms"] for checkpoint in checkpoints]
    assert list(curves["mse_dual"][:6]) == [checkpoint.errors["mse_dual"] for checkpoint in checkpoints]
    assert list(curves["mean_error_g"][:6]) == [checkpoint.mean_error[1] for checkpoint in checkpoints]
    assert set(curves["biases"][:6]) == {"frozen camera rays"}


def test_committed_curves_keep_their_failed_samples():
    curves = frames.curves(COMMITTED[2])
    failed = [cell for cell in load_kept(COMMITTED[2]).cells if cell.failed]
    assert failed
    assert len(curves[curves["status"] == "failed"]) == sum(len(c.samples) + len(c.errors) for c in failed)


def _stability() -> StabilityBuilder:
    builder = StabilityBuilder().case("lamp", parameters={"a": 0.5}).row({}, 2.0**-21, 2.0**-20)
    builder.case("needle", parameters={"b": 3.0}).row({}, math.inf, status="known limit", reason="too thin")
    return builder.none({"integrator": "wavefront"}, reason="needs depth_first")


def test_stability_has_a_row_a_check(tmp_path):
    path = _stability().write(tmp_path / "stability.json")
    known = stability_of(read_json(path))
    frame = frames.stability(path)
    assert list(frame["status"]) == [row.status for row in known.rows] == ["passed", "known limit", "n/a"]
    assert list(frame["reason"]) == ["", "too thin", "needs depth_first"]
    assert list(frame["parameter_a"].fillna(-1)) == [0.5, -1, -1]
    assert list(frame["parameter_b"].fillna(-1)) == [-1, 3, 3]
    assert list(frame["over_allowed"][:2]) == [0.5, math.inf]
    assert list(frame["quantity"].isna()) == [False, False, True]


def test_committed_stability_comes_back_whole():
    path = RESULTS / "amd-epyc-2-threads" / "stability.json"
    known = stability_of(read_json(path))
    frame = frames.stability(path)
    assert list(frame["status"]) == [row.status for row in known.rows]
    assert list(frame["case"]) == [row.case.name for row in known.rows]


def test_no_rows_still_have_columns(tmp_path):
    path = Builder().study("compaction").write(tmp_path / "empty.json")
    frame = frames.samples(path)
    assert len(frame) == 0
    assert frame["wall_ms"].dtype == np.float64
    assert len(frames.samples([])) == 0


def test_a_file_of_the_other_kind_is_refused_by_name(tmp_path):
    stability = _stability().write(tmp_path / "stability.json")
    with pytest.raises(InputError, match=r"stability\.json: \$\.schema: found .*frames\.stability reads it"):
        frames.samples(stability)
    with pytest.raises(InputError, match=r"quick\.json: \$\.schema: found nothing"):
        frames.stability(small().write(tmp_path / "quick.json"))


def run_example(name: str, folder: Path) -> str:
    """What an example says, run beside the committed results."""
    (folder / "results").symlink_to(RESULTS)
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "MPLBACKEND": "Agg"}
    command = [sys.executable, "-W", "error", EXAMPLES / f"{name}.py"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_example_draws_its_figure(tmp_path):
    said = run_example("own_plot", tmp_path)
    committed = load_kept(RESULTS / "nvidia-h200" / "seeds.json")
    assert f"{sum(len(cell.samples) for cell in committed.cells)} samples of {len(committed.cells)} cells" in said
    assert (tmp_path / "own_plot.png").read_bytes().startswith(b"\x89PNG")


def test_a_figure_for_a_paper_takes_ten_lines(tmp_path):
    code = (EXAMPLES / "paper_figure.py").read_text(encoding="utf-8").partition("import ptbench\n")[2]
    assert len([line for line in code.splitlines() if line]) <= 10
    run_example("paper_figure", tmp_path)
    assert (tmp_path / "paper_figure.pdf").read_bytes().startswith(b"%PDF")
