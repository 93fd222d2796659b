"""The captions: all that a reader needs to trust a figure that was cut out of its paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from analysis.results import Cell, Result
from analysis.statistics import INTERVAL_TEXT
from analysis.studies import Note, Question, fixed_axes

# More of one kind are only counted under the figure; stdout and summary.md have all of them.
SHOWN_NOTES_A_KIND = 3


def span(values: Iterable[int], unit: str = "") -> str:
    """ "4", "1 to 8": the range of a setting."""
    ordered = sorted(set(values))
    text = str(ordered[0]) if len(ordered) == 1 else f"{ordered[0]} to {ordered[-1]}"
    return f"{text} {unit}".strip()


def timing_caption(result: Result, cells: Sequence[Cell], question: Question, notes: Sequence[Note]) -> str:
    n = span(len(cell.samples) for cell in cells)
    what = (
        f"Points: median render wall time per sample per pixel, n = {n} samples each. Bars: {INTERVAL_TEXT}, hidden "
        "where smaller than the marker; "
        f"ratios: medians over that of {question.axis}={question.baseline}, both sides resampled."
    )
    return "\n".join([what, setting(result, cells, question), *note_lines(notes)])


def setting(result: Result, cells: Sequence[Cell], question: Question | None) -> str:
    """What was run, on what; without a question its variants are named whole."""
    resolutions = ", ".join(dict.fromkeys(cell.resolution_text.replace("x", "×") for cell in cells))
    scenes = list(dict.fromkeys(cell.scene for cell in cells))
    backends = ", ".join(dict.fromkeys(cell.backend for cell in cells))
    gpu = result.context.get("ptbench.gpu_name") or result.context.get("ptbench.gpu")
    if question is None:
        fixed = "variant " + ", ".join(dict.fromkeys(cell.variant for cell in cells))
    else:
        fixed = ", ".join(f"{axis}={choice}" for axis, choice in fixed_axes(cells, question).items())
    parts = [
        f"Scene{'s' if len(scenes) > 1 else ''} {', '.join(scenes)}; {resolutions} pixels; "
        f"{span(cell.spp for cell in cells)} spp a sample; depth {span(cell.depth for cell in cells)}"
        + (f"; {fixed}." if fixed else "."),
        f"Machine {result.about('machine')}: " + (f"{gpu}, " if gpu else "") + f"{result.about('cpu_model')}, "
        f"{result.about('threads')} threads, backend {backends}; "
        f"ptbench {result.about('version')}, git {result.git}, suite {result.suite or 'none'}, "
        f"{result.context['date'] or 'no date'}.",
    ]
    return " ".join(parts)


def note_lines(notes: Sequence[Note]) -> list[str]:
    """The notes as one paragraph, or nothing."""
    shown: list[str] = []
    for kind in dict.fromkeys(note.kind for note in notes):
        shorts = [note.short for note in notes if note.kind == kind]
        shown += shorts[:SHOWN_NOTES_A_KIND]
        if len(shorts) > SHOWN_NOTES_A_KIND:
            shown.append(f"And {len(shorts) - SHOWN_NOTES_A_KIND} more {kind} (see summary.md).")
    return ["Note: " + " ".join(shown)] if shown else []
