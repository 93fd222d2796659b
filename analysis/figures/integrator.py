"""The integrators against each other, one group of rows a scene, by layout and kernel where these differ."""

from __future__ import annotations

from analysis.figures import rows
from analysis.figures.rows import Data, draw
from analysis.results import Result, Study

__all__ = ["collect", "draw"]


def collect(result: Result, study: Study) -> Data:
    return rows.collect(result, study, "integrator", "Integrators against each other")
