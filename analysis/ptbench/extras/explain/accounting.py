"""Divides the difference between two cells' times into terms that add up to it exactly.

A cell's time is the median of its timed samples. Its stages are timed in the instrumented pass, another render with
CUDA events and counters. So the account of a cell has, in milliseconds per sample per pixel,

    median of the timed samples = sum over stages + instrumented pass outside its stages + (timed - instrumented pass),

which holds whatever the difference of the two passes, and the differences of two accounts add up to the difference of
the medians. The last two terms belong to no stage. If the instrumentation affects all stages alike, a stage changed
between none and all of (timed - instrumented) from one pass to the other: that is its range, for any timed median in
its 95 % interval. The instrumented pass is a single render, whose noise is unknown.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ptbench.io.cells import Cell
from ptbench.io.limits import limit
from ptbench.stats.estimates import Estimate, median_estimate

ADD_UP_WITHIN = limit("stages_add_up_within")  # relative tolerance for stage times to add up to the wall time
# Stages that trace and shade, in whatever way an integrator divides the work; other stages maintain a queue or cache.
TRACING = ("generate", "intersect", "shade", "first bounce", "bounce", "trace", "walk")
WHOLE = "trace and shade"  # name of all tracing and shading stages together
OUTSIDE = "outside the stages"
PASSES = "timed less instrumented"


def stage_order(names: Iterable[str]) -> list[str]:
    """The distinct stage names: tracing first, in the order in which a path meets them, then the others by name."""
    known = (*TRACING, WHOLE)
    return sorted(dict.fromkeys(names), key=lambda name: (known.index(name) if name in known else len(known), name))


@dataclass(frozen=True)
class Account:
    """The time of one cell in ms per sample per pixel; `total` is the sum of all other terms."""

    cell: Cell
    total: Estimate
    stages: dict[str, float]
    outside: float = 0.0  # time of the instrumented pass outside its stages: gaps between launches, waiting on the host
    passes: float = 0.0  # timed median less the instrumented pass, in ms: negative where instrumentation costs time
    divided: bool = True  # whether the file has stage times; False: a single stage stands for the timed median

    @property
    def instrumented(self) -> float | None:
        """The wall time of the instrumented pass, ms per sample per pixel; None where the file has none."""
        done = self.cell.instrumented
        return None if done is None or done.wall_ms is None else done.wall_ms / done.spp

    @property
    def _timed(self) -> tuple[float, float]:
        """The interval of the timed median; with one sample both ends are its value."""
        value = self.total.value
        return (value if self.total.low is None else self.total.low), (
            value if self.total.high is None else self.total.high
        )

    @property
    def adds_up(self) -> bool:
        """Whether the stage times add up to the timed median within 5 %, so that they may be read as timed stages."""
        return abs(self.total.value - sum(self.stages.values())) <= ADD_UP_WITHIN * self.total.value

    def range_of(self, names: Sequence[str]) -> tuple[float, float]:
        """The range of time that the stages `names` together may have taken in the timed samples."""
        staged = sum(self.stages.get(name, 0.0) for name in names)
        if not any(name in self.stages for name in names):
            return 0.0, 0.0
        low, high = self._timed
        if not self.divided:
            return low, high
        less, more = low - self.instrumented, high - self.instrumented
        return max(0.0, staged + min(less, 0.0)), staged + max(more, 0.0)


def account_of(cell: Cell) -> Account:
    """The account of a measured cell."""
    total = median_estimate(cell.ms_per_spp)
    done = cell.instrumented
    if done is None or done.wall_ms is None or len(done.stage_ms) < 2:
        name = next(iter(done.stage_ms), WHOLE) if done is not None else WHOLE
        return Account(cell, total, {name: total.value}, divided=False)
    stages = {name: done.stage_ms[name] / done.spp for name in stage_order(done.stage_ms)}
    wall = done.wall_ms / done.spp
    return Account(cell, total, stages, wall - sum(stages.values()), total.value - wall)


@dataclass(frozen=True)
class Step:
    """One term of the difference of two cells; `low` and `high` are a stage's range, None outside the stages."""

    name: str
    a: float | None  # time of cell A in the stages that this step covers; None: A has no such stage
    b: float | None
    low: float | None = None
    high: float | None = None

    @property
    def difference(self) -> float:
        """Milliseconds per sample per pixel by which B takes longer in this step."""
        return (self.b or 0.0) - (self.a or 0.0)

    @property
    def is_stage(self) -> bool:
        """Whether the step is a stage of the render, not one of the remaining terms."""
        return self.low is not None

    @property
    def is_settled(self) -> bool:
        """Whether the step's difference has the same sign in all of its range."""
        return self.is_stage and (self.low > 0 or self.high < 0)

    @property
    def is_tracing(self) -> bool:
        """Whether rays are traced in this step."""
        return self.name == WHOLE or self.name in TRACING


@dataclass(frozen=True)
class Accounting:
    """The accounts of two cells side by side; the differences of the steps add up to `difference`."""

    a: Account
    b: Account
    steps: tuple[Step, ...]
    merged: bool  # whether A and B divide tracing and shading into different stages, so that one step covers all these

    @property
    def difference(self) -> float:
        """Milliseconds per sample per pixel between the timed medians of B and A."""
        return self.b.total.value - self.a.total.value

    @property
    def stages(self) -> tuple[Step, ...]:
        """The steps that are stages of the render."""
        return tuple(step for step in self.steps if step.is_stage)


def accounting_of(a: Cell, b: Cell) -> Accounting:
    """Divides the time difference of two measured cells into terms that add up to it."""
    one, other = account_of(a), account_of(b)
    names = stage_order([*one.stages, *other.stages])
    tracing = [name for name in names if name in (*TRACING, WHOLE)]
    others = [name for name in names if name not in tracing]
    merged = any((name in one.stages) != (name in other.stages) for name in tracing)
    groups = [(WHOLE, tracing)] if merged else [(name, [name]) for name in tracing]
    steps = [_stage(label, members, one, other) for label, members in [*groups, *((n, [n]) for n in others)]]
    if one.divided or other.divided:
        steps.append(Step(OUTSIDE, one.outside if one.divided else None, other.outside if other.divided else None))
        steps.append(Step(PASSES, one.passes if one.divided else None, other.passes if other.divided else None))
    return Accounting(one, other, tuple(steps), merged)


def _stage(label: str, members: Sequence[str], a: Account, b: Account) -> Step:
    (a_low, a_high), (b_low, b_high) = a.range_of(members), b.range_of(members)

    def value(account: Account) -> float | None:
        there = [account.stages[name] for name in members if name in account.stages]
        return sum(there) if there else None

    return Step(label, value(a), value(b), b_low - a_high, b_high - a_low)
