"""Whether files of several machines come from one program, so that their differences are those of the machines."""

from collections.abc import Sequence
from typing import Protocol

UNKNOWN = "unknown"
_HASHES = ("cuda_kernel_source_hash", "program_hash")  # hashes of programs; the first that all files have counts


class Measured(Protocol):
    """Any file with a run's context: a result file or a file of `ptbench rays`."""

    def about(self, key: str) -> str:
        """A ptbench context value, or "unknown"."""


def why_not_one(files: Sequence[Measured]) -> str:
    """Why files may not be compared as machines; empty where they come from one program."""
    hashes = next(
        (found for name in _HASHES if UNKNOWN not in (found := [file.about(name) for file in files])), [UNKNOWN, ""]
    )
    if len(set(hashes)) > 1:
        commits = " and ".join(dict.fromkeys(map(_commit, files)))
        return f"they are of several programs ({commits}), and what those differ in would count as the machines'"
    if dirty := [file for file in files if file.about("git_dirty") == "true"]:
        return f"{_commit(dirty[0])} had changes that were not committed, so nobody can say which program it was"
    return ""


def _commit(file: Measured) -> str:
    return file.about("git_sha")[:7]


def devices_of(file: Measured) -> str:
    """The name of the GPU, or of the CPU where there is no GPU."""
    gpu = file.about("cuda_device")
    return gpu if gpu != UNKNOWN else file.about("cpu_model")
