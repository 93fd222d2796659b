"""Writes the summary.md of a stability result: a sentence or two per family, known limits, and failures."""

import math
from collections.abc import Iterable, Sequence

from ptbench.document.blocks import Lines
from ptbench.document.markdown import markdown
from ptbench.document.table import table_of
from ptbench.io.axes import ARITHMETIC, PRECISION, ROBUSTNESS
from ptbench.io.files import one_line
from ptbench.io.stability import BROKEN, KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Row, Stability
from ptbench.stability.layout import Layout, count, failures, point_label, short_power

RULE = (
    "A check is one quantity of one case at one point in one variant. Everything robust in arithmetic that is not fast "
    "must pass: its error must be no more than allowed, which is a tolerance for rounding with its origin, plus four "
    "standard errors where the quantity is an estimate. Naive kernels and fast arithmetic are there to compare."
)


def setting(stability: Stability) -> str:
    """The machine, commit and date of a file in one line."""
    machine = f"Machine {stability.about('machine')}: "
    if stability.about("backend") == "cuda":
        facts = [f"GPU {stability.about('cuda_device')}"]
        if stability.context.get("ptbench.cuda_driver"):
            facts.append(f"CUDA driver {stability.about('cuda_driver')}, NVRTC {stability.about('cuda_nvrtc')}")
        machine += "; ".join(facts)
    else:
        machine += f"{stability.about('cpu_model')}, {stability.about('threads')} threads"
    run = f"{'quick' if stability.is_quick else 'full'} run"
    run += "" if stability.seed is None else f", seed {stability.seed}"
    return (
        f"{machine}; backend {stability.about('backend')}; ptbench {stability.about('version')}, git {stability.git}, "
        f"{run}, {stability.context.get('date') or 'no date'}."
    )


def summary(stability: Stability, not_drawn: Sequence[str]) -> str:
    """The summary page of a stability result as Markdown."""
    layout = Layout(stability)
    lines: Lines = ["# Stability: what came out of stiff cases", ""]
    lines += [f"- Result file: {stability.path.name}", f"- {setting(stability)}"]
    lines += [f"- Run: {'' if stability.is_complete else 'NOT COMPLETE: '}{stability.about('status')}"]
    lines += [f"- Command: `{one_line(stability.about('command_line'))}`", "", RULE, ""]
    for reason in not_drawn:
        lines += [f"Not drawn: {one_line(reason)}", ""]
    lines += ["## By family", ""]
    for family in stability.families:
        lines += [family_text(stability, layout, family), ""]
    if not stability.families:
        lines += ["The file has no cases.", ""]
    return markdown([*lines, *limits(stability, layout), *must_pass_failures(stability, layout), *missing(stability)])


def _plural(n: int, what: str) -> str:
    return f"{n} {what}{'' if n == 1 else 's'}"


def family_text(stability: Stability, layout: Layout, family: str) -> str:
    """A paragraph on a family of cases: passes, failures of naive formulas, how near each precision is to a bound."""
    rows = [row for row in stability.rows if row.case.family == family]
    cases = [case for case in stability.cases if case.family == family]
    run = dict.fromkeys(row.case for row in rows if row.status != NOT_APPLICABLE)
    points = dict.fromkeys((row.case, row.point) for row in rows if row.status != NOT_APPLICABLE)
    head = f"**{family}**: {_plural(len(cases), 'case')}"
    if not run:
        return f"{head}, none of which was run."
    looked = f"{head}, {len(run)} of them run" if len(run) < len(cases) else head
    required = [row for row in rows if row.must_pass and row.status != NOT_APPLICABLE]
    passed, limits = count(required, PASSED), count(required, KNOWN_LIMIT)
    text = [f"{looked}, at {_plural(len(points), 'point')}."]
    if required:
        failed = failures(required)
        bad = f"{len(failed)} failed or broke ({_names(failed)})" if failed else "none failed"
        known = f", {_plural(limits, 'known limit')}" if limits else ""
        text.append(f"Of {_plural(len(required), 'check')} that must pass {passed} passed, {bad}{known}.")
    else:
        text.append("Nothing that must pass was run.")
    naive = [row for row in rows if row.axes.get(ROBUSTNESS) == "naive"]
    fast = [row for row in rows if row.axes.get(ARITHMETIC) == "fast" and row.axes.get(ROBUSTNESS) != "naive"]
    text += [_compared("The naive kernels", naive), _compared("Fast arithmetic", fast)]
    worst = [
        f"{label} {_worst(found)}"
        for label, formula in (("robust float", {}), ("robust double", {PRECISION: "double"}))
        if (found := [row for row in rows if row.measured is not None and layout.is_formula(row, **formula)])
    ]
    if worst:
        text.append(f"Worst error over allowed: {'; '.join(worst)}.")
    return " ".join(sentence for sentence in text if sentence)


