"""Error against the stiff parameter: a panel a case and quantity, a line a formula, and how much is allowed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from analysis import style
from analysis.errors import NotDrawable
from analysis.figures.stability_caption import caption
from analysis.stability import Layout, Place, number, point_label, short_power
from analysis.stability_file import Case, Row, Stability

LEAST_POINTS = 3
MOST_FIGURES = 4  # one a case; of more cases, one a family
MOST_PANELS = 10  # a page
RELATIVE, ABSOLUTE = "error / exact value", "absolute error"

# A line's label, and the formulas that it is of. The arithmetic "fast" is left to be what the file's backend has of it.
LINES = (
    ("robust float", {}),
    ("robust double_intersection", {"precision": "double_intersection"}),
    ("robust double", {"precision": "double"}),
    ("naive float", {"robustness": "naive"}),
    ("fast float", {"arithmetic": "fast"}),
)
BOUNDS = {"robust float": "allowed in single precision", "robust double": "allowed in double precision"}
_BOUND_LINES = {"robust float": (0, (5, 2)), "robust double": (0, (1, 1.6))}
_PLOT_WIDTH, _PLOT_HEIGHT, _LEFT, _GAP = 3.75, 2.25, 0.95, 0.85  # inches
_CAPTION = (
    "Lines: how far the result is off, relative to the exact value or absolute as the axis says. Grey: the error that "
    "is allowed (tolerance, plus four standard errors of estimates). Bars: one standard error, of estimates. "
    '"0" at the floor: no error at all. "∞" at the top: not finite.'
)


@dataclass(frozen=True)
class Line:
    """`errors` may be 0 or infinite."""

    label: str
    xs: tuple[float, ...]
    errors: tuple[float, ...]
    standard_errors: tuple[float, ...]
    allowed: tuple[float, ...]


@dataclass(frozen=True)
class Panel:
    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]

    @property
    def bounds(self) -> list[Line]:
        """Whose `allowed` is drawn: single precision's, and double's where it is another."""
        found = {line.label: line for line in self.lines if line.label in BOUNDS}
        single, double = found.get("robust float"), found.get("robust double")
        if single and double and _alike(single, double):
            return [single]
        return list(found.values()) or list(self.lines[:1])


@dataclass(frozen=True)
class SweepPage:
    name: str  # of the file
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
    """One page a case, or a family where there are many; raises NotDrawable."""
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
    """(file name, title, cases, panels) of each."""
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
    """Points that differ in the swept parameter only, where there are enough; else one point a value of it."""
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
    """Points of drawn sweeps that no panel has."""
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
    """Those that are measured at enough points; where none is, None stands for the worst of each point's."""
    seen: dict[str, set[Place]] = {}
    for place in places:
        for row in _rows_at(layout, place, {}) or [r for _, formula in LINES for r in _rows_at(layout, place, formula)]:
            seen.setdefault(row.measured.quantity, set()).add(place)
    return [quantity for quantity, at in seen.items() if len(at) >= LEAST_POINTS] or ([""] if seen else [])


def _panel(layout: Layout, case: Case, places: Sequence[Place], quantity: str, others: str) -> Panel | None:
    """None: nothing is off anywhere, or there are too few points."""
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


def looks() -> dict[str, style.Look]:
    """One look a formula, whichever of them a panel has."""
    return {label: style.look(index) for index, (label, _) in enumerate(LINES)}


