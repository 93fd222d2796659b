"""Costs of convergence: work-normalised variance, efficiency against a baseline, time to an error, checkpoint overhead.

Intervals are bootstraps over seeds. Within a cell, errors and times of a seed are drawn together. For two cells with
the same seeds, each seed is drawn for both, so that cells of equal errors compare by their times alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.convergence.assessment import PLATEAU, Assessment
from ptbench.io.axes import known_axes
from ptbench.io.cells import Cell, Result
from ptbench.numbers import figures, interval
from ptbench.stats.estimates import SEED, THRESHOLD, Estimate, interval_of_ratio, ratio_estimate, telling_digits
from ptbench.stats.intervals import bootstrap_interval, resampled
from ptbench.studies.disturbed import MOST_DISTURBED_SAID, doubt_of
from ptbench.studies.questions import usual_baseline

COMPANION = "_without_checkpoints"
# Axes whose choices affect the error; a file may have axes that this package does not know.
_DECIDE_ERROR = {name for name, axis in known_axes().items() if axis.decides_error}
# An error e counts as reachable above a plateau B if e^2 - B^2 is at least this share of e^2; less is noise of the fit.
_NEAR_PLATEAU = 1e-3
# Share of the last squared error that a plateau must make up for the cell to count as having reached the plateau.
_MOST_OF_PLATEAU = 0.5
# A time to an error is told only if it is at least this many times the fixed cost of a render.
_LEAST_LAUNCHES = 20

EFFICIENCY_RULE = (
    "Work-normalised variance: σ² times render wall time per spp; of samples that are not independent, N times MSE(N) "
    "at the last checkpoint instead of σ². Efficiency: the baseline's over the cell's, by the times of the same "
    "renders without checkpoints where both ran so; a plateau is not in it. "
    "Intervals: "
    "95 %, bootstrap over seeds with expanded percentiles, errors and times of a seed drawn together, seeds that both "
    "cells ran drawn for both. An efficiency whose times other processes disturbed in more than "
    f"{MOST_DISTURBED_SAID} of a cell's "
    "samples has no verdict (disturbed). Time to an error: the samples after which the fitted curve, with its plateau, "
    "meets it, times what a sample takes in the same render without checkpoints; never where the plateau lies above "
    "it, and not told without such a render or where a launch would be more than a twentieth of it. Efficiency by MSE "
    "or relMSE at the last spp: the baseline's error times render time over the cell's, bias and noise together; "
    "relMSE weighs dark pixels as much as bright ones."
)


@dataclass(frozen=True)
class Place:
    """Cells that can be compared with each other: of one scene, depth, resolution and backend."""

    scene: str
    depth: int
    resolution: tuple[int, int]
    backend: str

    def title(self, others: Sequence[Place]) -> str:
        """Scene and settings as a heading."""
        parts = [self.scene]
        if len({other.depth for other in others}) > 1:
            parts.append(f"depth {self.depth}")
        if len({other.resolution for other in others}) > 1:
            parts.append(f"{self.resolution[0]}×{self.resolution[1]}")
        if len({other.backend for other in others}) > 1:
            parts.append(self.backend)
        return ", ".join(parts)


def place_of(cell: Cell) -> Place:
    """Groups a cell by its reference's scene and depth: a variant may render another scene to get the same image."""
    reference = cell.convergence.reference
    return Place(reference.scene or cell.scene, reference.depth or cell.depth, cell.resolution, cell.backend)


def by_place(assessed: Sequence[Assessment]) -> dict[Place, list[Assessment]]:
    """The assessed cells by scene and settings, in their order."""
    groups: dict[Place, list[Assessment]] = {}
    for assessment in assessed:
        groups.setdefault(place_of(assessment.cell), []).append(assessment)
    return groups


def baseline_among(result: Result, group: Sequence[Assessment]) -> Assessment | None:
    """The baseline: the fitted cell with the plain estimator that is most like the others."""
    fitted = [one for one in group if one.fit is not None]

    def unlikeness(assessment: Assessment) -> tuple:
        cell = assessment.cell
        unusual = [axis for axis, choice in cell.axes.items() if usual_baseline(result, axis) != choice]
        is_plain = assessment.curve.independent and not cell.convergence.biases
        to_others = sum(len(_changes(cell, other.cell)) for other in fitted)
        return (
            not is_plain,
            len(set(unusual) & _DECIDE_ERROR),
            to_others,
            len(unusual),
            len(cell.tuned),
        )

    return min(fitted, key=unlikeness, default=None)


