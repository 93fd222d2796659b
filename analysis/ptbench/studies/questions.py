"""The question of a study: the axis or tunable that it compares, its baseline, and what else differs between cells."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ptbench.io.axes import INTEGRATOR, ROBUSTNESS
from ptbench.io.cells import Cell, Result, Study
from ptbench.io.older import usual_baselines


@dataclass(frozen=True)
class Question:
    """The axis or tunable that a figure compares, and the baseline choice."""

    axis: str
    baseline: str
    is_tunable: bool = False

    @property
    def shown_baseline(self) -> str:
        """The baseline's name in a figure."""
        return f"{self.axis}={self.baseline}" if self.is_tunable else self.baseline

    def choice_of(self, cell: Cell) -> str:
        """The name of a cell's choice in a figure."""
        value = dimension(cell, self.axis)
        if self.is_tunable:
            return f"no {self.axis}" if value is None else f"{self.axis}={value}"
        return value or "?"


# Parameters of scenes that studies sweep, with the setting of cells (such as the scene) that tells their values apart.
_SWEPT = {"materials": "scene"}


def question_of(result: Result, study: Study | None) -> Question | None:
    """The question of a study's figure; None where it compares no choices.

    The baseline is the file's for its backend, or the tunable's standard, or the first choice run if that was not run.
    """
    if study is None:
        return None
    cells = result.cells_of(study)
    if is_tunable(result, study):
        tuned = [cell for cell in cells if study.figure in cell.tunables]
        first = next((cell for cell in tuned if study.figure not in cell.tuned), tuned[0])
        return Question(study.figure, str(first.tunables[study.figure]), is_tunable=True)
    axis = _axis_of(result, study.figure)
    # A study along a parameter is about the axis that it names, or else the first axis with several choices in it.
    if study.along:
        axis = study.compares or _varying_axis(result, cells)
    if axis is None:
        return None
    run = list(dict.fromkeys(cell.axes[axis] for cell in cells if axis in cell.axes))
    baseline = usual_baseline(result, axis)
    # A file that does not name its baselines is older than studies without a baseline cell.
    if run and baseline not in run and (result.baselines or baseline is None):
        baseline = run[0]
    return Question(axis, baseline or "?")


def is_tunable(result: Result, study: Study) -> bool:
    """Whether the figure of a study compares the values of a tunable."""
    known = bool(study.along) or _axis_of(result, study.figure) is not None
    return not known and any(study.figure in cell.tunables for cell in result.cells_of(study))


def axes_of(result: Result) -> list[str]:
    """The axes of a file, in the order in which variants' names list them."""
    named = (axis for cell in result.cells for axis in cell.axes)
    return list(dict.fromkeys([*usual_baselines(result.baselines), *named]))


def _axis_of(result: Result, figure: str) -> str | None:
    """The axis that a figure of that name compares in this file; None: the figure is about no axis, or about any."""
    # Some studies of older files are about robustness, although these files lack the axis.
    return figure if figure in (ROBUSTNESS, *axes_of(result)) else None


def usual_baseline(result: Result, axis: str) -> str | None:
    """The baseline of an axis on the file's backend; None: unknown."""
    return usual_baselines(result.baselines).get(axis)


def _varying_axis(result: Result, cells: Sequence[Cell]) -> str | None:
    return next((name for name in axes_of(result) if len({cell.axes.get(name) for cell in cells}) > 1), None)


def swept_by(study: Study | None) -> str:
    """The dimension that tells the points of one line apart."""
    along = study.along if study is not None else ""
    return _SWEPT.get(along, along) or "depth"


def dimension(cell: Cell, name: str) -> str | None:
    """A cell's value of an axis, a setting or a tunable, as text; None: the cell has no such tunable."""
    if name in _SETTINGS:
        return _SETTINGS[name](cell)
    if name in cell.axes:
        return cell.axes[name]
    return str(cell.tunables[name]) if name in cell.tunables else None


_SETTINGS: dict[str, Callable[[Cell], str]] = {
    "scene": lambda cell: cell.scene,
    "backend": lambda cell: cell.backend,
    "resolution": lambda cell: cell.resolution_text,
    "depth": lambda cell: str(cell.depth),
    "spp": lambda cell: str(cell.spp),
}


def varying_dimensions(cells: Sequence[Cell], question: Question | None, swept: str = "depth") -> list[str]:
    """Dimensions that vary between cells of one scene and x besides the question's axis, and belong in labels."""
    axes = dict.fromkeys(name for cell in cells for name in cell.axes)
    tunables = dict.fromkeys(name for cell in cells for name in cell.tunables)
    settings = [name for name in ("backend", "resolution", "depth", "spp") if name != swept]
    varying = []
    for name in [*axes, *settings, *tunables]:
        if name == swept or (question is not None and name == question.axis):
            continue
        groups: dict[tuple, set[str | None]] = {}
        for cell in cells:
            # Labels do not mention a tunable if it differs only because two choices have different default values.
            choices = tuple(cell.axes.items()) if name in tunables else ()
            groups.setdefault((cell.scene, dimension(cell, swept), choices), set()).add(dimension(cell, name))
        if any(len(values - {None}) > 1 for values in groups.values()):
            varying.append(name)
    return varying


def fixed_axes(cells: Sequence[Cell], question: Question | None) -> dict[str, str]:
    """The axes that have the same choice in all of these cells."""
    names = dict.fromkeys(name for cell in cells for name in cell.axes)
    fixed = {}
    for name in names:
        choices = {cell.axes.get(name, "") for cell in cells}
        if len(choices) == 1 and (question is None or name != question.axis):
            fixed[name] = choices.pop()
    return fixed


def fixed_tunables(cells: Sequence[Cell], dimensions: Sequence[str]) -> dict[str, list[int]]:
    """The values of the tunables that are no dimension; several where choices have different standards."""
    names = dict.fromkeys(name for cell in cells for name in cell.tunables if name not in dimensions)
    return {name: sorted({cell.tunables[name] for cell in cells if name in cell.tunables}) for name in names}


def label_of(cell: Cell, question: Question | None, dimensions: Sequence[str]) -> str:
    """A cell's label: its choice and what else varies, or only the latter where no choices are compared."""
    values = ((name, dimension(cell, name)) for name in dimensions)
    others = [f"{name}={value}" for name, value in values if value is not None]
    if question is not None:
        others.insert(0, question.choice_of(cell))
    return ", ".join(others) or cell.axes.get(INTEGRATOR, cell.variant)
