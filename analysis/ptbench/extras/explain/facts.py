"""What else differs between two cells, and how much of their time difference each such fact may explain.

Everything is computed from the result file's rows; what a row lacks is left out, or said to be unknown.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.extras.explain.accounting import Accounting
from ptbench.io.axes import INTEGRATOR, LAUNCH
from ptbench.io.cells import Cell, Result
from ptbench.numbers import figures
from ptbench.numbers import ratio as ratio_text
from ptbench.stats.estimates import CLOCK_UNKNOWN

MILLION_RAYS, NS_A_RAY = "million rays a spp", "ns a ray"
# Relative difference below which two clocks or two counts are considered equal.
_SAME = 0.001
_CLOCK_MATTERS = 0.005
_ALL_ALIVE = ("wavefront_materials", "wavefront_refill")  # integrators whose queue holds live paths only


@dataclass(frozen=True)
class Fact:
    """One quantity of both cells; `says` is its meaning for the time difference, if any."""

    quantity: str
    a: float | None
    b: float | None
    says: str = ""

    @property
    def ratio(self) -> str:
        """The value of B over that of A, as text; empty where a ratio means nothing."""
        return ratio_text(self.b / self.a) if self.a and self.b is not None else ""


def signed(ms: float, digits: int = 3) -> str:
    """Milliseconds as text with a sign."""
    return ("+" if ms > 0 else "") + figures(ms, digits)


def percent(part: float, whole: float) -> str:
    """A share of the time difference in per cent, as text; "no part" where there is no difference."""
    return f"{round(100 * part / whole)} %" if whole else "no part"


def facts_of(result: Result, accounting: Accounting, *, has_difference: bool = True) -> list[Fact]:
    """All facts on two cells that the file has, in the order: work, host, machine, kernels, bytes.

    Without a verdict of FASTER or SLOWER there is no difference that a fact could explain a share of.
    """
    a, b = accounting.a.cell, accounting.b.cell
    return [
        *_rays(accounting),
        *_upkeep(accounting, has_difference),
        *_slots(a, b),
        *_launches(result, accounting, has_difference),
        *_host(accounting, has_difference),
        *_clock(a, b),
        *_threads(result, a, b),
        *_kernels(a, b),
        *_bytes(result, accounting),
    ]


def _median(cell: Cell, value: Callable) -> float | None:
    """The median of a value over a cell's samples; None where any sample lacks it."""
    values = [value(sample) for sample in cell.samples]
    return None if not values or None in values else float(np.median(values))


def rays_per_spp(cell: Cell) -> float:
    """Rays per sample per pixel, the median over the cell's samples."""
    return _median(cell, lambda sample: sample.rays / sample.spp)


def _rays(accounting: Accounting) -> Iterator[Fact]:
    a, b = accounting.a, accounting.b
    rays_a, rays_b = rays_per_spp(a.cell), rays_per_spp(b.cell)
    if not rays_a or not rays_b:
        return
    each_a, each_b = a.total.value / rays_a, b.total.value / rays_b
    # The time difference is exactly B's additional rays at A's time per ray plus all of B's rays at the change per ray.
    more, dearer = (rays_b - rays_a) * each_a, rays_b * (each_b - each_a)
    yield Fact(MILLION_RAYS, rays_a / 1e6, rays_b / 1e6, f"{signed(more)} ms at A's time a ray")
    yield Fact(NS_A_RAY, each_a * 1e6, each_b * 1e6, f"{signed(dearer)} ms over B's rays")


def _upkeep(accounting: Accounting, has_difference: bool) -> Iterator[Fact]:
    """The cost of maintaining a queue or cache, against the time that it saves elsewhere."""
    upkeep = [step for step in accounting.stages if not step.is_tracing]
    if not upkeep:
        return
    tracing = [step for step in accounting.stages if step.is_tracing]
    cost, rest = sum(s.difference for s in upkeep), sum(s.difference for s in tracing)
    says = ""
    if not has_difference:
        says = f"{signed(cost)} ms here, {signed(rest)} ms in tracing and shading"
    elif cost > 0 > rest:
        says = f"tracing and shading give back {percent(-rest, cost)} of what it costs more"
    elif cost < 0 < rest:
        says = f"tracing and shading take back {percent(rest, -cost)} of what it saves"
    elif cost and rest:
        says = "tracing and shading change the same way: one does not pay for the other"
    names = " + ".join(step.name for step in upkeep)
    yield Fact(f"{names}, instrumented ms", sum(s.a or 0 for s in upkeep), sum(s.b or 0 for s in upkeep), says)
    yield Fact("tracing and shading, instrumented ms", sum(s.a or 0 for s in tracing), sum(s.b or 0 for s in tracing))


