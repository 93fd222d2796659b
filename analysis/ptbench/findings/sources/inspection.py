"""A file of `ptbench inspect --counters`, as a page asks it: what kernels are made of."""

from pathlib import Path

from ptbench.errors import FindingError
from ptbench.findings.source import LIST, Source
from ptbench.io.inspection import Inspected, KernelCounters, load_inspected
from ptbench.numbers import figures, share


class Inspection(Source, form=LIST):
    """A file of `ptbench inspect --counters`."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._entries: list[Inspected] = load_inspected(results / file)

    def kernel(
        self, integrator: str, specialisation: str = "features", kernel: str = "", scene: str = ""
    ) -> KernelCounters:
        """The one kernel of that name, of the one entry with those choices, in that scene where one is named."""
        found = [
            one
            for entry in self._entries
            if entry.choices[0] == integrator and specialisation in entry.choices
            for one in entry.kernels
            if kernel in ("", one.name) and scene in ("", entry.scene)
        ]
        if len(found) != 1:
            asked = f"{integrator} {specialisation} {kernel} {scene}".rstrip()
            raise FindingError(f"{self._shown}: {len(found)} kernels: {asked}")
        return found[0]

    def row(self, integrator: str, specialisation: str = "features", kernel: str = "", scene: str = "") -> str:
        """Cells of a table: registers, occupancy, lanes, instructions and bytes a ray, parts of the ceilings."""
        one = self.kernel(integrator, specialisation, kernel, scene)
        ceiling = one.of_ceiling or {}
        counted = (one.active_lanes, one.thread_instructions_per_ray, one.memory_bytes_per_ray)
        return " | ".join(
            (
                str(one.registers),
                f"{share(one.occupancy)}, {share(one.achieved_occupancy)}",
                *("—" if value is None else figures(value, 3) for value in counted),
                *(share(ceiling.get(name)) for name in ("issue", "alu", "memory")),
            )
        )

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {self._link}: `ptbench inspect --counters`, hardware counters."
