"""Files that are no suite's result, as a page asks them: what kernels are made of, and what stiff cases found."""

from __future__ import annotations

from pathlib import Path

from ptbench.errors import FindingError
from ptbench.findings.quantities import link_to
from ptbench.io.inspection import Inspected, KernelCounters, load_inspected
from ptbench.io.nodes import read_json
from ptbench.io.stability import KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Row, Stability, stability_of
from ptbench.numbers import figures, share
from ptbench.stability.layout import Layout, count, failures
from ptbench.stability.summary import family_text


class Inspection:
    """A file of `ptbench inspect --counters`."""

    def __init__(self, results: Path, file: str) -> None:
        self._shown, self._results = file, results
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

    # Such a file does not say of which commit its kernels are.
    commit = ""

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {link_to(self._results, self._shown)}: `ptbench inspect --counters`, hardware counters."


GPU_TESTS = "ptbench-gpu-tests-1"


class GpuTestsSource:
    """A file of a package's gpu_tests."""

    def __init__(self, results: Path, file: str) -> None:
        self._shown, self._results = file, results
        self._root = read_json(results / file).value

    @property
    def commit(self) -> str:
        """The commit of the programs that ran."""
        return self._root["context"]["ptbench.git_sha"]

    @property
    def machine(self) -> str:
        """What kind of machine it was."""
        return self._root["context"]["ptbench.machine"]

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {link_to(self._results, self._shown)}: `gpu_tests` of a package."

    def must_not_fail(self, text: str) -> str:
        """The text; raises FindingError where a test failed or all were skipped."""
        if self.count("failed") > 0 or self.count("passed") == 0:
            raise FindingError(f"{self._shown}: {self.count('failed')} failed, {self.count('passed')} passed: {text}")
        return text

    def count(self, word: str) -> int:
        """How many tests `passed`, `failed` or were `skipped`."""
        return sum(program[word] for program in self._root["programs"].values())

    @property
    def programs(self) -> int:
        """How many test programs."""
        return len(self._root["programs"])


class Record:
    """Any other JSON file, such as a record made by hand: numbers and texts by their place in it."""

    commit = ""

    def __init__(self, results: Path, file: str) -> None:
        self._shown, self._results = file, results
        self._root = read_json(results / file).value

    def __call__(self, place: str) -> str:
        """The number or text at "prototype.cornell_open.nee_over_off"."""
        value = self._root
        for name in place.split("."):
            if not isinstance(value, dict) or name not in value:
                raise FindingError(f"{self._shown}: nothing at {place}")
            value = value[name]
        return figures(value, 3) if isinstance(value, float) else str(value)

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {link_to(self._results, self._shown)}: a record made by hand, which says what it leaves out."


class Transcript:
    """What a command printed, committed as it was: a page shows it as a block."""

    commit = ""

    def __init__(self, results: Path, file: str) -> None:
        self._text = (results / file).read_text(encoding="utf-8").rstrip("\n")

    def __str__(self) -> str:
        return self._text


class StabilitySource:
    """A file of `ptbench stability`."""

    def __init__(self, results: Path, file: str) -> None:
        self._shown, self._results = file, results
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
        """Number of cases that could be asked in any variant."""
        return len({row.case.name for row in self._stability.rows if row.status != NOT_APPLICABLE})

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
        return (
            f"- {link_to(self._results, self._shown)}: `ptbench stability`, {self.rows} rows; commit "
            f"{self.commit}.{drawn}"
        )
