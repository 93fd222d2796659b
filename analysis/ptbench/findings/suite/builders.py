"""Tree builders for a page: the cost of a tree, the time per sample with it, and the time to an image."""

from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.errors import FindingError
from ptbench.figures.time_to_image import BASELINE, Crossing, Way, crossings
from ptbench.findings.quantities import Quantity, Ratio
from ptbench.io.axes import ACCELERATOR, BUILDER, INTEGRATOR
from ptbench.stats.estimates import Estimate
from ptbench.studies.rows import time_ratio


@dataclass(frozen=True)
class Built:
    """The time to an image with one builder, beside that of `sah_binned` in the same scene."""

    way: Way
    base: Way

    @property
    def scene(self) -> str:
        """The name of the scene in which the builder was measured."""
        return self.way.scene

    @property
    def label(self) -> str:
        """The builder, and whether the CPU or the GPU ran it."""
        return self.way.label

    @property
    def triangles(self) -> int:
        """The number of triangles in the scene's meshes."""
        return self.way.cell.meshes.triangles

    @property
    def is_baseline(self) -> bool:
        """Whether the builder is the baseline `sah_binned`."""
        return self.way is self.base

    @property
    def before(self) -> Quantity:
        """Milliseconds to build and encode the tree."""
        return Quantity(Estimate(self.way.before_ms, None, None, 1), self.label)

    @property
    def sample(self) -> Quantity:
        """Milliseconds per sample per pixel with the builder's tree."""
        return Quantity(self.way.sample, self.label)

    @property
    def ratio(self) -> Ratio:
        """Time per sample over that with the tree of `sah_binned`."""
        estimate, verdict = time_ratio(self.way.cell, self.base.cell)
        return Ratio(estimate, verdict, f"{self.way.cell.name} over {BASELINE}")

    @property
    def sah(self) -> Quantity:
        """SAH cost over that of `sah_binned`."""
        costs = [one.cell.meshes.sah_cost for one in (self.way, self.base)]
        return Quantity(Estimate(costs[0] / costs[1], None, None, 1), self.label)

    def time(self, spp: int) -> Quantity:
        """Milliseconds to an image with `spp` samples per pixel."""
        return Quantity(self.way.time(spp), self.label)


@dataclass(frozen=True)
class Crossed:
    """The number of samples at which two builders take equal time to an image."""

    crossing: Crossing

    @property
    def scene(self) -> str:
        """The name of the scene in which the builders cross."""
        return self.crossing.later.scene

    @property
    def sooner(self) -> str:
        """The builder whose image is first with few samples."""
        return self.crossing.sooner.label

    @property
    def later(self) -> str:
        """The builder whose image is first from `spp` samples per pixel on."""
        return self.crossing.later.label

    @property
    def spp(self) -> Quantity:
        """Samples per pixel at which both builders take equal time."""
        return Quantity(Estimate(self.crossing.spp, None, None, 1), self.later)


def built(ways: Sequence[Way]) -> list[Built]:
    """Every builder's times beside the baseline of its scene and accelerator; raises FindingError without one."""
    bases = {_place(way): way for way in ways if way.cell.axes[BUILDER] == BASELINE}
    if missing := [way.scene for way in ways if _place(way) not in bases]:
        raise FindingError(f"{missing[0]}: no tree of {BASELINE}")
    return [Built(way, bases[_place(way)]) for way in ways]


def crossed(ways: Sequence[Way]) -> list[Crossed]:
    """All crossings of builders in one scene with one accelerator, by scene and then by samples."""
    places = dict.fromkeys(map(_place, ways))
    return [Crossed(one) for place in places for one in crossings([way for way in ways if _place(way) == place])]


def _place(way: Way) -> tuple[str, ...]:
    return way.scene, way.cell.axes[INTEGRATOR], way.cell.axes[ACCELERATOR]
