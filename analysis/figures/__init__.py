"""One module a figure: `collect` takes the numbers from a result and a study, `draw` makes a page of them.

`collect` raises NotDrawable with the reason where a study has nothing to show. Studies name figures by the keys
here, or by a tunable whose values they compare.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from analysis import style
from analysis.errors import NotDrawable
from analysis.figures import first_bounce_by_depth, remaining_paths, sorting_by_depth
from analysis.figures.choices import Choices
from analysis.figures.scaling import SWEEPS, Scaling
from analysis.results import Result, Study
from analysis.studies import AXIS_BASELINES, is_tunable

FIGURES = {
    "remaining_paths": remaining_paths,
    "sorting_by_depth": sorting_by_depth,
    "first_bounce_by_depth": first_bounce_by_depth,
    **{figure: Scaling(figure) for figure in SWEEPS},
    **{axis: Choices(axis) for axis in AXIS_BASELINES},
}


def collect_study(result: Result, study: Study):
    """The numbers of the study's figure; raises NotDrawable."""
    if not study.figure:
        raise NotDrawable("the study asks for no figure")
    if study.figure not in FIGURES and not is_tunable(result, study):
        raise NotDrawable(f'no figure is called "{study.figure}"; there are {", ".join(FIGURES)}')
    if not result.cells_of(study):
        raise NotDrawable("the file has no cell of this study")
    return _figure(study).collect(result, study)


def draw_study(study: Study, data) -> Figure:
    """The figure of what `collect_study` gave."""
    with style.applied():
        return _figure(study).draw(data)


def _figure(study: Study):
    """The figure of that name; any other name is a tunable's."""
    return FIGURES.get(study.figure) or Choices(study.figure)
