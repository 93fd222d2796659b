"""Selects cells of a result file by few words: "wavefront layout=soa scene=cornell_open".

A word without `=` is an integrator; other words are `axis=choice`, `tunable=value`, or set `scene`, `depth`,
`resolution`, `spp`, `backend` or `study`. An axis that is not named is at the file's baseline, a tunable at its
standard, and a setting must have only one value. `*` matches any value.
"""

from collections.abc import Mapping

from ptbench.errors import FindingError
from ptbench.io.axes import INTEGRATOR
from ptbench.io.cells import Cell, Result
from ptbench.io.older import usual_baselines
from ptbench.studies.questions import dimension

_SETTINGS = ("scene", "depth", "resolution", "spp", "backend")


def parsed(text: str) -> dict[str, str]:
    """The words of a selection by name; raises FindingError for a name that occurs twice."""
    chosen: dict[str, str] = {}
    for word in text.split():
        name, is_named, value = word.partition("=")
        key, choice = (name, value) if is_named else (INTEGRATOR, name)
        if key in chosen:
            raise FindingError(f'"{text}" names {key} twice')
        chosen[key] = choice
    return chosen


def cells_of(result: Result, chosen: Mapping[str, str]) -> list[Cell]:
    """Every cell that a selection matches, in the file's order; raises FindingError for none or a meaningless word."""
    studies = {study.name for study in result.studies}
    if chosen.get("study", "*") not in (*studies, "*"):
        raise FindingError(f"{result.path}: no study {chosen['study']}, there are {', '.join(sorted(studies))}")
    known = {name for cell in result.cells for name in (*cell.axes, *cell.tunables)} | {*_SETTINGS, "study"}
    if unknown := [name for name in chosen if name not in known]:
        raise FindingError(f"{result.path}: no cell has {', '.join(unknown)}")
    standard = usual_baselines(result.baselines)
    found = [cell for cell in result.cells if _is_named(standard, cell, chosen)]
    if not found:
        raise FindingError(f"{result.path}: no cell is {_text(chosen)}")
    return found


def cell_of(result: Result, chosen: Mapping[str, str]) -> Cell:
    """The one measured cell that a selection matches; raises FindingError for several, with differences, or none."""
    found = cells_of(result, chosen)
    if len(found) > 1:
        values = {name: list(dict.fromkeys(dimension(cell, name) for cell in found)) for name in _SETTINGS}
        differing = "; ".join(f"{name} ({', '.join(map(str, of))})" for name, of in values.items() if len(of) > 1)
        raise FindingError(f"{result.path}: {len(found)} cells are {_text(chosen)}; they differ in {differing}")
    if not found[0].measured:
        raise FindingError(f"{result.path}: {found[0].name} has no times: {found[0].failure}")
    return found[0]


def _is_named(standard: Mapping[str, str], cell: Cell, chosen: Mapping[str, str]) -> bool:
    """Whether a cell matches the words of a selection; `standard` holds the baseline of each axis."""
    if chosen.get("study", "*") not in (*cell.studies, "*"):
        return False
    return (
        all(value == "*" or dimension(cell, name) == value for name, value in chosen.items() if name != "study")
        and all(choice == standard.get(axis) for axis, choice in cell.axes.items() if axis not in chosen)
        and cell.tuned.keys() <= chosen.keys()
    )


def _text(chosen: Mapping[str, str]) -> str:
    return " ".join(f"{name}={value}" for name, value in chosen.items())
