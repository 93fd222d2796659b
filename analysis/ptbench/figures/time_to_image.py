"""Time to an image over samples per pixel: a better tree takes longer to build and less time to trace.

Each builder has a line: building + encoding + spp x the time per sample, over the same for `sah_binned`. Builders on
the GPU have a second line where the folder `rays` beside the result has the same mesh built and encoded on the GPU
without a copy, because the suite's own encoding runs on the host.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.errors import NotDrawable
from ptbench.figures import series
from ptbench.figures.caption import captioned
from ptbench.figures.declaration import StudyFigure
from ptbench.io.axes import ACCELERATOR, BUILDER, INTEGRATOR
from ptbench.io.cells import Cell, Result, Study
from ptbench.io.rays import RayMesh, load_rays_folder
from ptbench.numbers import plural
from ptbench.stats.estimates import Estimate, median_estimate
from ptbench.studies.notes import notes_of
from ptbench.studies.rows import measure

# Choices of the axis builder that only CUDA supports.
GPU_BUILDERS = ("hploc", "lbvh_gpu")
# Triangles of the enclosing box that `ptbench rays` adds to a mesh, two per side.
BOX_TRIANGLES = 12
SPPS = tuple(2**n for n in range(15))
BASELINE = "sah_binned"


@dataclass(frozen=True)
class Way:
    """A builder's time to an image in two parts: milliseconds before the first sample, and per sample."""

    scene: str
    label: str
    cell: Cell
    before_ms: float
    sample: Estimate

    def time(self, spp: float) -> Estimate:
        """Milliseconds to an image with `spp` samples per pixel; the interval is that of the samples."""
        low, high = self.sample.low, self.sample.high
        return Estimate(
            self.before_ms + spp * self.sample.value,
            None if low is None else self.before_ms + spp * low,
            None if high is None else self.before_ms + spp * high,
            self.sample.n,
        )


@dataclass(frozen=True)
class Crossing:
    """A crossing of two builders' lines: below `spp` samples per pixel `sooner` is faster, above it `later`."""

    sooner: Way
    later: Way
    spp: float


def ways(cells: Iterable[Cell], meshes: Sequence[RayMesh] = ()) -> list[Way]:
    """The time parts of every measured cell, also with encoding on the GPU where `meshes` has that."""
    found = []
    for cell in cells:
        if not cell.measured or cell.meshes is None or cell.meshes.nodes == 0:
            continue
        builder, facts = cell.axes[BUILDER], cell.meshes
        sample = median_estimate(cell.ms_per_spp)
        on_gpu = builder in GPU_BUILDERS
        where = "GPU, encoded by the CPU" if on_gpu else "CPU"
        found.append(Way(cell.scene, f"{builder} ({where})", cell, facts.build_ms + facts.encode_ms, sample))
        for mesh in meshes if on_gpu else ():
            for tree in mesh.trees if _is_of(mesh, cell) else ():
                if (tree.accelerator, tree.builder) == (cell.axes[ACCELERATOR], builder) and tree.device_build_ms:
                    before = float(np.median(tree.device_build_ms) + np.median(tree.device_encode_ms))
                    found.append(Way(cell.scene, f"{builder} (all on the GPU)", cell, before, sample))
    return found


def _is_of(mesh: RayMesh, cell: Cell) -> bool:
    """Whether a cell's scene shows that mesh in a room, by its name and number of triangles."""
    name = cell.scene.rpartition("/")[2].lower()
    return name == f"{mesh.name.lower()}_room" and mesh.triangles == cell.meshes.triangles + BOX_TRIANGLES


def crossings(of_scene: Sequence[Way]) -> list[Crossing]:
    """The builders that are fastest as samples increase: from the one that starts soonest to each that overtakes it."""
    found: list[Crossing] = []
    first = min(of_scene, key=lambda way: way.before_ms)
    while overtaking := [one for way in of_scene if (one := _overtakes(first, way)) is not None]:
        # Where several builders overtake at one number of samples, the one with the least time per sample is ahead.
        found.append(min(overtaking, key=lambda one: (one.spp, one.later.sample.value)))
        first = found[-1].later
    return found


