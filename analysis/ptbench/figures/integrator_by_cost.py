"""The time of a megakernel over a wavefront's, by arithmetic injected into shading, one line per triangle count.

Below 1 the megakernel is faster. Drawn only for a study with both integrators at equal settings.
"""

from ptbench.errors import NotDrawable
from ptbench.figures import series
from ptbench.figures.caption import captioned
from ptbench.figures.declaration import StudyFigure
from ptbench.io.axes import INTEGRATOR
from ptbench.io.cells import Cell, Result, Study
from ptbench.stats.estimates import INTERVAL_TEXT
from ptbench.studies.notes import notes_of
from ptbench.studies.rows import measure, time_ratio

KERNEL, QUEUE, COST = "megakernel_regen", "wavefront", "shading_fmas"


def collect(result: Result, study: Study) -> series.Data:
    """Collects one line per scene with a mesh; raises NotDrawable."""
    rows = measure(result, study)
    cells = [row.cell for row in rows if row.cell.measured and row.cell.meshes is not None]
    lines = []
    for scene in dict.fromkeys(cell.scene for cell in cells):
        queues, kernels = (_by_cost(cells, scene, name) for name in (QUEUE, KERNEL))
        if costs := sorted(queues.keys() & kernels.keys()):
            triangles = series.count_text(queues[costs[0]].meshes.triangles)
            ratios = tuple(time_ratio(kernels[cost], queues[cost])[0] for cost in costs)
            lines.append(series.Series(f"{triangles} triangles ({scene})", tuple(map(float, costs)), ratios))
    if not lines:
        raise NotDrawable(f"no scene with a mesh has both {KERNEL} and {QUEUE}")
    notes = notes_of(result, study, rows)
    what = (
        f"Time of {KERNEL} over that of {QUEUE}: below 1 the one kernel is faster. Bars: {INTERVAL_TEXT}, mostly "
        "hidden by the marker."
    )
    costs = sorted({x for line in lines for x in line.xs})
    return series.Data(
        "One kernel against a queue, by cost of shading",
        captioned(what, result, cells, notes, study),
        tuple(notes),
        tuple(line.label for line in lines),
        (series.Panel(f"Time of {KERNEL} over that of {QUEUE}", tuple(lines)),),
        "Multiply-adds injected into a shading (log scale right of 0)",
        "Ratio of times (log scale)",
        {cost: f"{cost:g}" for cost in costs},
        one=True,
    )


def _by_cost(cells: list[Cell], scene: str, integrator: str) -> dict[int, Cell]:
    return {
        cell.tunables.get(COST, 0): cell for cell in cells if (cell.scene, cell.axes[INTEGRATOR]) == (scene, integrator)
    }


FIGURES = (StudyFigure(COST, collect, part="by_integrator"),)
