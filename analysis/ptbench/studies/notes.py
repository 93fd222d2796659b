"""Notes on everything that limits what a figure or table of a study shows."""

from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.io.cells import Cell, NotApplicable, Result, Study
from ptbench.io.limits import limit_said
from ptbench.stats.estimates import MINIMUM_SAMPLES
from ptbench.studies.disturbed import CONTENDED, THROTTLED
from ptbench.studies.questions import Question, question_of
from ptbench.studies.rows import Row
from ptbench.studies.withdrawn import among


@dataclass(frozen=True)
class Note:
    """A note for readers of a figure: `short` goes below the figure, `full` to stdout and the summary."""

    kind: str
    short: str
    full: str


def notes_of(result: Result, study: Study | None, rows: Sequence[Row]) -> list[Note]:
    """All notes on a study's figure or table, so that nothing is omitted silently."""
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
            notes.append(Note("failed", short, f"{row.cell.shown}: {row.cell.failure}"))
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
        where = _first([f"{cell.shown} ({cell.low_clock_samples})" for cell in timed if cell.low_clock_samples])
        notes.append(Note("low clock", f"{text}.", f"{text}: {where}"))
    contended = sum(cell.contended_samples for cell in timed)
    if contended:
        total = sum(len(cell.samples) for cell in timed)
        who = f"other processes took over {limit_said('most_foreign_share')} of the CPU"
        if throttled := sum(cell.throttled_samples for cell in timed):
            who += f" or a quota was used up ({throttled})"
        text = f"{contended} of {total} samples while {who}, kept"
        if unsure := sum(row.verdict is not None and row.verdict.reason in (CONTENDED, THROTTLED) for row in rows):
            text += f" ({unsure} verdict{'s' if unsure > 1 else ''} UNSURE for that)"
        where = _first([f"{cell.shown} ({cell.contended_samples})" for cell in timed if cell.contended_samples])
        notes.append(Note("contended", f"{text}.", f"{text}: {where}"))
    if unknown := [cell for cell in timed if cell.mega_cycles_per_spp is None]:
        text = f"{len(unknown)} of {len(timed)} cells whose clock is unknown: judged in time alone, cycles not compared"
        notes.append(Note("clock unknown", f"{text}.", f"{text}: {_first([cell.shown for cell in unknown])}"))
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
    """Notes on withdrawn verdicts between these cells."""
    return [Note("withdrawn", entry.short, entry.full) for entry in among([cell for cell in cells if cell.measured])]


def missed(result: Result, study: Study | None) -> list[NotApplicable]:
    """The omitted variants of a study, except those run without a tunable that they do not have."""
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
    # Choices that only another backend has are just listed, because a suite may be written for two backends.
    elsewhere = list(dict.fromkeys(item.elsewhere for item in of_study if item.elsewhere))
    if elsewhere:
        text = f"not on the backend {result.about('backend')}: {', '.join(elsewhere)}"
        notes.append(Note("other backend", f"{text[0].upper()}{text[1:]}.", text))
    return notes


def _note_cells(notes: list[Note], kind: str, cells: Sequence[Cell], text: str, detail=None) -> None:
    if cells:
        count = f"{len(cells)} cell{'s' if len(cells) > 1 else ''} {text}"
        names = [cell.shown + (f" ({detail(cell)})" if detail else "") for cell in cells]
        notes.append(Note(kind, f"{count}.", f"{count}: {_first(names)}"))


def _first(names: Sequence[str], most: int = 3) -> str:
    """The first few of many cell names, as the summary's table marks all of these cells."""
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more, marked in summary.md's table" if rest > 0 else "")


def _gist(cell: Cell) -> str:
    """The reason why a cell failed, without the cell's name, with which messages of the GPU begin."""
    head, _, message = cell.failure.partition(": ")
    names = (cell.variant, cell.variant_in_file)
    return message if message and head.startswith(names) else cell.failure


def _clipped(text: str, length: int = 90) -> str:
    text = " ".join(text.split())
    return text if len(text) <= length else text[: length - 3] + "..."
