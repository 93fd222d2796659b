"""The tables of a convergence study in summary.md: verdicts, costs, slopes, errors, and the cost of checkpoints."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ptbench.convergence.assessment import RULES, Assessment, assess
from ptbench.convergence.efficiency import (
    DISTURBED,
    EFFICIENCY_RULE,
    Compared,
    Place,
    baseline_among,
    by_place,
    checkpoint_costs,
    compare,
    ends_beside_one,
    names_in,
    target_of,
    time_to,
)
from ptbench.convergence.last_errors import ERRORS, LastErrors, last_errors
from ptbench.document.blocks import Lines
from ptbench.document.table import Table
from ptbench.io.cells import Result, Study
from ptbench.numbers import figures, ratio
from ptbench.stats.estimates import Estimate
from ptbench.studies.withdrawn import between

_NONE = "—"
_CLOCK_NAMES = {"wall_ms": "Wall", "device_ms": "Device", "cpu_ms": "CPU"}


def convergence_rules(result: Result) -> list[str]:
    """Sentences on how errors were fitted and judged; nothing where no errors were measured."""
    if all(cell.convergence is None for cell in result.cells):
        return []
    return ["\n\n".join((*RULES, EFFICIENCY_RULE)), ""]


def convergence_tables(result: Result, study: Study) -> Lines:
    """All numbers that the figures of a convergence study show, scene by scene."""
    assessed, shown = assess(result), {cell.name: cell.shown for cell in result.cells}
    members = [assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed]
    lines: Lines = []
    places = by_place(members)
    for place, group in places.items():
        lines += [f"### {place.title(list(places))}", "", _reference_line(group, place), ""]
        baseline = baseline_among(result, group)
        names = names_in(group, baseline)
        if baseline is not None:
            lines += [f"Baseline: `{baseline.cell.variant}` ({names[baseline.cell.name]}).", ""]
        for table in (_verdicts(group, names, shown), _slopes(group, names), _errors(group, names)):
            lines += [*table, ""]
        lines += [*_costs(group, names, baseline), ""]
        lines += [*_at_the_end(group, names, baseline), ""]
        if costs := checkpoint_costs(group):
            lines += ["Render wall time per spp with checkpoints over that without, 95 % bootstrap of the medians:", ""]
            rows = [
                [names[cost.cell.name], ratio(cost.ratio.value), cost.interval or _NONE, cost.word] for cost in costs
            ]
            lines += [*_table(("Variant", "Ratio", "95 % interval", ""), rows, "lrrl"), ""]
    return lines


def _reference_line(group: Sequence[Assessment], place: Place) -> str:
    texts = []
    for one in group:
        reference = one.curve.reference
        if reference.is_exact:
            texts.append(f"closed form{f' `{reference.formula}`' if reference.formula else ''}")
        else:
            texts.append(
                f"two halves of {reference.spp_per_half} spp each by {reference.variant or 'an unnamed variant'}, "
                f"variance "
                f"{reference.variance:.3g} (error {math.sqrt(reference.variance):.3g}), mean square "
                f"{reference.mean_square:.4g}"
            )
    return f"Reference of {place.scene}: {'; '.join(dict.fromkeys(texts))}."


def _verdicts(group: Sequence[Assessment], names: dict[str, str], shown: Mapping[str, str]) -> Lines:
    """The table of convergence verdicts; `shown` maps a cell's name in the file to the one that readers see."""
    head = (
        "Variant",
        "Verdict",
        "K",
        "bias²",
        "95 % interval",
        "bias² of the fit",
        "σ²",
        "95 % interval",
        "N*",
        "Mean error RGB",
        "Remarks",
    )
    return _table(head, [_verdict_row(one, names[one.cell.name], shown) for one in group], "llrrrrrrrrl")


