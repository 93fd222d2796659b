"""Which variant is faster in a scene on each machine, and where that order changes between machines.

A change of order is reported only where verdicts support it on both machines: FASTER on one and SLOWER on the other.
Where the medians change places without such verdicts, the change is counted as within the noise.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ptbench.compare.match import Matching
from ptbench.io.cells import Cell, Result
from ptbench.stats.estimates import FASTER, SLOWER, Estimate
from ptbench.studies.rows import time_ratio

# Tunables that add work: variants that differ in one of them have another task, so they are not ranked together.
_WORK = ("shading_fmas",)


@dataclass(frozen=True)
class Change:
    """A change of order: variant `ahead` beats `behind` in file `at` and loses in file `turned_at`; all are indices."""

    ahead: int
    behind: int
    at: int
    turned_at: int
    ratio: Estimate  # time of the variant `ahead` over that of the variant `behind`, both in file number `at`
    turned_ratio: Estimate


@dataclass(frozen=True)
class Ranking:
    """Variants of one scene and setting that every file measured: `cells[variant][file]`, in the reference's order."""

    scene: str
    resolution: str
    depth: int
    spp: tuple[int, ...]  # samples per pixel of the ranked cells, one value per ranked file
    work: str  # settings of the task besides scene, size, depth and spp, such as "shading_fmas=64"; mostly empty
    cells: tuple[tuple[Cell, ...], ...]
    places: tuple[tuple[int, ...], ...]  # rank by [variant][file]; the fastest variant is 1
    changes: tuple[Change, ...]
    within_noise: int


def rankings(matchings: Sequence[Matching], thresholds: Callable[[Result], float]) -> list[Ranking]:
    """Ranks variants over the reference and all other files of `matchings`; groups of one variant are left out.

    `thresholds` gives the relative difference that a file's verdicts count as none.
    """
    files = [matchings[0].reference, *(matching.other for matching in matchings)]
    partners = [{pair.reference.name: pair.other for pair in matching.pairs} for matching in matchings]
    groups: dict[tuple, list[tuple[Cell, ...]]] = {}
    for cell in files[0].cells:
        if all(cell.name in of_file for of_file in partners):
            cells = (cell, *(of_file[cell.name] for of_file in partners))
            # Ranked variants have equal settings within a file, samples per pixel included.
            spp = tuple(one.spp for one in cells)
            key = (cell.scene, cell.scene_hash, cell.resolution_text, cell.depth, spp, _work_of(cell))
            groups.setdefault(key, []).append(cells)
    limits = [thresholds(file) for file in files]
    return [_ranking(key, variants, limits) for key, variants in groups.items() if len(variants) > 1]


def _work_of(cell: Cell) -> str:
    told = [f"{name}={cell.tuned[name]}" for name in _WORK if name in cell.tuned]
    return ", ".join([*told, *(("with checkpoints",) if cell.convergence is not None else ())])


def _ranking(key: tuple, variants: list[tuple[Cell, ...]], limits: Sequence[float]) -> Ranking:
    medians = np.array([[float(np.median(cell.ms_per_spp)) for cell in cells] for cells in variants])
    # Variants with equal median times get equal places in the ranking.
    places = 1 + (medians[:, None, :] > medians[None, :, :]).sum(axis=1)
    changes: list[Change] = []
    within_noise = 0
    for one, two in combinations(range(len(variants)), 2):
        for at, turned_at in combinations(range(len(limits)), 2):
            signs = [np.sign(medians[one, file] - medians[two, file]) for file in (at, turned_at)]
            if signs[0] * signs[1] >= 0:
                continue
            ahead, behind = (one, two) if signs[0] < 0 else (two, one)
            ratio, verdict = time_ratio(variants[ahead][at], variants[behind][at], limits[at])
            turned, turned_verdict = time_ratio(
                variants[ahead][turned_at], variants[behind][turned_at], limits[turned_at]
            )
            if (verdict.word, turned_verdict.word) == (FASTER, SLOWER):
                changes.append(Change(ahead, behind, at, turned_at, ratio, turned))
            else:
                within_noise += 1
    changes.sort(key=lambda change: change.ratio.value / change.turned_ratio.value)
    scene, _, resolution, depth, spp, work = key
    return Ranking(
        scene,
        resolution,
        depth,
        spp,
        work,
        tuple(variants),
        tuple(map(tuple, places.tolist())),
        tuple(changes),
        within_noise,
    )
