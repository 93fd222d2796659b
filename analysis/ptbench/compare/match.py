"""Pairs the cells of two result files that measured the same work, and tells why any other cell has no partner.

A cell is identified by what it rendered: the scene's content, the variant and the settings. Backend and samples per
pixel belong to its identity unless the two files have no backend in common. The work that the files report must agree,
too: the film bits, where both files claim bitwise equality, and the number of rays.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.io.axes import ARITHMETIC, PRECISION, ROBUSTNESS
from ptbench.io.cells import Cell, Result
from ptbench.io.limits import limit
from ptbench.io.older import before
from ptbench.stats.intervals import welch_test

# Axes that say how a variant computes its image, not what image it computes.
_HOW_IT_COMPUTES = (ARITHMETIC, PRECISION, ROBUSTNESS)
# Probability of refusing, for its ray counts, any pair of cells that did equal work, in one comparison of two files.
_FAMILY_ERROR = limit("family_error")

MACHINE_KEYS = (
    "machine", "backend", "cpu_model", "threads", "cuda_device", "cuda_multiprocessors", "cuda_clock_mhz",
    "cuda_memory_mib", "cuda_memory_clock_mhz", "cuda_memory_bus_bits",
)  # fmt: skip
PROGRAM_KEYS = (
    "version", "git_sha", "git_dirty", "program_hash", "cuda_kernel_source_hash", "compiler", "compiler_flags",
    "build_type", "os", "openmp_environment", "thrust_version", "thrust_system", "cuda_driver", "cuda_runtime",
    "cuda_nvrtc", "cuda_cccl",
)  # fmt: skip


def machine_of(result: Result) -> tuple[str, ...]:
    """The properties in which two result files must agree to count as one machine and backend."""
    return tuple(result.about(key) for key in MACHINE_KEYS)


def is_repeated(one: Result, other: Result) -> bool:
    """Whether two result files are of one machine and program: an A/A run, whose every difference is noise."""
    return (
        machine_of(one) == machine_of(other)
        and "unknown" not in (one.about("program_hash"), other.about("program_hash"))
        and all(one.about(key) == other.about(key) for key in PROGRAM_KEYS)
    )


@dataclass(frozen=True)
class Pair:
    """Two cells that measured the same work; `remarks` name what differs nonetheless."""

    reference: Cell
    other: Cell
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Alone:
    """A cell without a partner; `kind` is the reason in a word or two, `reason` the full sentence."""

    in_reference: bool
    cell: Cell
    kind: str
    reason: str


@dataclass(frozen=True)
class Matching:
    """All cells of two files, in pairs or alone."""

    reference: Result
    other: Result
    pairs: tuple[Pair, ...]
    alone: tuple[Alone, ...]
    across_backends: bool
    assumed: tuple[str, ...]  # one sentence per file of an older schema: values it lacks, and those assumed instead


def match(reference: Result, other: Result, *, films_may_differ: bool = False) -> Matching:
    """Pairs the cells of two files, each cell at most once.

    `films_may_differ`: a pair whose films have other bits stands if its mean numbers of rays agree.
    """
    across = _backends(reference).isdisjoint(_backends(other))
    axes = axes_of(reference, other)
    matched = _by_identity(reference, other, axes, across)
    partners = {cell.name: partner for cell, partner in matched}
    reverse = {partner.name: cell for cell, partner in matched}
    level = _FAMILY_ERROR / max(1, len(matched))
    pairs: list[Pair] = []
    alone: list[Alone] = []
    there = _There(other, reverse.keys(), axes, across)
    for cell in reference.cells:
        if (partner := partners.get(cell.name)) is None:
            alone.append(Alone(True, cell, *there.why_not(cell)))
            continue
        refused, remarks = _same_work(cell, partner, level, films_may_differ)
        if refused is None:
            pairs.append(Pair(cell, partner, tuple(remarks)))
        else:
            alone += [Alone(True, cell, *refused), Alone(False, partner, *refused)]
    here = _There(reference, partners.keys(), axes, across)
    alone += [Alone(False, cell, *here.why_not(cell)) for cell in other.cells if cell.name not in reverse]
    assumed = [sentence for result in (reference, other) if (sentence := _assumed(result, axes))]
    return Matching(reference, other, tuple(pairs), tuple(alone), across, tuple(assumed))


def _backends(result: Result) -> set[str]:
    return {cell.backend for cell in result.cells}


def axes_of(*results: Result) -> list[str]:
    """The axes that any cell of the result files has, in the files' order."""
    return list(dict.fromkeys(axis for result in results for axis in _axes(result)))