def draw(data: SweepPage) -> Figure:
    columns = 1 if len(data.panels) == 1 else 2
    rows = math.ceil(len(data.panels) / columns)
    block_width = _LEFT + _PLOT_WIDTH
    titles = [_title(panel, _PLOT_WIDTH + 0.5 * _GAP) for panel in data.panels]
    x_labels = [style.wrapped(panel.x_label, style.LABEL_SIZE, _PLOT_WIDTH + 0.3) for panel in data.panels]
    legend = list(_legend(data))
    width = max(columns * block_width + (columns - 1) * (_GAP - 0.35) + style.MARGIN + 0.3, 6.6)
    legend_rows = _legend_rows(legend, width - 2 * style.MARGIN)
    legend_height = 0.24 * len(legend_rows) + 0.1
    heights = []
    for row in range(rows):
        of_row = slice(row * columns, (row + 1) * columns)
        over = style.text_height(style.BASE_SIZE, max(map(len, titles[of_row]))) + 0.22
        under = 0.38 + style.text_height(style.LABEL_SIZE, max(map(len, x_labels[of_row])))
        heights.append((over, under))
    body = legend_height + sum(over + _PLOT_HEIGHT + under + 0.12 for over, under in heights)
    page = style.Page(width, body, data.title, data.caption)
    _draw_legend(page, legend_rows, body)
    top = body - legend_height
    for index, panel in enumerate(data.panels):
        over, under = heights[index // columns]
        x = _LEFT + (index % columns) * (block_width + _GAP - 0.35)
        axes = page.axes(x, top - over - _PLOT_HEIGHT, _PLOT_WIDTH, _PLOT_HEIGHT)
        for number_of_line, line in enumerate(titles[index]):
            y = top - over + 0.1 + style.text_height(style.BASE_SIZE, len(titles[index]) - number_of_line - 1)
            weight = "bold" if line in _head(panel, _PLOT_WIDTH + 0.5 * _GAP) else "normal"
            page.text(x - 0.3, y, line, size=style.BASE_SIZE, weight=weight, va="bottom")
        _draw_panel(axes, panel)
        axes.set_xlabel("\n".join(x_labels[index]), size=style.LABEL_SIZE, linespacing=style.LINE_SPACING)
        axes.set_ylabel(panel.y_label, size=style.LABEL_SIZE)
        if index % columns == columns - 1:
            top -= over + _PLOT_HEIGHT + under + 0.12
    return page.figure


def _head(panel: Panel, width: float) -> list[str]:
    return style.wrapped(panel.title.partition("\n")[0], style.BASE_SIZE, width, "bold")


def _title(panel: Panel, width: float) -> list[str]:
    return [*_head(panel, width), *style.wrapped(panel.title.partition("\n")[2], style.BASE_SIZE, width)]


def _legend(data: SweepPage) -> Iterable[tuple[str, dict]]:
    for label, look in looks().items():
        if any(line.label == label for panel in data.panels for line in panel.lines):
            yield label, {"color": look.colour, "marker": look.marker, "linestyle": look.line}
    for label in BOUNDS:
        if any(line.label == label for panel in data.panels for line in panel.bounds):
            yield BOUNDS[label], {"color": "#777777", "linestyle": _BOUND_LINES[label]}


def _legend_rows(legend: Sequence[tuple[str, dict]], width: float) -> list[list[tuple[float, str, dict]]]:
    rows, x = [[]], 0.0
    for label, properties in legend:
        needed = 0.5 + style.text_width(label, style.LABEL_SIZE) + 0.25
        if rows[-1] and x + needed > width:
            rows.append([])
            x = 0.0
        rows[-1].append((x, label, properties))
        x += needed
    return rows


def _draw_legend(page: style.Page, rows: Sequence[Sequence[tuple[float, str, dict]]], body: float) -> None:
    for index, row in enumerate(rows):
        y = body - 0.24 * (index + 0.5)
        for x, label, properties in row:
            axes = page.axes(style.MARGIN + x, y - 0.08, 0.42, 0.16, xlim=(0, 2), ylim=(-1, 1))
            axes.set_axis_off()
            axes.plot([0, 1, 2], [0, 0, 0], markevery=[1], **properties)
            page.text(style.MARGIN + x + 0.5, y, label, size=style.LABEL_SIZE, va="center")


class _Abscissa:
    """Where the swept values stand: by their logarithm, nought a step to the left; below nought, as they are."""

    def __init__(self, values: Sequence[float]):
        self.values = sorted(set(values))
        positive = [value for value in self.values if value > 0]
        self.is_log = self.values[0] >= 0 and len(positive) > 1 and max(positive) > 2 * min(positive)
        self._zero = 0.0
        if self.is_log and len(positive) < len(self.values):
            span = math.log10(max(positive) / min(positive))
            self._zero = math.log10(min(positive)) - max(0.15 * span, 0.2)

    def at(self, value: float) -> float:
        return value if not self.is_log else self._zero if value == 0 else math.log10(value)

    def set(self, axes: Axes) -> None:
        places = [self.at(value) for value in self.values]
        margin = 0.05 * (places[-1] - places[0])
        axes.set_xlim(places[0] - margin, places[-1] + margin)
        shown: list[tuple[float, str]] = []
        scale = _PLOT_WIDTH / (places[-1] - places[0] + 2 * margin)
        reach = -math.inf
        for place, value in zip(places, self.values, strict=True):
            half = 0.5 * style.text_width(number(value), style.LABEL_SIZE) + 0.06
            if place * scale - half >= reach:
                shown.append((place, number(value)))
                reach = place * scale + half
        axes.xaxis.set_major_locator(FixedLocator([place for place, _ in shown]))
        names = dict(shown)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda place, _: names.get(place, "")))
        axes.xaxis.set_minor_locator(FixedLocator([place for place in places if place not in names]))
        axes.xaxis.set_minor_formatter(NullFormatter())


