"""Parallel efficiency of several GPUs over samples per pixel: a line per number of GPUs, with and without reduction."""

from collections.abc import Sequence

from ptbench.errors import NotDrawable
from ptbench.figures import series
from ptbench.figures.caption import captioned
from ptbench.figures.declaration import StudyFigure
from ptbench.io.axes import DEVICES, PARTITION
from ptbench.io.cells import Result, Study
from ptbench.stats.estimates import INTERVAL_TEXT
from ptbench.studies.devices import WHOLE, Scaled, devices_of, strong, weak
from ptbench.studies.notes import notes_of
from ptbench.studies.rows import measure


def collect(result: Result, study: Study) -> series.Data:
    """Strong scaling of the study's cells, and weak scaling as far as the file has it; raises NotDrawable."""
    rows = measure(result, study)
    fixed = [one for one in strong([row.cell for row in rows]) if one.cell.axes[PARTITION] == WHOLE]
    if not fixed:
        raise NotDrawable("no cell on several GPUs has its like on one")
    first = fixed[0].one
    alike = [cell for cell in result.cells if (cell.scene, cell.resolution) == (first.scene, first.resolution)]
    growing = [one for one in weak(alike) if one.cell.axes[PARTITION] == WHOLE]
    lines = []
    for count in dict.fromkeys(devices_of(one.cell) for one in fixed):
        ours = [one for one in fixed if devices_of(one.cell) == count]
        lines.append(_line(f"{count} GPUs", ours, [one.efficiency for one in ours]))
        lines.append(_line(f"{count} GPUs, without the reduction", ours, [one.without_reduction for one in ours]))
        if theirs := [one for one in growing if devices_of(one.cell) == count]:
            lines.append(_line(f"{count} GPUs, {count} times the samples", theirs, [one.efficiency for one in theirs]))
    notes = notes_of(result, study, rows)
    what = (
        "Samples a second over those of one GPU, over the number of GPUs; 1 is as good as can be. Bars: "
        f"{INTERVAL_TEXT}, mostly hidden by the marker."
    )
    measured = [row.cell for row in rows if row.cell.measured]
    spps = sorted({x for line in lines for x in line.xs})
    return series.Data(
        study.title or "Several GPUs",
        captioned(what, result, measured, notes, study),
        tuple(notes),
        tuple(line.label for line in lines),
        (series.Panel(f"Efficiency on {first.scene}", tuple(lines)),),
        "Samples a pixel, on one GPU (log scale)",
        "Efficiency",
        {spp: f"{spp:g}" for spp in spps},
        one=True,
        linear=True,
    )


def _line(label: str, scaled: Sequence[Scaled], efficiencies: Sequence) -> series.Series:
    ordered = sorted(zip((float(one.one.spp) for one in scaled), efficiencies, strict=True), key=lambda pair: pair[0])
    return series.Series(label, tuple(x for x, _ in ordered), tuple(estimate for _, estimate in ordered))


FIGURES = (StudyFigure(DEVICES, collect, is_axis=True),)
