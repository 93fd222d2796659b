"""A file of `ptbench rays --leaks` as a source for a page: rays from inside closed meshes, and how many escaped."""

from ptbench.errors import FindingError
from ptbench.findings.commits import shown_commit
from ptbench.findings.source import Source
from ptbench.numbers import figures


class LeaksSource(Source, form="ptbench-leaks-1"):
    """Rays aimed at vertices and edges from inside closed meshes, by mesh, tree and kernel."""

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
        """The number of combinations of mesh, tree and kernel, each of which traced its own rays."""
        return len(self._ways())

    @property
    def least_rays(self) -> str:
        """The fewest rays of any combination of mesh, tree and kernel, in 1e9."""
        return figures(min(way["rays"] for way in self._ways()) / 1e9, 3)

    @property
    def leaks(self) -> int:
        """The number of rays that escaped, as no triangle stopped them."""
        return sum(way["leaks"] for way in self._ways())

    def must_be_closed(self, said: str) -> str:
        """Returns `said` if rays were traced and none escaped; otherwise raises FindingError."""
        if self.leaks or not all(way["rays"] for way in self._ways()) or not self._ways():
            raise FindingError(f"{self._shown}: {self.leaks} rays leave {self.ways} meshes; the page says: {said}")
        return said

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its number of combinations and its commit."""
        commit = shown_commit(self._results, self.commit)
        return f"- {self._link}: `ptbench rays --leaks`, {self.ways} ways; commit {commit}."
