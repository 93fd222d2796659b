"""Several GPUs of one host: efficiencies from a result, their figure and page, and the script that times neighbours."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import pytest
from builder import GPU_AXES, Builder
from conftest import ROOT
from legibility import check_legible

from ptbench.errors import NotDrawable
from ptbench.figures.registry import collect_study, draw
from ptbench.findings.page import read_page, render
from ptbench.io.results import load
from ptbench.studies.devices import strong, weak

RESOLUTION = [800, 800]
STRONG_SPPS = (16, 256)


def device_axes(devices: int, partition: str = "samples") -> dict[str, str]:
    common = {"integrator": "persistent", "arithmetic": "exact", "accelerator": "brute_force"}
    return common | {"devices": str(devices), "partition": partition}


def add(builder: Builder, study: str, devices: int, spp: int, ms_per_spp: float, partition="samples"):
    """A cell whose GPUs each take nine tenths of the time, the first one eight; a tenth is the reduction."""
    cell = builder.cell(
        study, ms_per_spp=ms_per_spp, spp=spp, axes=device_axes(devices, partition), resolution=RESOLUTION, noise=0.0
    )
    for row in builder.rows:
        if row["run_name"] == cell["cell"] and row["run_type"] == "iteration":
            row["film_hash"] = "a" * 16
            if devices > 1:
                wall = row["pt_wall_ms"]
                row |= {
                    "pt_devices": devices,
                    "pt_own_device_ms": [0.8 * wall, *[0.9 * wall] * (devices - 1)],
                    "pt_slowest_device_ms": 0.9 * wall,
                    "pt_device_reduce_ms": 0.1 * wall,
                }


@pytest.fixture
def measured(tmp_path):
    builder = Builder("devices").on_gpu().study("strong", "devices", "A fixed image on more GPUs").study("weak")
    builder.baselines = GPU_AXES | {"accelerator": "brute_force", "devices": "1", "partition": "samples"}
    for spp in STRONG_SPPS:
        add(builder, "strong", 1, spp, 3.0)
        add(builder, "strong", 2, spp, 2.0)
        add(builder, "strong", 4, spp, 1.0)
    add(builder, "strong", 2, 256, 2.04, partition="tiles")
    add(builder, "strong", 2, 256, 2.2, partition="dynamic")
    add(builder, "weak", 2, 32, 1.6)
    (tmp_path / "nvidia-h200").mkdir()
    return builder.write(tmp_path / "nvidia-h200" / "devices.json")


def test_a_fixed_image_is_held_against_one_gpu(measured):
    cells = load(measured).cells
    found = {(one.cell.axes["devices"], one.cell.axes["partition"], one.cell.spp): one for one in strong(cells)}
    assert set(found) == {("2", "samples", 16), ("4", "samples", 16), ("2", "samples", 256), ("4", "samples", 256),
                          ("2", "tiles", 256), ("2", "dynamic", 256)}  # fmt: skip
    two, tiles = found["2", "samples", 256], found["2", "tiles", 256]
    assert two.efficiency.value == pytest.approx(3 / 2 / 2)
    assert two.without_reduction.value == pytest.approx(3 / (0.9 * 2) / 2)
    assert two.reduce_ms.value == pytest.approx(0.1 * 2 * 256)
    assert two.idle_share.value == pytest.approx(1 - 0.85 / 0.9)
    assert tiles.efficiency.value == pytest.approx(3 / 2.04 / 2)
    assert found["4", "samples", 256].efficiency.value == pytest.approx(3 / 1 / 4)
    assert two.has_same_films
    other = [replace(sample, film_hash="b" * 16) for sample in two.cell.samples[:1]]
    assert not replace(two, cell=replace(two.cell, samples=tuple(other))).has_same_films


def test_a_growing_image_is_held_against_its_part_on_one_gpu(measured):
    (found,) = [one for one in weak(load(measured).cells) if one.cell.spp == 32]
    assert (found.one.spp, found.cell.spp != found.one.spp) == (16, True)
    # 16 samples of 3 ms on one, 32 of 1.6 ms on two.
    assert found.efficiency.value == pytest.approx(16 * 3 / (32 * 1.6))


def test_older_files_have_one_gpu(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction")
    (cell,) = load(builder.write(tmp_path / "a.json")).cells
    assert strong([cell]) == weak([cell]) == []
    assert cell.samples[0].render_ms == cell.samples[0].wall_ms
    assert cell.samples[0].own_device_ms == ()


def test_the_figure_has_a_line_a_number_of_gpus(measured):
    result = load(measured)
    data = collect_study(result, result.studies[0])
    assert data.order == (
        "2 GPUs", "2 GPUs, without the reduction", "2 GPUs, 2 times the samples",
        "4 GPUs", "4 GPUs, without the reduction",
    )  # fmt: skip
    lines = {line.label: line for line in data.panels[0].series}
    assert lines["2 GPUs"].xs == tuple(map(float, STRONG_SPPS))
    assert [e.value for e in lines["4 GPUs"].values] == pytest.approx([0.75, 0.75])
    assert [e.value for e in lines["2 GPUs, 2 times the samples"].values] == pytest.approx([48 / 51.2])
    check_legible(draw(data), "devices")


def test_one_gpu_alone_is_not_drawn(tmp_path):
    builder = Builder("devices").on_gpu().study("strong", "devices")
    builder.baselines = GPU_AXES | {"accelerator": "brute_force", "devices": "1", "partition": "samples"}
    add(builder, "strong", 1, 16, 3.0)
    result = load(builder.write(tmp_path / "devices.json"))
    with pytest.raises(NotDrawable, match="no cell on several GPUs has its like on one"):
        collect_study(result, result.studies[0])


def test_the_page_tells_what_there_is(measured):
    page = read_page(ROOT / "docs/templates/devices.md")
    text = render(page, measured.parent.parent)
    assert "6 of 6 cells on several GPUs left one GPU's film in every sample" in text
    assert "| cornell_open | 800x800 | 256 | 2 | `samples` | 0.750 [0.750, 0.750] |" in text
    assert "0.85: missed" in text
    assert "`dynamic` takes 1.100 of the time of `samples`, `tiles` 1.020." in text
    assert "Beside a busy GPU" not in text
    assert "Nothing is measured yet" in render(page, measured.parent)


# ---- tools/neighbours.py with a program that only says what it was asked ----

FAKE = """#!{python}
import json, os, sys, time
arguments = sys.argv[1:]


