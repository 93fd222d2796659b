"""The text of `explain`: one sentence of finding, two small tables, and how reliable their numbers are."""

from collections.abc import Sequence

from ptbench.extras.explain.accounting import ADD_UP_WITHIN, OUTSIDE, PASSES, TRACING, WHOLE, Account, Step
from ptbench.extras.explain.facts import NS_A_RAY, percent, rays_per_spp, same_work, signed
from ptbench.extras.explain.found import Found, Pair
from ptbench.io.axes import LAUNCH
from ptbench.io.cells import Result
from ptbench.io.inspection import KernelCounters, price_of_a_ray
from ptbench.numbers import figures
from ptbench.numbers import ratio as ratio_text
from ptbench.stats.estimates import INTERVAL_TEXT, VERDICT_RULE, interval_of_ratio, telling_digits
from ptbench.studies.disturbed import disturbance_of
from ptbench.studies.withdrawn import between

_METHOD = (
    "Times are ms a sample per pixel (spp). The total is the median of the timed samples. Stages are timed in the "
    "instrumented pass, another render that counts and records events between stages, on a GPU at a cost. The "
    f'differences of the stages, "{OUTSIDE}" (gaps between launches and waits of the host in that pass) and "{PASSES}" '
    "(what the passes differ by) add up to the difference of the medians. Range: where a stage's difference may lie in "
    "the timed samples, if any part of what the passes differ by, from none to all, is in that stage, for any timed "
    "median in its interval; not all stages can be at the ends of theirs together. The instrumented pass is one "
    "render, whose own noise is not known. What differs beside the times goes with the difference; that it causes it, "
    "no file can say."
)

_NO_PART = "—"  # placeholder for the share of a time difference where that is not established

_PROFILED = (
    ", more than 5 % away: the profiled render, another one with its own spp and clocks, does not account for this "
    "difference"
)


def explained(result: Result, names: tuple[str, str], found: Found) -> str:
    """The explanation as Markdown that is also readable in a terminal."""
    lines = [f"# {result.path.name}: where the time differs", ""]
    lines += [f"- A: {names[0]}", f"- B: {names[1]}"]
    lines += [
        f"- Machine {result.about('machine')}; ptbench {result.about('version')}, git {result.git}, "
        f"suite {result.suite or 'none'}, {result.context['date'] or 'no date'}",
        "",
    ]
    for pair in found.pairs:
        lines += _section(pair)
    if found.left_out:
        lines += ["Left out:", "", *(f"- {item}" for item in dict.fromkeys(found.left_out)), ""]
    if found.pairs:
        lines += [_METHOD, "", f"Intervals: {INTERVAL_TEXT}. {VERDICT_RULE}", ""]
    return "\n".join(lines)


def page_of(result: Result, names: tuple[str, str], found: Found, pictures: dict) -> str:
    """The text of explain.md: the explanation with its figures."""
    text = explained(result, names, found)
    for setting, file in pictures.items():
        text = text.replace(f"## {setting}\n", f"## {setting}\n\n![{setting}]({file})\n", 1)
    return text


def _section(pair: Pair) -> list[str]:
    lines = [f"## {pair.setting}", "", finding(pair), ""]
    lines += [f"- Disturbed, {side}: {disturbance_of([cell])}." for side, cell in zip("AB", pair.cells, strict=True)]
    lines += [f"- Withdrawn: {entry.full}" for entry in between(*pair.cells)] + [""]
    lines += [*_table(("", "A", "B", "B - A", "Range", "Part of the difference"), _step_rows(pair)), ""]
    lines += [f"- {text}" for text in how_far(pair)] + [""]
    if pair.facts:
        rows = [(f.quantity, _number(f.a), _number(f.b), f.ratio, f.says) for f in pair.facts]
        lines += [*_table(("What differs", "A", "B", "B / A", "What that can be of the difference"), rows), ""]
    return lines + _counted(pair)


