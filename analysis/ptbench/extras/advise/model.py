"""Forecasts the cost of a choice on an unmeasured scene: a weighted mean of its cost on similar scenes.

The weight of a measurement falls off as a power of its distance (Shepard 1968). The power, the stated error and the
distance up to which forecasts are trusted all come from leaving out one scene after the other.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ptbench.extras.advise.evidence import Choice, Decision, Point
from ptbench.extras.advise.features import Features, distance
from ptbench.stats.estimates import CONFIDENCE

POWERS = (1.0, 2.0, 4.0, 8.0)
SAME = 0.1  # feature distance below which two scenes count as one scene
WITHIN = 0.05  # an advised choice at most this fraction above the best time counts as equally good
LEAST_SCENES = 3  # least number of measured scenes for a model to be trusted
ALIKE = 0.02  # relative difference of two forecasts up to which the choice with fewer changes is preferred
# Feature distance, added in quadrature, for each axis of which a measurement has another choice than its forecast.
ANOTHER_CHOICE = 0.5
# Largest feature distance by which a choice's nearest measurement may lie behind the nearest one of all choices.
_MOST_BEHIND = 2.0


@dataclass(frozen=True)
class Wanted:
    """What a forecast is for: the features of a scene, and the choices of the other axes."""

    features: Features
    context: Mapping[str, str]


@dataclass(frozen=True)
class Near:
    """A measurement, its feature distance, and its share of the forecast."""

    point: Point
    distance: float
    share: float


@dataclass(frozen=True)
class Forecast:
    """The forecast cost of a choice over the reference's, with the error found by leaving out scenes."""

    choice: Choice
    ratio: float
    low: float | None
    high: float | None
    near: tuple[Near, ...]  # measurements that the forecast rests on, the nearest first

    @property
    def distance(self) -> float:
        """The feature distance of the nearest measurement."""
        return self.near[0].distance if self.near else 0.0


@dataclass(frozen=True)
class Trial:
    """The result of leaving out each scene in turn and forecasting it."""

    scenes: int
    factor: float | None  # factor that bounds 95 % of the errors of forecast ratios; None: too few scenes
    forecasts: int
    good: int  # number of settings where the choice forecast as best was within 5 % of the best when measured
    settings: int
    reach: float  # largest feature distance of a scene to its nearest other scene

    @property
    def is_good(self) -> bool:
        """Whether a model may overrule the reference: enough scenes, and right in at least half of its trials."""
        return self.scenes >= LEAST_SCENES and 0 < self.settings <= 2 * self.good


@dataclass(frozen=True)
class Model:
    """The measurements of one decision, and how well they forecast."""

    decision: Decision
    points: tuple[Point, ...]
    power: float
    trial: Trial

    def forecasts(
        self, features: Features, barred: Iterable[tuple[str, str]] = (), context: Mapping[str, str] | None = None
    ) -> list[Forecast]:
        """Every choice with measurements near enough, the best forecast first; the reference is included with ratio 1.

        `barred` are (axis, choice) pairs that do not apply; `context` are the choices of other axes.
        """
        out = set(barred)
        reference = () if out & set(self.decision.reference.items()) else (Forecast((), 1.0, 1.0, 1.0, ()),)
        wanted = Wanted(features, context or {})
        found = [
            _forecast(
                choice, [self.points[index] for index in indices], wanted, self.decision, self.power, self.trial.factor
            )
            for choice, indices in _by_choice(self.points).items()
            if not out & set(choice)
        ]
        nearest = min((one.distance for one in found), default=0.0)
        known = [one for one in found if one.distance <= nearest + _MOST_BEHIND]
        ordered = sorted([*known, *reference], key=lambda one: one.ratio)
        if not self.trial.is_good and reference:
            return [*reference, *(one for one in ordered if one.choice)]
        return _plainest_first(ordered)

    def is_far(self, forecasts: Sequence[Forecast]) -> bool:
        """Whether the nearest measurement is farther than any left-out scene's was when the model was tried."""
        nearest = min((one.distance for one in forecasts if one.near), default=math.inf)
        return nearest > self.trial.reach


def _plainest_first(ordered: Sequence[Forecast]) -> list[Forecast]:
    """Moves to the front the choice with the fewest changes among those forecast to be about as good as the best."""
    if not ordered:
        return []
    alike = [one for one in ordered if one.ratio <= ordered[0].ratio * (1 + ALIKE)]
    first = min(alike, key=lambda one: (len(one.choice), one.ratio))
    return [first, *(one for one in ordered if one is not first)]


