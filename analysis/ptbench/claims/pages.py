"""Pages of the claims ledger: a table of all claims and one page per claim, made from templates."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.claims.claim import Claim, Ledger, Span
from ptbench.claims.evidence import Evidence
from ptbench.claims.figure import draw, draw_all
from ptbench.claims.history import Order
from ptbench.claims.judging import NOT_REACHED, RULE, VERDICTS, WITHDRAWN, Judged, Verdict
from ptbench.figures import style
from ptbench.figures.saving import svg_of
from ptbench.findings.ledger import rendered_file
from ptbench.numbers import figures
from ptbench.stats.estimates import Estimate

DIGITS = 3
OVERVIEW = "overview.svg"
_READ = {
    "paper": "the paper was read",
    "abstract": "its abstract was read",
    "page": "its first page was read",
    "thread": "the thread was read",
    "commit": "the commit's message was read",
    "memory": "from memory or notes, not looked up",
}
_AUTHOR = re.compile(r"(?:^|, )(?:\w\. ?)+")  # initials of one author, at the beginning of a list or after a comma


@dataclass(frozen=True)
class Told:
    """A claim with what one machine's result says of it; without evidence there is no number."""

    claim: Claim
    verdict: Verdict
    evidence: Evidence | None = None
    order: Order | None = None

    @property
    def word(self) -> str:
        """The word of a claim's verdict, marked where the data existed before the prediction."""
        if self.claim.withdrawn:
            return WITHDRAWN
        if self.evidence is None:
            return "not run yet" if self.claim.experiment is not None else "cannot be asked yet"
        untested = self.order is not None and not self.order.is_test
        return f"{self.verdict.word} (no test)" if untested else self.verdict.word

    @property
    def machine(self) -> str:
        """The machine's folder in results/; empty where the experiment was not run."""
        return "" if self.evidence is None else self.evidence.machine

    @property
    def device(self) -> str:
        """The word "GPU" or "CPU" for the device of the claim's result."""
        return "—" if self.evidence is None else self.evidence.device

    @property
    def figure(self) -> str:
        """The file name of a claim's figure; empty: there is none."""
        has_number = any(one.found.estimate is not None for one in self.verdict.judged)
        return f"{self.claim.name}_{self.machine}.svg" if has_number else ""

    @property
    def files(self) -> tuple[str, ...]:
        """Paths of the claim's result files, relative to the folder of results."""
        return () if self.evidence is None else self.evidence.files

    @property
    def authors(self) -> str:
        """The authors of a claim's publication; from three on the first one's name and "et al."."""
        authors = self.claim["source"]["authors"]
        return f"{authors.split(',')[0]} et al." if len(_AUTHOR.findall(authors)) > 2 else authors

    @property
    def foreseen(self) -> str:
        """The number of correct predictions of a claim, as "5 of 8"."""
        right, of = self.verdict.foreseen
        return f"{right} of {of}" if of else "—"


def pages_of(ledger: Ledger, told: Sequence[Told]) -> dict[str, str]:
    """Every page and figure of docs/claims, by file name."""
    by_claim: dict[str, list[Told]] = {}
    for one in told:
        by_claim.setdefault(one.claim.name, []).append(one)
    with style.applied():
        overview = draw_all([(one.claim, one.verdict, one.device) for one in told])
        figure = "" if overview is None else OVERVIEW
        pages = {} if overview is None else {OVERVIEW: svg_of(overview)}
    pages["README.md"] = _rendered(
        ledger, "README.md", told=told, counts=_counts(told), figure=figure, foreseen=_foreseen(told)
    )
    for name, entries in by_claim.items():
        pages[f"{name}.md"] = _rendered(ledger, "claim.md", claim=entries[0].claim, told=entries)
    with style.applied():
        for one in told:
            if one.figure:
                pages[one.figure] = svg_of(draw(one.claim, one.verdict, one.device))
    return pages


def _counts(told: Sequence[Told]) -> dict[str, int]:
    """The number of verdicts by word, one per claim and device; claims not run are counted apart from untestable."""
    words = [one.word for one in told]
    counts = {word: words.count(word) for plain in VERDICTS for word in (plain, f"{plain} (no test)")}
    counts |= {word: words.count(word) for word in words if word not in counts}
    return {word: count for word, count in counts.items() if count}


def _foreseen(told: Sequence[Told]) -> tuple[int, int]:
    """How many measured numbers lie in their predicted interval, and how many could have contradicted a prediction."""
    scores = [one.verdict.foreseen for one in told if one.order is not None and one.order.is_test]
    return sum(right for right, _ in scores), sum(of for _, of in scores)


def _rendered(ledger: Ledger, template: str, **names: object) -> str:
    return rendered_file(
        ledger.templates / template, **names, interval=span_text, measured=measured_text, word=word_text, read=_READ,
        rule=RULE, not_reached=NOT_REACHED, run=run_text,
    )  # fmt: skip


def span_text(span: Span) -> str:
    """An interval in words: "1.06 to 1.32", "at least 1.36", "at most 1"."""
    if math.isinf(span.low) and math.isinf(span.high):
        return "any"
    if math.isinf(span.high):
        return f"at least {span.low:g}"
    return f"at most {span.high:g}" if math.isinf(span.low) else f"{span.low:g} to {span.high:g}"


def measured_text(one: Judged) -> str:
    """A measured number such as "1.21 [1.20, 1.23]", with enough digits to show where it lies to the claim's limits."""
    estimate = one.found.estimate
    if estimate is None:
        return "—"
    claimed = one.found.condition.claimed
    ends = [end for end in (claimed.low, claimed.high) if math.isfinite(end)]
    digits = next((count for count in range(DIGITS, 12) if _tells(estimate, ends, count)), 12)
    value = figures(estimate.value, digits)
    if estimate.low is None or estimate.high is None or estimate.low == estimate.high:
        return value
    return f"{value} [{figures(estimate.low, digits)}, {figures(estimate.high, digits)}]"


def _tells(estimate: Estimate, ends: Sequence[float], digits: int) -> bool:
    values = [value for value in (estimate.low, estimate.high) if value is not None]
    return all((float(figures(value, digits)) < end) == (value < end) for value in values for end in ends) and all(
        (float(figures(value, digits)) > end) == (value > end) for value in values for end in ends
    )


def word_text(one: Judged) -> str:
    """The word of a claim's condition, and the reason where it decides nothing."""
    return f"{one.word}: {one.found.doubt}" if one.found.doubt else one.word


def run_text(claim: Claim) -> str:
    """The ptbench command that measures a claim."""
    experiment = claim.experiment
    if experiment is None:
        return ""
    out = f"--out results/MACHINE/claims/{experiment.result}.json"
    if experiment.rays:
        return f"build/ptbench rays --backend {experiment.backend} {' '.join(experiment.rays)} {out}"
    suite = f"--suite claims/suites/{experiment.suite}.json"
    return f"build/ptbench run {suite} --backend {experiment.backend} --untuned {out}"
