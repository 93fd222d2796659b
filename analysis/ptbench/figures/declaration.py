"""How a figure declares itself: by `FIGURES` in its module, which `registry` finds."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ptbench.io.cells import Result, Study
from ptbench.io.stability import Stability


@dataclass(frozen=True)
class StudyFigure:
    """A figure drawn from a study of a result file; the module of `collect`'s result class must have `draw`."""

    # The name under which a study asks for this figure, or the axis or tunable whose values the study compares. For
    # studies of an axis along a parameter, a figure named AXIS_by_PARAMETER replaces scaling_by_PARAMETER.
    name: str
    collect: Callable[[Result, Study], object]  # computes the figure's numbers; raises NotDrawable with the reason
    part: str = ""  # suffix that the figure adds to the study's name; empty: the main figure, which every study has
    place: int = 0  # sort key of the figures that one study has
    is_axis: bool = False  # whether `name` is an axis: the figure then stands in for the rows of choices
    has_photographs: bool = False  # whether pages contain renders, whose colours must not be reduced when saved


@dataclass(frozen=True)
class StabilityFigure:
    """A figure of a stability file, which may have several pages."""

    name: str
    collect: Callable[[Stability], Sequence]  # computes the pages of the figure; raises NotDrawable with the reason
    draw: Callable[..., Figure]  # draws one of the pages that `collect` computed
