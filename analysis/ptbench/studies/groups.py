"""How the cells of a figure are grouped, labelled and ordered."""

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass

from ptbench.io.cells import Cell
from ptbench.studies.questions import Question, dimension, label_of, varying_dimensions
from ptbench.studies.rows import Row

# Most rows of a figure for one scene and depth, or lines of one panel; more are split into groups.
MOST_TOGETHER = 8


@dataclass(frozen=True)
class Parts:
    """The grouping of a figure's cells: groups differ in the dimensions `split`, and each cell has a label."""

    split: tuple[str, ...]
    labels: dict[str, str]  # label of each cell, by cell name
    order: tuple[str, ...]  # labels of choices: baselines first, then as in the file, so that each keeps one colour

    def values(self, cell: Cell) -> tuple[str | None, ...]:
        """The values of a cell in the dimensions that tell groups apart."""
        return tuple(dimension(cell, name) for name in self.split)

    def suffix(self, values: Sequence[str | None]) -> str:
        """The suffix that tells a group's title from the others'."""
        return "".join(f", {name}={value}" for name, value in zip(self.split, values, strict=True))


def parts_of(
    rows: Sequence[Row],
    question: Question | None,
    swept: str,
    place: Callable[[Row], Hashable],
    within: Sequence[Row],
    split_grids: bool = False,
) -> Parts:
    """Divides `rows` into groups if all rows of one `place` would be too many for one.

    Groups are split by all that varies besides the choice, except tunables that some choices lack: each group lists
    choices with a baseline of its own. With `split_grids` rows are also split where every choice was run in all these
    ways. What varies is determined `within` all of the study's rows.
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
    """Whether every choice was run with all values of `split` that occur."""
    if question is None:
        return False
    ways: dict[str | None, set[tuple]] = {}
    for cell in cells:
        values = tuple(dimension(cell, name) for name in split)
        ways.setdefault(dimension(cell, question.axis), set()).add(values)
    return len(ways) > 1 and len({frozenset(values) for values in ways.values()}) == 1


def in_file_order(keys: Iterable[tuple]) -> list[tuple]:
    """The distinct keys (tuples), sorted by each part in turn, whose values are ordered by first appearance.

    Parts whose values are all numbers, as a tunable's are, are sorted by size.
    """
    once = list(dict.fromkeys(keys))
    places = [_numbers_by_size(dict.fromkeys(part)) for part in zip(*once, strict=True)]
    ranks = [{value: rank for rank, value in enumerate(part)} for part in places]
    return sorted(once, key=lambda key: [rank[value] for rank, value in zip(ranks, key, strict=True)])


def _numbers_by_size(values: Iterable) -> list:
    values = list(values)
    return sorted(values, key=int) if all(isinstance(v, str) and v.isdecimal() for v in values) else values
