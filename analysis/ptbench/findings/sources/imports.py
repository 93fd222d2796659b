"""A file of tools/imports/survey.py as a source of numbers for a page."""

from ptbench.errors import FindingError
from ptbench.findings.commits import commit_of
from ptbench.findings.source import Source
from ptbench.numbers import figures


class ImportsSource(Source, form="ptbench-imports-1"):
    """A survey of other authors' scene files, and how many of them could be imported and rendered."""

    @property
    def commit(self) -> str:
        """The commit of the ptbench program that imported the scenes."""
        return commit_of(self._value["context"]["ptbench.version"])

    @property
    def authors(self) -> int:
        """The number of authors whose scene files were tried."""
        return self._value["authors"]

    def _share(self, dialect: str, group: str) -> dict:
        found = self._value["dialects"][dialect]
        return found[group] if group in found else found["groups"][group]

    def files(self, dialect: str = "all", group: str = "all") -> int:
        """The number of scene files tried; a group is "all", "with_their_files" or another of the file's."""
        return self._share(dialect, group)["files"]

    def came_through(self, dialect: str = "all", group: str = "all") -> int:
        """The number of scene files that were imported and rendered."""
        return self._share(dialect, group)["imported_and_rendered"]

    def exact(self, dialect: str = "all", group: str = "all") -> int:
        """The number of scene files that were imported without a warning."""
        return self._share(dialect, group)["without_a_warning"]

    def share(self, dialect: str = "all", group: str = "all") -> str:
        """The percentage of tried scene files that were imported and rendered."""
        files = self.files(dialect, group)
        return f"{figures(100 * self.came_through(dialect, group) / files, 3)} %" if files else "none"

    def must_reach(self, least: float, dialect: str, group: str, said: str) -> str:
        """Returns `said` if at least that share of scene files was imported and rendered; else raises FindingError."""
        if self.came_through(dialect, group) < least * self.files(dialect, group):
            raise FindingError(
                f"{self._shown}: of {group} {self.share(dialect, group)} come through; the page says: {said}"
            )
        return said

    @property
    def reasons(self) -> list[tuple[str, int]]:
        """The reasons why scene files failed to import, with the number of files; a file may have several reasons."""
        return list(self._value["dialects"]["all"]["reasons"].items())

    @property
    def left_out(self) -> str:
        """The scene files that were not tried: numbers with reasons."""
        return ", ".join(f"{count} ({reason})" for reason, count in self._value["left_out"].items())

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its date and version."""
        context = self._value["context"]
        return f"- {self._link}: {context['date'][:10]}, {context['ptbench.version']}."
