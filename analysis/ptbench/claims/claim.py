"""A claim is a file, claims/NAME.json: a published sentence, the experiment that tests it, and the predicted outcome.

The experiment of a claim is a suite of claims/suites or a call of `ptbench rays`. Each condition of a claim is a
number, usually the ratio of two cells, with the interval that was predicted before the measurement.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import FindingError, InputError, bad_value
from ptbench.io.files import named_files
from ptbench.io.nodes import read_json, shown
from ptbench.io.validate import complaints
from ptbench.studies.selection import parsed

# Keys of a claim's file that make up its prediction: a change of any of their values makes it a new prediction.
_PREDICTED = ("claim", "number", "rule", "prediction", "experiment")
_NO_PREDICTION = ("seconds", "also")
# Keys of a suite that say how a figure shows a study: no number depends on them, so a change makes no new prediction.
_HOW_IT_IS_SHOWN = ("figure", "compares", "along")

THEIRS = "theirs"


@dataclass(frozen=True)
class Span:
    """An interval whose ends may be open."""

    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether a value lies in the interval."""
        return self.low <= value <= self.high


def span_of(ends: Sequence[float | None]) -> Span:
    """Makes an interval from [low, high], where null is an open end."""
    low, high = ends
    return Span(-math.inf if low is None else low, math.inf if high is None else high)


@dataclass(frozen=True)
class Condition:
    """A condition of a claim: one number that the experiment gives, and the interval in which it must lie."""

    name: str
    side: str  # whether the measured setting is below the publication's along the axis, at it, or above it
    cell: str
    over: str
    predicted: Span
    claimed: Span  # interval that the measured number must lie in for the claim to hold


@dataclass(frozen=True)
class Experiment:
    """The experiment of a claim: what is run, and which numbers are taken from it."""

    suite: str  # suite in claims/suites that runs the experiment; empty: the experiment is a call of `ptbench rays`
    rays: tuple[str, ...]
    result: str  # name of the result file that the claim's experiment writes
    also: tuple[str, ...]  # names of other suites' result files that serve where the experiment's own suite was not run
    machines: tuple[str, ...]  # two folders of results/, whose ray rates give a ratio; empty: each machine alone
    backend: str
    seconds: int
    statistic: str
    axis: str
    conditions: tuple[Condition, ...]
    spp_at: int | None


@dataclass(frozen=True)
class Claim:
    """A claim of a publication, as its file has it."""

    name: str
    document: dict
    experiment: Experiment | None
    not_reached: str  # why the claim cannot be tested by ptbench; empty where it can
    withdrawn: str = ""  # why the existing measurement does not answer the claim; until a new one, no verdict is given
    seen: tuple[str, ...] = ()  # machines whose results the prediction was derived from

    def __getitem__(self, key: str) -> object:
        return self.document[key]


@dataclass(frozen=True)
class Ledger:
    """The folders in which claims, their suites and pages lie in a checkout."""

    root: Path

    @property
    def folder(self) -> Path:
        """The folder of claims."""
        return self.root / "claims"

    @property
    def verdicts(self) -> Path:
        """The file with the committed verdicts, verdicts.json in the folder of the claims' pages."""
        return self.pages / "verdicts.json"

    @property
    def pages(self) -> Path:
        """The folder of the claims' pages."""
        return self.root / "docs" / "claims"

    @property
    def templates(self) -> Path:
        """The folder of the templates from which the claims' pages are made."""
        return self.root / "docs" / "templates" / "claims"

    def suite(self, name: str) -> Path:
        """The path of a suite of the claims ledger."""
        return self.folder / "suites" / f"{name}.json"

    def claims(self, names: Sequence[str] = ()) -> list[Claim]:
        """Reads every claim, or those named; raises InputError for a claim that is missing or malformed."""
        return [read_claim(path, self.folder) for path in named_files(self.folder, names, "claim")]


def read_claim(path: Path, folder: Path) -> Claim:
    """Reads a claim's file and checks it; raises InputError."""
    root = read_json(path)
    if found := list(complaints(root.value, "claim")):
        raise InputError(f"{path}: {found[0]}")
    document = root.value
    about = document.get("experiment")
    experiment = None if about is None else _experiment(path, about, span_of(_ends(document["rule"])))
    if experiment is not None and experiment.suite and not (folder / "suites" / f"{experiment.suite}.json").is_file():
        raise bad_value(path, "$.experiment.suite", shown(experiment.suite), "the name of a file in claims/suites")
    reasons = document.get("not_reached", ""), document.get("withdrawn", "")
    return Claim(path.stem, document, experiment, *reasons, tuple(document.get("seen", ())))


def _experiment(path: Path, about: dict, rule: Span) -> Experiment:
    conditions = []
    for index, one in enumerate(about["conditions"]):
        place = f"$.experiment.conditions[{index}]"
        if one["name"] in (other.name for other in conditions):
            raise bad_value(path, f"{place}.name", shown(one["name"]), "each name once")
        for key in ("predicted", "claimed"):
            low, high = one.get(key) or (None, None)
            if low is not None and high is not None and low > high:
                raise bad_value(path, f"{place}.{key}", shown(one[key]), "[low, high]")
        for key in ("cell", "over"):
            _check_selection(path, f"{place}.{key}", one.get(key, ""))
        claimed = span_of(one["claimed"]) if "claimed" in one else rule
        conditions.append(
            Condition(one["name"], one["side"], one["cell"], one.get("over", ""), span_of(one["predicted"]), claimed)
        )
    return Experiment(
        suite=about.get("suite", ""),
        rays=tuple(about.get("rays", ())),
        result=about.get("result", about.get("suite", "")),
        also=tuple(about.get("also", ())),
        machines=tuple(about.get("machines", ())),
        backend=about["backend"],
        seconds=about["seconds"],
        statistic=about["statistic"],
        axis=about["axis"],
        conditions=tuple(conditions),
        spp_at=about.get("spp_at"),
    )


def _check_selection(path: Path, place: str, selections: str) -> None:
    for selection in selections.split(";"):
        try:
            parsed(selection)
        except FindingError as error:
            raise bad_value(path, place, shown(selection), f"each name once ({error})") from error


def _ends(rule: dict) -> tuple[float | None, float | None]:
    return rule["low"], rule["high"]


def _measured(studies: object) -> object:
    if isinstance(studies, list):
        return [_measured(study) for study in studies]
    if isinstance(studies, dict):
        return {key: value for key, value in studies.items() if key not in _HOW_IT_IS_SHOWN}
    return studies


def prediction_in(text: str, suite_text: str) -> str:
    """The prediction in the texts of a claim's file and its suite, as one string; empty: these are no such files."""
    try:
        document = json.loads(text)
        suite = json.loads(suite_text) if suite_text else {}
        parts = {key: document[key] for key in _PREDICTED}
        parts["experiment"] = {key: value for key, value in parts["experiment"].items() if key not in _NO_PREDICTION}
        return json.dumps([parts, _measured(suite.get("studies"))], sort_keys=True)
    except (ValueError, KeyError, AttributeError):
        return ""
