"""Sweeps of a stability file as pages of panels, each for one case and quantity with a line per formula."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from ptbench.errors import NotDrawable
from ptbench.figures.stability.caption import caption
from ptbench.io.axes import ARITHMETIC, PRECISION, ROBUSTNESS
from ptbench.io.stability import Case, Row, Stability
from ptbench.stability.layout import Layout, Place, point_label

LEAST_POINTS = 3
MOST_FIGURES = 4  # up to this number, stability cases get a page each; beyond it, each family shares one
MOST_PANELS = 10  # largest number of panels on one page of stability curves
RELATIVE, ABSOLUTE = "error / exact value", "absolute error"

# Lines of a stability panel, as (label, axes of variants); "fast" is the fast arithmetic of the file's backend.
LINES = (
    ("robust float", {}),
    ("robust double_intersection", {PRECISION: "double_intersection"}),
    ("robust double", {PRECISION: "double"}),
    ("naive float", {ROBUSTNESS: "naive"}),
    ("fast float", {ARITHMETIC: "fast"}),
)
BOUNDS = {"robust float": "allowed in single precision", "robust double": "allowed in double precision"}
_CAPTION = (
    "Lines: how far the result is off, relative to the exact value or absolute as the axis says. Grey: the error that "
    "is allowed (tolerance, plus four standard errors of estimates). Bars: one standard error, of estimates. "
    '"0" at the floor: no error at all. "∞" at the top: not finite.'
)


@dataclass(frozen=True)
class Line:
    """The errors of one formula along a sweep; values in `errors` may be 0 or infinite."""

    label: str
    xs: tuple[float, ...]
    errors: tuple[float, ...]
    standard_errors: tuple[float, ...]
    allowed: tuple[float, ...]


@dataclass(frozen=True)
class Panel:
    """A panel for a stability case and quantity: lines of errors over the swept parameter."""

    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]

    @property
    def bounds(self) -> list[Line]:
        """Lines whose allowed error is drawn: single precision's, and double's where it differs."""
        found = {line.label: line for line in self.lines if line.label in BOUNDS}
        single, double = found.get("robust float"), found.get("robust double")
        if single and double and _alike(single, double):
            return [single]
        return list(found.values()) or list(self.lines[:1])


@dataclass(frozen=True)
class SweepPage:
    """One page of panels with errors over swept parameters."""

    name: str  # file name of the page of panels, without extension
    title: str
    caption: str
    panels: tuple[Panel, ...]


def _alike(one: Line, other: Line) -> bool:
    theirs = dict(zip(other.xs, other.allowed, strict=True))
    return all(
        math.isclose(allowed, theirs.get(x, allowed), rel_tol=0.2)
        for x, allowed in zip(one.xs, one.allowed, strict=True)
    )


def collect(stability: Stability) -> list[SweepPage]:
    """Collects one page of panels per case, or per family where there are many cases; raises NotDrawable."""
    layout = Layout(stability)
    swept: dict[Case, list[Place]] = {}
    for place in layout.places:
        if place.case.sweep in dict(place.point):
            swept.setdefault(place.case, []).append(place)
    if not swept:
        raise NotDrawable("no case of the file has a parameter that is swept")
    panels = {case: found for case, places in swept.items() if (found := _panels(layout, case, places))}
    if not panels:
        raise NotDrawable(f"no case was looked at in {LEAST_POINTS} points of its sweep with errors to show")
    pages = []
    for name, title, cases, of_page in _pages(panels):
        left_out = [label for case in cases for label in _left_out(case, swept[case])]
        remarks = [f"In no panel: {', '.join(left_out)}."] if left_out else []
        pages.append(SweepPage(name, title, caption(stability, _CAPTION, remarks), tuple(of_page)))
    return pages


_Page = tuple[str, str, Sequence[Case], Sequence[Panel]]


def _pages(panels: dict[Case, list[Panel]]) -> Iterable[_Page]:
    """Distributes panels over pages, each with file name, title, cases and panels."""
    if len(panels) <= MOST_FIGURES:
        for case, found in panels.items():
            yield from _split(f"sweep_{case.name}", f"{case.shown}: {case.title}".rstrip(": "), [case], found)
        return
    for family, cases in groupby(panels, key=lambda case: case.family):
        of_family = list(cases)
        found = [panel for case in of_family for panel in panels[case]]
        yield from _split(f"sweep_{family}", f"Error against the stiff parameter: {family}", of_family, found)


def _split(name: str, title: str, cases: Sequence[Case], panels: Sequence[Panel]) -> Iterable[_Page]:
    pages = math.ceil(len(panels) / MOST_PANELS)
    for page in range(pages):
        part = panels[page * MOST_PANELS : (page + 1) * MOST_PANELS]
        if pages == 1:
            yield name, title, cases, part
        else:
            yield f"{name}_{page + 1}", f"{title} ({page + 1} of {pages})", cases, part


def _panels(layout: Layout, case: Case, places: Sequence[Place]) -> list[Panel]:
    panels = []
    for estimator in dict.fromkeys(place.estimator for place in places):
        of_estimator = [place for place in places if place.estimator == estimator]
        for others, chosen in _series(case, of_estimator):
            for quantity in _quantities(layout, chosen):
                if panel := _panel(layout, case, chosen, quantity, " ".join(filter(None, (others, estimator)))):
                    panels.append(panel)
    return panels


def _others(case: Case, place: Place) -> tuple[tuple[str, float], ...]:
    return tuple(item for item in place.point if item[0] != case.sweep)


def _series(case: Case, places: Sequence[Place]) -> list[tuple[str, list[Place]]]:
    """Series of a case's points that differ in the swept parameter only, if long enough; else one point per value."""
    groups: dict[tuple, list[Place]] = {}
    for place in places:
        groups.setdefault(_others(case, place), []).append(place)
    enough = [group for group in groups.values() if len(group) >= LEAST_POINTS]
    if enough:
        return [(point_label(case, _others(case, group[0])), _by_value(case, group)) for group in enough]
    once = {dict(place.point)[case.sweep]: place for place in reversed(places)}
    if len(once) < LEAST_POINTS:
        return []
    chosen = _by_value(case, once.values())
    moving = [
        name for name, _ in chosen[0].point
        if name != case.sweep and len({dict(place.point)[name] for place in chosen}) > 1
    ]  # fmt: skip
    return [(f"({', '.join(moving)} with it)" if moving else "", chosen)]


