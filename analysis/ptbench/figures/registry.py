"""One module a figure: `collect` takes the numbers from a result and a study, `draw` makes a page of them.

`collect` raises NotDrawable with the reason where a study has nothing to show. Studies name figures by the keys
here, or by an axis or a tunable whose values they compare. A study of convergence has several figures.
"""

from matplotlib.figure import Figure

from ptbench.errors import NotDrawable
from ptbench.figures import (
    devices,
    first_bounce_by_depth,
    integrator_by_cost,
    remaining_paths,
    sorting_by_depth,
    style,
    time_to_image,
)
from ptbench.figures.choices import Choices
from ptbench.figures.convergence import bias_variance, equal_time, error_against_time
from ptbench.figures.convergence.bars import CheckpointCost, Efficiency, TimeToError
from ptbench.figures.cost_of_robustness import CostOfRobustness
from ptbench.figures.scaling import SWEEPS, Scaling
from ptbench.io.cells import Result, Study
from ptbench.studies.questions import axes_of, is_tunable

FIGURES = {
    "remaining_paths": remaining_paths,
    "sorting_by_depth": sorting_by_depth,
    "first_bounce_by_depth": first_bounce_by_depth,
    **{figure: Scaling(figure) for figure in SWEEPS},
}
# The axes that have a figure of their own; any other axis is drawn by Choices.
AXIS_FIGURES = {"robustness": CostOfRobustness(), "devices": devices}
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
# What a study of these figures is drawn as too, where its scenes have meshes.
MESH_FIGURES = {"builder": {"time_to_image": time_to_image}, "shading_fmas": {"by_integrator": integrator_by_cost}}
# Figures with photographs, which keep their colours.
PICTURES = ("equal_time",)


def parts_of_study(study: Study) -> tuple[str, ...]:
    """The figures of a study, by what each adds to the study's name."""
    return tuple(CONVERGENCE_FIGURES) if study.figure == CONVERGENCE else ("", *MESH_FIGURES.get(study.figure, ()))


def collect_study(result: Result, study: Study, part: str = ""):
    """The numbers of the study's figure; raises NotDrawable."""
    if not study.figure:
        raise NotDrawable("the study asks for no figure")
    if study.figure not in figure_names(result) and not is_tunable(result, study):
        raise NotDrawable(f'no figure is called "{study.figure}"; there are {", ".join(figure_names(result))}')
    if not result.cells_of(study):
        raise NotDrawable("the file has no cell of this study")
    return _figure(study, part).collect(result, study)


def figure_names(result: Result) -> list[str]:
    """The figures that a study of this file may ask for, but for its tunables': those here, and one an axis."""
    axes = [axis for axis in axes_of(result) if axis not in AXIS_FIGURES]
    return [*FIGURES, *axes, *AXIS_FIGURES, CONVERGENCE]


def draw_study(study: Study, data, part: str = "") -> Figure:
    """The figure of what `collect_study` gave."""
    with style.applied():
        return _figure(study, part).draw(data)


def _figure(study: Study, part: str):
    """The figure of that name; any other name is an axis's or a tunable's."""
    if study.figure == CONVERGENCE:
        return CONVERGENCE_FIGURES[part]
    if part:
        return MESH_FIGURES[study.figure][part]
    return (FIGURES | AXIS_FIGURES).get(study.figure) or Choices(study.figure)
