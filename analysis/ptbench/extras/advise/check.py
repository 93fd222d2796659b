"""Measures the advised variant and its nearest rivals on the scene itself, and tells how good the advice was."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ptbench.extras.advise.model import WITHIN
from ptbench.extras.advise.probe import Probed
from ptbench.io.cells import Cell
from ptbench.program import Program
from ptbench.stats.estimates import MINIMUM_SAMPLES, Estimate, ratio_estimate
from ptbench.studies.disturbed import is_contended

GOOD, NOT_GOOD, OPEN = "within", "not within", "undecided"
# A variant whose time is above this multiple of the least cannot be the best, however wide the intervals.
_CLOSE = 1.3


@dataclass(frozen=True)
class Checked:
    """The advised variant compared with the best of those measured."""

    advised: str
    best: str
    ratio: Estimate | None  # time of the advised variant over the best one's; None where the advised one has no times
    word: str
    measured: int
    reason: str = ""
    close: tuple[Mapping[str, str], ...] = ()  # variants that may be the best, the advised one first

    @property
    def is_good(self) -> bool:
        """Whether the advised variant was within 5 % of the best."""
        return self.word == GOOD


def suite_of(name: str, probed: Probed, variants: Sequence[Mapping[str, str]], spp: int, repetitions: int) -> dict:
    """A suite with one study of the variants, given by axis or tunable; integer values are tunables."""
    entries = [
        {
            "axes": {key: [value] for key, value in one.items() if not value.isdigit()},
            "tunables": {key: [int(value)] for key, value in one.items() if value.isdigit()},
        }
        for one in variants
    ]
    entries = [{key: value for key, value in entry.items() if value} for entry in entries]
    study = {"name": name, "scenes": [probed.scene], "variants": entries, "resolution": list(probed.resolution),
             "depth": probed.features.depth, "spp": spp}  # fmt: skip
    return {"name": name, "description": "Whether the advice was good.", "repetitions": repetitions, "studies": [study]}


def check(
    program: Program, probed: Probed, variants: Sequence[Mapping[str, str]], backend: str, folder: Path,
    spp: int, repetitions: int = MINIMUM_SAMPLES, *, shown: bool = False,
) -> Checked:  # fmt: skip
    """Runs all variants, the advised one first; raises InputError where the program does."""
    result = program.measure(suite_of("advice", probed, variants, spp, repetitions), folder, backend, shown=shown)
    return replace(judged(result.cells, variants[0]), close=closest(result.cells, variants))


def closest(cells: Sequence[Cell], variants: Sequence[Mapping[str, str]]) -> tuple[Mapping[str, str], ...]:
    """The first of the variants, and all others whose time is near the least."""
    measured = [cell for cell in cells if cell.measured]
    least = min((_middle(cell) for cell in measured), default=0.0)
    found = [variants[0]]
    for variant in variants[1:]:
        named = [cell for cell in measured if _is(cell, variant)]
        # Several cells may match a variant's settings; the one with the fewest further settings is the variant itself.
        own = min(named, key=lambda cell: len(cell.variant.split()), default=None)
        if own is not None and _middle(own) <= _CLOSE * least:
            found.append(variant)
    return tuple(found)


def _middle(cell: Cell) -> float:
    return sorted(cell.ms_per_spp)[len(cell.samples) // 2]


def judged(cells: Sequence[Cell], advised: Mapping[str, str]) -> Checked:
    """The verdict on the advised variant by the measured times; failed and inapplicable variants do not count."""
    measured = [cell for cell in cells if cell.measured]
    own = next((cell for cell in measured if _is(cell, advised)), None)
    text = " ".join(f"{name}={value}" for name, value in advised.items())
    if own is None:
        return Checked(text, "", None, OPEN, len(measured), "the advised variant has no times here")
    best = min(measured, key=_middle)
    count = len(own.samples)
    ratio = Estimate(1.0, 1.0, 1.0, count) if best is own else ratio_estimate(own.ms_per_spp, best.ms_per_spp)
    if busy := [cell for cell in (own, best) if is_contended(cell)]:
        return Checked(own.variant, best.variant, ratio, OPEN, len(measured), f"{busy[0].variant} was disturbed")
    return Checked(own.variant, best.variant, ratio, _word(ratio), len(measured))


def _word(ratio: Estimate) -> str:
    low, high = (-math.inf, math.inf) if ratio.low is None or ratio.high is None else (ratio.low, ratio.high)
    if high <= 1 + WITHIN:
        return GOOD
    return NOT_GOOD if low > 1 + WITHIN else OPEN


def _is(cell: Cell, wanted: Mapping[str, str]) -> bool:
    has = {**cell.axes, **{name: str(value) for name, value in cell.tunables.items()}}
    named = all(has.get(name) == value for name, value in wanted.items())
    return named and cell.tuned.keys() <= wanted.keys()


def only(settings: Mapping[str, str], names: Iterable[str]) -> dict[str, str]:
    """The settings that can affect the variants' time."""
    kept = set(names)
    return {name: value for name, value in settings.items() if name in kept}
