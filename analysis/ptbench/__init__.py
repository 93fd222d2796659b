"""Reads ptbench result files and draws what they say. Knows nothing of the C++ side but the file format.

In a notebook:

    import ptbench

    ptbench.load("results/nvidia-h200/compaction.json").frame("verdicts")

From the bottom up, each using those before it: `errors`, `terminal`, `numbers`; `io`, the files; `stats`; `studies`,
`convergence` and `stability`, what was measured; `figures`; `explain`, `compare`, `plots`, `report`, what is told of
it; `tidy` and `frames`, rows for one's own work; `cli`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from ptbench.measured import Measured

__version__ = "1.0.0"  # version of the Python package; equal to that of the ptbench program in CMakeLists.txt


def load(paths: Path | str | Iterable[Path | str]) -> Measured:
    """Reads one result file or several of one kind for a notebook; see `ptbench.measured.Measured`.

    Raises ptbench.errors.InputError, which says in one line what is wrong in which file.
    """
    # numpy and other heavy packages are imported late, so that a wrong command line is refused at once.
    from ptbench import measured

    return measured.load(paths)
