"""Loads files of `ptbench inspect --counters` for a variant's kernels, and tells what makes a ray more expensive.

A kernel's time per ray is its warp instructions per ray over their issue rate, and warp instructions are thread
instructions over active lanes. So the ratio of two kernels' times per ray is exactly the product of three ratios:
thread instructions per ray, 1 / active lanes, 1 / fraction of the issue ceiling.
"""

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.axes import known_axes
from ptbench.io.cells import Cell
from ptbench.io.counters import MEASURED
from ptbench.io.names import tuned_in
from ptbench.io.nodes import Node, read_json, shown
from ptbench.io.older import filled_in

# Choices that variants implied before their axes existed, newest axis first; names in older files end without them.
_LAST = tuple(
    axis.as_before for axis in itertools.takewhile(lambda axis: axis.as_before, reversed(known_axes().values()))
)
# Names of counters that are rates: X_per_Y, or in files up to commit ede9627 X_a_Y.
_RATE = re.compile(r"_(a|per)_(?:ray|block|multiprocessor|second)$")


@dataclass(frozen=True)
class KernelCounters:
    """Counters of one kernel of a variant; None where inspect ran without a GPU."""

    name: str
    registers: int
    spill_bytes: int
    occupancy: float
    achieved_occupancy: float | None = None
    active_lanes: float | None = None
    warp_instructions_per_ray: float | None = None
    thread_instructions_per_ray: float | None = None
    memory_bytes_per_ray: float | None = None
    of_ceiling: dict[str, float] | None = None
    bound: str = ""
    milliseconds: float | None = None  # total time of the kernel's launches in one render, under ncu
    instructions: int | None = None  # machine instructions in the kernel's code, where nvdisasm was available


@dataclass(frozen=True)
class Inspected:
    """A variant's entry in a file of `ptbench inspect`, for one scene."""

    scene: str
    variant: str
    kernels: tuple[KernelCounters, ...]
    file: Path
    choices: tuple[str, ...] = ()  # choices of the variant, in the order of the file's axes
    tuned: dict[str, str] = field(default_factory=dict)  # tunables that differ from their choice's default
    others: tuple[KernelCounters, ...] = ()  # kernels of libraries that ran in the render
    architecture: str = ""
    rays_per_spp: float | None = None  # rays of the render whose counters were read, per sample of all pixels
    ceilings: dict[str, float] = field(default_factory=dict)  # measured throughput ceilings, in the file's units


def load_inspected(path: Path) -> list[Inspected]:
    """Reads the entries of an inspection file; raises InputError."""
    root = read_json(path)
    word = _word_of_rates(root)
    return [_inspected(node, word, path) for node in root.items()]


def _inspected(node: Node, word: str, path: Path) -> Inspected:
    name, axes = node.need("variant").name(), node.maybe("axes")
    named = {} if axes is None else axes.texts()
    return Inspected(
        scene=node.need("scene").name(),
        variant=name,
        kernels=tuple(_kernel(kernel, word) for kernel in node.need("kernels").items()),
        file=path,
        # An older file has no axes, so the variant's name is split into choices.
        choices=tuple(named.values()) if named else tuple(name.partition("+")[0].split(".")),
        tuned=tuned_in(name, named),
        others=_others(node, word),
        architecture=node.optional_text("architecture"),
        rays_per_spp=_rays_per_spp(node),
        ceilings=node.optional_numbers("ceilings"),
    )


def _others(node: Node, word: str) -> tuple[KernelCounters, ...]:
    others = node.maybe("other_kernels")
    if others is None:
        return ()
    return tuple(
        KernelCounters(one.need("name").name(), 0, 0, 0.0, **_counted(one.need("counters"), word))
        for one in others.items()
    )


def _rays_per_spp(node: Node) -> float | None:
    rays, spp = node.optional_number("rays"), node.optional_number("spp")
    return rays / spp if rays and spp else None


