"""Where the next cells of a map are to be measured: between neighbours of different verdict, until the line is known.

A coarse grid first; then, along each of its rows and columns, the geometric middle between two neighbours whose
verdicts differ, the widest bracket first, until all are as narrow as the map asks (bisection in logarithms).
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
    """One axis of a map, from its lowest to its highest value in equal steps of the logarithm."""

    name: str
    low: float
    high: float
    cells: int  # of the coarse grid
    is_integer: bool = False

    @property
    def grid(self) -> list[float]:
        """The coarse grid's values, each once."""
        step = math.log(self.high / self.low) / (self.cells - 1)
        return list(dict.fromkeys(self.rounded(self.low * math.exp(step * index)) for index in range(self.cells)))

    def rounded(self, value: float) -> float:
        """As the axis has it: an integer, or four digits."""
        inside = min(max(value, self.low), self.high)
        return float(round(inside)) if self.is_integer else float(f"{inside:.4g}")

    def middle(self, low: float, high: float) -> float | None:
        """Between two values; None where the axis has none there."""
        value = self.rounded(math.sqrt(low * high))
        return value if low < value < high else None


@dataclass(frozen=True)
class Bracket:
    """Two neighbours on a row or a column of the grid whose verdicts differ."""

    along: int  # 0: along x, 1: along y
    at: float  # the other axis's value
    low: float
    high: float
    is_firm: bool  # the two are on different sides of 1; else one of them is open

    @property
    def width(self) -> float:
        """A ratio of its ends."""
        return self.high / self.low


def verdict_of(estimate: Estimate | None) -> str | None:
    """On which side of 1 the whole interval lies; None where there is no number."""
    if estimate is None:
        return None
    if estimate.low is None or estimate.high is None:
        return OPEN
    return BELOW if estimate.high < 1 else ABOVE if estimate.low > 1 else OPEN


def lines_of(
    axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]
) -> Iterator[tuple[int, float, list[Place]]]:
    """Every row and column of the grid: which axis it is along, where it is, and its measured cells in order."""
    for along in (0, 1):
        for at in axes[1 - along].grid:
            yield along, at, sorted(place for place in known if place[1 - along] == at)


def brackets_of(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]) -> list[Bracket]:
    """All between which the line may be, as narrow as they are known."""
    found = []
    for along, at, places in lines_of(axes, known):
        judged = [(place[along], verdict) for place in places if (verdict := verdict_of(known[place])) is not None]
        for (low, one), (high, other) in pairwise(judged):
            if one != other:
                found.append(Bracket(along, at, low, high, OPEN not in (one, other)))
    return found


def spans_of(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None]) -> list[Bracket]:
    """Where the line is, a row or a column each: from the last firm cell on one side to the first on the other."""
    found = []
    for along, at, places in lines_of(axes, known):
        firm = [(place[along], verdict) for place in places if (verdict := verdict_of(known[place])) in (BELOW, ABOVE)]
        for (low, one), (high, other) in pairwise(firm):
            if one != other:
                between = [place for place in places if low < place[along] < high and known[place] is not None]
                found.append(Bracket(along, at, low, high, not between))
    return found


def next_cells(axes: tuple[Axis, Axis], known: Mapping[Place, Estimate | None], bracket: float) -> list[Place]:
    """What to measure next, the most telling first; none: every bracket is as narrow as `bracket`, or cannot be."""
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
    """Corners first, so that a run that is cut short has been everywhere."""
    return sum(place[index] in (axes[index].grid[0], axes[index].grid[-1]) for index in (0, 1))
