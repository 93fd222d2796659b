"""A file of `ptbench stability` as a source for a page: the outcomes of numerically stiff cases."""

from __future__ import annotations

from pathlib import Path

from ptbench.errors import FindingError
from ptbench.findings.source import STABILITY, Source
from ptbench.io.nodes import read_json
from ptbench.io.stability import KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Row, Stability, stability_of
from ptbench.stability.layout import Layout, count, failures
from ptbench.stability.summary import family_text


class StabilitySource(Source, form=STABILITY):
    """The checks of a file of `ptbench stability`, counted by outcome."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._stability: Stability = stability_of(read_json(results / file))
        self._layout = Layout(self._stability)
        self._required: list[Row] = [row for row in self._stability.rows if row.must_pass]

    @property
    def rows(self) -> int:
        """The number of rows in the file: checks, and cases that could not be run."""
        return len(self._stability.rows)

    @property
    def cases(self) -> int:
        """The number of cases in the stability file."""
        return len({row.case.name for row in self._stability.rows})

    @property
    def asked(self) -> int:
        """The number of cases that could be run in any variant."""
        return len({row.case.name for row in self._stability.rows if row.status != NOT_APPLICABLE})

    def cover_all(self, other: StabilitySource, said: str) -> str:
        """Returns `said` if every case that either program has is in either file; else raises FindingError."""
        both = (self._stability, other._stability)
        seen = {row.case.name for one in both for row in one.rows}
        missing = {case.name for one in both for case in one.cases} - seen
        if missing:
            raise FindingError(
                f"{self._shown} and {other._shown}: no rows of {', '.join(sorted(missing))}; the page says: {said}"
            )
        return said

    @property
    def passed(self) -> int:
        """The number of required checks that passed."""
        return count(self._required, PASSED)

    @property
    def known_limits(self) -> int:
        """The number of required checks that met a known limit."""
        return count(self._required, KNOWN_LIMIT)

    @property
    def failed(self) -> int:
        """The number of required checks that failed or broke."""
        return len(failures(self._required))

    def must_not_fail(self, said: str) -> str:
        """Returns `said` if no required check failed; otherwise raises FindingError."""
        if self.failed:
            raise FindingError(f"{self._shown}: {self.failed} checks failed that must pass; the page says: {said}")
        return said

    @property
    def families(self) -> list[str]:
        """A paragraph on each family of cases."""
        return [family_text(self._stability, self._layout, family) for family in self._stability.families]

    @property
    def commit(self) -> str:
        """The commit of the program that ran the cases, seven digits."""
        return self._stability.about("git_sha")[:7]

    @property
    def device(self) -> str:
        """The name of the GPU on which the cases ran."""
        return self._stability.about("cuda_device")

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file and what it is."""
        file = Path(self._shown)
        summary = file.parent / "figures" / file.stem / "summary.md"
        drawn = f" [summary](../../results/{summary})" if (self._results / summary).is_file() else ""
        return f"- {self._link}: `ptbench stability`, {self.rows} rows; commit {self.commit}.{drawn}"
