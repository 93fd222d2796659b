"""A result of a package's `gpu_tests` as a source of numbers for a page."""

from ptbench.errors import FindingError
from ptbench.findings.source import Source


class GpuTestsSource(Source, form="ptbench-gpu-tests-1"):
    """The numbers of passed, failed and skipped tests in a result of a package's `gpu_tests`."""

    @property
    def commit(self) -> str:
        """The commit of the test programs that ran."""
        return self._value["context"]["ptbench.git_sha"]

    @property
    def machine(self) -> str:
        """The kind of machine on which the GPU tests ran."""
        return self._value["context"]["ptbench.machine"]

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file and what it is."""
        return f"- {self._link}: `gpu_tests` of a package."

    def must_not_fail(self, text: str) -> str:
        """Returns `text` unless a GPU test failed or none passed; otherwise raises FindingError."""
        if self.count("failed") > 0 or self.count("passed") == 0:
            raise FindingError(f"{self._shown}: {self.count('failed')} failed, {self.count('passed')} passed: {text}")
        return text

    def count(self, word: str) -> int:
        """The number of GPU tests with an outcome: `passed`, `failed` or `skipped`."""
        return sum(program[word] for program in self._value["programs"].values())

    @property
    def programs(self) -> int:
        """The number of GPU test programs."""
        return len(self._value["programs"])
