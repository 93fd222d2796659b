"""The simulation itself: efficiencies by ranks, samples and partition, and the cost of each assumption. Seeded."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.extras.simulate.model import (
    BANDS,
    DYNAMIC,
    PARTITIONS,
    SAMPLES,
    TILES,
    Case,
    Network,
    added_up_ms,
    efficiency,
    finer,
    of_blocks,
    times_ms,
)
from ptbench.extras.simulate.parts import Parts, Point
from ptbench.io.axes import DEVICES, PARTITION
from ptbench.io.cells import Cell
from ptbench.io.results import load

# The dynamic partition is simulated in few trials, because each simulates thousands of chunks one by one.
_DYNAMIC_TRIALS = 20


@dataclass(frozen=True)
class Spread:
    """The median over trials, and the middle 90 % of them."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Study:
    """All simulated numbers; efficiencies by (partition, spp, ranks) at the smallest image over the far network."""

    parts: Parts
    side: int
    efficiencies: Mapping[tuple[str, int, int], Spread]
    reductions: Mapping[tuple[int, int], float]  # film reduction in ms over the far network, by (image side, ranks)
    even: Mapping[tuple[int, int], int | None]  # by (side, ranks), least spp where partition by samples equals tiles
    stragglers: Mapping[int, float]  # slowest over median rank's time, if they differ by noise alone; by ranks
    slow_one: Mapping[tuple[str, int], float]  # parallel efficiency with one slow GPU, by (partition, ranks)
    imbalance: Mapping[tuple[str, int], float]  # load imbalance: largest over mean share of work, by (partition, ranks)
    checks: tuple[Point, ...]  # simulated against measured efficiencies of several GPUs

    @property
    def far(self) -> Network:
        """The network between hosts."""
        return self.parts.networks[self.parts.definition["far"]]


def study_of(parts: Parts) -> Study:
    """Runs the simulation; equal parts give equal numbers."""
    about = parts.definition
    sides, ranks, spps = about["sides"], about["ranks"], about["spp"]
    far = parts.networks[about["far"]]
    noise = _Noise(parts.noise, about["seed"], about["trials"])
    side = sides[0]
    efficiencies = {
        (partition, spp, count): _spread(
            efficiency(Case(side * side, spp, count, partition), parts.work, parts.cost, far, noise(partition, count))
        )
        for partition in PARTITIONS
        for spp in spps
        for count in ranks
    }
    many = [count for count in ranks if count > 1]
    return Study(
        parts,
        side,
        efficiencies,
        {(one, count): added_up_ms(far, count, one * one) for one in sides for count in many},
        {(one, count): _even(parts, far, noise, one, count) for one in sides for count in many},
        {count: float(np.median(noise(SAMPLES, count).max(axis=1))) for count in ranks},
        {
            (partition, count): _slow_one(parts, far, noise, Case(side * side, max(spps), count, partition))
            for partition in PARTITIONS
            for count in many
        },
        {
            (partition, count): float(of_blocks(parts.work, count, partition).max() * count)
            for partition in (TILES, BANDS)
            for count in many
        },
        _checks(parts),
    )


class _Noise:
    """Noise factors on a rank's time by trial and rank, drawn from measured ones; equal for equal numbers of ranks."""

    def __init__(self, measured: np.ndarray, seed: int, trials: int) -> None:
        self._measured, self._seed, self._trials = measured, seed, trials

    def __call__(self, partition: str, ranks: int) -> np.ndarray:
        drawn = np.random.default_rng([self._seed, ranks]).integers(0, self._measured.size, (self._trials, ranks))
        factors = self._measured[drawn]
        return factors[:_DYNAMIC_TRIALS] if partition == DYNAMIC else factors


def _spread(values: np.ndarray) -> Spread:
    low, middle, high = np.percentile(values, [5, 50, 95])
    return Spread(float(middle), float(low), float(high))


def _even(parts: Parts, network: Network, noise: _Noise, side: int, ranks: int) -> int | None:
    work = finer(parts.work, side // parts.definition["sides"][0])
    for power in range(21):
        one, other = (
            float(np.median(times_ms(Case(side * side, 2**power, ranks, partition), work, parts.cost, network,
                                     noise(partition, ranks))))
            for partition in (SAMPLES, TILES)
        )  # fmt: skip
        if one <= other:
            return 2**power
    return None


def _slow_one(parts: Parts, network: Network, noise: _Noise, case: Case) -> float:
    factors = noise(case.partition, case.ranks).copy()
    factors[:, 0] /= parts.definition["slow"]
    return float(np.median(efficiency(case, parts.work, parts.cost, network, factors)))


def _checks(parts: Parts) -> tuple[Point, ...]:
    """Simulated against measured efficiencies of several GPUs in one host; empty where there are no measurements."""
    if parts.devices is None:
        return ()
    return device_checks(parts, load(Path(parts.devices)).cells)


def device_checks(parts: Parts, cells: tuple[Cell, ...]) -> tuple[Point, ...]:
    """Checks simulated efficiencies T(1) / (N T(N)) by cells with the axes `devices` and `partition`, at equal work.

    The measured efficiency uses one GPU's time in the same file; the simulated one uses the fitted cost line for both.
    """
    near = parts.networks[parts.definition["near"]]
    noise = _Noise(parts.noise, parts.definition["seed"], parts.definition["trials"])
    found = []
    for cell in cells:
        count = int(cell.axes.get(DEVICES, "1"))
        alone = next((other for other in cells if count > 1 and _is_alone(cell, other)), None)
        if alone is None or cell.scene != parts.work_scene:
            continue
        partition = cell.axes[PARTITION]
        case = Case(cell.pixels, cell.spp, count, partition)
        said = efficiency(case, parts.work, parts.cost, near, noise(partition, count))
        measured = float(np.median(alone.ms_per_spp) / (count * np.median(cell.ms_per_spp)))
        found.append(Point(f"{count} GPUs, {partition}, {cell.spp} spp", float(np.median(said)), measured))
    return tuple(found)


def _is_alone(cell: Cell, other: Cell) -> bool:
    """Whether `other` is the same render as `cell`, on one GPU."""
    own, its = ({k: v for k, v in one.axes.items() if k not in (DEVICES, PARTITION)} for one in (cell, other))
    same = (cell.scene, cell.spp, cell.depth, cell.resolution, own)
    return (
        other.measured
        and cell.measured
        and other.axes.get(DEVICES, "1") == "1"
        and (other.scene, other.spp, other.depth, other.resolution, its) == same
    )