def _verdict_row(one: Assessment, name: str, shown: Mapping[str, str]) -> list[str]:
    fit, origin = one.fit, one.cell.convergence.shared_with
    remarks = [text for text in (one.verdict.reason, *one.doubts) if text]
    if origin:
        remarks.append(f"errors measured once, by {shown.get(origin, origin)}")
    if fit is None:
        return [name, one.verdict.text, str(one.curve.count), *[_NONE] * 7, "; ".join(remarks)]
    crossing = one.crossing_spp
    if one.curve.independent and one.cell.convergence.biases and one.verdict.plateau is None:
        remarks.append(f"declared bias not found: {'; '.join(one.cell.convergence.biases)}")
    sigma2 = [f"{fit.sigma2.value:.4g}", _small(fit.sigma2)] if one.curve.independent else [_NONE, _NONE]
    return [
        name,
        f"**{one.verdict.text}**",
        str(one.curve.count),
        f"{fit.bias2.value:.3g}",
        _small(fit.bias2),
        f"{fit.bias2_of_fit.value:.3g}",
        *sigma2,
        _NONE if crossing is None else f"{crossing:.3g}",
        ", ".join(f"{channel.value:+.2g}" for channel in fit.mean_error) or _NONE,
        "; ".join(remarks),
    ]


def _slopes(group: Sequence[Assessment], names: dict[str, str]) -> Lines:
    """The table of log-log error slopes, overall and by octave, marked where the test rejects a slope of -1."""
    octaves = sorted({(octave.first, octave.last) for one in group if one.fit for octave in one.fit.octaves})
    head = ("Slope of", "over all", "95 % interval", "p of -1", "", *(f"{first}-{last}" for first, last in octaves))
    rows = []
    for one in group:
        if one.fit is None or one.fit.slope is None:
            continue
        slope = one.fit.slope
        word = "rejected" if slope.rejected else "-1 holds" if one.curve.independent else "at least as steep as -1"
        by_octave = {(octave.first, octave.last): _octave_text(octave.estimate) for octave in one.fit.octaves}
        rows.append(
            [
                names[one.cell.name],
                f"{slope.estimate.value:.4f}",
                f"[{slope.estimate.low:.4f}, {slope.estimate.high:.4f}]",
                f"{slope.p:.2g}" + ("" if one.curve.independent else " (one-sided)"),
                word + (", flatter" if slope.is_flatter else ", steeper" if slope.rejected else ""),
                *(by_octave.get(octave, _NONE) for octave in octaves),
            ]
        )
    return _table(head, rows, "lrrrl" + "r" * len(octaves))


def _octave_text(estimate: Estimate) -> str:
    return f"{estimate.value:.3f} ± {(estimate.high - estimate.low) / 2:.3f}"


def _errors(group: Sequence[Assessment], names: dict[str, str]) -> Lines:
    head = (
        "Errors at the last checkpoint",
        "spp",
        "MSE dual",
        "MSE",
        "relMSE dual",
        "relMSE",
        "SMAPE",
        "ME / root mean square",
    )
    rows = []
    for one in group:
        last = [sample.checkpoints[-1] for sample in one.cell.samples if len(sample.checkpoints) == len(one.curve.spp)]
        if not last:
            continue

        def mean(metric: str, last: list = last) -> str:
            values = [checkpoint.errors[metric] for checkpoint in last]
            return _NONE if None in values else f"{np.mean(values):.4g}"

        root = math.sqrt(one.curve.reference.mean_square)
        mean_error = (
            [np.mean([checkpoint.mean_error for checkpoint in last])] if one.curve.mean_error is not None else []
        )
        share = f"{100 * mean_error[0] / root:+.3g} %" if mean_error and root > 0 else _NONE
        metrics = (mean(metric) for metric in ("mse_dual", "mse", "rel_mse_dual", "rel_mse", "smape"))
        rows.append([names[one.cell.name], f"{int(one.curve.spp[-1])}", *metrics, share])
    return _table(head, rows, "lrrrrrrr")