def finding(pair: Pair) -> str:
    """The finding in one sentence, no firmer than the verdict on the times."""
    a, b = pair.labels
    word, said = pair.verdict.word, pair.verdict.said
    totals = f"{figures(pair.accounting.b.total.value)} against {figures(pair.accounting.a.total.value)} ms a spp"
    times = f"{ratio_text(pair.ratio.value)} {interval_of_ratio(pair.ratio) or 'no interval'}"
    because = f" ({said})" if said else ""
    if not pair.has_difference:
        known = "take the same time" if word == "SAME" else "are not known to differ"
        return (
            f"{word}: B ({b}) and A ({a}) {known}, {times} of the time, {totals}{because}: there is nothing to "
            "explain; the differences below cancel or are noise."
        )
    return f"{word}: B ({b}) takes {times} of the time of A ({a}), {totals}{because}; {_where(pair)}."


def _where(pair: Pair) -> str:
    accounting = pair.accounting
    if not (accounting.a.divided or accounting.b.divided):
        stages = ", ".join(dict.fromkeys([*accounting.a.stages, *accounting.b.stages]))
        return f"the file does not divide either ({stages}), so all of it is in that stage{_per_ray(pair)}"
    settled = [step for step in accounting.stages if step.is_settled]
    difference = accounting.difference
    along = sorted((s for s in settled if s.difference * difference > 0), key=lambda s: -abs(s.difference))
    against = sorted((s for s in settled if s.difference * difference < 0), key=lambda s: -abs(s.difference))
    if not along:
        return (
            f"no stage's difference is sure enough to name: the instrumented passes differ from the timed samples by "
            f"{signed(-accounting.a.passes)} (A) and {signed(-accounting.b.passes)} ms (B)"
        )
    verb = "more" if difference > 0 else "less"
    text = "B spends " + " and ".join(_told(step, verb) for step in along)
    if against:
        other = "less" if difference > 0 else "more"
        text += ", but " + " and ".join(_told(step, other) for step in against)
    return text


def _per_ray(pair: Pair) -> str:
    """A sentence on the time per ray, for cells without stage times."""
    price = next((fact for fact in pair.facts if fact.quantity == NS_A_RAY), None)
    if price is None:
        return ""
    rays = "the same rays" if same_work(pair.facts) else "other numbers of rays"
    return f": {rays} at {price.ratio} of the time a ray"


def _told(step: Step, verb: str) -> str:
    low, high = sorted((abs(step.low), abs(step.high)))
    span = figures(low, 3) if figures(low, 3) == figures(high, 3) else f"{figures(low, 3)} to {figures(high, 3)}"
    return f"{span} ms {verb} in {step.name}"


def _step_rows(pair: Pair) -> list[tuple[str, ...]]:
    accounting = pair.accounting
    whole = accounting.difference
    rows = []
    for step in accounting.steps:
        span = f"{signed(step.low)} to {signed(step.high)}" if step.is_stage else "in no stage"
        part = percent(step.difference, whole) if pair.has_difference else _NO_PART
        rows.append((step.name, _ms(step.a), _ms(step.b), signed(step.difference), span, part))
    totals = accounting.a.total.value, accounting.b.total.value
    part = "100 %" if pair.has_difference else _NO_PART
    rows.append(("median of the timed samples", _ms(totals[0]), _ms(totals[1]), signed(whole), "", part))
    return rows


def how_far(pair: Pair) -> list[str]:
    """How the timed and the instrumented pass relate, and how far the table of stages can be trusted."""
    accounting = pair.accounting
    lines = []
    if accounting.merged:
        lines.append(
            "A and B divide tracing and shading differently, so it is one row: "
            f"A has {_tracing(accounting.a)}; B has {_tracing(accounting.b)}."
        )
    for name, account in (("A", accounting.a), ("B", accounting.b)):
        lines.append(_passes(name, account))
    cells = pair.cells
    if cells[0].spp != cells[1].spp:
        lines.append(
            f"A had {cells[0].spp} spp a sample, B {cells[1].spp}: what is done once a sample weighs differently."
        )
    return lines


def _tracing(account: Account) -> str:
    return ", ".join(name for name in account.stages if name in (*TRACING, WHOLE))