def _axes(result: Result) -> list[str]:
    return list(dict.fromkeys(axis for cell in result.cells for axis in cell.axes))


def _assumed(result: Result, axes: Sequence[str]) -> str:
    known = _axes(result)
    taken = [f"{axis}={before(axis)}" for axis in axes if axis not in known and before(axis) is not None]
    return f"{result.path} is older than some axes; taken as {', '.join(taken)}" if taken else ""


def choice_of(cell: Cell, axis: str) -> str | None:
    """A cell's choice on an axis, or the implied one where its file is older than the axis; None: unknown."""
    return cell.axes.get(axis, before(axis))


def _fields(cell: Cell, axes: Sequence[str], across: bool) -> dict[str, object]:
    """The fields that identify a cell, by the names that a reader knows.

    Tunables are included only where they differ from their choice's standard, as in the variant's name: a standard may
    have moved between two commits, and then that is part of what is compared.
    """
    return {
        "scene": cell.scene_hash,
        **{axis: choice_of(cell, axis) for axis in axes},
        "tunables": tuple(sorted(cell.tuned.items())),
        "resolution": cell.resolution_text,
        "depth": cell.depth,
        "checkpoints": cell.convergence is not None,
        **({} if across else {"backend": cell.backend, "spp": cell.spp}),
    }


def _by_identity(reference: Result, other: Result, axes: Sequence[str], across: bool) -> list[tuple[Cell, Cell]]:
    """Pairs cells one to one by identity; nearest samples per pixel go first, then larger cells."""
    candidates: dict[tuple, list[Cell]] = {}
    for cell in other.cells:
        candidates.setdefault(tuple(_fields(cell, axes, across).values()), []).append(cell)
    possible = [
        (*_apart(cell, partner), order, cell, partner)
        for order, cell in enumerate(reference.cells)
        # A cell without a scene hash may show any scene, so it is not paired with a cell of the other file.
        if cell.scene_hash
        for partner in candidates.get(tuple(_fields(cell, axes, across).values()), ())
    ]
    taken: set[tuple[bool, str]] = set()
    matched = []
    for *_, cell, partner in sorted(possible, key=lambda item: item[:-2]):
        if (True, cell.name) not in taken and (False, partner.name) not in taken:
            taken |= {(True, cell.name), (False, partner.name)}
            matched.append((cell, partner))
    return matched


def _apart(cell: Cell, partner: Cell) -> tuple[float, int, bool]:
    """A sort key for how far apart two cells' samples are; their product prefers the larger of equally near ones."""
    return abs(math.log2(partner.spp / cell.spp)), -partner.spp * cell.spp, partner.scene != cell.scene


def _same_work(
    cell: Cell, partner: Cell, level: float, films_may_differ: bool
) -> tuple[tuple[str, str] | None, list[str]]:
    """Checks that two cells did the same work: ((kind, reason) for refusing the pair or None, remarks)."""
    for which, one in (("the reference", cell), ("the other file", partner)):
        if one.failed:
            return ("failed", f"failed in {which}: {one.failure}"), []
        if not one.samples:
            why = f" ({one.status}{': ' + one.reason if one.reason else ''})" if one.status != "ok" else ""
            return ("no samples", f"no samples in {which}{why}"), []
    if _renders(cell) == _renders(partner):
        return ("same renders", "both files hold the very same samples: one run is no two"), []
    if cell.claim != partner.claim:
        return ("other claim", f"claims {cell.claim or 'nothing'} here and {partner.claim or 'nothing'} there"), []
    remarks = []
    if cell.spp != partner.spp:
        remarks.append(f"spp {cell.spp} against {partner.spp}")
    if moved := _moved_standards(cell, partner):
        remarks.append("other standard of " + ", ".join(moved))
    different = None
    if _has_bits(cell, partner):
        different = _other_bits(cell, partner)
        if different is None:
            return None, remarks
        if not films_may_differ:
            return ("other film", different), []
        remarks.append(different)
    if (rays := _other_rays(cell, partner, level)) is not None:
        return ("other rays", rays), []
    if min(len(cell.samples), len(partner.samples)) < 2 and _rays_per_path(cell)[0] != _rays_per_path(partner)[0]:
        remarks.append("rays not tested: one sample")
    return None, remarks


