"""What a study measured, worked out once for its figure and its table: medians, ratios, verdicts, and what is amiss."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, replace

from analysis.disturbed import MOST_DISTURBED
from analysis.results import LATER_AXES, Cell, NotApplicable, Result, Study
from analysis.statistics import (
    CLOCK_UNKNOWN,
    MINIMUM_SAMPLES,
    THRESHOLD,
    Estimate,
    Verdict,
    confirmed,
    median_estimate,
    ratio_estimate,
    verdict_of_ratio,
    withheld,
)
from analysis.withdrawn import among, between


@dataclass(frozen=True)
class Question:
    """The axis, or the tunable, that a figure varies and the choice that all others are held against."""

    axis: str
    baseline: str
    is_tunable: bool = False

    @property
    def shown_baseline(self) -> str:
        return f"{self.axis}={self.baseline}" if self.is_tunable else self.baseline

    def choice_of(self, cell: Cell) -> str:
        value = dimension(cell, self.axis)
        if self.is_tunable:
            return f"no {self.axis}" if value is None else f"{self.axis}={value}"
        return value or "?"


# In the order in which a variant's name spells them. The baselines are those of files that do not name their own.
AXIS_BASELINES = {
    "integrator": "wavefront",
    "compaction": "none",
    "sorting": "none",
    "sort_key": "material",
    "first_bounce": "off",
    "direct_light": "off",
    **LATER_AXES,
    "layout": "aos",
    "specialisation": "features",
    "launch": "stream",
    "arithmetic": "precise",
    "precision": "float",
}

# The axis that a figure is about.
FIGURE_AXES = {
    "sorting_by_depth": "sorting",
    "first_bounce_by_depth": "first_bounce",
    **{axis: axis for axis in AXIS_BASELINES},
    "robustness": "robustness",
}

# What lies along the x axis of the figures that follow a cost: a setting of the cells, their scene or a tunable. They
# are about the first axis that has more than one choice in their study.
SWEPT = {
    "scaling_by_resolution": "resolution",
    "scaling_by_depth": "depth",
    "scaling_by_materials": "scene",
    "scaling_by_shading_fmas": "shading_fmas",
}

# More rows of one scene and depth, or lines of one panel, are split into groups.
MOST_TOGETHER = 8


def question_of(result: Result, study: Study | None) -> Question | None:
    """What the study's figure asks; None where it compares no choices.

    The baseline is the file's own for its backend, or a tunable's standard. A study that was not run with it is held
    against the first choice that it was run with.
    """
    if study is None:
        return None
    cells = result.cells_of(study)
    if is_tunable(result, study):
        tuned = [cell for cell in cells if study.figure in cell.tunables]
        first = next((cell for cell in tuned if study.figure not in cell.tuned), tuned[0])
        return Question(study.figure, str(first.tunables[study.figure]), is_tunable=True)
    axis = _varying_axis(cells) if study.figure in SWEPT else FIGURE_AXES.get(study.figure)
    if axis is None:
        return None
    run = list(dict.fromkeys(cell.axes[axis] for cell in cells if axis in cell.axes))
    baseline = usual_baseline(result, axis)
    # Files that do not name their baselines are older than studies without one.
    if run and baseline not in run and (result.baselines or baseline is None):
        baseline = run[0]
    return Question(axis, baseline or "?")


def is_tunable(result: Result, study: Study) -> bool:
    """Whether the study's figure is named for a tunable, whose values it holds against each other."""
    known = study.figure in FIGURE_AXES or study.figure in SWEPT
    return not known and any(study.figure in cell.tunables for cell in result.cells_of(study))


def usual_baseline(result: Result, axis: str) -> str | None:
    return result.baselines.get(axis) or AXIS_BASELINES.get(axis)


def _varying_axis(cells: Sequence[Cell]) -> str | None:
    names = dict.fromkeys([*AXIS_BASELINES, *(name for cell in cells for name in cell.axes)])
    return next((name for name in names if len({cell.axes.get(name) for cell in cells}) > 1), None)


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


_LAST: list[tuple[Result, dict[str | None, list[Row]]]] = []


