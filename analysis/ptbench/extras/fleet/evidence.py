"""Which hardware counters stand for a cell of a suite: its own variant's, or those of the nearest counted variant.

Counters describe kernels. How the host launches the kernels (the axis `launch`) does not affect them, and the rays per
sample show whether the counted render was the cell's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ptbench.errors import InputError
from ptbench.extras.fleet.gpus import Gpu
from ptbench.extras.fleet.model import KernelTime
from ptbench.io.axes import LAUNCH
from ptbench.io.cells import Cell
from ptbench.io.inspection import Inspected, inspected_of

OWN, NEAR = "own", "near"
_MEMORY_CEILING = "memory_gb_"
_SAME_RAYS = 0.01
# Plausible range of a measured copy bandwidth, relative to the data sheet's bandwidth.
_PLAUSIBLE = (0.5, 1.0)


@dataclass(frozen=True)
class Evidence:
    """Counters that stand for a cell; NEAR: from a variant with other tunables, depth or resolution."""

    kind: str
    entry: Inspected
    kernels: tuple[KernelTime, ...]


def evidence_of(cell: Cell, entries: Sequence[Inspected]) -> Evidence | None:
    """The counters of a cell's variant in its scene, or of the nearest variant; None: nothing was counted."""
    # Hardware counters are taken with kernels launched by stream, whatever choice of the axis `launch` the cell has.
    wanted = replace(cell, axes={**cell.axes, **({LAUNCH: "stream"} if LAUNCH in cell.axes else {})})
    counted = [entry for entry in entries if times_of(entry)]
    own = inspected_of(wanted, counted)
    if own is not None and _is_same_work(cell, own):
        return Evidence(OWN, own, times_of(own))
    alike = [entry for entry in counted if inspected_of(replace(wanted, tuned=entry.tuned), [entry]) is not None]
    if not alike:
        return None
    nearest = min(alike, key=lambda entry: (_unlike(cell, entry), not _is_same_work(cell, entry)))
    return Evidence(NEAR, nearest, times_of(nearest))


def times_of(entry: Inspected) -> tuple[KernelTime, ...]:
    """The kernels of a render that ran and were counted, with their times."""
    return tuple(
        KernelTime(kernel.name, kernel.milliseconds, kernel.of_ceiling)
        for kernel in (*entry.kernels, *entry.others)
        if kernel.milliseconds and kernel.of_ceiling
    )


def check_gpu(entries: Sequence[Inspected], gpu: Gpu, of: str) -> None:
    """Raises InputError for counters of another GPU: the measured memory ceiling does not fit the GPU's bandwidth."""
    for entry in entries:
        for key, value in entry.ceilings.items():
            if not key.startswith(_MEMORY_CEILING):
                continue
            low, high = (share * gpu.gb_per_second for share in _PLAUSIBLE)
            if not low <= value <= high:
                raise InputError(
                    f"{entry.file}: ceilings.{key}: found {value:.0f}, allowed: {low:.0f} to {high:.0f}, as counters "
                    f"are of the GPU of the first result file ({gpu.name}, {of})"
                )


def _is_same_work(cell: Cell, entry: Inspected) -> bool:
    if entry.rays_per_spp is None or not cell.samples:
        return False
    rays = float(np.median([sample.rays / sample.spp for sample in cell.samples]))
    return abs(entry.rays_per_spp / rays - 1) <= _SAME_RAYS


def _unlike(cell: Cell, entry: Inspected) -> int:
    """The number of differing tunables; one that only one variant names counts twice, being standard in the other."""
    names = cell.tuned.keys() | entry.tuned.keys()
    differing = [name for name in names if cell.tuned.get(name) != entry.tuned.get(name)]
    return sum(1 if name in cell.tuned and name in entry.tuned else 2 for name in differing)
