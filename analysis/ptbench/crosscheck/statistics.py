"""Tests whether two renderers' images of a scene have the same mean, from several seeds each, in three ways.

Welch's t test over seeds compares the image's mean and the means of 8x8 blocks, channel by channel. Single pixels are
tested by the sum of d_i d_j over pairs of seeds i and j (d: the difference of a pair of images), whose mean is the
squared bias whatever the noise looks like. Each of the three tests gets a third of `family`, the probability that any
of them tells equal renderers apart; within a test, Sidak's correction applies. Each reports which bias it would have
detected with the probability POWER. Scenes of one call share LEVEL_OF_A_CALL.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ptbench.crosscheck.limits import SIDE
from ptbench.stats import special

# Probability that a call of `ptbench crosscheck`, over all scenes and tests, tells equal renderers apart.
LEVEL_OF_A_CALL = 0.01
POWER = 0.9
# Relative rounding difference allowed between two programs where nothing is random: about 170 ulps of single precision.
ROUNDING = 1e-5
# Edges of the classes of the histogram of Welch's t over the pixels of two renderers' images.
EDGES = (-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0)


@dataclass(frozen=True)
class MeanTest:
    """The test of the image's mean by channel; biases and `sees` are relative to the mean of both renderers."""

    here: tuple[float, ...]
    there: tuple[float, ...]
    bias: tuple[float, ...]
    errors: tuple[float, ...]  # standard errors of the relative bias, by channel
    worst_p: float
    limit_p: float
    sees: float  # bias of the worst channel that the test would detect

    @property
    def differs(self) -> bool:
        """Whether any channel of the image's mean differs significantly."""
        return self.worst_p < self.limit_p


@dataclass(frozen=True)
class BlockTest:
    """The test of block means, each channel by itself; `sees` is relative to a block's mean, the median over blocks."""

    count: int  # number of tested means: blocks times channels
    beyond: int
    worst: float  # largest difference of a block mean, in standard errors
    worst_place: tuple[int, int, int]  # row and column of the worst block, and its channel
    worst_p: float
    limit: float  # allowed difference of a block mean in standard errors, at the worst block's degrees of freedom
    limit_p: float
    rms: float  # root mean square of all blocks' differences, in standard errors
    sees: float

    @property
    def differs(self) -> bool:
        """Whether the mean of any block differs significantly."""
        return self.beyond > 0


@dataclass(frozen=True)
class PixelTest:
    """The test of single pixels; `sees` is the RMS bias over pixels that it would detect, relative to the mean."""

    count: int
    still: int  # number of pixels without noise in either renderer's images
    still_beyond: int  # number of noise-free pixels that differ by more than rounding
    z: float
    p: float
    limit_p: float
    sees: float
    histogram: tuple[int, ...]  # histogram of Welch's t over pixels and channels, in classes between EDGES
    expected: tuple[float, ...]  # histogram expected of normal noise, by Student's t distribution

    @property
    def differs(self) -> bool:
        """Whether the test of single pixels finds a difference."""
        return self.p < self.limit_p or self.still_beyond > 0


@dataclass(frozen=True)
class Comparison:
    """The comparison of two renderers' images of one scene."""

    seeds: int
    image: MeanTest
    blocks: BlockTest
    pixels: PixelTest

    @property
    def differs(self) -> bool:
        """Whether any of the three tests finds a difference between the images."""
        return self.image.differs or self.blocks.differs or self.pixels.differs


@dataclass(frozen=True)
class _Welch:
    mean: np.ndarray  # larger of the absolute values of the two renderers' means
    difference: np.ndarray
    error: np.ndarray
    freedom: np.ndarray

    def t(self, allowed: float) -> np.ndarray:
        beyond = np.maximum(np.abs(self.difference) - allowed * self.mean, 0.0)
        return np.sign(self.difference) * np.divide(beyond, self.error, out=np.zeros_like(beyond), where=self.error > 0)

    def p(self, allowed: float) -> np.ndarray:
        return 2 * special.stdtr(self.freedom, -np.abs(self.t(allowed)))

    def sees(self, limit_p: float, allowed: float) -> np.ndarray:
        """The bias, relative to the mean, that the test at level `limit_p` detects with the probability POWER."""
        quantiles = special.stdtrit(self.freedom, 1 - limit_p / 2) + special.stdtrit(self.freedom, POWER)
        width = np.full_like(self.mean, np.inf)
        return np.divide(quantiles * self.error, self.mean, out=width, where=self.mean > 0) + allowed


def _welch(here: np.ndarray, there: np.ndarray) -> _Welch:
    """Welch's t test over axis 0, which are the seeds."""
    means = here.mean(axis=0), there.mean(axis=0)
    of_mean = here.var(axis=0, ddof=1) / len(here), there.var(axis=0, ddof=1) / len(there)
    variance = of_mean[0] + of_mean[1]
    shares = of_mean[0] ** 2 / (len(here) - 1) + of_mean[1] ** 2 / (len(there) - 1)
    freedom = np.full_like(variance, len(here) + len(there) - 2)
    # The square of a tiny variance may underflow to 0; the degrees of freedom then keep their default.
    np.divide(variance**2, shares, out=freedom, where=shares > 0)
    mean = np.maximum(np.abs(means[0]), np.abs(means[1]))
    error = np.sqrt(variance + (ROUNDING * mean) ** 2)
    return _Welch(mean, means[0] - means[1], error, freedom)


def _sidak(tests: int, family: float) -> float:
    return float(-np.expm1(np.log1p(-family) / tests))


def family_of(scenes: int) -> float:
    """The share of LEVEL_OF_A_CALL that each of the scenes of a call gets."""
    return _sidak(scenes, LEVEL_OF_A_CALL)


