"""One render on a thousand GPUs, as a page asks it: simulated from measured parts, and what of it was checked."""

from pathlib import Path

from ptbench.document.markdown import table_lines
from ptbench.errors import FindingError
from ptbench.extras.simulate.parts import WORK, Parts, parts_of
from ptbench.extras.simulate.study import Study, study_of
from ptbench.extras.simulate.text import TABLES, assumptions, checked_lines
from ptbench.findings.quantities import Quantity, link_to
from ptbench.findings.source import Source
from ptbench.stats.estimates import Estimate


class SimulationSource(Source, form=WORK):
    """The simulation of the package's definition, from the results of a checkout; `file` is its map of work."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._parts: Parts = parts_of(results)
        if self._parts.definition["work"] != file:
            raise FindingError(f"{file}: the simulation's map of work is {self._parts.definition['work']}")
        self._study: Study = study_of(self._parts)

    def efficiency(self, partition: str, spp: int, ranks: int) -> Quantity:
        """At the smallest image, over the far network; with the middle 90 % of trials."""
        key = (partition, spp, ranks)
        if key not in self._study.efficiencies:
            raise FindingError(f"simulation: no {partition}, {spp} spp, {ranks} GPUs")
        one = self._study.efficiencies[key]
        return Quantity(Estimate(one.value, one.low, one.high, self._parts.definition["trials"]), str(key))

    def imbalance(self, partition: str, ranks: int) -> Quantity:
        """The greatest share of work over the mean."""
        return self._number(self._study.imbalance[partition, ranks])

    def straggler(self, ranks: int) -> Quantity:
        """The slowest of so many renders over the median."""
        return self._number(self._study.stragglers[ranks])

    def slow_one(self, partition: str, ranks: int) -> Quantity:
        """Efficiency where one GPU is slow."""
        return self._number(self._study.slow_one[partition, ranks])

    def reduction(self, side: int, ranks: int) -> Quantity:
        """Adding up films, ms, over the far network."""
        return self._number(self._study.reductions[side, ranks])

    def even(self, side: int, ranks: int) -> int | None:
        """The least samples a pixel at which samples are as fast as tiles."""
        return self._study.even[side, ranks]

    @property
    def far(self) -> str:
        """The network between hosts."""
        return self._study.far.name

    @property
    def has_devices(self) -> bool:
        """Whether several GPUs were measured."""
        return bool(self._study.checks)

    @property
    def worst_device_error(self) -> Quantity:
        """Per cent by which an efficiency of several GPUs is off at most, without its sign."""
        return self._number(100 * max(abs(point.error) for point in self._study.checks))

    def device_errors(self, least_spp: int) -> list[float]:
        """Per cent by which efficiencies of several GPUs are off from so many samples a pixel on, without signs."""
        return [100 * abs(point.error) for point in self._study.checks if int(point.name.split()[-2]) >= least_spp]

    @property
    def near(self) -> str:
        """The network within a host."""
        return self._parts.definition["near"]

    def reduction_errors(self, ranks: int) -> list[float]:
        """Per cent by which the formula is off for so many ranks on one host, without signs."""
        points = [one for one in self._parts.reduction_checks if one.name.startswith(f"{ranks} ranks")]
        return [100 * abs(point.error) for point in points]

    @property
    def assumptions(self) -> list[str]:
        """A line each."""
        return assumptions(self._study)

    @property
    def checked(self) -> tuple[str, ...]:
        """What was held against measurements, and what was not."""
        return checked_lines(self._study)

    def table(self, name: str) -> str:
        """What the command tells, by the name of its table."""
        return "\n".join(table_lines(TABLES[name](self._study)))

    @property
    def provenance(self) -> str:
        """Lines of a list: the parts."""
        about = self._parts.definition
        files = [
            (about["render"]["file"], "one GPU's time by number of samples"),
            (about["noise"]["file"], "noise of renders"),
            (about["work"], "rays a path by block of pixels, counted by `simulate --work`"),
            *((file, "adding up films over MPI ranks of one host, suite `reduction`")
              for file in (about["reduction"]["fit"], *about["reduction"]["check"])),
            *([(about["devices"]["file"], "two and four GPUs of one host")] if self._parts.devices else []),
        ]  # fmt: skip
        return "\n".join(f"- {link_to(self._results, file)}: {what}." for file, what in files)

    def _number(self, value: float) -> Quantity:
        return Quantity(Estimate(value, None, None, 1), "simulation")
