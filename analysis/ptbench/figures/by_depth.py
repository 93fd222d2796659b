"""Time per spp against path depth, one line a choice and one panel a scene, with the ratio to the baseline below.

Two figures ask this of two axes; what they share is here. Where a file has one depth only, lines would be lonely points
on top of each other, so the rows of the compaction figure are drawn instead.
"""

from ptbench.errors import NotDrawable
from ptbench.figures import lines
from ptbench.figures import rows as row_figure
from ptbench.figures.caption import timing_caption
from ptbench.io.cells import Result, Study
from ptbench.studies.groups import in_file_order, parts_of
from ptbench.studies.notes import notes_of
from ptbench.studies.questions import question_of
from ptbench.studies.rows import measure, scenes_of

DEPTH = lines.Abscissa("Path depth", "ray segments", {})


def collect(result: Result, study: Study, default_title: str) -> lines.Data | row_figure.Data:
    """Lines over depth, or rows where there is one depth; raises NotDrawable."""
    question = question_of(result, study)
    rows = measure(result, study)
    notes = notes_of(result, study, rows)
    drawn = [row for row in rows if row.estimate is not None]
    if not drawn:
        raise NotDrawable("no cell has times: " + ("; ".join(note.full for note in notes) or "no samples"))
    title = study.title or default_title
    if all(len({row.cell.depth for row in drawn if row.cell.scene == scene}) == 1 for scene in scenes_of(drawn)):
        return row_figure.collect(result, study, title)
    parts = parts_of(drawn, question, "depth", lambda row: (row.cell.scene, row.cell.depth), rows)
    panels = []
    for scene, *values in in_file_order((row.cell.scene, *parts.values(row.cell)) for row in drawn):
        of_panel = [row for row in drawn if (row.cell.scene, *parts.values(row.cell)) == (scene, *values)]
        points = [(row.cell.depth, row) for row in of_panel]
        panels.append(lines.panel_of(scene + parts.suffix(values), points, parts))
    caption = timing_caption(result, study, [row.cell for row in drawn], question, notes)
    baseline = f"{question.axis}={question.baseline}"
    return lines.Data(title, caption, tuple(notes), baseline, parts.order, tuple(panels), DEPTH)
