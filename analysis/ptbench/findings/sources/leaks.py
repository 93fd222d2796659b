"""A file of `ptbench rays --leaks`, as a page asks it: how many rays there were from within closed meshes, and left."""

from ptbench.errors import FindingError
from ptbench.findings.commits import shown_commit
from ptbench.findings.source import Source
from ptbench.numbers import figures


class LeaksSource(Source, form="ptbench-leaks-1"):
    """Rays at vertices and edges, by mesh, tree and kernel."""

    @property
    def commit(self) -> str:
        """The commit of ptbench that was measured."""
        return self._value["context"]["ptbench.git_sha"]

    @property
    def meshes(self) -> list[str]:
        """The names of the meshes."""
        return [mesh["mesh"] for mesh in self._value["meshes"]]

    def _ways(self) -> list[dict]:
        return [way for mesh in self._value["meshes"] for tree in mesh["trees"] for way in tree["kernels"]]

    @property
    def ways(self) -> int:
        """Meshes by trees by kernels: each had rays of its own."""
        return len(self._ways())

    @property
    def least_rays(self) -> str:
        """Rays of the way that had the fewest, in 1e9."""
        return figures(min(way["rays"] for way in self._ways()) / 1e9, 3)

    @property
    def leaks(self) -> int:
        """Rays that no triangle stopped."""
        return sum(way["leaks"] for way in self._ways())

    def must_be_closed(self, said: str) -> str:
        """`said`, if there was a ray and none left."""
        if self.leaks or not all(way["rays"] for way in self._ways()) or not self._ways():
            raise FindingError(f"{self._shown}: {self.leaks} rays leave {self.ways} meshes; the page says: {said}")
        return said

    @property
    def provenance(self) -> str:
        """A line of a list."""
        commit = shown_commit(self._results, self.commit)
        return f"- {self._link}: `ptbench rays --leaks`, {self.ways} ways; commit {commit}."
