"""What a study measured, worked out once for its figure and its table: medians, ratios, verdicts, and what is amiss."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from analysis.results import Cell, Result, Study
from analysis.statistics import (
    MINIMUM_SAMPLES,
    Estimate,
    Verdict,
    confirmed,
    median_estimate,
    ratio_estimate,
    verdict_of_ratio,
)


@dataclass(frozen=True)
class Question:
    """The axis that a figure varies and the choice that all others are held against."""

    axis: str
    baseline: str


AXIS_BASELINES = {
    "integrator": "wavefront",
    "compaction": "none",
    "sorting": "none",
    "first_bounce": "off",
    "direct_light": "off",
    "layout": "aos",
    "specialisation": "features",
}

QUESTIONS = {
    "sorting_by_depth": Question("sorting", "none"),
    "first_bounce_by_depth": Question("first_bounce", "off"),
    **{axis: Question(axis, baseline) for axis, baseline in AXIS_BASELINES.items()},
}


@dataclass(frozen=True)
class Row:
    """One cell of a study and all that is said of it."""

    cell: Cell
    label: str
    is_baseline: bool
    estimate: Estimate | None
    mega_rays_per_second: Estimate | None
    ratio: Estimate | None
    verdict: Verdict | None


@dataclass(frozen=True)
class Note:
    """What a reader of the figure must know: `short` goes under the figure, `full` to stdout and the summary."""

    kind: str
    short: str
    full: str


def measure(result: Result, study: Study | None) -> list[Row]:
    """Every cell of the study (None: the cells of no study), measured or not, in the file's order."""
    cells = result.cells_of(study) if study is not None else tuple(cell for cell in result.cells if not cell.studies)
    question = QUESTIONS.get(study.figure) if study is not None else None
    dimensions = varying_dimensions(cells, question)
    rows = []
    for cell in cells:
        estimate = rays = ratio = verdict = None
        is_baseline = question is not None and cell.axes.get(question.axis) == question.baseline
        if cell.measured:
            estimate = median_estimate(cell.ms_per_spp)
            rays = median_estimate([sample.mega_rays_per_second for sample in cell.samples])
            if question is not None and not is_baseline:
                ratio, verdict = _against_baseline(cell, cells, question)
        rows.append(Row(cell, label_of(cell, question, dimensions), is_baseline, estimate, rays, ratio, verdict))
    return rows


def _against_baseline(cell: Cell, cells: Sequence[Cell], question: Question) -> tuple[Estimate | None, Verdict]:
    baseline = baseline_of(cell, cells, question)
    name = f"{question.axis}={question.baseline}"
    if baseline is None:
        return None, Verdict("—", f"no cell with {name} and all else equal")
    if not baseline.measured:
        return None, Verdict("—", f"the baseline {name} has no times ({baseline.status})")
    ratio = ratio_estimate(cell.ms_per_spp, baseline.ms_per_spp)
    cycles, baseline_cycles = cell.mega_cycles_per_spp, baseline.mega_cycles_per_spp
    in_cycles = None
    if _is_contended(cell) or _is_contended(baseline):
        return ratio, Verdict("UNSURE", "other processes took CPU time during more than a tenth of the samples")
    if cycles is not None and baseline_cycles is not None:
        in_cycles = verdict_of_ratio(ratio_estimate(cycles, baseline_cycles))
    return ratio, confirmed(verdict_of_ratio(ratio), in_cycles)


def _is_contended(cell: Cell) -> bool:
    return cell.contended_samples > 0.1 * len(cell.samples)


def baseline_of(cell: Cell, cells: Iterable[Cell], question: Question) -> Cell | None:
    """The cell that differs in the question's axis only. Equal spp is preferred, not required: times are per spp."""

    def setting(other: Cell) -> tuple:
        axes = {name: choice for name, choice in other.axes.items() if name != question.axis}
        return other.scene, other.backend, other.depth, other.resolution, axes

    matches = [
        other
        for other in cells
        if other.axes.get(question.axis) == question.baseline and setting(other) == setting(cell)
    ]
    return next((other for other in matches if other.spp == cell.spp), matches[0] if matches else None)


def _dimension(cell: Cell, name: str) -> str:
    settings = {"backend": cell.backend, "resolution": cell.resolution_text, "spp": str(cell.spp)}
    return settings[name] if name in settings else cell.axes.get(name, "")


def varying_dimensions(cells: Sequence[Cell], question: Question | None) -> list[str]:
    """What differs between cells of one scene and depth besides the question's axis: a label has to say it."""
    names = list(dict.fromkeys(name for cell in cells for name in cell.axes))
    varying = []
    for name in [*names, "backend", "resolution", "spp"]:
        if question is not None and name == question.axis:
            continue
        groups: dict[tuple, set[str]] = {}
        for cell in cells:
            groups.setdefault((cell.scene, cell.depth), set()).add(_dimension(cell, name))
        if any(len(values) > 1 for values in groups.values()):
            varying.append(name)
    return varying


def fixed_axes(cells: Sequence[Cell], question: Question | None) -> dict[str, str]:
    """The axes that have one choice in all of these cells."""
    names = dict.fromkeys(name for cell in cells for name in cell.axes)
    fixed = {}
    for name in names:
        choices = {cell.axes.get(name, "") for cell in cells}
        if len(choices) == 1 and (question is None or name != question.axis):
            fixed[name] = choices.pop()
    return fixed


