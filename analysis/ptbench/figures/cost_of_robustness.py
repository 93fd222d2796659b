"""The figure of what robust formulas and higher precision cost: times as ratios to robust float, all else equal."""

from collections.abc import Sequence

from ptbench import numbers
from ptbench.errors import NotDrawable
from ptbench.figures.caption import note_lines, setting
from ptbench.figures.convergence import bars
from ptbench.figures.convergence.bars import Bar, Bars
from ptbench.figures.declaration import StudyFigure
from ptbench.io.axes import PRECISION, ROBUSTNESS
from ptbench.io.cells import Cell, NotApplicable, Result, Study
from ptbench.stats.estimates import INTERVAL_TEXT, Estimate, median_estimate, ratio_estimate
from ptbench.studies.notes import Note, missed, notes_of
from ptbench.studies.questions import dimension, question_of, varying_dimensions
from ptbench.studies.rows import Row, measure

REFERENCE = "robust float"
_FORMULA_AXES = (PRECISION, ROBUSTNESS)
_WHAT = (
    "Median render wall time per sample per pixel over that of robust float with all else equal, n = {} samples each. "
    f"Whiskers: {INTERVAL_TEXT}, both sides resampled. Naive kernels are no substitute: their images are wrong where a "
    "scene is stiff."
)


def formula_of(cell: Cell | NotApplicable) -> str:
    """The formula of a cell, such as "robust float"; files older than the axis have robust kernels only."""
    return f"{cell.axes.get(ROBUSTNESS, 'robust')} {cell.axes.get(PRECISION, 'float')}"


def _notes(result: Result, study: Study, rows: Sequence[Row]) -> list[Note]:
    """The notes of a study; those on inapplicable cells also name the precision."""
    absent = dict.fromkeys((formula_of(item), item.reason) for item in missed(result, study) if not item.elsewhere)
    notes = [Note("n/a", f"Not applicable: {what}.", f"{what}: {reason}") for what, reason in absent]
    return [*notes, *(note for note in notes_of(result, study, rows) if note.kind != "n/a")]


def collect(result: Result, study: Study) -> bars.Data:
    """The bars of the study, one per variant; raises NotDrawable."""
    rows = measure(result, study)
    notes = _notes(result, study, rows)
    cells = [row.cell for row in rows]
    told = [name for name in varying_dimensions(cells, None, swept="") if name not in _FORMULA_AXES]
    groups: dict[tuple, list[Cell]] = {}
    for cell in cells:
        place = (cell.scene, *(f"{name}={dimension(cell, name)}" for name in told))
        groups.setdefault(place, []).append(cell)
    if not any(_reference(members) for members in groups.values()):
        raise NotDrawable(f"no cell of {REFERENCE} has times")
    drawn = tuple(Bars(", ".join(place), _bars(members)) for place, members in groups.items())
    timed = [cell for cell in cells if cell.measured]
    n, question = numbers.span(len(cell.samples) for cell in timed), question_of(result, study)
    order = dict.fromkeys([REFERENCE, *(bar.label for group in drawn for bar in group.bars)])
    return bars.Data(
        title=study.title or "The cost of robustness",
        caption="\n".join([_WHAT.format(n), setting(result, timed, question, study), *note_lines(notes)]),
        notes=tuple(notes),
        order=tuple(order),
        groups=drawn,
        quantity=f"Time over that of {REFERENCE}",
        heading="ratio [95 %]",
        line_at=1.0,
        from_line=True,
    )


def _reference(cells: Sequence[Cell]) -> Cell | None:
    return next((cell for cell in cells if formula_of(cell) == REFERENCE and cell.measured), None)


def _bars(cells: Sequence[Cell]) -> tuple[Bar, ...]:
    """The bars of some cells: robust float first, then in the file's order."""
    reference = _reference(cells)
    ordered = sorted(cells, key=lambda cell: formula_of(cell) != REFERENCE)
    return tuple(_bar(cell, reference) for cell in ordered)


def _bar(cell: Cell, reference: Cell | None) -> Bar:
    label = formula_of(cell)
    if not cell.measured:
        return Bar(label, None, "failed" if cell.failed else "no samples")
    if reference is None:
        return Bar(label, None, f"no {REFERENCE} to compare")
    if cell is reference:
        time = numbers.figures(median_estimate(cell.ms_per_spp).value)
        return Bar(label, Estimate(1.0, None, None, len(cell.samples)), f"1 = {time} ms per spp")
    ratio = ratio_estimate(cell.ms_per_spp, reference.ms_per_spp)
    ends = "" if ratio.low is None else f" [{numbers.ratio(ratio.low)}, {numbers.ratio(ratio.high)}]"
    return Bar(label, ratio, f"{numbers.ratio(ratio.value)}×{ends}")


FIGURES = (StudyFigure(ROBUSTNESS, collect, is_axis=True),)