def _overtakes(first: Way, way: Way) -> Crossing | None:
    spp = series.crossing((first.before_ms, way.before_ms), (first.sample.value, way.sample.value))
    # A builder overtakes another only if its time per sample is lower and their confidence intervals are disjoint.
    is_quicker = way.sample.value < first.sample.value and _differ(first.sample, way.sample)
    return Crossing(first, way, spp) if spp is not None and is_quicker else None


def _differ(one: Estimate, other: Estimate) -> bool:
    ends = (one.low, one.high, other.low, other.high)
    return None not in ends and (one.high < other.low or other.high < one.low)


def sibling_meshes(path: Path) -> list[RayMesh]:
    """The meshes in the folder `rays` beside a result file; none if there is no such folder."""
    folder = path.parent / "rays"
    if not folder.is_dir():
        return []
    files, _ = load_rays_folder(folder)
    return [mesh for file in files for mesh in file.meshes]


def collect(result: Result, study: Study) -> series.Data:
    """Collects one panel per scene, accelerator and integrator; raises NotDrawable."""
    rows = measure(result, study)
    cells = [row.cell for row in rows if row.cell.measured and row.cell.meshes is not None]
    found = ways(cells, sibling_meshes(result.path))
    panels, said = [], []

    def key(way: Way) -> tuple[str, ...]:
        return way.scene, way.cell.axes[INTEGRATOR], way.cell.axes[ACCELERATOR]

    keys = list(dict.fromkeys(map(key, found)))
    for one in keys:
        of_panel = [way for way in found if key(way) == one]
        if len({way.cell.axes[BUILDER] for way in of_panel}) < 2:
            continue
        crossed = [item for item in crossings(of_panel) if SPPS[0] <= item.spp <= SPPS[-1]]
        base = next((way for way in of_panel if way.cell.axes[BUILDER] == BASELINE), of_panel[0])
        lines = tuple(_line(way, base, crossed) for way in of_panel)
        varying = [part for index, part in enumerate(one) if index == 0 or len({k[index] for k in keys}) > 1]
        title = ", ".join(varying)
        panels.append(series.Panel(f"{title}: {series.count_text(of_panel[0].cell.meshes.triangles)} triangles", lines))
        words = [f"{one.later.label} is first from {one.spp:.0f} spp, before it {one.sooner.label}" for one in crossed]
        said.append(f"{title}: {'; '.join(words) or 'no crossing from 1 to ' + str(SPPS[-1]) + ' spp'}.")
    if not panels:
        raise NotDrawable("no scene has trees of two builders")
    notes = notes_of(result, study, rows)
    threads = result.about("threads")
    what = (
        f"Time: building, once, plus encoding, once, plus spp times the median time of a sample. CPU: "
        f"{plural(threads, 'thread')}. Below 1: the image is there before that of {BASELINE}. All on the GPU: "
        "build and encoding as "
        "`ptbench rays` timed them on this mesh, medians, without a copy. "
        "Rings: from there on the line is the lowest. " + " ".join(said)
    )
    order = dict.fromkeys(one.label for panel in panels for one in panel.series)
    return series.Data(
        f"Time to an image by samples a pixel: builders over {BASELINE}",
        captioned(what, result, cells, notes, study),
        tuple(notes),
        tuple(order),
        tuple(panels),
        "Samples a pixel (log scale)",
        f"Time over {BASELINE}'s",
        {float(spp): str(spp) for spp in SPPS[::3]},
        one=True,
    )


def _line(way: Way, base: Way, crossed: Sequence[Crossing]) -> series.Series:
    def over(spp: float) -> float:
        return way.time(spp).value / base.time(spp).value

    ratios = tuple(Estimate(over(spp), None, None, 1) for spp in SPPS)
    rings = tuple((item.spp, over(item.spp)) for item in crossed if item.later is way)
    return series.Series(way.label, tuple(map(float, SPPS)), ratios, rings)


FIGURES = (StudyFigure(BUILDER, collect, part="time_to_image"),)
