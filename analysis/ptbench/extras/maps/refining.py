"""Chooses which cells of a map to measure next: between neighbours whose verdicts differ, to find the break-even line.

A coarse grid comes first. Then each row and column is bisected at the geometric middle of two neighbours whose verdicts
differ, the widest bracket first, until all are as narrow as the map asks.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from ptbench.stats.estimates import Estimate

BELOW, OPEN, ABOVE = "below 1", "open", "above 1"
Place = tuple[float, float]


@dataclass(frozen=True)
class Axis:
    """One axis of a map, with logarithmically spaced values."""

    name: str
    low: float
    high: float
    cells: int  # number of points along the axis in the map's initial coarse grid
    is_integer: bool = False

    @property
    def grid(self) -> list[float]:
        """The distinct values of the coarse grid."""
        step = math.log(self.high / self.low) / (self.cells - 1)
        return list(dict.fromkeys(self.rounded(self.low * math.exp(step * index)) for index in range(self.cells)))

    def rounded(self, value: float) -> float:
        """A value rounded as the axis has it: to an integer or to four digits."""
        inside = min(max(value, self.low), self.high)
        return float(round(inside)) if self.is_integer else float(f"{inside:.4g}")

    def middle(self, low: float, high: float) -> float | None:
        """The geometric middle of two values; None where rounding leaves none between them."""
        value = self.rounded(math.sqrt(low * high))
        return value if low < value < high else None


@dataclass(frozen=True)
class Bracket:
    """Two neighbouring cells in a row or column of the map whose verdicts differ."""

    along: int  # map axis along which the bracket's two cells are neighbours; 0: x, 1: y
    at: float  # coordinate of both cells of the bracket on the other axis of the map
    low: float
    high: float
    is_firm: bool  # whether the bracket's ends are decidedly on different sides of ratio 1; False: one is undecided

    @property
    def width(self) -> float:
        """The ratio of the bracket's upper to its lower end."""
        return self.high / self.low


def verdict_of(estimate: Estimate | None) -> str | None:
    """On which side of 1 the whole interval of a ratio lies; None where there is no ratio."""
    if estimate is None:
        return None
    if estimate.low is None or estimate.high is None:
        return OPEN
    return BELOW if estimate.high < 1 else ABOVE if estimate.low > 1 else OPEN


def lines_of(
    axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]
) -> Iterator[tuple[int, float, list[Place]]]:
    """Every row and column of a map: its axis, its position, and its measured cells in order."""
    for along in (0, 1):
        for at in axes[1 - along].grid:
            yield along, at, sorted(place for place in known if place[1 - along] == at)


def brackets_of(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]) -> list[Bracket]:
    """All brackets that may contain the break-even line, as narrow as measured."""
    found = []
    for along, at, places in lines_of(axes, known):
        judged = [(place[along], verdict) for place in places if (verdict := verdict_of(known[place])) is not None]
        for (low, one), (high, other) in pairwise(judged):
            if one != other:
                found.append(Bracket(along, at, low, high, OPEN not in (one, other)))
    return found


def spans_of(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]) -> list[Bracket]:
    """Where the break-even line crosses each row and column: from the last decided cell on one side to the next one."""
    found = []
    for along, at, places in lines_of(axes, known):
        firm = [(place[along], verdict) for place in places if (verdict := verdict_of(known[place])) in (BELOW, ABOVE)]
        for (low, one), (high, other) in pairwise(firm):
            if one != other:
                between = [place for place in places if low < place[along] < high and known[place] is not None]
                found.append(Bracket(along, at, low, high, not between))
    return found


def next_cells(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None], bracket: float) -> list[Place]:
    """The cells to measure next, most informative first; empty: no bracket is wider than `bracket` or divisible."""
    grid = [(x, y) for x in axes[0].grid for y in axes[1].grid]
    if missing := [place for place in grid if place not in known]:
        return sorted(missing, key=lambda place: _coarseness(axes, place), reverse=True)
    wide = [one for one in brackets_of(axes, known) if one.width > bracket]
    wide.sort(key=lambda one: (not one.is_firm, -math.log(one.width)))
    found = []
    for one in wide:
        middle = axes[one.along].middle(one.low, one.high)
        place = None if middle is None else (middle, one.at) if one.along == 0 else (one.at, middle)
        if place is not None and place not in known and place not in found:
            found.append(place)
    return found


def _coarseness(axes: tuple[Axis, Axis], place: Place) -> int:
    """Sort key that puts corners of the grid first, so that an interrupted measurement has covered the whole range."""
    return sum(place[index] in (axes[index].grid[0], axes[index].grid[-1]) for index in (0, 1))