def _costs(group: Sequence[Assessment], names: dict[str, str], baseline: Assessment | None) -> Lines:
    target = target_of(group)
    clocks = [clock for clock in _CLOCK_NAMES if any(clock in one.ms_per_spp for one in group)]
    head = (
        "Variant", *(f"{_CLOCK_NAMES[clock]} ms/spp" for clock in clocks), "σ² × ms/spp", "95 % interval",
        "Efficiency", "95 % interval", "ms to RMSE " + (f"{target:g}" if target else "?"), "95 % interval",
    )  # fmt: skip
    rows = []
    for one in group:
        compared = compare(one, baseline)
        time = time_to(one, target) if target is not None else None
        efficiency = None if compared is None else compared.efficiency
        rows.append(
            [
                names[one.cell.name],
                *(_value(one.ms_per_spp.get(clock), figures) for clock in clocks),
                _value(None if compared is None else compared.work, lambda value: f"{value:.4g}"),
                _NONE if compared is None else _small(compared.work),
                "baseline" if one is baseline else _efficiency(compared, one, baseline),
                _NONE if efficiency is None else (ends_beside_one(efficiency) or _NONE),
                _value(time, _time),
                _NONE if time is None or time.low is None else f"[{_time(time.low)}, {_time(time.high)}]",
            ]
        )
    return _table(head, rows, "l" + "r" * (len(head) - 1))


def _at_the_end(group: Sequence[Assessment], names: dict[str, str], baseline: Assessment | None) -> Lines:
    """The table of errors at the last checkpoint and their efficiency by MSE and relMSE, as a run prints it."""
    errors = last_errors(group)
    if baseline is None or baseline.cell.name not in errors:
        return []
    base = errors[baseline.cell.name]
    head = ["Variant", "Last spp"]
    for metric in ERRORS:
        head += [f"{metric} there", "Efficiency by it", "95 % interval"]
    rows = []
    for one in group:
        if (own := errors.get(one.cell.name)) is None:
            continue
        row = [names[one.cell.name], str(one.cell.spp)]
        for metric in ERRORS:
            row += [f"{own.mean(metric):.3g}", *_efficiency_by(metric, own, base)]
        rows.append(row)
    return _table(head, rows, "l" + "r" * (len(head) - 1))


def _efficiency_by(metric: str, own: LastErrors, base: LastErrors) -> tuple[str, str]:
    if own is base:
        return "baseline", _NONE
    efficiency = own.efficiency(base, metric)
    if efficiency is None:
        return _NONE, _NONE
    marks = ["withdrawn"] if between(own.cell, base.cell) else []
    marks += [DISTURBED] if own.doubt(base) else []
    mark = f" ({', '.join(marks)})" if marks else ""
    return figures(efficiency.value, 3) + mark, ends_beside_one(efficiency) or _NONE


def _efficiency(compared: Compared | None, one: Assessment, baseline: Assessment | None) -> str:
    if compared is None or compared.efficiency is None or baseline is None:
        return _NONE
    marks = ["withdrawn"] if between(one.cell, baseline.cell) else []
    marks += [DISTURBED] if compared.doubt else []
    return figures(compared.efficiency.value, 3) + (f" ({', '.join(marks)})" if marks else "")


def _value(estimate: Estimate | None, text: Callable[[float], str]) -> str:
    return _NONE if estimate is None else text(estimate.value)


def _time(value: float) -> str:
    return figures(value) if math.isfinite(value) else "never"


def _small(estimate: Estimate) -> str:
    """A confidence interval as text, for numbers that may be far below 1 or negative."""
    return _NONE if estimate.low is None else f"[{estimate.low:.3g}, {estimate.high:.3g}]"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], sides: str) -> Lines:
    """A table as Markdown lines; empty where there are no rows."""
    return [Table(tuple(head), tuple(map(tuple, rows)), tuple(side == "r" for side in sides))] if rows else []
