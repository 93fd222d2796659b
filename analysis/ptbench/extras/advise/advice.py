"""The advice for one scene: for each decision the forecast times, best first, and which measurements they rest on."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ptbench.convergence.costs import TIME, VARIANCE
from ptbench.extras.advise.evidence import DECISIONS, SCHEDULE, Book, Choice, Decision, choice_text
from ptbench.extras.advise.features import Features, farthest
from ptbench.extras.advise.model import WITHIN, Forecast, Model, Near, model_of
from ptbench.io.axes import ACCELERATOR, BUILDER, INTEGRATOR, LEVELS
from ptbench.numbers import figures, interval, percent
from ptbench.stats.estimates import CONFIDENCE

_SHOWN = 3
_DIGITS = 3
_NOT_BELIEVED = ": too few, or of too few scenes, so it is left as it was"
# Axes of acceleration structures. Their usual baselines are ignored: nobody renders meshes with them.
_OF_TREES = (ACCELERATOR, BUILDER, LEVELS)
_OF_QUEUES = ("compaction of a queue", "sorting of a queue")


@dataclass(frozen=True)
class Advised:
    """The forecasts of one decision for a scene; empty where nothing was measured."""

    decision: Decision
    model: Model | None
    forecasts: tuple[Forecast, ...]

    @property
    def pick(self) -> Choice | None:
        """The recommended choice of a decision; None where nothing was measured."""
        return self.forecasts[0].choice if self.forecasts else None

    @property
    def is_far(self) -> bool:
        """Whether no measured scene is near the advised one."""
        return self.model is not None and self.model.is_far(self.forecasts)


def models_of(book: Book) -> dict[str, Model | None]:
    """A forecasting model for each decision, by the decision's name."""
    return {decision.name: model_of(decision, book.points[decision.name]) for decision in DECISIONS}


def advise_on(
    models: Mapping[str, Model | None],
    features: Features,
    barred: frozenset[tuple[str, str]],
    baselines: Mapping[str, str],
) -> list[Advised]:
    """Advice on each decision that applies to the scene; each decision takes the earlier picks as given."""
    advised: list[Advised] = []
    usual = {axis: choice for axis, choice in baselines.items() if axis not in _OF_TREES}
    for decision in DECISIONS:
        if decision.of_meshes and not features.triangles:
            continue
        model = models[decision.name]
        context = {**usual, **settings_of(advised)}
        forecasts = () if model is None else tuple(model.forecasts(features, barred, context))
        advised.append(Advised(decision, model, forecasts))
    return advised


def settings_of(advised: Sequence[Advised]) -> dict[str, str]:
    """All picked choices as a variant, by axis or tunable; choices about queues are part of the scheduler's."""
    chosen: dict[str, str] = {}
    for one in advised:
        if one.pick is not None and one.decision.name not in _OF_QUEUES:
            first = next(iter(one.decision.reference))
            chosen |= {first: one.decision.reference[first], **dict(one.pick)}
    return chosen


def lines_of(advised: Sequence[Advised], features: Features) -> Iterator[str]:
    """The printed lines of advice on each decision."""
    schedule = next(one for one in advised if one.decision.name == SCHEDULE)
    has_queue = schedule.pick is None or dict(schedule.pick).get(INTEGRATOR, "wavefront").startswith("wavefront")
    for one in advised:
        name = one.decision.name
        if one.pick is None:
            yield f"{name}: nothing was measured there"
            continue
        moot = " (the integrator above has none)" if name in _OF_QUEUES and not has_queue else ""
        yield f"{name}{moot}: {choice_text(one.pick, one.decision)}"
        yield from (f"  {line}" for line in _details(one, features))


def _details(one: Advised, features: Features) -> Iterator[str]:
    best = one.forecasts[0]
    reference = choice_text((), one.decision)
    if best.choice:
        yield f"{_ratio_text(best)} of the {one.decision.statistic} with {reference}"
        yield from _nearest(best)
        if one.decision.statistic == VARIANCE:
            yield f"pays while a sample takes less than {figures(1 / best.ratio, _DIGITS)} times as long"
    others = one.forecasts[1 : _SHOWN + 1]
    if others:
        of = "" if best.choice else f" of the {one.decision.statistic} with it"
        yield f"next{of}: " + "; ".join(f"{choice_text(o.choice, one.decision)} {_ratio_text(o)}" for o in others)
    if not best.choice and others:
        yield from _nearest(next(other for other in others if other.near))
    yield _trial_text(one.model)
    if one.is_far and any(other.near for other in one.forecasts):
        near = min((other.near[0] for other in one.forecasts if other.near), key=lambda found: found.distance)
        most = farthest(features, near.point.features, one.decision.features)
        yield (
            f"NO MEASUREMENT IS NEAR: {near.point.scene} is {figures(near.distance, 2)} away, most of it in {most}; "
            f"the model was tried to {figures(one.model.trial.reach, 2)}"
        )


def _ratio_text(one: Forecast) -> str:
    return f"{figures(one.ratio, _DIGITS)} {interval(one.low, one.high, _DIGITS)}" if one.choice else "1"


def _nearest(one: Forecast) -> Iterator[str]:
    for near in one.near[:_SHOWN]:
        yield f"from {_near_text(near)}"


def _near_text(near: Near) -> str:
    point = near.point
    measured = f"{figures(point.ratio.value, _DIGITS)} {interval(point.ratio.low, point.ratio.high, _DIGITS)}"
    way = f", by way of {point.by_way_of}" if point.by_way_of else ""
    return (
        f"{point.scene}, {point.setting}: {measured}, {figures(near.distance, 2)} away, "
        f"{near.share:.0%} of the forecast (results/{point.file}{way})"
    )


def _trial_text(model: Model) -> str:
    trial = model.trial
    if trial.factor is None:
        return "one scene only: no error is known, so it is left as it was"
    return (
        f"scenes left out in turn: {percent(CONFIDENCE)} of {trial.forecasts} forecasts within a factor of "
        f"{figures(trial.factor, _DIGITS)}, the pick within {WITHIN:.0%} of the best measured in {trial.good} of "
        f"{trial.settings} settings{'' if trial.is_good else _NOT_BELIEVED}"
    )


def alternatives(one: Advised, count: int) -> list[Choice]:
    """The picked choice of a decision and the next best forecasts."""
    return [forecast.choice for forecast in one.forecasts[: count + 1]]


def is_timed(one: Advised) -> bool:
    """Whether a few renders can check the advice on a decision: a picked choice that is about time alone."""
    return one.decision.statistic == TIME and one.decision.name not in _OF_QUEUES and one.pick is not None
