"""How a figure declares itself: `FIGURES` in its module, which `registry` finds where it lies."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ptbench.io.cells import Result, Study
from ptbench.io.stability import Stability


@dataclass(frozen=True)
class StudyFigure:
    """A figure that a study of a result file is drawn as, by `draw` of the module that its numbers' class is of."""

    # What a study asks for: a figure by name, or the axis or the tunable whose values it compares. AXIS_by_ALONG is an
    # axis's own figure where it is followed along something, in the place of scaling_by_ALONG.
    name: str
    collect: Callable[[Result, Study], object]  # its numbers; raises NotDrawable with the reason
    part: str = ""  # what it adds to the study's name; empty: it is the one that every study has
    place: int = 0  # among the parts of a study, from the least on
    is_axis: bool = False  # whether `name` is an axis, whose choices are then not drawn as rows
    has_photographs: bool = False  # whether it keeps all its colours


@dataclass(frozen=True)
class StabilityFigure:
    """A figure of a stability file, on pages."""

    name: str
    collect: Callable[[Stability], Sequence]  # its pages; raises NotDrawable with the reason
    draw: Callable[..., Figure]  # one of its pages
