"""Where the difference between two cells' times lies: an account in which nothing is left over.

A cell's time is the median of its timed samples. Its stages are timed in the instrumented pass, another render with
events and counters in it. So the account of a cell has, in milliseconds a sample per pixel,

    median of the timed samples = sum over stages + instrumented pass outside its stages + (timed - instrumented pass),

which holds whatever the passes differ by, and the differences of two accounts add up to the difference of the medians.
The last two terms are in no stage. A stage took between none and all of (timed - instrumented) less or more in the
timed samples than in the instrumented pass, if the pass disturbs all its stages the same way: that is its range, for
any timed median in its 95 % interval. The instrumented pass is one render, whose own noise no file tells.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ptbench.io.cells import Cell
from ptbench.io.limits import limit
from ptbench.stats.estimates import Estimate, median_estimate

ADD_UP_WITHIN = limit("stages_add_up_within")  # of the wall time, as the harness asks of an instrumented pass
# What traces and shades, however an integrator divides it; every other stage keeps the queue or a cache.
TRACING = ("generate", "intersect", "shade", "first bounce", "bounce", "trace", "walk")
WHOLE = "trace and shade"  # their name together
OUTSIDE = "outside the stages"
PASSES = "timed less instrumented"


def stage_order(names: Iterable[str]) -> list[str]:
    """Each name once: tracing first, in the order in which a path meets it, then the others by name."""
    known = (*TRACING, WHOLE)
    return sorted(dict.fromkeys(names), key=lambda name: (known.index(name) if name in known else len(known), name))


@dataclass(frozen=True)
class Account:
    """One cell's time, in ms a sample per pixel; `total` is the sum of everything else."""

    cell: Cell
    total: Estimate
    stages: dict[str, float]
    outside: float = 0.0  # of the instrumented pass: gaps between launches, waits of the host
    passes: float = 0.0  # timed less instrumented: below zero where counting and timing cost something
    divided: bool = True  # False: the file does not divide the time, so that the one stage is all of the timed median

    @property
    def instrumented(self) -> float | None:
        """The instrumented pass's wall time, ms a sample per pixel; None where the file has none."""
        done = self.cell.instrumented
        return None if done is None or done.wall_ms is None else done.wall_ms / done.spp

    @property
    def _timed(self) -> tuple[float, float]:
        """The ends of the interval of the timed median; one sample has none."""
        value = self.total.value
        return (value if self.total.low is None else self.total.low), (
            value if self.total.high is None else self.total.high
        )

    @property
    def adds_up(self) -> bool:
        """Whether the stages are the timed median within 5 %, so that they may be read as the timed ones."""
        return abs(self.total.value - sum(self.stages.values())) <= ADD_UP_WITHIN * self.total.value

    def range_of(self, names: Sequence[str]) -> tuple[float, float]:
        """Between which the stages `names` together may lie in the timed samples."""
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
    """One term of the difference; `low` and `high` are its range in the timed samples, None for what is in no stage."""

    name: str
    a: float | None  # None: it has no such stage
    b: float | None
    low: float | None = None
    high: float | None = None

    @property
    def difference(self) -> float:
        """Milliseconds a spp that B takes longer here."""
        return (self.b or 0.0) - (self.a or 0.0)

    @property
    def is_stage(self) -> bool:
        """Whether it is a stage, and no rest."""
        return self.low is not None

    @property
    def is_settled(self) -> bool:
        """Whether the term has one sign in all of its range."""
        return self.is_stage and (self.low > 0 or self.high < 0)

    @property
    def is_tracing(self) -> bool:
        """Whether rays are traced in it."""
        return self.name == WHOLE or self.name in TRACING


@dataclass(frozen=True)
class Accounting:
    """Two accounts side by side; the steps' differences add up to `difference`."""

    a: Account
    b: Account
    steps: tuple[Step, ...]
    merged: bool  # the two divide tracing and shading into other stages, so that these are one step

    @property
    def difference(self) -> float:
        """Milliseconds a spp between the timed medians."""
        return self.b.total.value - self.a.total.value

    @property
    def stages(self) -> tuple[Step, ...]:
        """The steps that are stages."""
        return tuple(step for step in self.steps if step.is_stage)


def accounting_of(a: Cell, b: Cell) -> Accounting:
    """The difference of two measured cells, in terms that add up to it."""
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
