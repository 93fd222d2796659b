"""How time grows with a parameter of the scene or setting, and from where on one choice overtakes another.

The parameters are pixels, depth, materials, and arithmetic injected into shading. Both axes are logarithmic: equal
slopes are equal growth, and a constant extra cost matters less as the work grows.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from ptbench.errors import NotDrawable
from ptbench.figures import lines
from ptbench.figures import rows as row_figure
from ptbench.figures.caption import timing_caption
from ptbench.figures.declaration import StudyFigure
from ptbench.io.axes import FIRST_BOUNCE, SORTING
from ptbench.io.cells import Cell, Result, Study
from ptbench.studies.groups import in_file_order, parts_of
from ptbench.studies.notes import Note, notes_of
from ptbench.studies.questions import Question, question_of, swept_by
from ptbench.studies.rows import Row, measure


@dataclass(frozen=True)
class Sweep:
    """A swept parameter: with `x`, its value in a cell, and a panel per scene; without `x`, scenes are swept."""

    title: str
    quantity: str
    unit: str
    said: Callable[[str], str]  # words for the label of a tick on the axis of the swept parameter
    x: Callable[[Cell], int | None] | None = None
    tick: Callable[[Cell], str] | None = None
    overtaking: bool = True  # whether growth is shown: logarithmic axes, and a caption that tells overtakings


def _size(cell: Cell) -> str:
    width, height = cell.resolution
    return f"{width}²" if width == height else f"{width}×{height}"


def _pixels(tick: str) -> str:
    return re.sub(r"(\d+)²", r"\1×\1", tick) + " pixels"


def _materials(count: str) -> str:
    return f"{count} material" + ("" if count == "1" else "s")


SWEEPS = {
    "scaling_by_resolution": Sweep(
        "Time by image size", "Image size", "pixels", _pixels, lambda cell: cell.pixels, _size
    ),
    "scaling_by_depth": Sweep(
        "Time by path depth", "Path depth", "ray segments", "depth {}".format, lambda cell: cell.depth
    ),
    "scaling_by_materials": Sweep("Time by number of materials", "Materials in the scene", "", _materials),
    "scaling_by_shading_fmas": Sweep(
        "Time by cost of shading",
        "Multiply-adds injected into a shading",
        "",
        "{} multiply-adds".format,
        lambda cell: cell.tunables.get("shading_fmas"),
    ),
}
# Figures over the path depth for two axes, sorting and first-bounce cache: what each choice costs or saves by depth.
_BY_DEPTH = {
    f"{axis}_by_depth": Sweep(
        title, "Path depth", "ray segments", "depth {}".format, lambda cell: cell.depth, overtaking=False
    )
    for axis, title in (
        (SORTING, "Material sorting: time by depth"),
        (FIRST_BOUNCE, "First-bounce cache: time by depth"),
    )
}
_BY_ORDER = Sweep("", "Scene, by its number in the caption", "", "{}".format)


@dataclass(frozen=True)
class Place:
    """The panel of a cell and its value in a sweep; `x` is None where the cell lacks the parameter."""

    panel: str
    x: int | None


def numbered_scenes(scenes: Sequence[str]) -> dict[str, Place] | None:
    """Places by the number at the end of each scene's name: `materials_08` is 8 of `materials`; None: some lack one."""
    places = {}
    for scene in dict.fromkeys(scenes):
        match = re.fullmatch(r"(.*?)[_-]?(\d+)", scene)
        if not match or int(match[2]) == 0:
            return None
        places[scene] = Place(match[1] or "scenes", int(match[2]))
    return places if len(set(places.values())) == len(places) else None


def _places(sweep: Sweep, rows: Sequence[Row]) -> tuple[Sweep, dict[str, Place]]:
    """The sweep along x, and every cell's place in it, by cell name."""
    if sweep.x is not None:
        return sweep, {row.cell.name: Place(row.cell.scene, sweep.x(row.cell)) for row in rows}
    scenes = list(dict.fromkeys(row.cell.scene for row in rows))
    by_scene = numbered_scenes(scenes)
    if by_scene is None:
        sweep = _BY_ORDER
        by_scene = {scene: Place("scenes in the study's order", number) for number, scene in enumerate(scenes, 1)}
    return sweep, {row.cell.name: by_scene[row.cell.scene] for row in rows}


