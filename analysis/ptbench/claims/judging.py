"""Turns the numbers of a claim into its verdict, by one rule for all claims.

A condition holds where the whole confidence interval of its number lies in the interval of the claim's rule. It fails
where the whole confidence interval lies outside, and is open otherwise. Conditions are called "theirs" where they are
nearest to the publication's setting; the others lie below or above it along the axis that the claim names.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ptbench.claims.claim import THEIRS, Claim
from ptbench.claims.evidence import Evidence, Found

HOLDS, HOLDS_WHERE, DOES_NOT, NOT_REACHED = "holds", "holds only where", "does not hold", "not reached"
WITHDRAWN = "withdrawn"
WITHIN, LESS, MORE, OPEN, MISSING = "holds", "less", "more", "open", "no number"
_SIDES = {LESS: "below", MORE: "above"}
VERDICTS = (HOLDS, HOLDS_WHERE, DOES_NOT, NOT_REACHED)

RULE = (
    "*holds*: every condition does. *holds only where*: some do, and the table is the map. *does not hold*: none does, "
    "none is open, and there are conditions on both sides of theirs. *not reached*: anything else, with the reason. "
    "*withdrawn*: there was a verdict, and what it rested on is no answer; the question stands, and is asked anew."
)


@dataclass(frozen=True)
class Judged:
    """One condition's number and the word that it earns."""

    found: Found
    word: str

    @property
    def foreseen(self) -> bool | None:
        """Whether the measured number lies in its predicted interval; None: there is no number."""
        estimate = self.found.estimate
        return None if estimate is None else self.found.condition.predicted.holds(estimate.value)


@dataclass(frozen=True)
class Verdict:
    """What the measurements of one machine say of a claim."""

    word: str
    reason: str
    judged: tuple[Judged, ...] = ()

    @property
    def held(self) -> list[str]:
        """Names of the conditions of a claim that hold."""
        return [one.found.condition.name for one in self.judged if one.word == WITHIN]

    @property
    def foreseen(self) -> tuple[int, int]:
        """How many measured numbers lie in their predicted interval, and how many were measured."""
        told = [one.foreseen for one in self.judged if one.foreseen is not None]
        return sum(told), len(told)


def judge(claim: Claim, evidence: Evidence | None) -> Verdict:
    """The verdict on a claim; without evidence "not reached", for the claim's reason or because nothing was run.

    A withdrawn claim gets no number, whatever was measured.
    """
    if claim.experiment is None:
        return Verdict(NOT_REACHED, claim.not_reached)
    if claim.withdrawn:
        return Verdict(WITHDRAWN, claim.withdrawn)
    if evidence is None:
        return Verdict(NOT_REACHED, "it was not run yet")
    judged = tuple(Judged(found, word_of(found)) for found in evidence.found)
    if evidence.refused:
        return Verdict(NOT_REACHED, f"the files cannot be compared as machines: {evidence.refused}", judged)
    word, reason = _verdict(judged)
    return Verdict(word, reason, judged)


def word_of(found: Found) -> str:
    """The word for one condition of a claim that its measured interval allows."""
    estimate, claimed = found.estimate, found.condition.claimed
    if estimate is None or estimate.low is None or estimate.high is None:
        return MISSING
    if found.doubt:
        return OPEN
    if estimate.high < claimed.low:
        return LESS
    if estimate.low > claimed.high:
        return MORE
    return WITHIN if claimed.low <= estimate.low and estimate.high <= claimed.high else OPEN


def _verdict(judged: Sequence[Judged]) -> tuple[str, str]:
    theirs = [one for one in judged if one.found.condition.side == THEIRS]
    others = [one for one in judged if one not in theirs]
    tally = _tally(theirs, "near theirs")
    tally += f", {_tally(others, 'elsewhere')}" if others else ""
    held = _count(judged)
    if unknown := sum(one.word == MISSING for one in theirs):
        return NOT_REACHED, f"{unknown} of {len(theirs)} conditions near theirs have no number"
    if held == len(judged):
        return HOLDS, tally
    if held:
        return HOLDS_WHERE, tally
    if undecided := [one.found.condition.name for one in judged if one.word in (OPEN, MISSING)]:
        return NOT_REACHED, f"no condition holds, and {_listed(undecided)} decided nothing"
    sides = {one.found.condition.side for one in judged}
    if not {"below", "above"} <= sides:
        return NOT_REACHED, f"no condition holds: {tally}; theirs were not approached from two sides"
    return DOES_NOT, tally


def _tally(judged: Sequence[Judged], where: str) -> str:
    """Counts the conditions that hold, and on which side of the rule the others lie: above may mean a larger gain."""
    sides = [f"{count} {said}" for word, said in _SIDES.items() if (count := _count(judged, word))]
    beyond = f" ({', '.join(sides)} the rule)" if sides else ""
    return f"{_count(judged)} of {len(judged)} {where}{beyond}"


def _count(judged: Iterable[Judged], word: str = WITHIN) -> int:
    return sum(one.word == word for one in judged)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{len(names)} of them ({names[0]}, ...)"