def _slots(a: Cell, b: Cell) -> Iterator[Fact]:
    """How full a queue is that no compaction shortens."""

    def live_share(cell: Cell) -> float | None:
        share = None if cell.instrumented is None else cell.instrumented.live_share(cell.depth)
        if share is None or cell.axes.get(INTEGRATOR, "").find("wavefront") < 0:
            return None
        is_all_alive = cell.axes[INTEGRATOR] in _ALL_ALIVE
        if is_all_alive and cell.tunables.get("refill_every", 1) > 1:
            return None  # slots that wait empty for a refill are not counted, so the queue's live share is unknown
        is_full = cell.counters.get("compactions") or is_all_alive
        return 1.0 if is_full else share

    shares = live_share(a), live_share(b)
    if shares == (1.0, 1.0) or None in shares:
        return
    yield Fact(
        "live share of the queue, mean over bounces",
        *shares,
        "a queue that is neither compacted nor refilled has the slots of ended paths passed over in each bounce",
    )


def _launches(result: Result, accounting: Accounting, has_difference: bool) -> Iterator[Fact]:
    a, b = accounting.a.cell, accounting.b.cell
    counts = a.work_per_spp("launches"), b.work_per_spp("launches")
    if None not in counts and any(counts):
        more = counts[1] - counts[0]
        says = ""
        least = _least_time_of_a_launch(result)
        if more and least is not None:
            ms, cell = least
            which = f"{cell.axes.get(INTEGRATOR, cell.variant)} in {cell.scene}, {cell.resolution_text}"
            says = (
                f"at most {figures(abs(more) * ms, 3)} ms {'more' if more > 0 else 'less'}, at the least time that a "
                f"launch took in any cell of the file, its kernel's work included ({figures(1e3 * ms, 3)} us: {which}, "
                f"depth {cell.depth}); but a library's call, which may launch several kernels, counts as one"
            )
        yield Fact("launches a spp", *counts, says)
    waits = a.work_per_spp("host_waits"), b.work_per_spp("host_waits")
    if None not in waits and any(waits):
        more = waits[1] - waits[0]
        says = ""
        if more and has_difference:
            each = 1e3 * accounting.difference / more
            says = f"the whole difference would be {figures(each, 3)} us a wait; its share is not measured apart"
        yield Fact("host waits a spp", *waits, says)
    nodes = a.work_per_spp("graph_nodes"), b.work_per_spp("graph_nodes")
    if None not in nodes and any(nodes):
        yield Fact("graph nodes a spp", *nodes, "stages are timed without the graph: events cannot be captured")


def _least_time_of_a_launch(result: Result) -> tuple[float, Cell] | None:
    """An upper bound on the cost of a launch, in ms: the least time per launch of the file's cells, with its cell."""
    found = []
    for cell in result.cells:
        launches = cell.work_per_spp("launches") if cell.measured else None
        if launches and not cell.work_per_spp("graph_nodes") and cell.axes.get(LAUNCH, "stream") == "stream":
            found.append((float(np.median(cell.ms_per_spp)) / launches, cell))
    return min(found, key=lambda pair: pair[0], default=None)


def _host(accounting: Accounting, has_difference: bool) -> Iterator[Fact]:
    a, b = accounting.a.cell, accounting.b.cell
    if not (a.on_gpu and b.on_gpu):
        return
    times = [
        _median(
            cell,
            lambda sample: None if sample.device_ms is None else (sample.wall_ms - sample.device_ms) / sample.spp,
        )
        for cell in (a, b)
    ]
    if None not in times:
        more = times[1] - times[0]
        share = f"{percent(more, accounting.difference)} of the difference; " if has_difference else ""
        says = f"{share}waits within the render are device time"
        yield Fact("wall less device time, ms a spp", *times, says)