def collect(result: Result, study: Study, sweep: Sweep) -> lines.Data | row_figure.Data:
    """The data of lines over the swept parameter, or of rows where it has one value; raises NotDrawable."""
    question = question_of(result, study)
    rows = measure(result, study)
    notes = notes_of(result, study, rows)
    timed = [row for row in rows if row.estimate is not None]
    if not timed:
        raise NotDrawable("no cell has times: " + ("; ".join(note.full for note in notes) or "no samples"))
    title = study.title or sweep.title
    sweep, places = _places(sweep, rows)
    drawn = [row for row in timed if places[row.cell.name].x is not None]
    if not drawn:
        raise NotDrawable(f"no cell has what {study.figure} follows")
    if len(drawn) < len(timed):
        text = f"{len(timed) - len(drawn)} of {len(timed)} cells have no place along x"
        notes.append(Note("no place", f"{text}.", text))
    if len({places[row.cell.name] for row in drawn}) == len({places[row.cell.name].panel for row in drawn}):
        if question is None:
            raise NotDrawable("all cells have one x and one choice: there is no line to draw and nothing to compare")
        return row_figure.collect(result, study, title)

    parts = parts_of(drawn, question, swept_by(study), lambda row: places[row.cell.name], rows)
    by_panel: dict[tuple, list[tuple[int, Row]]] = {}
    for row in drawn:
        place = places[row.cell.name]
        by_panel.setdefault((place.panel, *parts.values(row.cell)), []).append((place.x, row))
    panels = [
        lines.panel_of(key[0] + parts.suffix(key[1:]), by_panel[key], parts, with_crossovers=sweep.overtaking)
        for key in in_file_order(by_panel)
    ]
    cells = {places[row.cell.name].x: row.cell for row in drawn}
    ticks = {x: sweep.tick(cell) for x, cell in cells.items()} if sweep.tick else {}
    abscissa = lines.Abscissa(sweep.quantity, sweep.unit, ticks, log=sweep.overtaking and sweep is not _BY_ORDER)
    remarks = []
    if sweep is _BY_ORDER:
        remarks.append("Scenes: " + ", ".join(f"{x} {cell.scene}" for x, cell in sorted(cells.items())) + ".")
    told = list(notes)
    if question is not None and sweep.overtaking:
        named = {x: cell.scene if sweep is _BY_ORDER else sweep.said(abscissa.tick(x)) for x, cell in cells.items()}
        words = [crossover_words(panel, named) for panel in panels]
        rule = f"the first x from which on the whole interval of a ratio to {_named(question)} is below 1"
        remarks.append(f"Crossover: {rule}; ringed, unless it is the first of all. {' '.join(f'{w}.' for w in words)}")
        notes += [Note("crossover", f"{text}.", text) for text in words]
    caption = timing_caption(result, study, [row.cell for row in drawn], question, told, remarks)
    baseline = "" if question is None else _named(question)
    return lines.Data(
        title, caption, tuple(notes), baseline, parts.order, tuple(panels), abscissa, log_times=sweep.overtaking
    )


def crossover_words(panel: lines.Panel, named: dict[int, str]) -> str:
    """A panel's crossovers in words, the earliest first; lines without a crossover are named as well."""
    found: dict[tuple[int, str], list[str]] = {}
    none, unknown = [], []
    for line in panel.lines:
        if line.is_baseline:
            continue
        if line.crossover is None:
            unknown.append(line.label)
            continue
        doubts = list(line.crossover.doubts)
        if line.crossover.missing:
            doubts.append(f"no ratio at {', '.join(named[x] for x in line.crossover.missing)}")
        doubted = f" ({'; '.join(doubts)})" if doubts else ""
        if line.crossover.x is None:
            none.append(line.label + doubted)
        else:
            first = ", the first measured" if line.crossover.is_first else ""
            where = f"from {named[line.crossover.x]}{first}{doubted}"
            found.setdefault((line.crossover.x, where), []).append(line.label)
    parts = [f"{_listed(labels)} {where}" for (_, where), labels in sorted(found.items(), key=lambda item: item[0][0])]
    if none:
        parts.append("no crossover in the range measured: " + _listed(none))
    if unknown:
        parts.append("no ratio: " + _listed(unknown))
    return f"{panel.title}: " + ("; ".join(parts) or "the baseline only")


def _listed(labels: Sequence[str]) -> str:
    # Labels are listed with bars between them if any contains a comma, else with commas.
    return (" | " if any("," in label for label in labels) else ", ").join(labels)


def _named(question: Question) -> str:
    return f"{question.axis}={question.baseline}"


FIGURES = tuple(StudyFigure(name, partial(collect, sweep=sweep)) for name, sweep in (_BY_DEPTH | SWEEPS).items())
