"""`python3 -m analysis plots`: every study's figure and the summary, from a result file alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from analysis import style
from analysis.errors import NotDrawable
from analysis.figures import collect_study, draw_study
from analysis.files import make_folder, one_line, safe_name, write_text
from analysis.results import Result, load
from analysis.saving import save_figure
from analysis.studies import Note, measure, notes_of
from analysis.summary import summary


def default_folder(result: Result) -> Path:
    """figures/SUITE beside the file; files of one suite under other names get folders of their own."""
    stem = result.path.stem
    name = stem if result.suite in ("", stem) else f"{result.suite}-{stem}"
    return result.path.parent / "figures" / safe_name(name)


def plots(path: Path, out: Path | None) -> int:
    result = load(path)
    folder = out if out is not None else default_folder(result)
    make_folder(folder)
    not_drawn: dict[str, str] = {}
    notes: dict[str, Sequence[Note]] = {}
    taken: set[str] = set()
    for study in result.studies:
        try:
            data = collect_study(result, study)
            notes[study.name] = data.notes
        except NotDrawable as reason:
            not_drawn[study.name] = str(reason)
            notes[study.name] = notes_of(result, study, measure(result, study))
            print(f"not drawn: {study.name}: {one_line(str(reason))}")
        else:
            name = safe_name(study.name)
            while name in taken:
                name += "_"
            taken.add(name)
            with style.applied():
                for written in save_figure(draw_study(study, data), folder, name):
                    print(written)
        for note in notes[study.name]:
            print(f"note: {study.name}: {note.kind}: {one_line(note.full)}")
    if not result.studies:
        print(f"not drawn: {path} has no studies")
    print(write_text(folder / "summary.md", summary(result, not_drawn, notes)))
    return 0
