"""How the cells of a figure stand together: groups, labels and their order."""

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass

from ptbench.io.cells import Cell
from ptbench.studies.questions import Question, dimension, label_of, varying_dimensions
from ptbench.studies.rows import Row

# More rows of one scene and depth, or lines of one panel, are split into groups.
MOST_TOGETHER = 8


@dataclass(frozen=True)
class Parts:
    """How a figure's cells stand together: in groups that differ in `split`, each cell under its label."""

    split: tuple[str, ...]
    labels: dict[str, str]  # by cell name
    order: tuple[str, ...]  # of the labels: baselines first, then as the file has them, so one colour a choice

    def values(self, cell: Cell) -> tuple[str | None, ...]:
        """What the cell has of each dimension that the groups differ in."""
        return tuple(dimension(cell, name) for name in self.split)

    def suffix(self, values: Sequence[str | None]) -> str:
        """What tells a group's title from the others'."""
        return "".join(f", {name}={value}" for name, value in zip(self.split, values, strict=True))


def parts_of(
    rows: Sequence[Row],
    question: Question | None,
    swept: str,
    place: Callable[[Row], Hashable],
    within: Sequence[Row],
    split_grids: bool = False,
) -> Parts:
    """How to show `rows` in parts, if all rows of one `place` would not fit together.

    Where they would be too many, they are split by all that varies besides the choice, but for tunables that some
    choices do not have: each group is a list of choices with its own baseline. So they are with `split_grids` where
    every choice was run in all these ways. What varies is looked for `within` all of the study's rows.
    """
    cells = [row.cell for row in within]
    dimensions = varying_dimensions(cells, question, swept)
    split = tuple(name for name in dimensions if all(dimension(cell, name) is not None for cell in cells))
    too_many = max(Counter(place(row) for row in rows).values()) > MOST_TOGETHER
    if not too_many and not (split_grids and _is_grid(cells, question, split)):
        split = ()
    told = [name for name in dimensions if name not in split]
    labels = {row.cell.name: label_of(row.cell, question, told) for row in rows}
    order = dict.fromkeys([labels[row.cell.name] for row in rows if row.is_baseline] + list(labels.values()))
    return Parts(split, labels, tuple(order))


def _is_grid(cells: Sequence[Cell], question: Question | None, split: Sequence[str]) -> bool:
    """Whether each choice was run with all the values of `split` that any was run with."""
    if question is None:
        return False
    ways: dict[str | None, set[tuple]] = {}
    for cell in cells:
        values = tuple(dimension(cell, name) for name in split)
        ways.setdefault(dimension(cell, question.axis), set()).add(values)
    return len(ways) > 1 and len({frozenset(values) for values in ways.values()}) == 1


def in_file_order(keys: Iterable[tuple]) -> list[tuple]:
    """Each key once, by its first part, then the second, ...; each part in the order in which its values appear.

    Values that are all numbers written out, a tunable's, are in the order of the numbers.
    """
    once = list(dict.fromkeys(keys))
    places = [_numbers_by_size(dict.fromkeys(part)) for part in zip(*once, strict=True)]
    ranks = [{value: rank for rank, value in enumerate(part)} for part in places]
    return sorted(once, key=lambda key: [rank[value] for rank, value in zip(ranks, key, strict=True)])


def _numbers_by_size(values: Iterable) -> list:
    values = list(values)
    return sorted(values, key=int) if all(isinstance(v, str) and v.isdecimal() for v in values) else values
