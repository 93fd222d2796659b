"""Builders as a page asks them: what a tree costs to make, what a sample takes with it, and when the image is there."""

from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.errors import FindingError
from ptbench.figures.time_to_image import BASELINE, Crossing, Way, crossings
from ptbench.findings.quantities import Quantity, Ratio
from ptbench.stats.estimates import Estimate
from ptbench.studies.rows import time_ratio


@dataclass(frozen=True)
class Built:
    """One way to an image, beside that of `sah_binned` in the same scene."""

    way: Way
    base: Way

    @property
    def scene(self) -> str:
        """The scene's name."""
        return self.way.scene

    @property
    def label(self) -> str:
        """The builder, and what ran where."""
        return self.way.label

    @property
    def triangles(self) -> int:
        """Triangles of the scene's meshes."""
        return self.way.cell.meshes.triangles

    @property
    def is_baseline(self) -> bool:
        """Whether it is `sah_binned`'s own."""
        return self.way is self.base

    @property
    def before(self) -> Quantity:
        """Build and encoding, ms."""
        return Quantity(Estimate(self.way.before_ms, None, None, 1), self.label)

    @property
    def sample(self) -> Quantity:
        """A sample a pixel, ms."""
        return Quantity(self.way.sample, self.label)

    @property
    def ratio(self) -> Ratio:
        """Time of a sample over that with `sah_binned`'s tree."""
        estimate, verdict = time_ratio(self.way.cell, self.base.cell)
        return Ratio(estimate, verdict, f"{self.way.cell.name} over {BASELINE}")

    @property
    def sah(self) -> Quantity:
        """SAH cost over `sah_binned`'s."""
        costs = [one.cell.meshes.sah_cost for one in (self.way, self.base)]
        return Quantity(Estimate(costs[0] / costs[1], None, None, 1), self.label)

    def time(self, spp: int) -> Quantity:
        """To an image of so many samples a pixel, ms."""
        return Quantity(self.way.time(spp), self.label)


@dataclass(frozen=True)
class Crossed:
    """Where two ways to an image change places."""

    crossing: Crossing

    @property
    def scene(self) -> str:
        """The scene's name."""
        return self.crossing.later.scene

    @property
    def sooner(self) -> str:
        """Whose image is there first with few samples."""
        return self.crossing.sooner.label

    @property
    def later(self) -> str:
        """Whose is from `spp` on."""
        return self.crossing.later.label

    @property
    def spp(self) -> Quantity:
        """Samples a pixel."""
        return Quantity(Estimate(self.crossing.spp, None, None, 1), self.later)


def built(ways: Sequence[Way]) -> list[Built]:
    """Every way beside the baseline of its scene and accelerator; raises FindingError where there is none."""
    bases = {_place(way): way for way in ways if way.cell.axes["builder"] == BASELINE}
    if missing := [way.scene for way in ways if _place(way) not in bases]:
        raise FindingError(f"{missing[0]}: no tree of {BASELINE}")
    return [Built(way, bases[_place(way)]) for way in ways]


def crossed(ways: Sequence[Way]) -> list[Crossed]:
    """Where ways of one scene and accelerator change places, by scene and then by samples."""
    places = dict.fromkeys(map(_place, ways))
    return [Crossed(one) for place in places for one in crossings([way for way in ways if _place(way) == place])]


def _place(way: Way) -> tuple[str, ...]:
    return way.scene, way.cell.axes["integrator"], way.cell.axes["accelerator"]