def _by_value(case: Case, places: Iterable[Place]) -> list[Place]:
    return sorted(places, key=lambda place: dict(place.point)[case.sweep])


def _left_out(case: Case, places: Sequence[Place]) -> list[str]:
    """Labels of a case's points that no panel shows, although another point with their estimator is shown."""
    left = []
    for estimator in dict.fromkeys(place.estimator for place in places):
        of_estimator = [place for place in places if place.estimator == estimator]
        drawn = [place for _, chosen in _series(case, of_estimator) for place in chosen]
        left += [place.label for place in of_estimator if drawn and place not in drawn]
    return left


def _rows_at(layout: Layout, place: Place, formula: dict[str, str]) -> list[Row]:
    return [
        row
        for column in layout.columns
        for row in layout.by_cell.get((place, column.label), ())
        if row.measured is not None and layout.is_formula(row, **formula)
    ]


def _quantities(layout: Layout, places: Sequence[Place]) -> list[str]:
    """Quantities measured at enough points for lines; if none, an empty name stands for each point's worst quantity."""
    seen: dict[str, set[Place]] = {}
    for place in places:
        for row in _rows_at(layout, place, {}) or [r for _, formula in LINES for r in _rows_at(layout, place, formula)]:
            seen.setdefault(row.measured.quantity, set()).add(place)
    return [quantity for quantity, at in seen.items() if len(at) >= LEAST_POINTS] or ([""] if seen else [])


def _panel(layout: Layout, case: Case, places: Sequence[Place], quantity: str, others: str) -> Panel | None:
    """The panel of a quantity's errors; None where all errors are 0 or points are too few."""
    rows = {
        label: [(place, row) for place in places if (row := _row_of(layout, place, formula, quantity)) is not None]
        for label, formula in LINES
    }
    all_rows = [row for found in rows.values() for _, row in found]
    relative = all(
        row.measured.relation == "equal" and row.measured.exact != 0 and math.isfinite(row.measured.exact)
        for row in all_rows
    )
    lines = tuple(
        _line(label, case, found, quantity, relative) for label, found in rows.items() if len(found) >= LEAST_POINTS
    )
    if not any(error > 0 for line in lines for error in line.errors):
        return None
    parameter = case.parameters.get(case.sweep)
    summary = f": {parameter.summary}" if parameter is not None and parameter.summary else ""
    what = quantity or "the worst quantity"
    return Panel(
        title=f"{case.shown} {others}".strip() + f"\n{what}",
        x_label=f"{case.sweep}{summary}",
        y_label=("error / allowed" if not quantity else RELATIVE if relative else ABSOLUTE),
        lines=lines,
    )


def _row_of(layout: Layout, place: Place, formula: dict[str, str], quantity: str) -> Row | None:
    rows = _rows_at(layout, place, formula)
    if quantity:
        return next((row for row in rows if row.measured.quantity == quantity), None)
    return max(rows, key=lambda row: row.measured.over_allowed, default=None)


def _line(label: str, case: Case, found: Sequence[tuple[Place, Row]], quantity: str, relative: bool) -> Line:
    def scaled(row: Row, value: float) -> float:
        if not quantity:
            return value / row.measured.allowed if row.measured.allowed > 0 else math.inf if value > 0 else 0.0
        return value / abs(row.measured.exact) if relative else value

    measured = [row for _, row in found]
    return Line(
        label,
        tuple(dict(place.point)[case.sweep] for place, _ in found),
        tuple(math.inf if math.isnan(row.measured.error) else scaled(row, row.measured.error) for row in measured),
        tuple(scaled(row, row.measured.standard_error) for row in measured),
        tuple(1.0 if not quantity else scaled(row, row.measured.allowed) for row in measured),
    )