def model_of(decision: Decision, points: Sequence[Point]) -> Model | None:
    """Builds a decision's model from its measurements; None where there are none."""
    if not points:
        return None
    tried = {power: _left_out(decision, points, power) for power in POWERS}
    power = min(POWERS, key=lambda one: _mean_square(tried[one].values()))
    return Model(decision, tuple(points), power, _trial(decision, points, tried[power]))


def _forecast(
    choice: Choice, points: Sequence[Point], wanted: Wanted, decision: Decision, power: float, factor: float | None
) -> Forecast:
    distances = np.array([_off(point, wanted, decision) for point in points])
    weights = ((distances**2 + SAME**2) / (distances.min() ** 2 + SAME**2)) ** (-power / 2)
    weights *= _of_each_scene(points, distances)
    shares = weights / weights.sum()
    ratio = math.exp(float(np.dot(shares, [point.log_ratio for point in points])))
    order = np.argsort(distances, kind="stable")
    near = tuple(Near(points[index], float(distances[index]), float(shares[index])) for index in order if shares[index])
    low, high = (None, None) if factor is None else (ratio / factor, ratio * factor)
    return Forecast(choice, ratio, low, high, near)


def _of_each_scene(points: Sequence[Point], distances: np.ndarray) -> np.ndarray:
    """Weights that keep only the measurements nearest within each scene, so that often measured scenes count once."""
    kept: dict[str, list[int]] = {}
    for index in np.argsort(distances, kind="stable"):
        found = kept.setdefault(points[index].family, [])
        if not found or distances[index] <= distances[found[0]] + SAME:
            found.append(int(index))
    weights = np.zeros(len(points))
    for found in kept.values():
        weights[found] = 1 / len(found)
    return weights


def _off(point: Point, wanted: Wanted, decision: Decision) -> float:
    others = sum(wanted.context.get(axis, choice) != choice for axis, choice in point.context.items())
    return math.hypot(distance(point.features, wanted.features, decision.features), ANOTHER_CHOICE * math.sqrt(others))


def _by_choice(points: Sequence[Point]) -> dict[Choice, list[int]]:
    """The indices of the measurements of each choice."""
    found: dict[Choice, list[int]] = {}
    for index, point in enumerate(points):
        found.setdefault(point.choice, []).append(index)
    return found


def _left_out(decision: Decision, points: Sequence[Point], power: float) -> dict[int, float]:
    """Errors of log-ratio forecasts by measurement, each made without the measurement's own scene."""
    told = {}
    for indices in _by_choice(points).values():
        for index in indices:
            others = [points[other] for other in indices if points[other].family != points[index].family]
            if others:
                wanted = Wanted(points[index].features, points[index].context)
                one = _forecast((), others, wanted, decision, power, None)
                told[index] = math.log(one.ratio) - points[index].log_ratio
    return told


def _mean_square(errors: Iterable[float]) -> float:
    squares = [error**2 for error in errors]
    return sum(squares) / len(squares) if squares else math.inf


def _trial(decision: Decision, points: Sequence[Point], errors: Mapping[int, float]) -> Trial:
    sizes = np.abs(list(errors.values()))
    # The 95 % quantile of fewer than 20 forecast errors is the largest of them.
    factor = math.exp(float(np.quantile(sizes, CONFIDENCE, method="higher"))) if len(sizes) else None
    settings: dict[tuple, dict[Choice, tuple[float, float]]] = {}
    for index, error in errors.items():
        point = points[index]
        place = settings.setdefault((*point.rest, point.file), {(): (0.0, 0.0)})
        place[point.choice] = (point.log_ratio + error, point.log_ratio)
    good = 0
    for place in settings.values():
        limit = min(told for told, _ in place.values()) + math.log1p(ALIKE)
        alike = [choice for choice, (told, _) in place.items() if told <= limit]
        _, picked = place[min(alike, key=lambda choice: (len(choice), place[choice][0]))]
        good += picked <= min(truth for _, truth in place.values()) + math.log1p(WITHIN)
    scenes = len({point.family for point in points})
    return Trial(scenes, factor, len(sizes), good, len(settings), _reach(decision, points))


def _reach(decision: Decision, points: Sequence[Point]) -> float:
    """The largest distance of any scene to its nearest other scene."""
    places = list({(point.family, point.setting): point for point in points}.values())
    nearest = [
        min((distance(one.features, other.features, decision.features) for other in places
             if other.family != one.family), default=0.0)
        for one in places
    ]  # fmt: skip
    return max(nearest, default=0.0)
