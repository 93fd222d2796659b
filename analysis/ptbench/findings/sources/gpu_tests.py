"""A file of a package's gpu_tests, as a page asks it."""

from ptbench.errors import FindingError
from ptbench.findings.source import Source


class GpuTestsSource(Source, form="ptbench-gpu-tests-1"):
    """A file of a package's gpu_tests."""

    @property
    def commit(self) -> str:
        """The commit of the programs that ran."""
        return self._value["context"]["ptbench.git_sha"]

    @property
    def machine(self) -> str:
        """What kind of machine it was."""
        return self._value["context"]["ptbench.machine"]

    @property
    def provenance(self) -> str:
        """A line of a list: the file and what it is."""
        return f"- {self._link}: `gpu_tests` of a package."

    def must_not_fail(self, text: str) -> str:
        """The text; raises FindingError where a test failed or all were skipped."""
        if self.count("failed") > 0 or self.count("passed") == 0:
            raise FindingError(f"{self._shown}: {self.count('failed')} failed, {self.count('passed')} passed: {text}")
        return text

    def count(self, word: str) -> int:
        """How many tests `passed`, `failed` or were `skipped`."""
        return sum(program[word] for program in self._value["programs"].values())

    @property
    def programs(self) -> int:
        """How many test programs."""
        return len(self._value["programs"])
