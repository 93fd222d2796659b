"""The measured inputs of a simulation, from result files, with the fit error of each model."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.errors import InputError, bad_value
from ptbench.extras.simulate.model import BYTES_PER_PIXEL, Cost, Network, added_up_ms
from ptbench.io.cells import Result
from ptbench.io.files import package_file
from ptbench.io.nodes import Node, read_json
from ptbench.io.results import load_kept
from ptbench.studies.selection import cells_of, parsed

DEFINITION = "thousand.json"
WORK = "ptbench-work-1"


@dataclass(frozen=True)
class Point:
    """A model's value and the measured one."""

    name: str
    said: float
    measured: float

    @property
    def error(self) -> float:
        """The relative error of the model's value."""
        return self.said / self.measured - 1


@dataclass(frozen=True)
class Parts:
    """All measured inputs of a simulation; `definition` holds the rest."""

    definition: Mapping
    cost: Cost
    cost_points: tuple[Point, ...]  # measured render times to which the straight line `cost` is fitted
    device: str
    noise: np.ndarray  # measured times of renders over the median of their cell
    noise_cells: int
    work: np.ndarray  # rays per path, by block of pixels
    work_scene: str
    reduction: Network  # network model fitted to film reductions between ranks on one host
    reduction_points: tuple[Point, ...]  # measured film reductions that the network model is fitted to
    reduction_checks: tuple[Point, ...]  # measured film reductions of other numbers of ranks, to check the model
    networks: Mapping[str, Network]
    devices: Path | None  # result file of a multi-GPU run; None: there is none


def parts_of(results: Path, definition: Path | None = None) -> Parts:
    """Loads the files that the definition names; raises InputError."""
    root = read_json(definition or package_file("extras", "simulate", DEFINITION))
    render, noise, reduction = (root.need(name) for name in ("render", "noise", "reduction"))
    cost, cost_points, device = _cost(results, render)
    values, cells = _noise(load_kept(results / noise.need("file").name()), noise.need("least_ms").number())
    work_file = results / root.need("work").name()
    work, scene = read_work(work_file)
    most = reduction.need("most_ms").number(above_zero=True)
    fitted = reduction_ms(load_kept(results / reduction.need("fit").name()), most)
    network = _network(fitted)
    checks: dict[tuple[int, int], float] = {}
    for file in reduction.need("check").items():
        checks |= reduction_ms(load_kept(results / file.name()), most)
    networks = {
        name: Network(name, one.need("microseconds").number() / 1e3, one.need("gb_per_second").number(above_zero=True),
                      one.need("source").name())
        for name in root.need("networks").fields()
        for one in [root.need("networks").need(name)]
    }  # fmt: skip
    devices = results / root.need("devices").need("file").name()
    return Parts(
        root.fields(), cost, cost_points, device, values, cells, work, scene, network,
        _points(network, fitted), _points(network, checks), networks,
        devices if devices.exists() or Path(f"{devices}.gz").exists() else None,
    )  # fmt: skip


def _cost(results: Path, about: Node) -> tuple[Cost, tuple[Point, ...], str]:
    result = load_kept(results / about.need("file").name())
    cells = [cell for cell in cells_of(result, parsed(about.need("where").name())) if cell.measured]
    if len(cells) < 2:
        raise bad_value(result.path, "render", f"{len(cells)} sizes", "two or more, for a line")
    samples = np.array([float(cell.pixels * cell.spp) for cell in cells])
    times = np.array([float(np.median([sample.wall_ms for sample in cell.samples])) for cell in cells])
    fixed, slope = _line(samples / 1e6, times)
    cost = Cost(fixed, slope)
    points = tuple(
        Point(f"{cell.resolution_text}, {cell.spp} spp", cost.ms(n), ms)
        for cell, n, ms in zip(cells, samples, times, strict=True)
    )
    return cost, points, result.about("cuda_device")


def _line(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Fits y = a + b x with a, b >= 0 by least squares of the relative error; returns a and b."""
    columns = np.stack([1 / y, x / y], axis=1)
    (a, b), *_ = np.linalg.lstsq(columns, np.ones_like(y), rcond=None)
    if a < 0:
        a, b = 0.0, float(np.sum(x / y) / np.sum((x / y) ** 2))
    return float(a), float(b)


def _noise(result: Result, least_ms: float) -> tuple[np.ndarray, int]:
    """The time of each render over its cell's median, and the number of cells; very short renders are left out."""
    found = []
    for cell in result.cells:
        times = np.array([sample.wall_ms for sample in cell.samples])
        if cell.measured and np.median(times) >= least_ms:
            found.append(times / np.median(times))
    if not found:
        raise bad_value(result.path, "noise", f"no cell of {least_ms:g} ms", "a file that has some")
    return np.sort(np.concatenate(found)), len(found)


def reduction_ms(result: Result, most_ms: float) -> dict[tuple[int, int], float]:
    """Median time of the film reduction by (ranks, pixels), for sizes shorter than a scheduler's time slice.

    On a shared host longer reductions are interrupted by other processes, so their times are not the network's.
    """
    root = read_json(result.path)
    times: dict[tuple[int, int], list[float]] = {}
    pixels = {cell.name: cell.pixels for cell in result.cells}
    for row in root.need("benchmarks").items():
        ms = row.optional_number("pt_reduce_ms")
        if ms is None:
            continue
        key = (row.need("pt_ranks").integer(1), pixels[row.need("run_name").name()])
        times.setdefault(key, []).append(ms)
    medians = {key: float(np.median(of)) for key, of in times.items()}
    found = {key: ms for key, ms in medians.items() if ms <= most_ms}
    if not found:
        raise bad_value(result.path, "$.benchmarks", f"no pt_reduce_ms up to {most_ms:g}", "a result of several ranks")
    return found


def _network(measured: Mapping[tuple[int, int], float]) -> Network:
    if {ranks for ranks, _ in measured} != {2}:
        raise InputError("reduction: found other numbers of ranks, allowed: a fit of 2 ranks, one message each")
    sizes = np.array([pixels * BYTES_PER_PIXEL for _, pixels in measured], dtype=float)
    alpha, slope = _line(sizes / 1e6, np.array(list(measured.values())))
    return Network("ranks on one host", alpha, 1 / slope)


def _points(network: Network, measured: Mapping[tuple[int, int], float]) -> tuple[Point, ...]:
    return tuple(
        Point(f"{ranks} ranks, {pixels} pixels", added_up_ms(network, ranks, pixels), ms)
        for (ranks, pixels), ms in sorted(measured.items())
    )


def read_work(path: Path) -> tuple[np.ndarray, str]:
    """Reads rays per path by block of pixels, and the scene's name; raises InputError."""
    root = read_json(path)
    root.need("schema").one_of((WORK,))
    rows = [[value.number(above_zero=True) for value in row.items()] for row in root.need("rays_per_path").items()]
    if not rows or len({len(row) for row in rows}) != 1:
        raise bad_value(path, "$.rays_per_path", "rows of several lengths", "a rectangle of numbers")
    return np.array(rows), root.need("scene").name()