def _changes(base: Cell, cell: Cell) -> dict[str, str]:
    """The settings in which `cell` differs from `base`, with its values."""
    usual = _settings(base)
    return {name: value for name, value in _settings(cell).items() if usual.get(name) != value}


def names_in(group: Sequence[Assessment], baseline: Assessment | None) -> dict[str, str]:
    """What a figure calls each cell: its differences from the baseline, or its choice where one setting differs."""
    cells = [assessment.cell for assessment in group]
    if baseline is None:
        return {cell.name: cell.variant for cell in cells}
    base = _settings(baseline.cell)
    varied = _varied_tunables(cells)
    changes = {
        cell.name: {
            **_changes(baseline.cell, cell),
            **{name: str(value) for name, value in cell.tunables.items() if name in varied},
        }
        for cell in cells
    }
    differing = {name for changed in changes.values() for name in changed}
    if len(differing) == 1 and differing <= baseline.cell.axes.keys():
        only = differing.pop()
        return {name: changed.get(only, base.get(only, "baseline")) for name, changed in changes.items()}
    names: dict[str, str] = {}
    for cell in cells:
        label = ", ".join(f"{name}={value}" for name, value in changes[cell.name].items()) or "baseline"
        is_other = label == "baseline" and cell.name != baseline.cell.name
        if is_other or label in names.values():
            label += f", {cell.spp} spp" if cell.spp != baseline.cell.spp else f", {cell.variant}"
        names[cell.name] = label
    return names


def _varied_tunables(cells: Sequence[Cell]) -> set[str]:
    """The tunables that have several values for one choice, so that names must tell the standard values, too."""
    values: dict[tuple, set[int]] = {}
    for cell in cells:
        for name, value in cell.tunables.items():
            values.setdefault((name, cell.scene, *cell.axes.values()), set()).add(value)
    return {key[0] for key, found in values.items() if len(found) > 1}


def _settings(cell: Cell) -> dict[str, str]:
    scene = cell.scene
    if cell.convergence is not None and scene.startswith(f"{cell.convergence.reference.scene}_"):
        # A scene whose name begins with its reference image's scene is labelled by the rest, so that labels match.
        scene = "…" + scene.removeprefix(cell.convergence.reference.scene)
    return {"scene": scene, **cell.axes, **cell.tuned}


HIGHER, LOWER, NOT_TOLD_APART, DISTURBED = "higher", "lower", "not told apart from 1", "disturbed"


@dataclass(frozen=True)
class Compared:
    """A cell's work-normalised variance, and its efficiency against the baseline."""

    work: Estimate
    efficiency: Estimate | None
    doubt: str = ""  # why there is no verdict on a cell's efficiency against the baseline

    @property
    def word(self) -> str:
        """On which side of 1 the whole interval of the efficiency lies; empty: there is no interval."""
        if self.efficiency is None or self.efficiency.low is None or self.efficiency.high is None:
            return ""
        if self.doubt:
            return DISTURBED
        return HIGHER if self.efficiency.low > 1 else LOWER if self.efficiency.high < 1 else NOT_TOLD_APART


def _variance_of_seeds(assessment: Assessment) -> np.ndarray:
    curve = assessment.curve
    return assessment.fit.sigma2_of_seeds if curve.independent else curve.mse[:, -1] * curve.spp[-1]


def _drawn_work(assessment: Assessment, ms: np.ndarray, drawn: np.ndarray) -> np.ndarray:
    return _variance_of_seeds(assessment)[drawn].mean(axis=1) * np.median(ms[drawn], axis=1)


def _work(assessment: Assessment, ms: np.ndarray) -> float:
    return float(_variance_of_seeds(assessment).mean() * np.median(ms))


