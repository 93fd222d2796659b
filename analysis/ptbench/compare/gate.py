"""What `compare --fail-on` says of the files, and whether it fails.

A gate asks whether a program became slower. Where verdicts are withheld, "no cell is SLOWER" is no answer to that, so
slower and different fail also where they cannot be judged: where a cell would be it by its times alone and only the way
they were taken forbids the word (disturbed samples, no noise floor), and where all cells of a file are UNSURE. A cell
that is UNSURE because its interval is wide is noise that a program which did not change has, too: that is told, and
passes.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.compare.verdicts import Comparison
from ptbench.stats.estimates import FASTER, SLOWER, UNSURE


@dataclass(frozen=True)
class Outcome:
    """What a gate says: whether it fails, and its line."""

    fails: bool
    text: str


def outcome(comparisons: Sequence[Comparison], what: str) -> Outcome:
    """`what` is one of FAIL_ON."""
    if what == "unmatched":
        alone = sum(item.in_reference for one in comparisons for item in one.matching.alone)
        cells = sum(len(one.reference.cells) for one in comparisons)
        return _outcome(what, alone > 0, f"{alone} of {cells} cells of the reference have no partner")
    words = (SLOWER,) if what == "slower" else (SLOWER, FASTER)
    name = " or ".join(words)
    rows = [row for one in comparisons for row in one.rows]
    found = sum(row.verdict.word in words for row in rows)
    hidden = [row for row in rows if row.verdict.withheld in words]
    unjudged = [one for one in comparisons if one.count(UNSURE) == len(one.rows)]
    unsure = [row for row in rows if row.verdict.word == UNSURE]
    why = Counter(_kind(row.verdict.reason) for row in unsure)
    told = f"; UNSURE are {len(unsure)} ({'; '.join(f'{count}: {kind}' for kind, count in why.items())})"
    text = f"{found} of {len(rows)} cells {name}" + (told if unsure else "")
    if hidden:
        text += f"; by their times alone {len(hidden)} of these would be {name}"
    if unjudged:
        text += "; all cells UNSURE in " + ", ".join(str(one.other.path) for one in unjudged)
    return _outcome(what, bool(found), text, could_not_judge=bool(hidden or unjudged))


def _outcome(what: str, found: bool, text: str, *, could_not_judge: bool = False) -> Outcome:
    word = "FAILED" if found else "NOT JUDGED, which fails" if could_not_judge else "passed"
    return Outcome(found or could_not_judge, f"--fail-on {what}: {word}: {text}.")


def _kind(reason: str) -> str:
    """Reasons with numbers of their own are counted as one."""
    if reason.startswith("interval "):
        return "the interval reaches both sides of a limit"
    return "too few samples" if reason.startswith("n = ") else reason