def limits(panel: Panel) -> tuple[float, float]:
    """The floor, where errors of 0 stand, and the ceiling, where infinite ones do."""
    drawn = [value for line in panel.lines for value in line.errors] + [
        b for line in panel.bounds for b in line.allowed
    ]
    known = [value for value in drawn if value > 0 and math.isfinite(value)] or [1.0]
    low, high = math.floor(math.log10(min(known))), math.ceil(math.log10(max(known)))
    span = max(high - low, 1)
    return 10.0 ** (low - 0.12 * span), 10.0 ** (high + 0.12 * span)


def _power(value: float) -> str:
    return f"{value:g}" if 0.01 <= value < 1000 else short_power(f"{value:.0e}")


def _draw_panel(axes: Axes, panel: Panel) -> None:
    abscissa = _Abscissa([x for line in panel.lines for x in line.xs])
    floor, ceiling = limits(panel)
    abscissa.set(axes)
    axes.set_yscale("log")
    has_zero = any(0 in line.errors for line in panel.lines)
    has_infinite = any(math.inf in line.errors for line in panel.lines)
    step = (ceiling / floor) ** 0.06
    axes.set_ylim(floor / step if has_zero else floor, ceiling * step if has_infinite else ceiling)
    axes.yaxis.set_major_locator(LogLocator(numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _power(value)))
    axes.grid(axis="y")
    for line in panel.bounds:
        if any(line.allowed):
            xs = [abscissa.at(x) for x in line.xs]
            shown = [allowed if allowed > 0 else math.nan for allowed in line.allowed]
            axes.plot(xs, shown, color="#777777", linestyle=_BOUND_LINES.get(line.label, "--"), linewidth=1.4, zorder=2)
    for line in panel.lines:
        _draw_errors(axes, line, abscissa, floor, ceiling)
    for value, height, text, away in ((0.0, floor, "0", 6), (math.inf, ceiling, "∞", -6)):
        xs = {x for line in panel.lines for x, error in zip(line.xs, line.errors, strict=True) if error == value}
        for x in sorted(xs):
            axes.annotate(
                text, (abscissa.at(x), height), (8, away), textcoords="offset points", size=style.BASE_SIZE,
                ha="center", va="center",
            )  # fmt: skip


def _draw_errors(axes: Axes, line: Line, abscissa: _Abscissa, floor: float, ceiling: float) -> None:
    look = looks()[line.label]
    xs = [abscissa.at(x) for x in line.xs]
    ys = [min(max(error, floor), ceiling) for error in line.errors]
    axes.plot(
        xs, ys, color=look.colour, marker=look.marker, linestyle=look.line, markersize=5.5, zorder=3, clip_on=False,
        markerfacecolor="none" if line.label == "robust float" else look.colour, label=line.label,
    )  # fmt: skip
    bars = [
        (x, y, e) for x, y, e, error in zip(xs, ys, line.standard_errors, line.errors, strict=True)
        if e > 0 and 0 < error < math.inf and math.isfinite(e)
    ]  # fmt: skip
    if bars:
        axes.errorbar(
            [x for x, _, _ in bars],
            [y for _, y, _ in bars],
            yerr=[[min(e, y - floor) for _, y, e in bars], [e for _, _, e in bars]],
            fmt="none",
            ecolor=look.colour,
            elinewidth=0.8,
            alpha=0.7,
            zorder=3,
        )