def _renders(cell: Cell) -> list[tuple]:
    return [(sample.timestamp, sample.wall_ms) for sample in cell.samples]


def _moved_standards(cell: Cell, partner: Cell) -> list[str]:
    return [
        f"{name} ({value}, now {partner.tunables[name]})"
        for name, value in cell.tunables.items()
        if name in partner.tunables and name not in cell.tuned and value != partner.tunables[name]
    ]


def _has_bits(cell: Cell, partner: Cell) -> bool:
    """Whether two cells must have the same film bits: exact arithmetic, a bitwise claim, equal seeds and samples."""
    return (
        all(one.claim == "bitwise" and choice_of(one, ARITHMETIC) == "exact" for one in (cell, partner))
        and cell.spp == partner.spp
        and bool(_common_seeds(cell, partner))
    )


def _common_seeds(cell: Cell, partner: Cell) -> list[int]:
    theirs = {sample.seed for sample in partner.samples}
    return [sample.seed for sample in cell.samples if sample.seed is not None and sample.seed in theirs]


def _other_bits(cell: Cell, partner: Cell) -> str | None:
    if cell.film_hash and partner.film_hash and cell.film_hash != partner.film_hash:
        return f"film {cell.film_hash} against {partner.film_hash}, which must be equal"
    rays, theirs = ({sample.seed: sample.rays for sample in one.samples} for one in (cell, partner))
    for seed in _common_seeds(cell, partner):
        if rays[seed] != theirs[seed]:
            return f"{rays[seed]:.0f} rays against {theirs[seed]:.0f} with seed {seed}, which must be equal"
    return None


def _rays_per_path(cell: Cell) -> np.ndarray:
    return np.array([sample.rays / sample.paths for sample in cell.samples if sample.paths])


def _other_rays(cell: Cell, partner: Cell, level: float) -> str | None:
    """Tells by how much the rays per path of two cells differ, if by more than samples with other seeds differ.

    Welch's test compares the means over samples. Equal seeds make the samples alike, and the test refuse less often.
    """
    rays, theirs = _rays_per_path(cell), _rays_per_path(partner)
    if min(rays.size, theirs.size) < 2 or welch_test(rays, theirs) >= level:
        return None
    return f"{rays.mean():.6g} rays a path against {theirs.mean():.6g}: not the same work"


# Sets of fields: an unpaired cell is reported with cells of the other file that differ from it in the first such set.
_TELLABLE = (
    ("spp",), *((axis,) for axis in _HOW_IT_COMPUTES), ("tunables",), ("checkpoints",), ("backend",), ("depth",),
    ("resolution",), ("backend", "spp"), ("depth", "spp"), ("resolution", "spp"), ("resolution", "depth", "spp"),
    ("tunables", "spp"),
)  # fmt: skip