def measure(result: Result, study: Study | None) -> list[Row]:
    """Every cell of the study (None: the cells of no study), measured or not, in the file's order.

    Figure and table of a study ask for the same: those of the last file are kept.
    """
    if not _LAST or _LAST[0][0] is not result:
        _LAST[:] = [(result, {})]
    measured = _LAST[0][1]
    name = None if study is None else study.name
    if name not in measured:
        measured[name] = _measure(result, study)
    return list(measured[name])


def _measure(result: Result, study: Study | None) -> list[Row]:
    cells = result.cells_of(study) if study is not None else tuple(cell for cell in result.cells if not cell.studies)
    question = question_of(result, study)
    dimensions = varying_dimensions(cells, question, swept_by(study))
    rows = []
    for cell in cells:
        estimate = rays = ratio = verdict = None
        is_baseline = question is not None and dimension(cell, question.axis) == question.baseline
        if cell.measured:
            estimate = median_estimate(cell.ms_per_spp)
            rays = median_estimate([sample.mega_rays_per_second for sample in cell.samples])
            if question is not None and not is_baseline:
                ratio, verdict = _against_baseline(cell, cells, question)
        compared = question is not None or (study is not None and study.figure in SWEPT)
        label = label_of(cell, question, dimensions) if compared else cell.variant
        rows.append(Row(cell, label, is_baseline, estimate, rays, ratio, verdict))
    return rows


CONTENDED = "other processes took CPU time during more than a tenth of the samples"


def _against_baseline(cell: Cell, cells: Sequence[Cell], question: Question) -> tuple[Estimate | None, Verdict]:
    baseline = baseline_of(cell, cells, question)
    name = f"{question.axis}={question.baseline}"
    if baseline is None:
        return None, Verdict("—", f"no cell with {name} and all else equal")
    if not baseline.measured:
        return None, Verdict("—", f"the baseline {name} has no times ({baseline.status})")
    return time_ratio(cell, baseline)


def time_ratio(
    cell: Cell, baseline: Cell, threshold: float = THRESHOLD, *, one_clock: bool = True
) -> tuple[Estimate, Verdict]:
    """Time of one measured cell over that of another, a sample per pixel, and what that allows to say.

    `one_clock`: both ran on one machine, so that a ratio that is another one in cycles comes from a clock that moved.
    """
    ratio = ratio_estimate(cell.ms_per_spp, baseline.ms_per_spp)
    cycles = cycles_ratio(cell, baseline) if one_clock else None
    in_cycles = None if cycles is None else verdict_of_ratio(cycles, threshold)
    notes = [entry.mark for entry in between(cell, baseline)]
    notes += [CLOCK_UNKNOWN] if one_clock and cycles is None else []
    verdict = replace(confirmed(verdict_of_ratio(ratio, threshold), in_cycles), note="; ".join(notes))
    return ratio, withheld(verdict, CONTENDED) if is_contended(cell) or is_contended(baseline) else verdict


def cycles_ratio(cell: Cell, baseline: Cell) -> Estimate | None:
    """The ratio in cycles of each one's clock; None where a clock was not measured."""
    cycles, baseline_cycles = cell.mega_cycles_per_spp, baseline.mega_cycles_per_spp
    return None if cycles is None or baseline_cycles is None else ratio_estimate(cycles, baseline_cycles)


def is_contended(cell: Cell) -> bool:
    return cell.disturbed_samples > MOST_DISTURBED * len(cell.samples)


# An axis that says how another one's choice works, and the choice with which it says nothing.
_QUALIFIES = {"sort_key": ("sorting", "none")}