def has_ended():
    try:
        number = open({pid!r}).read()
        return number != "" and open(f"/proc/{{number}}/stat").read().rsplit(")", 1)[1].split()[0] in "ZX"
    except FileNotFoundError:
        return os.path.exists({pid!r})


with open({log!r}, "a") as log:
    print(json.dumps([os.environ["CUDA_VISIBLE_DEVICES"], *arguments]), file=log)
if arguments[0] == "render":
    open({pid!r}, "w").write(str(os.getpid()))
    time.sleep({life})
else:
    out = arguments[arguments.index("--out") + 1]
    while {life} == 0 and "beside" in out and not has_ended():
        time.sleep(0.01)
    open(out, "w").write("{{}}")
"""


def neighbours(tmp_path, *, visible: str, life: float) -> subprocess.CompletedProcess:
    program, smi = tmp_path / "program", tmp_path / "nvidia-smi"
    program.write_text(
        FAKE.format(python=sys.executable, log=str(tmp_path / "log"), pid=str(tmp_path / "pid"), life=life)
    )
    smi.write_text("#!/bin/sh\necho 99\n")
    program.chmod(0o755)
    smi.chmod(0o755)
    call = [sys.executable, ROOT / "tools/neighbours.py", "--binary", program, "--out", tmp_path / "out"]
    environment = {"PATH": f"{tmp_path}:/usr/bin:/bin", "CUDA_VISIBLE_DEVICES": visible}
    return subprocess.run(call, capture_output=True, text=True, env=environment, check=False)


def test_neighbours_are_timed_on_one_gpu_while_the_other_works(tmp_path):
    ran = neighbours(tmp_path, visible="4,7", life=60)
    assert ran.returncode == 0, ran.stderr
    names = {"alone.json", "alone_again.json", "beside_computing.json", "beside_moving.json"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names
    calls = [json.loads(line) for line in (tmp_path / "log").read_text().splitlines()]
    assert {(call[0], call[1]) for call in calls} <= {("4", "run"), ("7", "render")}
    assert [call[0] for call in calls].count("4") == 4


def test_a_neighbour_that_ends_is_an_error(tmp_path):
    # If the neighbour still runs when the run begins, the run waits for its end.
    ran = neighbours(tmp_path, visible="4,7", life=0)
    assert ran.returncode != 0
    assert "neighbour ended" in ran.stderr


def test_neighbours_need_two_gpus(tmp_path):
    ran = neighbours(tmp_path, visible="4", life=0)
    assert ran.returncode != 0
    assert "CUDA_VISIBLE_DEVICES: found 4, allowed: two GPUs" in ran.stderr
