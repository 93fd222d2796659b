"""Result files for a notebook: `ptbench.load` reads them once, and gives them as rows, arrays or pandas tables."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ptbench.tidy.rows import Loaded, Rows, load_files, table_of


@dataclass(frozen=True)
class Measured:
    """One or several files of one kind, `ptbench run`'s, `ptbench stability`'s or `ptbench rays`'.

    The tables by name: "samples" (one row a timed sample), "cells", "verdicts" (one row a study and cell, with its
    ratio over the study's baseline), "stages", "live_paths", "kernels", "curves", "not_applicable", "stability"
    (one row a check), and "rays" (one row a batch). Without a name: "samples", or "stability" or "rays" of such files.
    Units are in the columns' names.
    """

    files: tuple[Loaded, ...]

    def rows(self, table: str = "") -> list[dict[str, Any]]:
        """The rows, each with the columns that it has a value of; raises InputError for another kind of file."""
        return list(self.table(table).rows)

    def columns(self, table: str = "") -> dict[str, np.ndarray]:
        """A table as one numpy array a column, all of one length: NaN or None where a row has no value."""
        return self.table(table).columns()

    def frame(self, table: str = "") -> Any:
        """A table as a pandas.DataFrame; raises ImportError where pandas is not installed."""
        # pandas is an extra: rows and columns do without it.
        from ptbench.frames import frame_of

        return frame_of(self.table(table))

    def table(self, name: str = "") -> Rows:
        """The rows with the types of all their columns."""
        return table_of(self.files, name)


def load(paths: Path | str | Iterable[Path | str]) -> Measured:
    """Reads the file, or the files; raises InputError, which says in one line what is wrong in which."""
    return Measured(load_files(paths))
