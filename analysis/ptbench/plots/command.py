"""`python3 -m ptbench plots`: every study's figure and the summary, from a result file alone."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.registry import collect_study, draw, has_photographs, parts_of_study
from ptbench.figures.saving import DPI, save_figure, save_pictures
from ptbench.found import modules
from ptbench.io.cells import Result
from ptbench.io.files import make_folder, one_line, safe_name, write_text
from ptbench.io.nodes import read_json
from ptbench.io.rays import is_rays, load_rays_folder, rays_of
from ptbench.io.results import result_of
from ptbench.io.stability import Stability, is_stability, stability_of
from ptbench.plots.rays import rays_plots
from ptbench.plots.stability import stability_plots
from ptbench.plots.summary import summary
from ptbench.studies.disturbed import disturbance_in
from ptbench.studies.notes import Note, notes_of
from ptbench.studies.rows import measure
from ptbench.terminal import say


def default_folder(result: Result | Stability) -> Path:
    """The default output folder figures/SUITE beside the file, or SUITE-FILE for a file with another name."""
    stem = result.path.stem
    name = stem if result.suite in ("", stem) else f"{result.suite}-{stem}"
    return result.path.parent / "figures" / safe_name(name)


def _free_name(wanted: str, taken: set[str]) -> str:
    name = safe_name(wanted)
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _save(figure: Figure, folder: Path, name: str, *, is_picture: bool) -> list[Path]:
    if is_picture:
        return [save_pictures(figure, folder / f"{name}.png", DPI)]
    return save_figure(figure, folder, name)


def plots(path: Path, out: Path | None) -> int:
    """Draws all figures of a file into `out` or a folder beside the file; the exit code. Raises InputError.

    A folder as `path` holds files of `ptbench rays`.
    """
    if path.is_dir():
        return rays_plots(*load_rays_folder(path), out if out is not None else path.parent / "figures" / path.name)
    root = read_json(path)
    for other in modules("extras/*/plots.py"):
        if isinstance(root.value, dict) and root.value.get("schema") == other.SCHEMA:
            stem = path.name.partition(".")[0]
            return other.plots(root.value, out if out is not None else path.parent / "figures" / stem)
    if is_rays(root):
        rays = rays_of(root)
        return rays_plots([rays], [], out if out is not None else path.parent / "figures" / path.stem)
    if is_stability(root):
        stability = stability_of(root)
        return stability_plots(stability, out if out is not None else default_folder(stability))
    result = result_of(root)
    folder = out if out is not None else default_folder(result)
    make_folder(folder)
    print(f"disturbed: {disturbance_in(result)}")
    not_drawn: dict[str, list[str]] = {}
    notes: dict[str, Sequence[Note]] = {}
    taken: set[str] = set()
    for study in result.studies:
        not_drawn[study.name] = []
        for part in parts_of_study(study):
            try:
                data = collect_study(result, study, part)
                # Duplicate notes are dropped, since the figures of one study have many in common.
                notes[study.name] = list(dict.fromkeys([*notes.get(study.name, ()), *data.notes]))
            except NotDrawable as reason:
                what = f"{part}: " if part else ""
                not_drawn[study.name].append(f"{what}{reason}")
                say(f"not drawn: {study.name}: {what}{one_line(str(reason))}")
            else:
                name = _free_name(study.name + (f"_{part}" if part else ""), taken)
                with style.applied():
                    for written in _save(draw(data), folder, name, is_picture=has_photographs(study, part)):
                        say(written)
        if study.name not in notes:
            notes[study.name] = notes_of(result, study, measure(result, study))
        for note in notes[study.name]:
            say(f"note: {study.name}: {note.kind}: {one_line(note.full)}")
    if not result.studies:
        say(f"not drawn: {path} has no studies")
    say(write_text(folder / "summary.md", summary(result, not_drawn, notes)))
    return 0
