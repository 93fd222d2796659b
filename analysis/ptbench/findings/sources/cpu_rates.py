"""A file of tools/rays/rays_cpu.cpp as a source: rates of ray batches on one thread, ptbench's beside Embree's."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from ptbench.errors import FindingError
from ptbench.findings.commits import shown_commit
from ptbench.findings.source import Source
from ptbench.numbers import figures

EMBREE = "embree"  # prefix of the names of Embree's trees, with or without ptbench; others are ptbench's own
PEER = "embree_native"


@dataclass(frozen=True)
class CpuRays:
    """Rates of one class of rays over one mesh: 10^6 rays per second by contender, medians."""

    mesh: str
    name: str
    rates: dict[str, float]

    @property
    def best(self) -> str:
        """The fastest of our trees."""
        return max((name for name in self.rates if not name.startswith(EMBREE)), key=lambda tree: self.rates[tree])

    @property
    def over_peer(self) -> float:
        """The rate of ptbench's best tree over Embree's with its own triangle test; both are called ray by ray."""
        return self.rates[self.best] / self.rates[PEER]

    def rate(self, name: str) -> str:
        """The rate of a contender, in 10^6 rays a second."""
        return figures(self.rates[name], 3)

    @property
    def ratio(self) -> str:
        """The rate of ptbench's best tree over Embree's, as text."""
        return figures(self.over_peer, 3)


class CpuRaysSource(Source, form="ptbench-rays-cpu-1"):
    """Rates of ray batches on one CPU thread, by mesh and class of rays."""

    @property
    def commit(self) -> str:
        """The commit of ptbench that was measured."""
        return self._value["commit"]

    @property
    def cpu(self) -> str:
        """The name of the processor on which the rays were traced."""
        return self._value["cpu"]

    @cached_property
    def classes(self) -> list[CpuRays]:
        """Every class of rays over every mesh; raises FindingError where a tree's hits differ from those of `bvh2`."""
        return list(self._classes())

    def _classes(self) -> Iterator[CpuRays]:
        for mesh in self._value["meshes"]:
            for one in mesh["classes"]:
                for by in one["by"]:
                    if not by["name"].startswith(EMBREE) and (by["other_primitive"] or by["other_bits"]):
                        raise FindingError(f"{self._shown}: {by['name']} over {mesh['mesh']} leaves other hits")
                rates = {by["name"]: by["mrays_per_s"] for by in one["by"]}
                yield CpuRays(mesh["mesh"], one["class"], rates)

    @property
    def least_over_peer(self) -> str:
        """The smallest ratio of ptbench's best tree to Embree, over all classes and meshes."""
        return figures(min(one.over_peer for one in self.classes), 3)

    def must_reach(self, bar: float, said: str) -> str:
        """Returns `said` if ptbench's best tree reaches `bar` times Embree's rate in every class and mesh."""
        for one in self.classes:
            if one.over_peer < bar:
                raise FindingError(
                    f"{self._shown}: {one.mesh}, {one.name}: {one.ratio} of {PEER}; the page says: {said}"
                )
        return said

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its number of batches and its commit."""
        commit = shown_commit(self._results, self.commit)
        count = len(self.classes)
        return f"- {self._link}: `tools/rays/rays_cpu`, {count} batches; commit {commit}."
