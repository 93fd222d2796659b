"""Model of rendering one image on many GPUs: division of the work, noise, and the reduction of the film.

A GPU's time is t0 + c x (samples x pixels) x noise, with t0 and c from renders of one GPU at several sizes. Partitions:
- samples: every GPU renders all pixels, at most ceil(spp / P) samples of them; films are summed;
- tiles: blocks of pixels dealt round-robin; bands: contiguous runs of as many blocks; films are put together;
- dynamic: as in harness/render/device_shares.h, chunks of samples of all pixels go to whichever GPU is free, each half
  of an even share of the rest; a chunk is a launch and a message; films are summed.

A message of n bytes takes alpha + n / beta. Summing P films takes the shorter of a binomial tree, ceil(log2 P) (alpha +
n / beta), and a reduce-scatter with gather, 2 ceil(log2 P) alpha + 2 (P - 1) / P n / beta; gathering parts takes
ceil(log2 P) alpha + (P - 1) / P n / beta. (Thakur, Rabenseifner and Gropp, Optimization of Collective Communication
Operations in MPICH, IJHPCA 19(1), 2005. The time of the additions counts as the network's.)
"""

import heapq
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# Size in bytes of a pixel of the film: three sums of 64 bits.
BYTES_PER_PIXEL = 24
SAMPLES, TILES, BANDS, DYNAMIC = "samples", "tiles", "bands", "dynamic"
PARTITIONS = (SAMPLES, TILES, BANDS, DYNAMIC)


@dataclass(frozen=True)
class Network:
    """A network's latency and bandwidth."""

    name: str
    alpha_ms: float
    gb_per_second: float
    source: str = ""

    def ms(self, messages: float, size: float) -> float:
        """Milliseconds for a number of messages in sequence and their total bytes."""
        return messages * self.alpha_ms + size / self.gb_per_second / 1e6


@dataclass(frozen=True)
class Cost:
    """Render time of one GPU: a fixed part, and the time per 1e6 samples."""

    fixed_ms: float
    ms_per_mega: float

    def ms(self, samples: float) -> float:
        """Milliseconds for a number of samples, counted over all pixels."""
        return self.fixed_ms + self.ms_per_mega * samples / 1e6


def added_up_ms(network: Network, ranks: int, pixels: int) -> float:
    """Milliseconds to sum whole films into one."""
    if ranks == 1:
        return 0.0
    rounds, size = _rounds(ranks), pixels * BYTES_PER_PIXEL
    return min(network.ms(rounds, rounds * size), network.ms(2 * rounds, 2 * (ranks - 1) / ranks * size))


def gathered_ms(network: Network, ranks: int, pixels: int) -> float:
    """Milliseconds to gather the parts of a film."""
    return 0.0 if ranks == 1 else network.ms(_rounds(ranks), (ranks - 1) / ranks * pixels * BYTES_PER_PIXEL)


def _rounds(ranks: int) -> int:
    return math.ceil(math.log2(ranks))


def of_blocks(work: np.ndarray, ranks: int, partition: str) -> np.ndarray:
    """Each rank's share of an image's work under a partition by blocks; the shares add up to 1."""
    blocks = work.ravel() / work.sum()
    owner = np.arange(blocks.size) % ranks if partition == TILES else np.arange(blocks.size) * ranks // blocks.size
    return np.bincount(owner, weights=blocks, minlength=ranks)


def of_samples(spp: int, ranks: int) -> np.ndarray:
    """Each rank's share of the samples: contiguous, and within one sample of even."""
    return np.array([(spp * (rank + 1)) // ranks - (spp * rank) // ranks for rank in range(ranks)]) / spp


def finer(work: np.ndarray, factor: int) -> np.ndarray:
    """The work map of an image with `factor` times as many pixels per side, in blocks of equal size."""
    return np.kron(work, np.ones((factor, factor)))


@dataclass(frozen=True)
class Case:
    """One render on many GPUs: pixels, samples, ranks and partition."""

    pixels: int
    spp: int
    ranks: int
    partition: str


def times_ms(case: Case, work: np.ndarray, cost: Cost, network: Network, speeds: np.ndarray) -> np.ndarray:
    """Wall time of the simulated render by trial; `speeds` are noise factors on a rank's time, by trial and rank."""
    whole = cost.ms_per_mega * case.pixels * case.spp / 1e6
    if case.partition == SAMPLES:
        shares, end = of_samples(case.spp, case.ranks), added_up_ms(network, case.ranks, case.pixels)
    elif case.partition == DYNAMIC and case.ranks > 1:
        chunks = [cost.fixed_ms + samples / case.spp * whole for samples in chunks_of(case.spp, case.ranks)]
        end = added_up_ms(network, case.ranks, case.pixels)
        return np.array([_in_turn(chunks, factors, network.alpha_ms) for factors in speeds]) + end
    elif case.partition == DYNAMIC:
        shares, end = np.ones(1), 0.0
    else:
        shares = of_blocks(work, case.ranks, case.partition)
        end = gathered_ms(network, case.ranks, case.pixels)
    busy = np.where(shares > 0, cost.fixed_ms + shares * whole, 0.0)
    return (busy * speeds).max(axis=1) + end


def chunks_of(spp: int, ranks: int) -> list[int]:
    """The chunks of samples that the dynamic partition hands out, in order."""
    least = min(max(spp // (16 * ranks), 1), 16)
    chunks, left = [], spp
    while left > 0:
        chunks.append(min(left, max(least, left // (2 * ranks) // least * least)))
        left -= chunks[-1]
    return chunks


def _in_turn(chunks: Sequence[float], factors: np.ndarray, message_ms: float) -> float:
    """The finishing time of the last of the chunks, each taken in order by the rank that is free first."""
    free = [(0.0, rank) for rank in range(len(factors))]
    last = 0.0
    for chunk in chunks:
        at, rank = heapq.heappop(free)
        done = at + message_ms + chunk * factors[rank]
        last = max(last, done)
        heapq.heappush(free, (done, rank))
    return last


def efficiency(case: Case, work: np.ndarray, cost: Cost, network: Network, speeds: np.ndarray) -> np.ndarray:
    """Parallel efficiency of each trial: one GPU's time, without noise, over P times that of P GPUs."""
    alone = cost.ms(case.pixels * case.spp)
    return alone / (case.ranks * times_ms(case, work, cost, network, speeds))