def baseline_of(cell: Cell, cells: Iterable[Cell], question: Question) -> Cell | None:
    """The cell that differs in what the question is about only.

    Equal spp is preferred, not required: times are per spp. Tunables that both cells have must be equal, or both at
    their choice's standard (which two choices need not share); those that only the baseline has, at theirs if possible.
    """
    moot = [name for name, idle in _QUALIFIES.items() if idle == (question.axis, question.baseline)]

    def setting(other: Cell) -> tuple:
        axes = {name: choice for name, choice in other.axes.items() if name not in (question.axis, *moot)}
        return other.scene, other.backend, other.depth, other.resolution, axes

    def shared(other: Cell) -> list[str]:
        return [name for name in cell.tunables if name in other.tunables and name != question.axis]

    def equally_tuned(other: Cell) -> bool:
        return all(
            cell.tunables[name] == other.tunables[name] or (name not in cell.tuned and name not in other.tuned)
            for name in shared(other)
        )

    def unlikeness(other: Cell) -> tuple:
        axes = sum(cell.axes.get(name) != other.axes.get(name) for name in moot)
        values = sum(cell.tunables[name] != other.tunables[name] for name in shared(other))
        return axes, values, other.spp != cell.spp, len(other.tuned.keys() - cell.tunables.keys())

    matches = [
        other
        for other in cells
        if dimension(other, question.axis) == question.baseline
        and setting(other) == setting(cell)
        and equally_tuned(other)
    ]
    return min(matches, key=unlikeness, default=None)


def swept_by(study: Study | None) -> str:
    """What tells the points of one line apart."""
    return SWEPT.get(study.figure, "depth") if study is not None else "depth"


def dimension(cell: Cell, name: str) -> str | None:
    """What a cell has of an axis, a setting or a tunable, as text; None: it has no such tunable."""
    settings = {
        "scene": cell.scene,
        "backend": cell.backend,
        "resolution": cell.resolution_text,
        "depth": str(cell.depth),
        "spp": str(cell.spp),
    }
    tunables = {tunable: str(value) for tunable, value in cell.tunables.items()}
    return {**tunables, **cell.axes, **settings}.get(name)


def varying_dimensions(cells: Sequence[Cell], question: Question | None, swept: str = "depth") -> list[str]:
    """What differs between cells of one scene and x besides the question's axis: a label has to say it."""
    axes = dict.fromkeys(name for cell in cells for name in cell.axes)
    tunables = dict.fromkeys(name for cell in cells for name in cell.tunables)
    settings = [name for name in ("backend", "resolution", "depth", "spp") if name != swept]
    varying = []
    for name in [*axes, *settings, *tunables]:
        if name == swept or (question is not None and name == question.axis):
            continue
        groups: dict[tuple, set[str | None]] = {}
        for cell in cells:
            # Two choices may have other standards of one tunable: that alone is no difference to tell.
            choices = tuple(cell.axes.items()) if name in tunables else ()
            groups.setdefault((cell.scene, dimension(cell, swept), choices), set()).add(dimension(cell, name))
        if any(len(values - {None}) > 1 for values in groups.values()):
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


def fixed_tunables(cells: Sequence[Cell], dimensions: Sequence[str]) -> dict[str, list[int]]:
    """The values of the tunables that are no dimension; several where choices have standards of their own."""
    names = dict.fromkeys(name for cell in cells for name in cell.tunables if name not in dimensions)
    return {name: sorted({cell.tunables[name] for cell in cells if name in cell.tunables}) for name in names}


def label_of(cell: Cell, question: Question | None, dimensions: Sequence[str]) -> str:
    """The choice and what else varies; where no choices are compared, what varies."""
    values = ((name, dimension(cell, name)) for name in dimensions)
    others = [f"{name}={value}" for name, value in values if value is not None]
    if question is not None:
        others.insert(0, question.choice_of(cell))
    return ", ".join(others) or cell.axes.get("integrator", cell.variant)


@dataclass(frozen=True)
class Parts:
    """How a figure's cells stand together: in groups that differ in `split`, each cell under its label."""

    split: tuple[str, ...]
    labels: dict[str, str]  # by cell name
    order: tuple[str, ...]  # of the labels: baselines first, then as the file has them, so one colour a choice

    def values(self, cell: Cell) -> tuple[str | None, ...]:
        return tuple(dimension(cell, name) for name in self.split)

    def suffix(self, values: Sequence[str | None]) -> str:
        return "".join(f", {name}={value}" for name, value in zip(self.split, values, strict=True))


