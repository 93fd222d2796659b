"""The parameter value x from which on a choice is faster, claimed only if the ratio's whole interval shows it."""

from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.stats.estimates import verdict_of_ratio
from ptbench.studies.rows import Row

Point = tuple[int, Row]


@dataclass(frozen=True)
class Crossover:
    """The first x from which on the whole interval of the ratio is below 1; None: there is no such measured x."""

    x: int | None
    is_first: bool = False  # whether x is the smallest measured value, so that the crossover may lie below it
    doubts: tuple[str, ...] = ()
    missing: tuple[int, ...] = ()  # values above the crossover x at which the line has no ratio


def crossover_of(points: Sequence[Point], xs: Sequence[int]) -> Crossover | None:
    """The crossover of a line's points, among the panel's `xs`; None where the line has no ratio at all."""
    known = sorted(((x, row) for x, row in points if row.ratio is not None), key=lambda point: point[0])
    if not known:
        return None
    beyond: list[Point] = []
    for point in reversed(known):
        high = point[1].ratio.high
        if high is None or high >= 1:
            break
        beyond.insert(0, point)
    if not beyond:
        without = known[-1][1].ratio.high is None
        return Crossover(None, doubts=("one sample has no interval",) if without else ())
    first = beyond[0][0]
    doubts = dict.fromkeys(doubt for _, row in beyond if (doubt := _doubt(row)))
    with_ratio = {x for x, _ in known}
    missing = tuple(x for x in sorted(set(xs)) if x > first and x not in with_ratio)
    return Crossover(first, is_first=first == min(xs), doubts=tuple(doubts), missing=missing)


def _doubt(row: Row) -> str:
    """Why a ratio gets no verdict although its interval would allow one: few samples, a busy machine, the clock."""
    allowed = verdict_of_ratio(row.ratio)
    if row.verdict is None or (row.verdict == allowed and not allowed.needs_samples):
        return ""
    return row.verdict.reason
