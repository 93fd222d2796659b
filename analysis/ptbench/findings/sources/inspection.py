"""A file of `ptbench inspect --counters` as a source for a page: resources and hardware counters of kernels."""

from pathlib import Path

from ptbench.errors import FindingError
from ptbench.findings.source import LIST, Source
from ptbench.io.inspection import Inspected, KernelCounters, load_inspected
from ptbench.numbers import figures, share


class Inspection(Source, form=LIST):
    """Hardware counters and resources of kernels, from a file of `ptbench inspect --counters`."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._entries: list[Inspected] = load_inspected(results / file)

    def kernel(
        self, integrator: str, specialisation: str = "features", kernel: str = "", scene: str = ""
    ) -> KernelCounters:
        """The one kernel of the one entry with these choices and names; raises FindingError for none or several."""
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
        """A kernel's table row: registers, occupancy, lanes, instructions and bytes per ray, fractions of ceilings."""
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
        """A Markdown list item with the file and what it is."""
        return f"- {self._link}: `ptbench inspect --counters`, hardware counters."
