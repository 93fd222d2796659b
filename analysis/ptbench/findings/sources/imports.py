"""A file of tools/imports/survey.py, as a page asks it."""

from ptbench.errors import FindingError
from ptbench.findings.commits import commit_of
from ptbench.findings.source import Source
from ptbench.numbers import figures


class ImportsSource(Source, form="ptbench-imports-1"):
    """Other people's scenes, and how many came through."""

    @property
    def commit(self) -> str:
        """The program's."""
        return commit_of(self._value["context"]["ptbench.version"])

    @property
    def authors(self) -> int:
        """Whose files were tried."""
        return self._value["authors"]

    def _share(self, dialect: str, group: str) -> dict:
        found = self._value["dialects"][dialect]
        return found[group] if group in found else found["groups"][group]

    def files(self, dialect: str = "all", group: str = "all") -> int:
        """How many were tried; a group is "all", "with_their_files" or another of the file's."""
        return self._share(dialect, group)["files"]

    def came_through(self, dialect: str = "all", group: str = "all") -> int:
        """How many were imported and rendered."""
        return self._share(dialect, group)["imported_and_rendered"]

    def exact(self, dialect: str = "all", group: str = "all") -> int:
        """How many of them without a warning."""
        return self._share(dialect, group)["without_a_warning"]

    def share(self, dialect: str = "all", group: str = "all") -> str:
        """The share of the files that were tried which came through, as a percentage."""
        files = self.files(dialect, group)
        return f"{figures(100 * self.came_through(dialect, group) / files, 3)} %" if files else "none"

    def must_reach(self, least: float, dialect: str, group: str, said: str) -> str:
        """`said`, if at least that share came through."""
        if self.came_through(dialect, group) < least * self.files(dialect, group):
            raise FindingError(
                f"{self._shown}: of {group} {self.share(dialect, group)} come through; the page says: {said}"
            )
        return said

    @property
    def reasons(self) -> list[tuple[str, int]]:
        """Why others did not, and how many files each keeps out; a file may have several."""
        return list(self._value["dialects"]["all"]["reasons"].items())

    @property
    def left_out(self) -> str:
        """What was not tried."""
        return ", ".join(f"{count} ({reason})" for reason, count in self._value["left_out"].items())

    @property
    def provenance(self) -> str:
        """A line of a list."""
        context = self._value["context"]
        return f"- {self._link}: {context['date'][:10]}, {context['ptbench.version']}."
