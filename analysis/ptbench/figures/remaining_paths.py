"""The figure of paths alive after each bounce, one line per scene: an open box loses paths, a closed one keeps them."""

import math
from dataclasses import dataclass

from matplotlib.figure import Figure

from ptbench import numbers
from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.caption import captioned
from ptbench.figures.declaration import StudyFigure
from ptbench.io.cells import Cell, Result, Study
from ptbench.studies.notes import Note, notes_of
from ptbench.studies.rows import measure

# Most columns of numbers that stay readable under the axis of bounces; with more bounces only every k-th is shown.
_MOST_COLUMNS = 11


@dataclass(frozen=True)
class Line:
    """Live paths of one scene: entry k is after k bounces, so entry 0 counts camera rays."""

    scene: str
    fractions: tuple[float, ...]
    counts: tuple[float, ...]  # by bounce, paths alive per sample per pixel, summed over the pixels


@dataclass(frozen=True)
class Data:
    """The contents of the figure of remaining paths."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    lines: tuple[Line, ...]


def collect(result: Result, study: Study) -> Data:
    """Collects one line per scene with the paths alive after each bounce; raises NotDrawable."""
    rows = measure(result, study)
    notes = notes_of(result, study, rows)
    cells: list[Cell] = []
    lines = []
    for scene in dict.fromkeys(row.cell.scene for row in rows):
        of_scene = [row.cell for row in rows if row.cell.scene == scene]
        counted = [cell for cell in of_scene if not cell.failed and cell.instrumented and cell.instrumented.live_paths]
        if not counted:
            text = f"{scene}: no live path counts"
            notes.append(
                Note("no counts", f"{text}.", f"{text} ({', '.join(c.name + ' ' + c.status for c in of_scene)})")
            )
            continue
        # All variants of a scene trace the same paths, so the figure shows the cell with the greatest path depth.
        cell = max(counted, key=lambda cell: cell.depth)
        live, paths, spp = cell.instrumented.live_paths, cell.instrumented.paths, cell.instrumented.spp
        wrong = next((k for k, (a, b) in enumerate(zip((paths, *live), live, strict=False)) if b > a), None)
        if wrong is not None:
            text = f"{scene}: live paths rise at bounce {wrong}, so the counts are wrong"
            notes.append(Note("wrong counts", f"{text}.", f"{text} ({cell.shown})"))
            continue
        others = [c for c in counted if c.depth == cell.depth and c.resolution == cell.resolution and c is not cell]
        differing = [
            c.name
            for c in others
            if [x * spp for x in c.instrumented.live_paths] != [x * c.instrumented.spp for x in live]
        ]
        if differing:
            text = f"{scene}: {len(differing)} other variants count other paths; drawn is {cell.variant}"
            notes.append(Note("counts differ", f"{text}.", f"{text}; others: {', '.join(differing)}"))
        cells.append(cell)
        lines.append(Line(scene, tuple(x / paths for x in live), tuple(x / spp for x in live)))
    if not lines:
        raise NotDrawable("; ".join(note.full for note in notes) or "no cell has live path counts")
    passes = numbers.span(cell.instrumented.spp for cell in cells)
    what = (
        "Paths that still trace a ray after k bounces (k = 0: the camera rays), as a share of all paths; below, their "
        f"number per spp. Counted exactly in one instrumented pass of {passes} spp a scene, apart from all timing, so "
        "there is no interval."
    )
    # The figure of live paths shows no times, so notes about timing go to stdout and the summary only.
    told = [note for note in notes if note.kind not in ("few samples", "low clock")]
    caption = captioned(what, result, cells, told)
    return Data(study.title or "Paths that remain after each bounce", caption, tuple(notes), tuple(lines))


def draw(data: Data) -> Figure:
    """Draws the page of paths alive after each bounce, from the data of `collect`."""
    names = [line.scene for line in data.lines]
    looks = [style.look(index) for index in range(len(names))]
    labels = ["\n".join(style.wrapped(name, style.LABEL_SIZE, 1.5)) for name in names]
    name_width = max(style.text_width(part, style.LABEL_SIZE) for label in labels for part in label.split("\n"))
    row_heights = [style.text_height(style.LABEL_SIZE, label.count("\n") + 1) for label in labels]
    table_height = sum(row_heights) + style.text_height(style.LABEL_SIZE) + 0.1
    left = max(style.MARGIN + 0.3 + name_width + 0.35, 0.95)
    right = style.LABEL_GAP + name_width + style.MARGIN
    width = 8.4
    plot_width = max(width - left - right, 3.6)
    plot_height = max(2.9, 1.3 * sum(row_heights))
    axis_height = 0.62
    page = style.Page(
        left + plot_width + right, table_height + axis_height + plot_height + 0.12, data.title, data.caption
    )
    axes = page.axes(left, table_height + axis_height, plot_width, plot_height)

    bounces = max(len(line.fractions) for line in data.lines)
    for line, look in zip(data.lines, looks, strict=True):
        axes.plot(
            range(len(line.fractions)),
            [100 * fraction for fraction in line.fractions],
            color=look.colour,
            marker=look.marker,
            linestyle=look.line,
            clip_on=False,
            zorder=3,
        )
    axes.set_ylim(0, 105)
    axes.set_yticks(range(0, 101, 20))
    axes.set_xlim(-0.25, max(bounces - 1, 1) + 0.25)
    step = math.ceil(bounces / _MOST_COLUMNS)
    ticks = range(0, bounces, step)
    axes.set_xticks(list(ticks))
    axes.grid(axis="y")
    axes.set_xlabel("Bounces done, k")
    axes.set_ylabel("Paths alive (% of all)")
    ends = [(len(line.fractions) - 1, 100 * line.fractions[-1]) for line in data.lines]
    style.label_lines(page, axes, ends, labels, looks)

    # The numbers of live paths stand below their bounce, as numbers at risk stand below a survival curve.
    top = table_height - 0.06
    page.text(style.MARGIN, top, "Paths alive per spp", size=style.LABEL_SIZE, va="top", weight="bold")
    middle = top - style.text_height(style.LABEL_SIZE)
    for line, label, look, height in zip(data.lines, labels, looks, row_heights, strict=True):
        centre = middle - height / 2
        page.figure.add_artist(style.marker_at(page, style.MARGIN + 0.08, centre, look))
        page.text(style.MARGIN + 0.22, centre, label, size=style.LABEL_SIZE, va="center")
        for bounce in ticks:
            if bounce < len(line.counts):
                x = axes.transData.transform((bounce, 0))[0] / page.figure.dpi
                page.text(x, centre, numbers.count(line.counts[bounce]), size=8.5, va="center", ha="center")
        middle -= height
    return page.figure


FIGURES = (StudyFigure("remaining_paths", collect),)