def _passes(name: str, account: Account) -> str:
    if not account.divided:
        where = f"one stage ({', '.join(account.stages)})" if account.cell.instrumented else "no instrumented pass"
        text = f"{name} has {where}, so the file does not divide its time: the timed median stands there as a whole"
        if account.instrumented is not None:
            share = account.instrumented / account.total.value
            text += f" (its instrumented pass took {ratio_text(share)} of that)"
        return text + "."
    staged, wall, timed = sum(account.stages.values()), account.instrumented, account.total.value
    own = "within 5 %" if abs(wall - staged) <= ADD_UP_WITHIN * wall else "more than 5 % off"
    text = (
        f"{name}: its stages add up to {_share(staged / wall)} of the instrumented pass's wall time ({own}) and to "
        f"{_share(staged / timed)} of the timed median"
    )
    if account.adds_up:
        return text + " (within 5 %)."
    graph = account.cell.axes.get(LAUNCH, "stream")
    without = f"; that pass ran without the {graph}" if graph != "stream" else ""
    return text + f" (more than 5 % off): they are that pass's times, not the timed samples'{without}."


def _share(part: float) -> str:
    """A share in per cent, with enough digits to show whether it is within 5 % of the whole."""
    limits = [100 * (1 - ADD_UP_WITHIN), 100 * (1 + ADD_UP_WITHIN)]
    digits = telling_digits([100 * part], limits, lambda value, count: f"{value:.{count}f}", least=1)
    return f"{100 * part:.{digits}f} %"


def _counted(pair: Pair) -> list[str]:
    """Hardware counters of `ptbench inspect`, where its files were given and have both variants."""
    if pair.inspected is None:
        return []
    kernels = [
        (f"{side}: {kernel.name}", kernel)
        for side, of in zip("AB", pair.inspected, strict=True)
        for kernel in of.kernels
    ]
    rows = [(name, *_kernel_row(kernel)) for name, kernel in kernels if kernel.bound]
    unseen = [name for name, kernel in kernels if not kernel.bound]
    head = (
        "Kernel (inspect)", "Registers", "Spilled bytes", "Occupancy", "Reached", "Active lanes",
        "Instructions a ray", "Bytes a ray", "Nearest ceiling",
    )  # fmt: skip
    lines = [*_table(head, rows), ""]
    if unseen:
        lines += [f"- Without counters, so not in the table: {', '.join(unseen)}.", ""]
    price = price_of_a_ray(*pair.inspected)
    if price is not None:
        rays = [rays_per_spp(cell) for cell in pair.cells]
        timed = pair.ratio.value * rays[0] / rays[1]
        doubt = "" if abs(price.time / timed - 1) <= ADD_UP_WITHIN else _PROFILED
        lines += [
            f"- Time a ray in those kernels, B over A: {ratio_text(price.time)} = {ratio_text(price.instructions)} "
            f"(instructions a ray) x {ratio_text(price.lanes)} (for active lanes) x {ratio_text(price.issue)} (for the "
            f"share of the issue ceiling). The timed samples have {ratio_text(timed)}{doubt}.",
            "",
        ]
    return lines


def _kernel_row(kernel: KernelCounters) -> tuple[str, ...]:
    reached = (kernel.of_ceiling or {}).get(kernel.bound)
    share = "" if reached is None else f" {100 * reached:.0f} %"
    return (
        str(kernel.registers),
        str(kernel.spill_bytes),
        f"{100 * kernel.occupancy:.0f} %",
        "—" if kernel.achieved_occupancy is None else f"{100 * kernel.achieved_occupancy:.0f} %",
        _number(kernel.active_lanes),
        _number(kernel.thread_instructions_per_ray),
        _number(kernel.memory_bytes_per_ray),
        f"{kernel.bound or '—'}{share}",
    )


def _ms(value: float | None) -> str:
    return "—" if value is None else figures(value)


def _number(value: float | None) -> str:
    if value is None:
        return "—"
    return str(int(value)) if value == int(value) and abs(value) < 1e6 else figures(value)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A Markdown table with padded columns, readable as plain text; the last column is not padded."""
    widths = [max(3, *(len(row[column]) for row in (head, *rows))) for column in range(len(head) - 1)]

    def line(row: Sequence[str]) -> str:
        padded = [
            text.ljust(width) if index == 0 else text.rjust(width)
            for index, (text, width) in enumerate(zip(row[:-1], widths, strict=True))
        ]
        return f"| {' | '.join(padded)} | {row[-1]} |"

    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:]), "---"]
    return [line(head), line(rule), *map(line, rows)]