def _names(rows: Iterable[Row]) -> str:
    return ", ".join(dict.fromkeys(row.case.name for row in rows))


def _compared(what: str, rows: Sequence[Row]) -> str:
    run = [row for row in rows if row.status != NOT_APPLICABLE]
    if not run:
        return ""
    bad = [row for row in run if row.is_failure]
    if not bad:
        return f"{what} passed all of theirs, {len(run)}."
    return f"{what} failed or broke in {len(bad)} of {len(run)} ({_names(bad)})."


def _worst(rows: Sequence[Row]) -> str:
    row = max(rows, key=lambda row: row.measured.over_allowed)
    if row.measured.over_allowed == 0:
        return "0 everywhere"
    where = f"{row.case.name} {point_label(row.case, row.point)}".strip()
    if row.status == KNOWN_LIMIT:
        others = [other.measured.over_allowed for other in rows if other.status != KNOWN_LIMIT]
        where += ", a known limit" + (f"; {_short(max(others))} elsewhere" if others else "")
    return f"{_short(row.measured.over_allowed)} ({where})"


def _short(value: float) -> str:
    if math.isinf(value):
        return "∞"
    return f"{value:.0f}" if 10 <= value < 1000 else short_power(f"{value:.2g}")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], numeric: Iterable[str] = ()) -> Lines:
    return [table_of(head, rows, numeric), ""]


def _where(row: Row) -> tuple[str, str]:
    return row.case.shown, point_label(row.case, row.point) or "—"


def _variant(layout: Layout, row: Row) -> str:
    return " ".join(part for part in (layout.column_of(row), layout.place_of(row).estimator) if part)


def limits(stability: Stability, layout: Layout) -> Lines:
    """The section on checks that exceed their bound by a known limit, grouped."""
    lines = ["## Known limits", ""]
    rows = [row for row in stability.rows if row.status == KNOWN_LIMIT]
    if not rows:
        return [*lines, "None.", ""]
    groups: dict[tuple, list[Row]] = {}
    for row in rows:
        quantity = row.measured.quantity if row.measured is not None else "—"
        groups.setdefault((*_where(row), quantity, row.reason), []).append(row)
    table = []
    for (case, point, quantity, reason), members in groups.items():
        variants = ", ".join(dict.fromkeys(_variant(layout, row) for row in members))
        measured = [row.measured for row in members if row.measured is not None]
        worst = max(measured, key=lambda one: one.over_allowed, default=None)
        numbers = ("—", "—") if worst is None else (_short(worst.error), _short(worst.allowed))
        table.append((case, point, variants, quantity, *numbers, reason or "no reason given"))
    head = ("Case", "Point", "Variants", "Quantity", "Worst error", "Allowed", "Reason")
    return lines + _table(head, table, ("Worst error", "Allowed"))


def must_pass_failures(stability: Stability, layout: Layout) -> Lines:
    """The section on required checks that failed or broke."""
    lines = ["## Failures of what must pass", ""]
    rows = failures(stability.rows)
    if not rows:
        return [*lines, "None: everything that must pass and was run has passed or is a known limit.", ""]
    table = []
    for row in rows:
        one = row.measured
        numbers = ["—"] * 5
        if one is not None:
            numbers = [one.quantity, f"{one.value:.10g}", f"{one.exact:.10g}", _short(one.error), _short(one.allowed)]
        looks = str(row.looks) if one is not None else "—"
        state = "broken" if row.status == BROKEN else "failed"
        table.append((*_where(row), _variant(layout, row), state, *numbers, looks, row.reason or "—"))
    head = (
        "Case",
        "Point",
        "Variant",
        "Status",
        "Quantity",
        "Measured",
        "Exact",
        "Error",
        "Allowed",
        "Looks",
        "Reason",
    )
    return lines + _table(head, table, ("Measured", "Exact", "Error", "Allowed", "Looks"))


def missing(stability: Stability) -> Lines:
    """The section on cases that ptbench cannot show, and cases that the run left out."""
    run = {row.case for row in stability.rows}
    lacking = [(case.shown, case.title, case.missing_feature) for case in stability.cases if case.missing_feature]
    left_out = [case.shown for case in stability.cases if case not in run and not case.missing_feature]
    lines = []
    if lacking:
        lines += ["## Cases that ptbench cannot show", "", *_table(("Case", "What", "Why"), lacking)]
    if left_out:
        lines += ["## Cases without a row in this file", "", ", ".join(left_out) + ".", ""]
    return lines
