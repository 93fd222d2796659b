"""`compare` of files of `ptbench stability`: which rows changed their status against the first file, and which numbers.

A row is identified by its case, point, quantity and variant. The backend does not count, so that a CPU's rows can be
compared with a GPU's. A case that broke or does not apply has one row instead of one for each quantity: that row is
compared with each of them.
"""

import math
from argparse import Namespace
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from ptbench.compare.choices import FAIL_ON
from ptbench.compare.gate import Outcome
from ptbench.errors import InputError, bad_value
from ptbench.io.nodes import read_json
from ptbench.io.stability import NOT_APPLICABLE, Row, Stability, is_stability, stability_of
from ptbench.stability.layout import failures

_FAIL_ON = tuple(choice for choice in FAIL_ON if choice != "slower")


@dataclass(frozen=True)
class Pair:
    """A row (check) that both compared stability files contain."""

    one: Row
    other: Row

    @property
    def is_changed(self) -> bool:
        """Whether a row's status or its `must_pass` differs between the files."""
        return (self.one.status, self.one.must_pass) != (self.other.status, self.other.must_pass)

    @property
    def has_numbers(self) -> bool:
        """Whether both rows of a pair have a measured value."""
        rows = (self.one, self.other)
        return all(row.measured is not None and row.status != NOT_APPLICABLE for row in rows)

    @property
    def has_same_value(self) -> bool:
        """Whether both rows of a pair measured the same number, bit for bit or both NaN."""
        return _same(self.one.measured.value, self.other.measured.value)

    @property
    def relative_change(self) -> float:
        """The change of a row's measured value, relative to the larger one."""
        one, other = self.one.measured.value, self.other.measured.value
        if one == other or self.has_same_value:
            return 0.0
        if not (math.isfinite(one) and math.isfinite(other)):
            return math.inf
        larger = max(abs(one), abs(other))
        return abs(other / larger - one / larger)

    @property
    def has_another_check(self) -> bool:
        """Whether the exact value or the allowed error of a row differs between the files."""
        one, other = self.one.measured, self.other.measured
        return not (_same(one.exact, other.exact) and _same(one.allowed, other.allowed))


def _same(one: float, other: float) -> bool:
    """Whether two numbers are equal bit for bit; any two NaN are equal."""
    return one.hex() == other.hex()


@dataclass(frozen=True)
class Against:
    """A file of `ptbench stability` compared with the first one."""

    reference: Stability
    other: Stability
    pairs: tuple[Pair, ...]
    alone: tuple[tuple[bool, Row], ...]  # rows that one file lacks, each as (whether the reference has it, row)

    @cached_property
    def changed(self) -> list[Pair]:
        """The pairs whose status or `must_pass` is another one."""
        return [pair for pair in self.pairs if pair.is_changed]

    @cached_property
    def numbers(self) -> list[Pair]:
        """The pairs of rows of equal status, which can differ in their numbers only."""
        return [pair for pair in self.pairs if not pair.is_changed and pair.has_numbers]

    @cached_property
    def moved(self) -> list[Pair]:
        """The pairs of one status whose numbers differ."""
        return [pair for pair in self.numbers if not pair.has_same_value]

    @cached_property
    def newly_failed(self) -> list[Row]:
        """Rows that must pass and fail, but in the reference were absent or did not fail."""
        partners = [pair.other for pair in self.pairs if not failures([pair.one])]
        return failures([*partners, *(row for in_reference, row in self.alone if not in_reference)])


@dataclass(frozen=True)
class StabilityCompared:
    """Everything that a comparison of stability files found; `comparisons` are the files after the first, in order."""

    files: tuple[Stability, ...]
    comparisons: tuple[Against, ...]


def compare_stability_files(paths: Sequence[Path]) -> StabilityCompared:
    """Loads and compares stability files; raises InputError."""
    files = [_load(path, paths[0]) for path in paths]
    return StabilityCompared(tuple(files), tuple(_against(files[0], other) for other in files[1:]))


def check_stability_options(options: Namespace) -> None:
    """Refuses options of `compare` that need times or films; raises InputError."""
    kind = f"files of `ptbench stability` ({options.results[0]})"
    if options.noise:
        raise InputError(f"--noise: found {kind}, allowed: result files of `ptbench run`, which have times")
    if options.films_may_differ:
        raise InputError(f"--films-may-differ: found {kind}, allowed: result files of `ptbench run`")
    for what in options.fail_on:
        if what not in _FAIL_ON:
            raise bad_value("--fail-on", what, kind, f"{', '.join(_FAIL_ON)} for these")


def _load(path: Path, first: Path) -> Stability:
    root = read_json(path)
    if not is_stability(root):
        raise InputError(f"{path}: found no file of `ptbench stability`, allowed: one, as {first} is")
    return stability_of(root)


def _against(reference: Stability, other: Stability) -> Against:
    ones, others = _by_identity(reference.rows), _by_identity(other.rows)
    pairs = [Pair(row, others[key]) for key, row in ones.items() if key in others]
    unpaired: dict[tuple, tuple[list[Row], list[Row]]] = {}
    for index, (rows, partners) in enumerate(((ones, others), (others, ones))):
        for key, row in rows.items():
            if key not in partners:
                unpaired.setdefault(key[:3], ([], []))[index].append(row)
    alone = []
    for left, right in unpaired.values():
        if left and right and (_are_whole(left) or _are_whole(right)):
            pairs += [
                Pair(left[min(i, len(left) - 1)], right[min(i, len(right) - 1)])
                for i in range(max(len(left), len(right)))
            ]
        else:
            alone += [*((True, row) for row in left), *((False, row) for row in right)]
    if not pairs:
        raise InputError(
            f"{other.path}: found no row to hold against one of {reference.path}, allowed: files with some case, point "
            "and variant in common"
        )
    return Against(reference, other, tuple(pairs), tuple(alone))


def _by_identity(rows: Sequence[Row]) -> dict[tuple, Row]:
    """Rows by case, point, variant, quantity, and a running number among equal ones."""
    seen: Counter = Counter()
    found = {}
    for row in rows:
        quantity = row.measured.quantity if row.measured is not None else ""
        key = (row.case.name, tuple(sorted(row.point)), row.variant, quantity)
        found[(*key, seen[key])] = row
        seen[key] += 1
    return found


def _are_whole(rows: Sequence[Row]) -> bool:
    """Whether rows without a quantity stand for all quantities of their case and point at once."""
    return all(row.measured is None for row in rows)


def stability_outcome(compared: StabilityCompared, what: str) -> Outcome:
    """The outcome of `--fail-on` for stability files; `what` is one that `check_stability_options` accepts."""
    found = compared.comparisons
    if what == "unmatched":
        bad = sum(in_reference for one in found for in_reference, _ in one.alone)
        text = f"{bad} of {len(found) * len(compared.files[0].rows)} rows of the reference have no partner"
    elif what == "different":
        bad = sum(len(one.changed) for one in found)
        text = f"{bad} of {sum(len(one.pairs) for one in found)} rows have another status"
    else:
        bad = sum(len(one.newly_failed) for one in found)
        text = f"{bad} rows that must pass fail and did not in the reference"
    return Outcome(bad > 0, f"--fail-on {what}: {'FAILED' if bad else 'passed'}: {text}.")
