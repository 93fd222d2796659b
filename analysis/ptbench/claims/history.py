"""Tells by git whether a prediction is older than its result, by the commit that last changed it and the one measured.

An edited prediction counts as new: its age is that of the oldest commit since which neither the predicting part of the
claim nor the studies of its suite have changed.
"""

from dataclasses import asdict, dataclass
from datetime import UTC, datetime

from ptbench.claims.claim import Claim, Ledger, prediction_in
from ptbench.git import git

TEST, BY_DATE, LOOK_UP, UNCOMMITTED, UNKNOWN = "test", "test by dates", "look-up", "not committed", "unknown"
# Grade of a result that tests nothing: the prediction was derived from an earlier result of the same machine.
REPEAT = "repeat"


@dataclass(frozen=True)
class Measured:
    """When a result was measured, and the commit of the program that measured it."""

    commit: str
    on: str  # date of the measurement in ISO 8601
    dirty: bool = False


@dataclass(frozen=True)
class Order:
    """Whether the result or the prediction came first, with the commit and dates that show it."""

    grade: str
    predicted: str = ""  # commit that last changed the claim's prediction
    predicted_on: str = ""
    measured: str = ""
    measured_on: str = ""

    @property
    def said(self) -> str:
        """A sentence on whether the result or the prediction came first."""
        if self.grade == UNCOMMITTED:
            return "the prediction is not committed: whatever is measured now proves nothing"
        if self.grade == UNKNOWN:
            return "git cannot say which came first"
        if self.grade == REPEAT:
            return "the prediction was made from this machine's data: a repeat, not a test"
        predicted = f"predicted in {self.predicted[:7]}, {_minute(self.predicted_on)}"
        measured = f"measured with {self.measured[:7]}, {_minute(self.measured_on)}"
        if self.grade == LOOK_UP:
            return f"prediction is later than the data: a look-up, not a test ({predicted}; {measured})"
        shown = "a program that has the prediction in its history" if self.grade == TEST else "dates alone show it"
        return f"prediction before result: {predicted}; {measured} ({shown})"

    @property
    def is_test(self) -> bool:
        """Whether the data could have contradicted the prediction."""
        return self.grade in (TEST, BY_DATE)

    def document(self) -> dict[str, str]:
        """The order of prediction and result as JSON, stored beside the verdict for readers without the repository."""
        return asdict(self)


def _minute(date: str) -> str:
    return f"{date[:10]} {date[11:16]}"


def order_of(ledger: Ledger, claim: Claim, machine: str, measured: Measured) -> Order:
    """Whether the prediction or the result came first; UNKNOWN where there is no git or only part of its history."""
    if machine in claim.seen:
        return Order(REPEAT)
    if git(ledger.root, "rev-parse", "--is-shallow-repository") != "false":
        return Order(UNKNOWN)
    predicted = prediction_commit(ledger, claim)
    if predicted is None:
        return Order(UNCOMMITTED)
    on = git(ledger.root, "show", "-s", "--format=%cI", predicted) or ""
    facts = (predicted, _utc(on), measured.commit, _utc(measured.on))
    if not on or _time(measured.on) <= _time(on):
        return Order(LOOK_UP, *facts)
    known = git(ledger.root, "merge-base", "--is-ancestor", predicted, measured.commit) is not None
    return Order(TEST if known else BY_DATE, *facts)


def prediction_commit(ledger: Ledger, claim: Claim) -> str | None:
    """The oldest commit since which a prediction is unchanged; None: its present text is not committed."""
    paths = [f"claims/{claim.name}.json"]
    if claim.experiment is not None and claim.experiment.suite:
        paths.append(f"claims/suites/{claim.experiment.suite}.json")
    here = prediction_in(*_texts([(ledger.root / path).read_text(encoding="utf-8") for path in paths]))
    found = None
    for commit in (git(ledger.root, "log", "--format=%H", "--", *paths) or "").split():
        texts = [git(ledger.root, "show", f"{commit}:{path}") or "" for path in paths]
        if not here or prediction_in(*_texts(texts)) != here:
            break
        found = commit
    return found


def _texts(texts: list[str]) -> tuple[str, str]:
    return texts[0], texts[1] if len(texts) > 1 else ""


def _time(date: str) -> datetime:
    return datetime.fromisoformat(date)


def _utc(date: str) -> str:
    return _time(date).astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%SZ") if date else ""