def _is_timed_alone(one: Assessment) -> bool:
    """Whether every seed of the cell also has a time without checkpoints."""
    return one.ms_alone is not None and len(one.ms_alone) == one.curve.count


def _has_noise_apart(one: Assessment) -> bool:
    """Whether a cell's noise can be told from its bias; dependent samples allow it only where no plateau dominates."""
    return one.has_noise and (one.curve.independent or one.plateau_bias2 < _MOST_OF_PLATEAU * one.last_error)


def compare(assessment: Assessment, baseline: Assessment | None) -> Compared | None:
    """A cell's efficiency; None where there is no fit, or no noise that can be told apart from a plateau."""
    if not _has_noise_apart(assessment) or (baseline is not None and not _has_noise_apart(baseline)):
        return None
    # Each part of a render with checkpoints drains the GPU at its end, which multiplies the time of a small image.
    alone = all(_is_timed_alone(one) for one in (assessment, baseline) if one is not None)
    ms = assessment.ms_alone if alone else assessment.curve.ms_per_spp
    count = assessment.curve.count
    drawn = resampled(count)
    own = _drawn_work(assessment, ms, drawn)
    value = _work(assessment, ms)
    work = bootstrap_interval(value, own, count)
    if baseline is None or baseline is assessment:
        return Compared(work, None)
    paired = baseline.curve.seeds == assessment.curve.seeds
    others = baseline.curve.count
    base_ms = baseline.ms_alone if alone else baseline.curve.ms_per_spp
    theirs = _drawn_work(baseline, base_ms, drawn if paired else resampled(others, np.random.default_rng(SEED + 1)))
    ratio = _work(baseline, base_ms) / value
    timed = (one.alone if alone else one.cell for one in (assessment, baseline))
    return Compared(work, bootstrap_interval(ratio, theirs / own, min(count, others)), doubt_of(timed))


def ends_beside_one(efficiency: Estimate) -> str:
    """The interval of an efficiency in digits that show on which side of 1 each end lies; empty without an interval."""
    if efficiency.low is None or efficiency.high is None:
        return ""
    ends = efficiency.low, efficiency.high
    return interval(*ends, telling_digits(ends, [1], figures))


def target_of(group: Sequence[Assessment]) -> float | None:
    """A round RMS error that every cell not yet at a plateau reached within its measured samples."""
    fitted = [one for one in group if one.fit is not None and one.last_error > 0]
    falling = [one for one in fitted if one.plateau_bias2 < _MOST_OF_PLATEAU * one.last_error]
    errors = [float(np.sqrt(one.last_error)) for one in falling or fitted]
    if not errors:
        return None
    highest = max(errors)
    power = 10.0 ** np.floor(np.log10(highest))
    return float(next(step * power for step in (1, 2, 5, 10, 20) if step * power >= 1.02 * highest))


def time_to(assessment: Assessment, error: float) -> Estimate | None:
    """Milliseconds until a render in one piece has the RMS error `error`; infinite where it never has.

    The samples to the error, by the fit, are multiplied by the time per sample of the same render without checkpoints.
    None where there is no fit or no such render, or where the unmeasured cost of a launch would be a large part of it.
    """
    if assessment.fit is None or not _is_timed_alone(assessment):
        return None
    curve, ms = assessment.curve, assessment.ms_alone
    drawn = resampled(curve.count)
    spp, spps = _samples_to(assessment, error, drawn)
    per_spp = float(np.median(ms))
    value = spp * per_spp
    begun = float(np.median(curve.times["wall_ms"][:, 0])) - curve.spp[0] * per_spp
    if math.isfinite(value) and value < _LEAST_LAUNCHES * begun:
        return None
    return bootstrap_interval(value, spps * np.median(ms[drawn], axis=1), curve.count)


