"""The simulation of a thousand GPUs as a source of numbers for a page, with the checks that were made of it."""

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
    """The simulation of the package's definition, from a checkout's results; `file` is its map of rays per path."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._parts: Parts = parts_of(results)
        if self._parts.definition["work"] != file:
            raise FindingError(f"{file}: the simulation's map of work is {self._parts.definition['work']}")
        self._study: Study = study_of(self._parts)

    def efficiency(self, partition: str, spp: int, ranks: int) -> Quantity:
        """Parallel efficiency at the smallest image over the far network; with the middle 90 % of trials."""
        key = (partition, spp, ranks)
        if key not in self._study.efficiencies:
            raise FindingError(f"simulation: no {partition}, {spp} spp, {ranks} GPUs")
        one = self._study.efficiencies[key]
        return Quantity(Estimate(one.value, one.low, one.high, self._parts.definition["trials"]), str(key))

    def imbalance(self, partition: str, ranks: int) -> Quantity:
        """Load imbalance of a partition: the largest share of work over the mean."""
        return self._number(self._study.imbalance[partition, ranks])

    def straggler(self, ranks: int) -> Quantity:
        """The slowest rank's time over the median, by noise alone."""
        return self._number(self._study.stragglers[ranks])

    def slow_one(self, partition: str, ranks: int) -> Quantity:
        """Parallel efficiency where one GPU is slow."""
        return self._number(self._study.slow_one[partition, ranks])

    def reduction(self, side: int, ranks: int) -> Quantity:
        """Milliseconds to sum the films over the far network."""
        return self._number(self._study.reductions[side, ranks])

    def even(self, side: int, ranks: int) -> int | None:
        """The least samples per pixel at which dividing samples is as fast as dividing tiles; None: never."""
        return self._study.even[side, ranks]

    @property
    def far(self) -> str:
        """The name of the network between hosts."""
        return self._study.far.name

    @property
    def has_devices(self) -> bool:
        """Whether renders on several GPUs were measured, to check the simulation."""
        return bool(self._study.checks)

    @property
    def worst_device_error(self) -> Quantity:
        """The largest error of a simulated multi-GPU efficiency in per cent, unsigned."""
        return self._number(100 * max(abs(point.error) for point in self._study.checks))

    def device_errors(self, least_spp: int) -> list[float]:
        """Unsigned errors of simulated multi-GPU efficiencies, per cent, for at least `least_spp` samples per pixel."""
        return [100 * abs(point.error) for point in self._study.checks if int(point.name.split()[-2]) >= least_spp]

    @property
    def near(self) -> str:
        """The name of the network within a host."""
        return self._parts.definition["near"]

    def reduction_errors(self, ranks: int) -> list[float]:
        """Errors of the reduction model in per cent, unsigned, for a number of ranks on one host."""
        points = [one for one in self._parts.reduction_checks if one.name.startswith(f"{ranks} ranks")]
        return [100 * abs(point.error) for point in points]

    @property
    def assumptions(self) -> list[str]:
        """The assumptions of the simulation, one line each."""
        return assumptions(self._study)

    @property
    def checked(self) -> tuple[str, ...]:
        """Lines on which parts of the simulation were checked against measurements, and which were not."""
        return checked_lines(self._study)

    def table(self, name: str) -> str:
        """A table of the simulation as Markdown, by name."""
        return "\n".join(table_lines(TABLES[name](self._study)))

    @property
    def provenance(self) -> str:
        """The list of files with the measured parts, as Markdown."""
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