def label_of(cell: Cell, question: Question | None, dimensions: Sequence[str]) -> str:
    if question is None:
        return cell.variant
    others = [f"{name}={_dimension(cell, name)}" for name in dimensions]
    return ", ".join([cell.axes.get(question.axis, "?"), *others])


def series_order(rows: Sequence[Row]) -> list[str]:
    """The labels, baselines first, then as the file has them: one order, so one colour a choice in every panel."""
    return list(dict.fromkeys([row.label for row in rows if row.is_baseline] + [row.label for row in rows]))


def scenes_of(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(row.cell.scene for row in rows))


def notes_of(result: Result, study: Study | None, rows: Sequence[Row]) -> list[Note]:
    """All that keeps a figure or a table from being the whole story: nothing is left out in silence."""
    notes: list[Note] = []
    question = QUESTIONS.get(study.figure) if study is not None else None
    cells = [row.cell for row in rows]
    if result.interrupted:
        text = "the run was interrupted: cells and samples may be missing"
        notes.append(Note("interrupted run", "Run interrupted: cells and samples may be missing.", text))
    notes += _not_applicable_notes(result, study, question)
    for row in rows:
        if row.cell.failed:
            where = f"{row.label} in {row.cell.scene} at depth {row.cell.depth}"
            short = f"Failed: {where} ({_clipped(row.cell.failure)})."
            notes.append(Note("failed", short, f"{row.cell.name}: {row.cell.failure}"))
    _note_cells(notes, "interrupted", [c for c in cells if c.status == "interrupted"], "interrupted while measuring")
    without = [c for c in cells if not c.failed and not c.samples]
    _note_cells(notes, "no samples", without, "without a sample")
    timed = [cell for cell in cells if cell.measured]
    _note_cells(
        notes,
        "few samples",
        [cell for cell in timed if len(cell.samples) < MINIMUM_SAMPLES],
        f"with fewer than {MINIMUM_SAMPLES} samples (no verdict)",
        lambda cell: f"n = {len(cell.samples)}",
    )
    low = sum(cell.low_clock_samples for cell in timed)
    if low:
        total = sum(len(cell.samples) for cell in timed)
        text = f"{low} of {total} samples at a low clock, kept"
        where = _first([f"{cell.name} ({cell.low_clock_samples})" for cell in timed if cell.low_clock_samples])
        notes.append(Note("low clock", f"{text}.", f"{text}: {where}"))
    contended = sum(cell.contended_samples for cell in timed)
    if contended:
        total = sum(len(cell.samples) for cell in timed)
        text = f"{contended} of {total} samples while other processes took over a tenth of the CPU, kept"
        where = _first([f"{cell.name} ({cell.contended_samples})" for cell in timed if cell.contended_samples])
        notes.append(Note("contended", f"{text}.", f"{text}: {where}"))
    biased = list(dict.fromkeys(row.label for row in rows if row.cell.claim == "biased" and row.cell.measured))
    if biased:
        text = f"declared biased: {', '.join(biased)}"
        reasons = dict.fromkeys(
            c.reason or c.claim_check for c in timed if c.claim == "biased" and (c.reason or c.claim_check)
        )
        notes.append(
            Note("biased", text[0].upper() + text[1:] + ".", text + (f" ({'; '.join(reasons)})" if reasons else ""))
        )
    for counter in ("nonfinite", "negative", "saturated", "unfinished_walks"):
        what = counter.replace("_", " ") + ("" if counter == "unfinished_walks" else " film values")
        bad = [cell for cell in timed if getattr(cell, counter)]
        _note_cells(notes, counter, bad, f"with {what}", lambda cell, key=counter: str(getattr(cell, key)))
    return notes


def _not_applicable_notes(result: Result, study: Study | None, question: Question | None) -> list[Note]:
    seen: dict[tuple[str, str], list[str]] = {}
    for item in result.not_applicable:
        if item.study == (study.name if study is not None else ""):
            what = item.axes.get(question.axis, item.variant) if question is not None else item.variant
            scenes = seen.setdefault((what, item.reason), [])
            if item.scene not in scenes:
                scenes.append(item.scene)
    notes = []
    for (what, reason), scenes in seen.items():
        where = f" in {', '.join(scenes)}" if any(scenes) else ""
        notes.append(Note("n/a", f"Not applicable: {what}{where} ({_clipped(reason)}).", f"{what}{where}: {reason}"))
    return notes


def _note_cells(notes: list[Note], kind: str, cells: Sequence[Cell], text: str, detail=None) -> None:
    if cells:
        count = f"{len(cells)} cell{'s' if len(cells) > 1 else ''} {text}"
        names = [cell.name + (f" ({detail(cell)})" if detail else "") for cell in cells]
        notes.append(Note(kind, f"{count}.", f"{count}: {_first(names)}"))


def _first(names: Sequence[str], most: int = 3) -> str:
    """The first few: cell names are long, and the summary's table marks every one of them."""
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more, marked in summary.md's table" if rest > 0 else "")


def _clipped(text: str, length: int = 90) -> str:
    text = " ".join(text.split())
    return text if len(text) <= length else text[: length - 3] + "..."