def _mean_test(here: np.ndarray, there: np.ndarray, allowed: float, family: float) -> MeanTest:
    found = _welch(here.mean(axis=(1, 2)), there.mean(axis=(1, 2)))
    limit = _sidak(here.shape[-1], family)
    scale = np.where(found.mean > 0, found.mean, 1.0)
    return MeanTest(
        here=tuple(here.mean(axis=(0, 1, 2)).tolist()),
        there=tuple(there.mean(axis=(0, 1, 2)).tolist()),
        bias=tuple((found.difference / scale).tolist()),
        errors=tuple((found.error / scale).tolist()),
        worst_p=float(found.p(allowed).min()),
        limit_p=limit,
        sees=float(_largest(found.sees(limit, allowed), found.mean)),
    )


def _largest(sees: np.ndarray, mean: np.ndarray) -> float:
    """The largest detectable bias over channels or pixels that are not black; 0 where all are black."""
    lit = sees[mean > 0]
    return lit.max() if lit.size else 0.0


def block_means(images: np.ndarray) -> np.ndarray:
    """Block means (seeds, rows and columns of blocks, channels) of images whose sides are multiples of SIDE."""
    seeds, height, width, channels = images.shape
    return images.reshape(seeds, height // SIDE, SIDE, width // SIDE, SIDE, channels).mean(axis=(2, 4))


def _block_test(here: np.ndarray, there: np.ndarray, allowed: float, family: float) -> BlockTest:
    found = _welch(block_means(here), block_means(there))
    limit = _sidak(found.mean.size, family)
    t, p = found.t(allowed), found.p(allowed)
    worst = np.unravel_index(int(np.argmin(p)), p.shape)
    sees = found.sees(limit, allowed)[found.mean > 0]
    return BlockTest(
        count=int(p.size),
        beyond=int((p < limit).sum()),
        worst=float(t[worst]),
        worst_place=(int(worst[0]), int(worst[1]), int(worst[2])),
        worst_p=float(p[worst]),
        limit=float(special.stdtrit(found.freedom[worst], 1 - limit / 2)),
        limit_p=limit,
        rms=float(np.sqrt((t**2).mean())),
        sees=float(np.median(sees)) if sees.size else 0.0,
    )


def _pixel_test(here: np.ndarray, there: np.ndarray, allowed: float, limit: float) -> PixelTest:
    found = _welch(here, there)
    seeds = min(len(here), len(there))
    pairs = here[:seeds] - there[:seeds]
    noise = pairs.var(axis=0, ddof=1)
    still = (noise <= (ROUNDING * found.mean) ** 2).all(axis=-1)
    tolerance = (10 * ROUNDING + allowed) * found.mean
    still_beyond = still & (np.abs(found.difference) > tolerance).any(axis=-1)
    variance = _variance_around(noise)
    weight = np.divide(1.0, variance, out=np.zeros_like(variance), where=variance > 0) * ~still[..., None]
    products = (pairs.sum(axis=0) ** 2 - (pairs**2).sum(axis=0)) / (seeds * (seeds - 1))
    terms = (weight * products).sum(axis=-1)
    # The squared allowed bias is subtracted from the summed squared differences, so that only a larger bias counts.
    total = float(terms.sum() - (weight * (allowed * found.mean) ** 2).sum())
    error = float(np.sqrt((terms**2).sum()))
    z = total / error if error > 0 else 0.0
    weights, mean = float(weight.sum()), float(found.mean.mean())
    seen = (special.ndtri(1 - limit) + special.ndtri(POWER)) * error / weights if weights > 0 else 0.0
    t = found.t(0.0)[~still]
    freedom = found.freedom[~still]
    return PixelTest(
        count=int(still.size),
        still=int(still.sum()),
        still_beyond=int(still_beyond.sum()),
        z=z,
        p=float(special.ndtr(-z)),
        limit_p=limit,
        sees=float(np.sqrt(seen) / mean + allowed) if mean > 0 else 0.0,
        histogram=_histogram(t),
        expected=_expected(freedom),
    )


def _variance_around(noise: np.ndarray) -> np.ndarray:
    """For each pixel and channel the mean noise variance of the other pixels in its block.

    Few seeds estimate a single pixel's variance badly, so the block's mean is used. The pixel itself is left out: where
    its variance is too small by chance, its pairs' products are too large, and a dependent weight would bias the test.
    """
    of_blocks = block_means(noise[None])[0].repeat(SIDE, axis=0).repeat(SIDE, axis=1)
    return (of_blocks * SIDE**2 - noise) / (SIDE**2 - 1)


def _histogram(t: np.ndarray) -> tuple[int, ...]:
    counts, _ = np.histogram(t, bins=[-np.inf, *EDGES, np.inf])
    return tuple(int(count) for count in counts)


def _expected(freedom: np.ndarray) -> tuple[float, ...]:
    below = [0.0, *(float(special.stdtr(freedom, edge).sum()) for edge in EDGES), float(freedom.size)]
    return tuple(high - low for low, high in pairwise(below))


def compare(here: np.ndarray, there: np.ndarray, allowed: float = 0.0, family: float = LEVEL_OF_A_CALL) -> Comparison:
    """Compares images of at least two seeds each (seeds, rows, columns, channels) whose sides are multiples of SIDE.

    `allowed` is a bias, relative to each mean, that is no difference; `family` the probability that any of the tests
    tells equal renderers apart.
    """
    here, there = here.astype(np.float64), there.astype(np.float64)
    return Comparison(
        seeds=min(len(here), len(there)),
        image=_mean_test(here, there, allowed, family / 3),
        blocks=_block_test(here, there, allowed, family / 3),
        pixels=_pixel_test(here, there, allowed, family / 3),
    )
