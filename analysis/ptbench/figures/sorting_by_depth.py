"""What sorting rays (by material or otherwise) costs or saves at each path depth."""

from ptbench.figures import by_depth, lines, rows
from ptbench.figures.by_depth import draw
from ptbench.io.cells import Result, Study

__all__ = ["collect", "draw"]


def collect(result: Result, study: Study) -> lines.Data | rows.Data:
    """Lines over depth, or rows where there is one depth; raises NotDrawable."""
    return by_depth.collect(result, study, "Material sorting: time by depth")
