"""The layout of a stability result as a table: variants as columns, cases at points as rows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.io.axes import ARITHMETIC, PRECISION, ROBUSTNESS, known_axes
from ptbench.io.older import plainest_formulas
from ptbench.io.stability import BROKEN, KNOWN_LIMIT, SCHEMA, Case, Row, Stability

# Axes that affect how numbers are computed; other axes affect only the order of computation.
FORMULA_AXES = (PRECISION, ARITHMETIC, ROBUSTNESS)
# Axes that affect how samples are drawn: variants that differ in them make different rows of a stability report.
ESTIMATOR_AXES = tuple(name for name, axis in known_axes().items() if axis.decides_samples)


def number(value: float) -> str:
    """A parameter's value in few characters; tiny and huge powers of two as such."""
    mantissa, exponent = math.frexp(value)
    if abs(mantissa) == 0.5 and not -10 < exponent - 1 < 20:
        return f"{'-' if value < 0 else ''}2^{exponent - 1}"
    return short_power(f"{value:g}")


def short_power(text: str) -> str:
    """A power of ten without leading zeros: "1e-6" for "1e-06"."""
    return text.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


@dataclass(frozen=True)
class Column:
    """A column: a variant, described by what differs between the file's variants, without estimators."""

    label: str
    must_pass: bool


@dataclass(frozen=True)
class Place:
    """A row of the table: a case at a point with an estimator."""

    case: Case
    point: tuple[tuple[str, float], ...]
    estimator: str

    @property
    def label(self) -> str:
        """The label of the row: case, point and estimator."""
        return " ".join(part for part in (self.case.shown, self.where) if part)

    @property
    def where(self) -> str:
        """The point and the estimator of the row."""
        return " ".join(part for part in (point_label(self.case, self.point), self.estimator) if part)


def point_label(case: Case, point: Sequence[tuple[str, float]]) -> str:
    """A point as text: the swept parameter, and parameters that are off their standard."""
    parts = []
    for name, value in sorted(point, key=lambda item: item[0] != case.sweep):
        parameter = case.parameters.get(name)
        if name == case.sweep or parameter is None or value != parameter.standard:
            parts.append(f"{name}={number(value)}")
    return " ".join(parts)


class Layout:
    """The labels of all columns and rows of a stability file."""

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
        """A row's column label, such as "float" or "double naive": the differences from the plainest variant."""
        if row.variant not in self._labels:
            self._labels[row.variant] = self._column_of(row)
        return self._labels[row.variant]

    def _column_of(self, row: Row) -> str:
        others = [axis for axis in self._labelled if axis not in ESTIMATOR_AXES]
        scheduling = [row.axes[axis] for axis in others if axis in row.axes and row.axes[axis] != self.plain[axis]]
        formulas = [
            row.axes[axis]
            for axis in FORMULA_AXES
            if axis in row.axes and (row.axes[axis] != self.plain[axis] or (axis == PRECISION and not scheduling))
        ]
        return " ".join([*scheduling, *formulas]) or row.variant

    def place_of(self, row: Row) -> Place:
        """The case, point and estimator of a check."""
        estimator = [
            row.axes[axis]
            for axis in ESTIMATOR_AXES
            if axis in self._labelled and axis in row.axes and row.axes[axis] != self.plain[axis]
        ]
        return Place(row.case, row.point, " ".join(estimator))

    def is_formula(self, row: Row, **formula: str) -> bool:
        """Whether a check is of the plainest scheduler with these formulas; other axes have their plainest choice."""
        wanted = {**{axis: self.plain.get(axis) for axis in row.axes if axis not in ESTIMATOR_AXES}, **formula}
        return all(row.axes.get(axis) == choice for axis, choice in wanted.items())


@dataclass(frozen=True)
class HeatCell:
    """The worst quantity of a row in one column."""

    kind: str  # kind of a heat map's cell: "value", "n/a", "broken" or "missing"
    over_allowed: float = math.nan
    quantity: str = ""
    is_limit: bool = False
    is_failure: bool = False  # whether a check that must pass failed


def heat_cell(rows: Sequence[Row]) -> HeatCell:
    """The heat map's cell for the checks of one row and column; "missing" if there are none."""
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
    """The number of checks with a status."""
    return sum(row.status == status for row in rows)


def failures(rows: Sequence[Row]) -> list[Row]:
    """The required checks that failed or broke."""
    return [row for row in rows if row.must_pass and row.is_failure]