def _word_of_rates(root: Node) -> str:
    """Whether the file spells rates with "a" or with "per"; raises InputError where both occur."""
    word = ""
    for node in _with_rates(root):
        for rate in filter(None, map(_RATE.search, node.fields())):
            word = word or rate[1]
            if rate[1] != word:
                allowed = f"X_{word}_Y, as before it in the file"
                raise bad_value(root.file, node.place, f"the key {shown(rate.string)}", allowed)
    return word or "per"


def _with_rates(root: Node) -> Iterator[Node]:
    """The JSON objects of a file that contain rates."""
    for report in root.items():
        kernels = list(report.need("kernels").items())
        yield from kernels
        counted = [kernel.maybe("counters") for kernel in kernels]
        yield from (node for node in (*counted, report.maybe("ceilings")) if node is not None)


def _kernel(node: Node, word: str) -> KernelCounters:
    code = node.maybe("instructions")
    static = {
        "name": node.need("name").name(),
        "registers": node.need("registers").integer(),
        "spill_bytes": (node.optional_integer("spill_store_bytes") or 0)
        + (node.optional_integer("spill_load_bytes") or 0),
        "occupancy": node.need("occupancy").number(),
        "instructions": None if code is None else code.need("total").integer(),
    }
    counters = node.maybe("counters")
    if counters is None or not counters.fields():
        return KernelCounters(**static)
    return KernelCounters(**static, **_counted(counters, word))


def _counted(counters: Node, word: str) -> dict:
    return {
        **{name: counters.need(name.replace("_per_", f"_{word}_")).number() for name in MEASURED},
        "of_ceiling": counters.optional_numbers("of_ceiling") or None,
        "bound": counters.optional_text("bound"),
        "milliseconds": counters.optional_number("milliseconds"),
    }


def inspected_of(cell: Cell, entries: list[Inspected]) -> Inspected | None:
    """The entry for a cell's scene and variant, even where either file is too old to name some axes."""
    # All files list axes in one order, so the choices of axes unknown to a file are left out of a variant's name.
    later, choices = filled_in(), tuple(cell.axes.values())
    without = tuple(choice for name, choice in cell.axes.items() if later.get(name) != choice)
    known = {_plain(choices), _plain(without)}
    return next(
        (e for e in entries if e.scene == cell.scene and e.tuned == cell.tuned and _plain(e.choices) in known), None
    )


def _plain(choices: tuple[str, ...]) -> tuple[str, ...]:
    """A variant's choices without trailing ones that were implied before their axes existed."""
    for before_it in _LAST:
        if choices[-1:] == (before_it,):
            choices = choices[:-1]
    return choices


@dataclass(frozen=True)
class PriceOfARay:
    """The factors of the time per ray of kernel B over A; their product is `time`."""

    instructions: float
    lanes: float  # 1 / active lanes per warp: kernel B's over kernel A's
    issue: float  # 1 / fraction reached of the issue ceiling: kernel B's over kernel A's

    @property
    def time(self) -> float:
        """The time per ray of B over A."""
        return self.instructions * self.lanes * self.issue


def price_of_a_ray(a: Inspected, b: Inspected) -> PriceOfARay | None:
    """The factors that make a ray more expensive in B than in A; None unless each has one kernel with counters."""
    if len(a.kernels) != 1 or len(b.kernels) != 1:
        return None
    one, other = a.kernels[0], b.kernels[0]
    values = [
        value
        for kernel in (one, other)
        for value in (
            kernel.thread_instructions_per_ray,
            kernel.warp_instructions_per_ray,
            (kernel.of_ceiling or {}).get("issue"),
        )
    ]
    if not all(values):
        return None
    threads_a, warps_a, issue_a, threads_b, warps_b, issue_b = values
    # Active lanes are thread over warp instructions, so that the product of the factors is exactly the time's ratio.
    return PriceOfARay(threads_b / threads_a, (warps_b / threads_b) / (warps_a / threads_a), issue_a / issue_b)