def _clock(a: Cell, b: Cell) -> Iterator[Fact]:
    def clock(sample) -> float | None:
        ends = sample.clock_mhz_before, sample.clock_mhz_after
        return None if not all(ends) else sum(ends) / 2

    clocks = _median(a, clock), _median(b, clock)
    if None not in clocks:
        apart = abs(clocks[1] / clocks[0] - 1)
        says = "compare cycles" if apart > _CLOCK_MATTERS else f"the same within {100 * _CLOCK_MATTERS:g} %"
        yield Fact("clock round the samples, MHz", *clocks, says)
    else:
        yield Fact("clock round the samples, MHz", *clocks, CLOCK_UNKNOWN)


def _threads(result: Result, a: Cell, b: Cell) -> Iterator[Fact]:
    if a.on_gpu or b.on_gpu:
        return
    busy = [
        _median(cell, lambda sample: None if sample.cpu_ms is None else sample.cpu_ms / sample.wall_ms)
        for cell in (a, b)
    ]
    if None not in busy:
        yield Fact("threads busy, CPU time over wall time", *busy, f"of {result.about('threads')}")


def _kernels(a: Cell, b: Cell) -> Iterator[Fact]:
    """Registers and local memory of the kernels, where they differ or only one variant has the kernel."""
    kernels = [cell.cuda.kernels if cell.cuda is not None else {} for cell in (a, b)]
    for name in dict.fromkeys([*kernels[0], *kernels[1]]):
        of = [kernels[0].get(name), kernels[1].get(name)]
        if of[0] == of[1]:
            continue
        registers = [None if kernel is None else kernel.registers for kernel in of]
        yield Fact(f"registers a thread, {name}", *registers)
        local = [None if kernel is None else kernel.local_bytes for kernel in of]
        if any(local):
            yield Fact(f"local memory a thread, bytes, {name}", *local, "arrays and spills: traffic beside the paths'")


def _bytes(result: Result, accounting: Accounting) -> Iterator[Fact]:
    """Memory traffic of path states as a yardstick: each live path's state is read and written once per bounce."""
    accounts = accounting.a, accounting.b
    states = [account.cell.cuda.path_state_bytes if account.cell.cuda is not None else None for account in accounts]
    done = [account.cell.instrumented for account in accounts]
    if None in states or None in done or not any(states) or not all(d.live_paths for d in done):
        return
    yield Fact("bytes of a path's state", *map(float, states))
    megabytes = [2 * state * sum(d.live_paths) / d.spp / 1e6 for state, d in zip(states, done, strict=True)]
    rate = rated_bandwidth(result)
    says = "were each live path's state read and written once a bounce"
    if rate is not None:
        ms = [1e6 * mb / rate * 1e3 for mb in megabytes]
        says += (
            f": {figures(ms[0], 3)} and {figures(ms[1], 3)} ms at the memory's rated {rate / 1e9:.0f} GB/s, "
            f"{percent(ms[0], accounts[0].total.value)} and {percent(ms[1], accounts[1].total.value)} of the times, "
            f"{signed(ms[1] - ms[0])} ms between them"
        )
    yield Fact("MB of path states a spp", *megabytes, says)
    l2 = result.context.get("ptbench.cuda_l2_bytes", "")
    if l2.isdecimal() and int(l2):
        queues = [
            state * account.cell.pixels * account.cell.tunables.get("spp_in_flight", 1) / 1e6
            for state, account in zip(states, accounts, strict=True)
        ]
        says = f"L2 holds {int(l2) / 1e6:.0f} MB: what fits need not go to memory"
        yield Fact("MB of states in the queue", *queues, says)


def rated_bandwidth(result: Result) -> float | None:
    """Memory bandwidth in bytes/s: two transfers per clock over the bus width; None where the file lacks them."""
    clock, bus = (result.context.get(f"ptbench.cuda_memory_{name}", "") for name in ("clock_mhz", "bus_bits"))
    if not clock.isdecimal() or not bus.isdecimal() or not int(clock) or not int(bus):
        return None
    return 2 * int(clock) * 1e6 * int(bus) / 8


def same_work(facts: Sequence[Fact]) -> bool:
    """Whether both variants trace the same rays."""
    rays = next((fact for fact in facts if fact.quantity == MILLION_RAYS), None)
    return rays is not None and abs(rays.b / rays.a - 1) <= _SAME
