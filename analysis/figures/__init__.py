"""One module a figure: `collect` takes the numbers from a result and a study, `draw` makes a page of them.

`collect` raises NotDrawable with the reason where a study has nothing to show. Studies name figures by the keys
here, or by a tunable whose values they compare. A study of convergence has several figures.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from analysis import style
from analysis.errors import NotDrawable
from analysis.figures import (
    bias_variance,
    equal_time,
    error_against_time,
    first_bounce_by_depth,
    remaining_paths,
    sorting_by_depth,
)
from analysis.figures.bars import CheckpointCost, Efficiency, TimeToError
from analysis.figures.choices import Choices
from analysis.figures.cost_of_robustness import CostOfRobustness
from analysis.figures.scaling import SWEEPS, Scaling
from analysis.results import Result, Study
from analysis.studies import AXIS_BASELINES, is_tunable

FIGURES = {
    "remaining_paths": remaining_paths,
    "sorting_by_depth": sorting_by_depth,
    "first_bounce_by_depth": first_bounce_by_depth,
    **{figure: Scaling(figure) for figure in SWEEPS},
    **{axis: Choices(axis) for axis in AXIS_BASELINES},
    "robustness": CostOfRobustness(),
}
# What a study of the figure "convergence" is drawn as: by what follows the study's name in a file's.
CONVERGENCE_FIGURES = {
    "": error_against_time,
    "equal_time": equal_time,
    "time_to_error": TimeToError(),
    "efficiency": Efficiency(),
    "bias_variance": bias_variance,
    "checkpoint_cost": CheckpointCost(),
}
CONVERGENCE = "convergence"
# Photographs keep their colours.
PICTURES = ("equal_time",)


def parts_of_study(study: Study) -> tuple[str, ...]:
    """The figures of a study, by what each adds to the study's name."""
    return tuple(CONVERGENCE_FIGURES) if study.figure == CONVERGENCE else ("",)


def collect_study(result: Result, study: Study, part: str = ""):
    """The numbers of the study's figure; raises NotDrawable."""
    if not study.figure:
        raise NotDrawable("the study asks for no figure")
    if study.figure not in (*FIGURES, CONVERGENCE) and not is_tunable(result, study):
        raise NotDrawable(f'no figure is called "{study.figure}"; there are {", ".join([*FIGURES, CONVERGENCE])}')
    if not result.cells_of(study):
        raise NotDrawable("the file has no cell of this study")
    return _figure(study, part).collect(result, study)


def draw_study(study: Study, data, part: str = "") -> Figure:
    """The figure of what `collect_study` gave."""
    with style.applied():
        return _figure(study, part).draw(data)


def _figure(study: Study, part: str):
    """The figure of that name; any other name is a tunable's."""
    if study.figure == CONVERGENCE:
        return CONVERGENCE_FIGURES[part]
    return FIGURES.get(study.figure) or Choices(study.figure)
