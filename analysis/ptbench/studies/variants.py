"""Finds a variant by its name or a part of it, and describes how two variants differ."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.axes import INTEGRATOR
from ptbench.io.cells import Cell, Result
from ptbench.io.names import shown_name
from ptbench.io.older import usual_baselines

_SHOWN = 3


def find_variant(result: Result, text: str, role: str = "the variant") -> str:
    """The full name of the one variant in a file that `text` matches; raises InputError.

    `role` is the call's name for it. `text` is the full name, or some of its parts in order: choices, AXIS=CHOICE,
    TUNABLE=VALUE, separated by spaces, dots, commas or plus signs. A choice that several axes have counts for the first
    axis that fits: "wavefront.none.soa" has no compaction. If no tunable is named, a variant with default tunables has
    precedence.
    """
    axes = {cell.variant: cell.axes for cell in result.cells}
    tuned = {cell.variant: cell.tuned for cell in result.cells}
    if text in axes:
        return text
    parts = [part for part in re.split(r"[.,+\s]+", text) if part]
    places = {variant: _places(axes[variant], tuned[variant], parts) for variant in axes} if parts else {}
    first = min((at for at in places.values() if at is not None), default=None)
    found = [variant for variant, at in places.items() if at is not None and at == first]
    standard = [variant for variant in found if not tuned[variant]]
    if len(found) > 1 and standard and not any(_names_tunable(axes, part) for part in parts):
        found = standard
    if len(found) == 1:
        return found[0]
    if found:
        differing = "; ".join(
            f"{name} ({', '.join(values)})" for name, values in _differences([(axes[v], tuned[v]) for v in found])
        )
        what = f'{len(found)} variants with "{text}", which differ in {differing}'
        raise bad_value(result.path, role, what, "what names one of them")
    raise _unknown(result.path, role, text, parts, axes)


def _places(axes: Mapping[str, str], tuned: Mapping[str, str], parts: Sequence[str]) -> tuple[int, ...] | None:
    """The earliest positions in a variant's name where its choices match `parts`; None: a part does not occur."""
    choices = list(axes.values())
    places: list[int] = []
    for part in parts:
        name, is_named, value = part.partition("=")
        if is_named:
            if axes.get(name, tuned.get(name)) != value:
                return None
            continue
        after = places[-1] + 1 if places else 0
        if part not in choices[after:]:
            return None
        places.append(choices.index(part, after))
    return tuple(places)


def _names_tunable(axes: Mapping[str, Mapping[str, str]], part: str) -> bool:
    return "=" in part and part.partition("=")[0] not in next(iter(axes.values()))


def _differences(variants: Sequence[tuple[Mapping[str, str], Mapping[str, str]]]) -> list[tuple[str, list[str]]]:
    """The axes and tunables in which variants, given as (axes, tuned), differ, with their values."""
    names = dict.fromkeys(name for axes, tuned in variants for name in (*axes, *tuned))
    values = {
        name: list(dict.fromkeys(axes.get(name) or tuned.get(name, "standard") for axes, tuned in variants))
        for name in names
    }
    return [(name, found) for name, found in values.items() if len(found) > 1]


def _unknown(
    path: Path, role: str, text: str, parts: Sequence[str], axes: Mapping[str, Mapping[str, str]]
) -> InputError:
    choices = list(dict.fromkeys(choice for of in axes.values() for choice in of.values()))
    unknown = [part for part in parts if "=" not in part and part not in choices]
    close = [name for part in unknown for name in get_close_matches(part, choices, _SHOWN)]
    close = close or get_close_matches(text, axes, _SHOWN, cutoff=0.3) or list(axes)[:_SHOWN]
    nearest = ", ".join(dict.fromkeys(close[:_SHOWN])) or "it has none"
    return bad_value(path, role, f'"{text}"', f"a variant of the file or a part of one name; nearest: {nearest}")


@dataclass(frozen=True)
class TableNames:
    """Names for the rows of a table, by cell name, without the settings shared by all, which stand above the table."""

    names: dict[str, str]
    shared: str  # settings that all rows share, such as "arithmetic=exact, depth"; empty if only the baseline is

    def above(self) -> list[str]:
        """The lines above the table, which tell the shared settings."""
        return [f"All rows: {self.shared}.", ""] if self.shared else []


def table_names(result: Result, cells: Sequence[Cell]) -> TableNames:
    """Names of the cells' variants without what all of them share; a single variant gets its full name."""
    usual = usual_baselines(result.baselines)
    if len({cell.variant for cell in cells}) < 2:
        return TableNames({cell.name: cell.variant for cell in cells}, "")
    axes = {axis for cell in cells for axis in cell.axes if axis != INTEGRATOR}
    fixed = {
        axis: cells[0].axes[axis]
        for axis in cells[0].axes
        if axis in axes and all(cell.axes.get(axis) == cells[0].axes[axis] for cell in cells)
    }
    tuned = {name: value for name, value in cells[0].tuned.items() if all(c.tuned.get(name) == value for c in cells)}
    told = shown_name({INTEGRATOR: "", **fixed}, tuned, usual).split()
    names = {
        cell.name: shown_name(
            cell.axes, {name: value for name, value in cell.tuned.items() if name not in tuned}, usual | fixed
        )
        for cell in cells
    }
    return TableNames(names, ", ".join(told))


def labels_of(a: Cell, b: Cell) -> tuple[str, str]:
    """The differences of two variants, for each as AXIS=CHOICE."""
    differing = _differences([(a.axes, a.tuned), (b.axes, b.tuned)])

    def label(cell: Cell) -> str:
        told = []
        for name, _ in differing:
            value = cell.axes.get(name) or cell.tuned.get(name)
            if value is None and name in cell.tunables:
                value = str(cell.tunables[name])
            told += [] if value is None else [f"{name}={value}"]
        return ", ".join(told) or cell.variant

    return label(a), label(b)