def parts_of(
    rows: Sequence[Row],
    question: Question | None,
    swept: str,
    place: Callable[[Row], Hashable],
    within: Sequence[Row],
    split_grids: bool = False,
) -> Parts:
    """How to show `rows`, of which those of one `place` would stand together.

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


def scenes_of(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(row.cell.scene for row in rows))


def notes_of(result: Result, study: Study | None, rows: Sequence[Row]) -> list[Note]:
    """All that keeps a figure or a table from being the whole story: nothing is left out in silence."""
    notes: list[Note] = []
    question = question_of(result, study)
    cells = [row.cell for row in rows]
    if result.interrupted:
        text = "the run was interrupted: cells and samples may be missing"
        notes.append(Note("interrupted run", "Run interrupted: cells and samples may be missing.", text))
    notes += _not_applicable_notes(result, study, question)
    for row in rows:
        if row.cell.failed:
            where = f"{row.label} in {row.cell.scene} at depth {row.cell.depth}"
            short = f"Failed: {where} ({_clipped(_gist(row.cell))})."
            notes.append(Note("failed", short, f"{row.cell.name}: {row.cell.failure}"))
    notes += withdrawn_notes(cells)
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
        if unsure := sum(row.verdict is not None and row.verdict.reason == CONTENDED for row in rows):
            text += f" ({unsure} verdict{'s' if unsure > 1 else ''} UNSURE for that)"
        where = _first([f"{cell.name} ({cell.contended_samples})" for cell in timed if cell.contended_samples])
        notes.append(Note("contended", f"{text}.", f"{text}: {where}"))
    if unknown := [cell for cell in timed if cell.mega_cycles_per_spp is None]:
        text = f"{len(unknown)} of {len(timed)} cells whose clock is unknown: judged in time alone, cycles not compared"
        notes.append(Note("clock unknown", f"{text}.", f"{text}: {_first([cell.name for cell in unknown])}"))
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


def withdrawn_notes(cells: Sequence[Cell]) -> list[Note]:
    """What is withdrawn of the verdicts that these cells give against each other."""
    return [Note("withdrawn", entry.short, entry.full) for entry in among([cell for cell in cells if cell.measured])]


def missed(result: Result, study: Study | None) -> list[NotApplicable]:
    """What was left out of the study, but for variants that were run in it without a tunable that they do not have."""
    run = [(cell.scene, cell.axes) for cell in (result.cells_of(study) if study is not None else ())]
    return [
        item
        for item in result.not_applicable
        if item.study == (study.name if study is not None else "")
        and not (item.has_nothing_to_tune and (item.scene, item.axes) in run)
    ]


def _not_applicable_notes(result: Result, study: Study | None, question: Question | None) -> list[Note]:
    seen: dict[tuple[str, str], list[str]] = {}
    of_study = missed(result, study)
    for item in of_study:
        if not item.elsewhere:
            what = item.axes.get(question.axis, item.variant) if question is not None else item.variant
            scenes = seen.setdefault((what, item.reason), [])
            if item.scene not in scenes:
                scenes.append(item.scene)
    notes = []
    for (what, reason), scenes in seen.items():
        where = f" in {', '.join(scenes)}" if any(scenes) else ""
        notes.append(Note("n/a", f"Not applicable: {what}{where} ({_clipped(reason)}).", f"{what}{where}: {reason}"))
    # A suite may be written for two backends: what only the other one has is no news of this one.
    elsewhere = list(dict.fromkeys(item.elsewhere for item in of_study if item.elsewhere))
    if elsewhere:
        text = f"not on the backend {result.about('backend')}: {', '.join(elsewhere)}"
        notes.append(Note("other backend", f"{text[0].upper()}{text[1:]}.", text))
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


def _gist(cell: Cell) -> str:
    """Why a cell failed, without the cell's own name, with which the GPU's messages begin."""
    head, _, message = cell.failure.partition(": ")
    return message if message and head.startswith(cell.variant) else cell.failure


def _clipped(text: str, length: int = 90) -> str:
    text = " ".join(text.split())
    return text if len(text) <= length else text[: length - 3] + "..."
