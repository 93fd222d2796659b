"""The choices of one axis against each other, one group of rows a scene and depth; named for the axis."""

from dataclasses import dataclass

from matplotlib.figure import Figure

from ptbench.figures import rows
from ptbench.figures.rows import Data
from ptbench.io.cells import Result, Study


@dataclass(frozen=True)
class Choices:
    """The figure of one axis or tunable."""

    axis: str

    def collect(self, result: Result, study: Study) -> Data:
        """A row a choice; raises NotDrawable."""
        return rows.collect(result, study, f"The choices of {self.axis} against each other")

    def draw(self, data: Data) -> Figure:
        """The figure of the rows that `collect` gave."""
        return rows.draw(data)
