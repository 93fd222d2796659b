"""What `compare --fail-on` says of the files, and whether it fails.

A gate asks whether a program became slower. Where verdicts are withheld, "no cell is SLOWER" is no answer. So `slower`
and `different` fail also where they cannot be judged: where a cell's times alone would make it so and only disturbed
samples or a missing noise floor forbid the word, and where all cells of a file are UNSURE. A cell that is UNSURE
because of a wide interval shows noise that an unchanged program has, too: the gate reports the cell and passes.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.compare.verdicts import Comparison
from ptbench.stats.estimates import FASTER, SLOWER, UNSURE


@dataclass(frozen=True)
class Outcome:
    """The outcome of a gate: whether it fails, and its line of text."""

    fails: bool
    text: str


def outcome(comparisons: Sequence[Comparison], what: str) -> Outcome:
    """The outcome of a gate for `what`, one of the words of FAIL_ON."""
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
    """Reduces reasons that differ only in their numbers to one, so that they are counted together."""
    if reason.startswith("interval "):
        return "the interval reaches both sides of a limit"
    return "too few samples" if reason.startswith("n = ") else reason
