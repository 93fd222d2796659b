"""Captions of figures, complete enough that a figure can be understood outside of its paper."""

from collections.abc import Sequence

from ptbench.io.cells import Cell, Result, Study
from ptbench.numbers import plural, span
from ptbench.stats.estimates import INTERVAL_TEXT
from ptbench.studies.gpu import KERNEL_AXES, gpu_line
from ptbench.studies.notes import Note
from ptbench.studies.questions import Question, fixed_axes, fixed_tunables, swept_by, varying_dimensions

# Notes of one kind beyond this number are only counted under the figure; stdout and summary.md list all.
SHOWN_NOTES_A_KIND = 3


def timing_caption(
    result: Result,
    study: Study,
    cells: Sequence[Cell],
    question: Question | None,
    notes: Sequence[Note],
    remarks: Sequence[str] = (),
) -> str:
    """The caption of a figure of times: how to read it, what was run on which machine, and notes."""
    n = span(len(cell.samples) for cell in cells)
    what = (
        f"Points: median render wall time per sample per pixel, n = {n} samples each. Bars: {INTERVAL_TEXT}, hidden "
        "where smaller than the marker"
    )
    if question is not None:
        what += f"; ratios: medians over that of {question.axis}={question.baseline}, both sides resampled"
    return "\n".join([f"{what}.", *remarks, setting(result, cells, question, study), *note_lines(notes)])


def setting(
    result: Result,
    cells: Sequence[Cell],
    question: Question | None = None,
    study: Study | None = None,
    *,
    told: bool = True,
) -> str:
    """The setting part of a caption: what was run on which machine; without a study variants are named if `told`."""
    resolutions = ", ".join(dict.fromkeys(cell.resolution_text.replace("x", "×") for cell in cells))
    scenes = list(dict.fromkeys(cell.scene for cell in cells))
    backends = ", ".join(dict.fromkeys(cell.backend for cell in cells))
    gpu = gpu_line(result, cells)
    if not told:
        fixed = ""
    elif study is None:
        fixed = "variant " + ", ".join(dict.fromkeys(cell.variant for cell in cells))
    else:
        fixed = _fixed(cells, question, study, told=KERNEL_AXES if gpu else ())
    machine = f"Machine {result.about('machine')}: "
    if not gpu:
        machine += f"{result.about('cpu_model')}, {plural(result.about('threads'), 'thread')}, "
    parts = [
        f"Scene{'s' if len(scenes) > 1 else ''} {', '.join(scenes)}; {resolutions} pixels; "
        f"{span(cell.spp for cell in cells)} spp a sample; depth {span(cell.depth for cell in cells)}"
        + (f"; {fixed}." if fixed else "."),
        f"{machine}backend {backends}; "
        f"ptbench {result.about('version')}, git {result.git}, suite {result.suite or 'none'}, "
        f"{result.context['date'] or 'no date'}.",
    ]
    return " ".join(parts) + (f"\n{gpu}" if gpu else "")


def _fixed(cells: Sequence[Cell], question: Question | None, study: Study, told: Sequence[str]) -> str:
    axes = [f"{axis}={choice}" for axis, choice in fixed_axes(cells, question).items() if axis not in told]
    varying = [*varying_dimensions(cells, question, swept_by(study)), swept_by(study)]
    if question is not None:
        varying.append(question.axis)
    tunables = [
        f"{name}={' or '.join(map(str, values))}{' by choice' if len(values) > 1 else ''}"
        for name, values in fixed_tunables(cells, varying).items()
    ]
    return ", ".join(axes) + ("; tunables " + ", ".join(tunables) if tunables else "")


def captioned(
    what: str, result: Result, cells: Sequence[Cell], notes: Sequence[Note], study: Study | None = None
) -> str:
    """The caption of a figure: how to read it, what was run on which machine, and notes."""
    return "\n".join([what, setting(result, cells, None, study), *note_lines(notes)])


def note_lines(notes: Sequence[Note]) -> list[str]:
    """A caption's notes as one paragraph; empty without notes."""
    shown: list[str] = []
    for kind in dict.fromkeys(note.kind for note in notes):
        shorts = [note.short for note in notes if note.kind == kind]
        shown += shorts[:SHOWN_NOTES_A_KIND]
        if len(shorts) > SHOWN_NOTES_A_KIND:
            shown.append(f"And {len(shorts) - SHOWN_NOTES_A_KIND} more {kind} (see summary.md).")
    return ["Note: " + " ".join(shown)] if shown else []