class _Cells:
    """An index that finds cells by all but a few of their fields."""

    def __init__(self, fields: Sequence[dict[str, object]]):
        self._fields = fields
        self._by_rest: dict[tuple[str, ...], dict[tuple, list[dict[str, object]]]] = {}

    def but_for(self, names: tuple[str, ...], mine: dict[str, object]) -> list[dict[str, object]]:
        """The indexed cells that equal the cell `mine` in every field outside `names`."""
        if names not in self._by_rest:
            groups = self._by_rest[names] = {}
            for fields in self._fields:
                groups.setdefault(_rest(fields, names), []).append(fields)
        alike = self._by_rest[names].get(_rest(mine, names), [])
        return [fields for fields in alike if all(fields[name] != mine[name] for name in names)]

    def nearest(self, mine: dict[str, object]) -> tuple[str, str] | None:
        """(kind, reason) of cells that differ from `mine` in one set of _TELLABLE, the first possible, or None."""
        for names in _TELLABLE:
            if all(name in mine for name in names) and (found := self.but_for(names, mine)):
                return _kind(names), "; ".join(_difference(name, mine, found) for name in names)
        return None


def _rest(fields: dict[str, object], names: tuple[str, ...]) -> tuple:
    return tuple(value for name, value in fields.items() if name not in names)


class _There:
    """A result file, asked why it has no partner for a given cell of the other file."""

    def __init__(self, result: Result, paired: Collection[str], axes: Sequence[str], across: bool):
        self._result, self._axes, self._across = result, axes, across
        self._own_axes = _axes(result)
        self._hashes: dict[str, set[str]] = {}
        for cell in result.cells:
            self._hashes.setdefault(cell.scene, set()).add(cell.scene_hash)
        fields = {cell.name: _fields(cell, axes, across) for cell in result.cells}
        # The nearest cell to one without a partner is sought first among this file's cells that lack a partner as well.
        self._lonely = _Cells([of_cell for name, of_cell in fields.items() if name not in paired])
        self._every = _Cells(list(fields.values()))

    def why_not(self, cell: Cell) -> tuple[str, str]:
        """Why the file has no partner for the cell, as (kind, reason)."""
        if not cell.scene_hash:
            return "no scene hash", "its file does not say the scene's content"
        if not any(cell.scene_hash in hashes for hashes in self._hashes.values()):
            if hashes := self._hashes.get(cell.scene):
                return (
                    "other scene content",
                    f"{cell.scene} is {cell.scene_hash} here, {', '.join(sorted(hashes))} there",
                )
            return "scene not there", f"no cell of {cell.scene}"
        if (reason := self._not_applicable(cell)) is not None:
            return "n/a", f"not applicable there: {reason}"
        choices = {axis: choice for axis, choice in cell.axes.items() if axis not in self._own_axes}
        if unknown := [f"{axis}={choice}" for axis, choice in choices.items() if choice != before(axis)]:
            return "axis not there", "that file does not know " + ", ".join(unknown)
        mine = _fields(cell, self._axes, self._across)
        nearest = self._lonely.nearest(mine) or self._every.nearest(mine)
        if nearest is not None:
            return nearest
        if self._every.but_for((), mine):
            nearer = ", whose samples per pixel are nearer" if self._across else " that is alike"
            return "already paired", f"the cell there is the partner of another one{nearer}"
        return "not run there", "no cell of this variant"

    def _not_applicable(self, cell: Cell) -> str | None:
        for item in self._result.not_applicable:
            if item.scene == cell.scene and item.tuned == cell.tuned:
                axes = (item.axes.get(axis, before(axis)) == choice_of(cell, axis) for axis in self._axes)
                if all(axes):
                    return item.reason
        return None


def _kind(names: Sequence[str]) -> str:
    words = {"tunables": "other tunables", "checkpoints": "other clock", "backend": "other backend"}
    words |= {axis: f"other {axis}" for axis in _HOW_IT_COMPUTES}
    return words.get(names[0], "other settings")


def _difference(name: str, mine: dict[str, object], found: Sequence[dict[str, object]]) -> str:
    if name == "checkpoints":
        return "rendered in parts, with checkpoints, " + ("here only" if mine[name] else "there only")

    def told(value: object) -> str:
        if name != "tunables":
            return str(value)
        return ",".join(f"{key}={number}" for key, number in value) or "standard"

    theirs = dict.fromkeys(told(other[name]) for other in found)
    return f"{name} {told(mine[name])} here, {', '.join(theirs)} there"
