"""Whether files of several machines are of one program, so that what differs between them is the machines'."""

from collections.abc import Sequence
from typing import Protocol

UNKNOWN = "unknown"
_HASHES = ("cuda_kernel_source_hash", "program_hash")  # the first that all files have decides


class Measured(Protocol):
    """A result file or one of `ptbench rays`."""

    def about(self, key: str) -> str:
        """A ptbench context value, or "unknown"."""


def why_not_one(files: Sequence[Measured]) -> str:
    """Why they may not be held against each other as machines; empty where they may."""
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
    """The GPU, or the CPU where there is none."""
    gpu = file.about("cuda_device")
    return gpu if gpu != UNKNOWN else file.about("cpu_model")
