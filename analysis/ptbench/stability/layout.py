"""How a stability result is laid out: the columns that its variants are, the places that its cases are looked at."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.io.axes import known_axes
from ptbench.io.older import plainest_formulas
from ptbench.io.stability import BROKEN, KNOWN_LIMIT, SCHEMA, Case, Row, Stability

# How numbers are computed; a variant's other axes say who computes what when.
FORMULA_AXES = ("precision", "arithmetic", "robustness")
# How samples are drawn: a case has these for rows of their own, since each case is run with those that matter to it.
ESTIMATOR_AXES = tuple(name for name, axis in known_axes().items() if axis.decides_samples)


def number(value: float) -> str:
    """A parameter in few characters; powers of two as such where they are tiny or huge."""
    mantissa, exponent = math.frexp(value)
    if abs(mantissa) == 0.5 and not -10 < exponent - 1 < 20:
        return f"{'-' if value < 0 else ''}2^{exponent - 1}"
    return short_power(f"{value:g}")


def short_power(text: str) -> str:
    """A power of ten without a leading zero: "1e-6" for "1e-06"."""
    return text.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


@dataclass(frozen=True)
class Column:
    """A variant as far as the file's variants differ, but for estimators."""

    label: str
    must_pass: bool


@dataclass(frozen=True)
class Place:
    """A case at a point with an estimator."""

    case: Case
    point: tuple[tuple[str, float], ...]
    estimator: str

    @property
    def label(self) -> str:
        """The case, the point, the estimator."""
        return " ".join(part for part in (self.case.shown, self.where) if part)

    @property
    def where(self) -> str:
        """The point and the estimator."""
        return " ".join(part for part in (point_label(self.case, self.point), self.estimator) if part)


def point_label(case: Case, point: Sequence[tuple[str, float]]) -> str:
    """The swept parameter and those that are not at their standards."""
    parts = []
    for name, value in sorted(point, key=lambda item: item[0] != case.sweep):
        parameter = case.parameters.get(name)
        if name == case.sweep or parameter is None or value != parameter.standard:
            parts.append(f"{name}={number(value)}")
    return " ".join(parts)


class Layout:
    """The names of all that the file has."""

    def __init__(self, stability: Stability):
        choices: dict[str, dict[str, None]] = {}
        for row in stability.rows:
            for axis, choice in row.axes.items():
                choices.setdefault(axis, {})[choice] = None
        plain = plainest_formulas(SCHEMA)
        self.plain = {
            axis: plain[axis] if plain.get(axis) in found else next(iter(found)) for axis, found in choices.items()
        }
        self._labelled = [axis for axis, found in choices.items() if len(found) > 1 and axis not in FORMULA_AXES]
        self._labels: dict[str, str] = {}
        self.by_cell: dict[tuple[Place, str], list[Row]] = {}
        must_pass: dict[str, bool] = {}
        for row in stability.rows:
            label = self.column_of(row)
            must_pass[label] = must_pass.get(label, True) and row.must_pass
            self.by_cell.setdefault((self.place_of(row), label), []).append(row)
        columns = [Column(label, must) for label, must in must_pass.items()]
        self.columns = sorted(columns, key=lambda column: not column.must_pass)
        order = {case.name: index for index, case in enumerate(stability.cases)}
        places = dict.fromkeys(place for place, _ in self.by_cell)
        self.places = sorted(places, key=lambda place: order[place.case.name])

    def column_of(self, row: Row) -> str:
        """ "float", "double naive", "wavefront": what differs from the plainest, its precision where nothing else."""
        if row.variant not in self._labels:
            self._labels[row.variant] = self._column_of(row)
        return self._labels[row.variant]

    def _column_of(self, row: Row) -> str:
        others = [axis for axis in self._labelled if axis not in ESTIMATOR_AXES]
        scheduling = [row.axes[axis] for axis in others if axis in row.axes and row.axes[axis] != self.plain[axis]]
        formulas = [
            row.axes[axis]
            for axis in FORMULA_AXES
            if axis in row.axes and (row.axes[axis] != self.plain[axis] or (axis == "precision" and not scheduling))
        ]
        return " ".join([*scheduling, *formulas]) or row.variant

    def place_of(self, row: Row) -> Place:
        """The case, point and estimator of a row."""
        estimator = [
            row.axes[axis]
            for axis in ESTIMATOR_AXES
            if axis in self._labelled and axis in row.axes and row.axes[axis] != self.plain[axis]
        ]
        return Place(row.case, row.point, " ".join(estimator))

    def is_formula(self, row: Row, **formula: str) -> bool:
        """Whether the row is of the plainest scheduler with these formulas; those not named are the plain ones."""
        wanted = {**{axis: self.plain.get(axis) for axis in row.axes if axis not in ESTIMATOR_AXES}, **formula}
        return all(row.axes.get(axis) == choice for axis, choice in wanted.items())


@dataclass(frozen=True)
class HeatCell:
    """The worst of a place's quantities in one column."""

    kind: str  # "value", "n/a", "broken", "missing"
    over_allowed: float = math.nan
    quantity: str = ""
    is_limit: bool = False
    is_failure: bool = False  # of what must pass


def heat_cell(rows: Sequence[Row]) -> HeatCell:
    """The heat cell of one place and column, from its rows; without rows it was not run."""
    if not rows:
        return HeatCell("missing")
    is_failure = any(row.must_pass and row.is_failure for row in rows)
    is_limit = any(row.status == KNOWN_LIMIT for row in rows)
    measured = [row.measured for row in rows if row.measured is not None]
    worst = max(measured, key=lambda one: one.over_allowed, default=None)
    if any(row.status == BROKEN for row in rows):
        quantity = next((row.measured.quantity for row in rows if row.status == BROKEN and row.measured), "")
        return HeatCell("broken", quantity=quantity, is_limit=is_limit, is_failure=is_failure)
    if worst is None:
        return HeatCell("n/a")
    return HeatCell("value", worst.over_allowed, worst.quantity, is_limit, is_failure)


def count(rows: Sequence[Row], status: str) -> int:
    """How many rows have that status."""
    return sum(row.status == status for row in rows)


def failures(rows: Sequence[Row]) -> list[Row]:
    """What failed or broke though it must pass."""
    return [row for row in rows if row.must_pass and row.is_failure]
