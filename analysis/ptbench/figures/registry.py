"""Finds every figure by its name: each module of this folder declares its own in `FIGURES`.

A study names a figure, or an axis or tunable whose values it compares. A study may have several figures, called parts.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from importlib import import_module

from matplotlib.figure import Figure

from ptbench.errors import NotDrawable
from ptbench.figures import rows, style
from ptbench.figures.declaration import StabilityFigure, StudyFigure
from ptbench.found import modules
from ptbench.io.asked import CONVERGENCE
from ptbench.io.cells import Result, Study
from ptbench.studies.questions import axes_of, is_tunable


def _declared() -> Iterator[StudyFigure | StabilityFigure]:
    for module in modules("figures/*.py", "figures/*/*.py"):
        yield from getattr(module, "FIGURES", ())


@cache
def study_figures() -> Mapping[tuple[str, str], StudyFigure]:
    """The figures of studies by name and part; parts are ordered by `place`, the rest by module."""
    found = [figure for figure in _declared() if isinstance(figure, StudyFigure)]
    by_name: dict[tuple[str, str], StudyFigure] = {}
    for figure in sorted(found, key=lambda figure: figure.place):
        if by_name.setdefault((figure.name, figure.part), figure) is not figure:
            raise ValueError(f'two figures are called "{figure.name}" with the part "{figure.part}"')
    return by_name


@cache
def stability_figures() -> tuple[StabilityFigure, ...]:
    """The figures of stability files, in the order of their modules."""
    return tuple(figure for figure in _declared() if isinstance(figure, StabilityFigure))


def parts_of_study(study: Study) -> tuple[str, ...]:
    """The parts of a study: the suffixes that its figures add to the study's name."""
    name = _name(study)
    return ("", *(part for figure, part in study_figures() if part and figure == name))


def has_photographs(study: Study, part: str) -> bool:
    """Whether a part of the study contains renders, so that its colours must not be reduced."""
    figure = study_figures().get((_name(study), part))
    return figure is not None and figure.has_photographs


def collect_study(result: Result, study: Study, part: str = ""):
    """The numbers of a study's figure; raises NotDrawable."""
    if not study.figure:
        raise NotDrawable("the study asks for no figure")
    if _name(study) not in figure_names(result) and not is_tunable(result, study):
        raise NotDrawable(f'no figure is called "{study.figure}"; there are {", ".join(figure_names(result))}')
    if not result.cells_of(study):
        raise NotDrawable("the file has no cell of this study")
    return _collect(study, part)(result, study)


def figure_names(result: Result) -> list[str]:
    """The figures that a study of a file may name, except those of tunables: the declared ones, and one per axis."""
    declared = [figure for (_, part), figure in study_figures().items() if not part]
    named = [figure.name for figure in declared if not figure.is_axis and figure.name != CONVERGENCE]
    own = [figure.name for figure in declared if figure.is_axis]
    return [*named, *(axis for axis in axes_of(result) if axis not in own), *own, CONVERGENCE]


def draw(data) -> Figure:
    """Draws the figure for data from `collect_study`."""
    with style.applied():
        return import_module(type(data).__module__).draw(data)


def _name(study: Study) -> str:
    """The name of a study's figure: AXIS_by_ALONG where that is declared, else what the study asks for."""
    own = f"{study.compares}_by_{study.along}"
    return own if (own, "") in study_figures() else study.figure


def _collect(study: Study, part: str) -> Callable[[Result, Study], object]:
    """The function that collects a figure's data; an undeclared one shows an axis's choices or a tunable's values."""
    name = _name(study)
    if part or (name, part) in study_figures():
        return study_figures()[name, part].collect
    return partial(rows.collect, default_title=f"The choices of {study.figure} against each other")
