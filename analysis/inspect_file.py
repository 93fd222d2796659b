"""Loads what `ptbench inspect --counters` measured of a variant's kernels, and what in it makes a ray dearer.

A kernel's time a ray is its warp instructions a ray over the rate at which they are issued, and its warp instructions
are thread instructions over active lanes. So the ratio of two kernels' times a ray is exactly the product of three:
thread instructions a ray, 1 / active lanes, 1 / issued of the ceiling.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from analysis.nodes import Node, read_json
from analysis.results import LATER_AXES, Cell

_ROBUST = ".robust"  # the last axis, which older files lack


@dataclass(frozen=True)
class KernelCounters:
    """One kernel of one variant; counters are None where inspect ran without a GPU."""

    name: str
    registers: int
    spill_bytes: int
    occupancy: float
    achieved_occupancy: float | None = None
    active_lanes: float | None = None
    warp_instructions_a_ray: float | None = None
    thread_instructions_a_ray: float | None = None
    memory_bytes_a_ray: float | None = None
    of_ceiling: dict[str, float] | None = None
    bound: str = ""


@dataclass(frozen=True)
class Inspected:
    scene: str
    variant: str
    kernels: tuple[KernelCounters, ...]
    file: Path


def load_inspected(path: Path) -> list[Inspected]:
    """The file's entries; raises InputError."""
    return [
        Inspected(
            scene=node.need("scene").name(),
            variant=node.need("variant").name(),
            kernels=tuple(_kernel(kernel) for kernel in node.need("kernels").items()),
            file=path,
        )
        for node in read_json(path).items()
    ]


def _kernel(node: Node) -> KernelCounters:
    static = {
        "name": node.need("name").name(),
        "registers": node.need("registers").integer(),
        "spill_bytes": (node.optional_integer("spill_store_bytes") or 0)
        + (node.optional_integer("spill_load_bytes") or 0),
        "occupancy": node.need("occupancy").number(),
    }
    counters = node.maybe("counters")
    if counters is None or not counters.fields():
        return KernelCounters(**static)
    ceiling = counters.maybe("of_ceiling")
    numbers = ("achieved_occupancy", "active_lanes", "warp_instructions_a_ray", "thread_instructions_a_ray")
    return KernelCounters(
        **static,
        **{name: counters.optional_number(name) for name in (*numbers, "memory_bytes_a_ray")},
        of_ceiling=None if ceiling is None else {key: ceiling.need(key).number() for key in ceiling.fields()},
        bound=counters.optional_text("bound"),
    )


def inspected_of(cell: Cell, entries: list[Inspected]) -> Inspected | None:
    """The entry of the cell's scene and variant, whichever axes the two files are too old to name."""
    names = {_plain(cell.variant), _plain(".".join(cell.axes.values()) + _tunables(cell.variant))}
    # The axes that a file lacks stand after the same one in every name.
    without = [choice for name, choice in cell.axes.items() if LATER_AXES.get(name) != choice]
    names.add(_plain(".".join(without) + _tunables(cell.variant)))
    return next((e for e in entries if e.scene == cell.scene and _plain(e.variant) in names), None)


def _tunables(variant: str) -> str:
    _, plus, tuned = variant.partition("+")
    return plus + tuned


def _plain(variant: str) -> str:
    name, plus, tuned = variant.partition("+")
    return name.removesuffix(_ROBUST) + plus + tuned


@dataclass(frozen=True)
class PriceOfARay:
    """Ratios, B over A; their product is `time`."""

    instructions: float
    lanes: float  # of 1 / active lanes
    issue: float  # of 1 / the share of the issue ceiling

    @property
    def time(self) -> float:
        return self.instructions * self.lanes * self.issue


def price_of_a_ray(a: Inspected, b: Inspected) -> PriceOfARay | None:
    """Why a ray costs more in B; None unless each is one kernel with counters."""
    if len(a.kernels) != 1 or len(b.kernels) != 1:
        return None
    one, other = a.kernels[0], b.kernels[0]
    values = [
        value
        for kernel in (one, other)
        for value in (
            kernel.thread_instructions_a_ray,
            kernel.warp_instructions_a_ray,
            (kernel.of_ceiling or {}).get("issue"),
        )
    ]
    if not all(values):
        return None
    threads_a, warps_a, issue_a, threads_b, warps_b, issue_b = values
    # Lanes from the two instruction counts, so that the product is exact.
    return PriceOfARay(threads_b / threads_a, (warps_b / threads_b) / (warps_a / threads_a), issue_a / issue_b)
