"""The compaction choices against each other, one group of rows a scene."""

from __future__ import annotations

from analysis.figures import rows
from analysis.figures.rows import Data, draw
from analysis.results import Result, Study

__all__ = ["collect", "draw"]


def collect(result: Result, study: Study) -> Data:
    return rows.collect(result, study, "compaction", "Stream compaction: the choices against each other")