def _samples_to(assessment: Assessment, error: float, drawn: np.ndarray) -> tuple[float, np.ndarray]:
    """Samples per pixel until the error is `error`, for the fit and each bootstrap draw; at least one checkpoint's."""
    curve, fit = assessment.curve, assessment.fit
    if curve.independent and assessment.has_noise:
        has_plateau = assessment.verdict.word == PLATEAU
        seeds = fit.bias2_of_seeds if has_plateau else np.zeros(curve.count)
        # A plateau detected through the mean error may exceed the fitted bias^2.
        bias2 = max(float(seeds.mean()), assessment.plateau_bias2)
        drawn_bias2 = np.maximum(seeds[drawn].mean(axis=1) + bias2 - seeds.mean(), 0)
        sigma2 = fit.sigma2_of_seeds
        value = _spp_to(np.array([sigma2.mean()]), np.array([bias2]), error)
        spps = _spp_to(sigma2[drawn].mean(axis=1), drawn_bias2, error)
        value, spps = np.maximum(value, curve.spp[0]), np.maximum(spps, curve.spp[0])
    else:
        value = _spp_measured(curve.spp, curve.mean[None], error)
        spps = _spp_measured(curve.spp, curve.mse[drawn].mean(axis=1), error)
    return float(value[0]), spps


def render_times(group: Sequence[Assessment]) -> tuple[list[np.ndarray], str]:
    """Milliseconds to every checkpoint of each cell, and a phrase that tells how the times were obtained.

    Times are those of renders without checkpoints (`time_to`) if every cell has one, else of those with checkpoints.
    """
    if all(_is_timed_alone(one) for one in group):
        times = [one.curve.spp * float(np.median(one.ms_alone)) for one in group]
        return times, "render wall time without checkpoints (samples times the median of a sample)"
    times = [np.median(one.curve.times["wall_ms"], axis=0) for one in group]
    return times, "render wall time of renders cut at their checkpoints, which take a GPU longer than whole ones"


def _spp_to(sigma2: np.ndarray, bias2: np.ndarray, error: float) -> np.ndarray:
    left = error**2 - bias2
    reached = left > _NEAR_PLATEAU * error**2
    return np.where(reached, sigma2 / np.where(reached, left, 1), np.inf)


def _spp_measured(spp: np.ndarray, mse: np.ndarray, error: float) -> np.ndarray:
    """Where each seed's curve first reaches `error`, interpolated between checkpoints in log-log space."""
    falling = np.minimum.accumulate(np.maximum(mse, 1e-300), axis=1)
    goal, log_spp = 2 * np.log(error), np.log(spp)
    return np.array([_crossing(log_spp, np.log(one), goal) for one in falling])


def _crossing(log_spp: np.ndarray, log_mse: np.ndarray, goal: float) -> float:
    below = np.flatnonzero(log_mse <= goal)
    if not len(below):
        return np.inf
    first = int(below[0])
    if first == 0:
        return float(np.exp(log_spp[0]))
    share = (log_mse[first - 1] - goal) / (log_mse[first - 1] - log_mse[first])
    return float(np.exp(log_spp[first - 1] + share * (log_spp[first] - log_spp[first - 1])))


@dataclass(frozen=True)
class CheckpointCost:
    """A cell's time per sample per pixel with checkpoints, over that of the same render without them."""

    cell: Cell
    ratio: Estimate
    doubt: str  # why the cost of checkpoints gets no verdict

    @property
    def interval(self) -> str:
        """The interval of the checkpoint cost, in digits that show the verdict; empty with one sample."""
        return interval_of_ratio(self.ratio, 0, THRESHOLD)

    @property
    def word(self) -> str:
        """The verdict on the cost of checkpoints that its interval allows."""
        low, high = self.ratio.low, self.ratio.high
        if low is None or high is None:
            return "one sample: no interval"
        if self.doubt:
            return DISTURBED
        if low <= 1 <= high:
            return "within noise"
        if low >= 1 - THRESHOLD and high <= 1 + THRESHOLD:
            return "within 1 %"
        return "SLOWER with checkpoints" if low > 1 else "FASTER with checkpoints"


def checkpoint_costs(assessed: Sequence[Assessment]) -> list[CheckpointCost]:
    """The cost of checkpoints (an A/A comparison) of every cell whose companion without them was run."""
    return [
        CheckpointCost(one.cell, ratio_estimate(one.curve.ms_per_spp, one.ms_alone), doubt_of((one.cell, one.alone)))
        for one in assessed
        if one.ms_alone is not None and one.curve.count
    ]
