"""Result files for a notebook: `ptbench.load` reads them once, and gives them as rows, arrays or pandas tables."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ptbench.tidy.rows import Loaded, Rows, load_files, table_of


@dataclass(frozen=True)
class Measured:
    """Files of one kind, of `ptbench run`, `ptbench stability` or `ptbench rays`, as tables.

    The tables by name: "samples" (one row per timed sample), "cells", "verdicts" (one row per study and cell, with its
    ratio over the study's baseline), "stages", "live_paths", "kernels", "curves", "not_applicable", "stability" (one
    row per check), and "rays" (one row per batch). The default is "samples", or for such files "stability" or "rays".
    Units are in the columns' names.
    """

    files: tuple[Loaded, ...]

    def rows(self, table: str = "") -> list[dict[str, Any]]:
        """The rows of a table, each with the columns that have a value; raises InputError for another kind of file."""
        return list(self.table(table).rows)

    def columns(self, table: str = "") -> dict[str, np.ndarray]:
        """A table as one numpy array per column, all of one length: NaN or None where a row has no value."""
        return self.table(table).columns()

    def frame(self, table: str = "") -> Any:
        """A table as a pandas.DataFrame; raises ImportError where pandas is not installed."""
        # pandas is an optional dependency that only `frame` needs, so it is imported only here.
        from ptbench.frames import frame_of

        return frame_of(self.table(table))

    def table(self, name: str = "") -> Rows:
        """The rows of a table with the types of all its columns."""
        return table_of(self.files, name)


def load(paths: Path | str | Iterable[Path | str]) -> Measured:
    """Reads one or several result files; raises InputError, which names the file and what is wrong in it."""
    return Measured(load_files(paths))
