"""A file of `ptbench stability`, as a page asks it: what stiff cases found."""

from collections import Counter
from pathlib import Path

from ptbench.errors import FindingError
from ptbench.findings.source import STABILITY, Source
from ptbench.io.nodes import read_json
from ptbench.io.stability import KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Row, Stability, stability_of
from ptbench.stability.layout import Layout, count, failures
from ptbench.stability.summary import family_text


class StabilitySource(Source, form=STABILITY):
    """A file of `ptbench stability`."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._stability: Stability = stability_of(read_json(results / file))
        self._layout = Layout(self._stability)
        self._required: list[Row] = [row for row in self._stability.rows if row.must_pass]

    @property
    def rows(self) -> int:
        """Checks and what could not be asked, in the file."""
        return len(self._stability.rows)

    @property
    def cases(self) -> int:
        """Cases in the file."""
        return len({row.case.name for row in self._stability.rows})

    @property
    def asked(self) -> int:
        """Cases in the file that could be asked in any variant."""
        return len({row.case.name for row in self._stability.rows if row.status != NOT_APPLICABLE})

    @property
    def left_out(self) -> str:
        """Cases of the program that the file has no row of, by family: "10 of film, 4 of lights"."""
        seen = {row.case.name for row in self._stability.rows}
        missing = Counter(case.family for case in self._stability.cases if case.name not in seen)
        if not missing:
            raise FindingError(f"{self._shown}: the file has rows of every case; the page says that some are left out")
        return ", ".join(f"{number} of {family}" for family, number in missing.items())

    @property
    def passed(self) -> int:
        """Checks that must pass and passed."""
        return count(self._required, PASSED)

    @property
    def known_limits(self) -> int:
        """Checks that must pass and met a known limit."""
        return count(self._required, KNOWN_LIMIT)

    @property
    def failed(self) -> int:
        """Checks that must pass and failed or broke."""
        return len(failures(self._required))

    def must_not_fail(self, said: str) -> str:
        """`said`, if no check failed that must pass."""
        if self.failed:
            raise FindingError(f"{self._shown}: {self.failed} checks failed that must pass; the page says: {said}")
        return said

    @property
    def families(self) -> list[str]:
        """A paragraph a family of cases."""
        return [family_text(self._stability, self._layout, family) for family in self._stability.families]

    @property
    def commit(self) -> str:
        """The commit of the program that measured, seven digits."""
        return self._stability.about("git_sha")[:7]

    @property
    def device(self) -> str:
        """The GPU."""
        return self._stability.about("cuda_device")

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        file = Path(self._shown)
        summary = file.parent / "figures" / file.stem / "summary.md"
        drawn = f" [summary](../../results/{summary})" if (self._results / summary).is_file() else ""
        return f"- {self._link}: `ptbench stability`, {self.rows} rows; commit {self.commit}.{drawn}"
