"""What keeping the camera rays' intersections costs or saves at each path depth."""

from __future__ import annotations

from analysis.figures import by_depth, lines, rows
from analysis.figures.by_depth import draw
from analysis.results import Result, Study

__all__ = ["collect", "draw"]


def collect(result: Result, study: Study) -> lines.Data | rows.Data:
    return by_depth.collect(result, study, "First-bounce cache: time by depth")
