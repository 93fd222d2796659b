"""Measured numbers for use in a page's sentences: they format themselves, and check what may be said of them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import FindingError
from ptbench.io.results import Result
from ptbench.numbers import figures, ratio
from ptbench.stats.estimates import Estimate, Verdict, interval_of_ratio

DIGITS = 3


@dataclass(frozen=True)
class Quantity:
    """A measured number, such as milliseconds per sample per pixel, with its interval where there is one."""

    estimate: Estimate
    of: str  # name of the cell with the quantity, for error messages

    def __str__(self) -> str:
        return self._text(self.estimate.value)

    def __float__(self) -> float:
        return self.estimate.value

    @property
    def with_interval(self) -> str:
        """The number as "0.922 [0.920, 0.926]", or alone where there is no interval."""
        low, high = self.estimate.low, self.estimate.high
        return (
            str(self)
            if low is None or high is None or math.isinf(self.estimate.value)
            else f"{self} [{self._text(low)}, {self._text(high)}]"
        )

    def over(self, other: float | Quantity) -> Quantity:
        """The quantity divided by a number, or by the value of another quantity, whose uncertainty is ignored."""
        by = float(other)
        one = self.estimate
        ends = (None if end is None else end / by for end in (one.low, one.high))
        return Quantity(Estimate(one.value / by, *ends, one.n), self.of)

    def _text(self, value: float) -> str:
        return "never" if math.isinf(value) else figures(value, DIGITS)


@dataclass(frozen=True)
class Ratio:
    """A ratio with its interval and the verdict that it allows; as text "0.922 [0.920, 0.926]"."""

    estimate: Estimate
    verdict: Verdict
    of: str

    def __str__(self) -> str:
        return f"{self.value} {interval_of_ratio(self.estimate)}".rstrip()

    @property
    def value(self) -> str:
        """The ratio alone as text, "0.922"."""
        return ratio(self.estimate.value)

    @property
    def number(self) -> float:
        """The ratio as a number."""
        return self.estimate.value

    @property
    def times(self) -> str:
        """How many times as fast as the baseline, "3.43": the ratio's reciprocal."""
        return figures(1 / self.estimate.value, DIGITS)

    @property
    def word(self) -> str:
        """The verdict on the ratio: FASTER, SLOWER, SAME or UNSURE."""
        return self.verdict.word

    def must_be(self, word: str, said: str = "") -> str:
        """Returns `said` if the verdict is `word`; otherwise raises FindingError, as the page contradicts the data."""
        if self.word != word:
            raise FindingError(f"{self.of}: {self}, so {self.word}, where the page says {word} ({said or 'in words'})")
        return said

    def is_times(self, least: float) -> bool:
        """Whether the whole interval is at least `least` times as fast; False without an interval."""
        return self.estimate.high is not None and 1 / self.estimate.high >= least

    def must_exceed(self, other: Ratio, said: str = "") -> str:
        """Returns `said` if the whole interval is above the other ratio's; otherwise raises FindingError."""
        low, high = self.estimate.low, other.estimate.high
        if low is None or high is None or low <= high:
            raise FindingError(f"{self.of}: {self}, which is not above {other}, as the page says ({said})")
        return said

    def must_be_over(self, *words: str) -> str:
        """Returns an empty text if the ratio's baseline has all these words; otherwise raises FindingError."""
        base = self.of.partition(" over ")[2].split()
        if missing := [word for word in words if word not in base]:
            raise FindingError(f"{self.of}: its baseline is not {' '.join(missing)}, as the page says")
        return ""

    def said(self, **words: str) -> str:
        """The phrase for the ratio's verdict: said(FASTER="pays", SLOWER="costs", ...)."""
        if self.word not in words:
            raise FindingError(f"{self.of}: {self}, so {self.word}, of which the page says nothing")
        return words[self.word]


@dataclass(frozen=True)
class Ratios:
    """Several ratios; as text "1.084 to 1.336"."""

    ratios: tuple[Ratio, ...]

    def __iter__(self):
        return iter(self.ratios)

    def __len__(self) -> int:
        return len(self.ratios)

    def __str__(self) -> str:
        low, high = self.lowest.value, self.highest.value
        return low if low == high else f"{low} to {high}"

    @property
    def lowest(self) -> Ratio:
        """The smallest of the ratios."""
        return min(self.ratios, key=lambda one: one.number)

    @property
    def highest(self) -> Ratio:
        """The largest of the ratios."""
        return max(self.ratios, key=lambda one: one.number)

    @property
    def times(self) -> str:
        """How many times as fast as their baselines the ratios are, "1.1 to 2.4"."""
        low, high = self.highest.times, self.lowest.times
        return low if low == high else f"{low} to {high}"

    def all_are(self, words: str, said: str = "") -> str:
        """Returns `said` if every ratio's verdict is one of `words` ("SLOWER UNSURE"); else raises FindingError."""
        for one in self.ratios:
            if one.word not in words.split():
                raise FindingError(f"{one.of}: {one}, so {one.word}, where the page says {words} of all ({said})")
        return said

    def all_are_times(self, least: float, said: str = "") -> str:
        """Returns `said` if each ratio's whole interval is at least `least` times as fast; else raises FindingError."""
        for one in self.ratios:
            if not one.is_times(least):
                raise FindingError(f"{one.of}: {one.times} times as fast, where the page says {least} of all ({said})")
        return said

    def most_are(self, words: str, said: str = "") -> str:
        """Returns `said` if more than half of the ratios' verdicts are among `words`; else raises FindingError."""
        count = sum(one.word in words.split() for one in self.ratios)
        if 2 * count <= len(self.ratios):
            raise FindingError(f"{count} of {len(self.ratios)} are {words}, where the page says most ({said})")
        return said

    def none_is(self, words: str, said: str = "") -> str:
        """Returns `said` if no ratio's verdict is among `words`; else raises FindingError."""
        for one in self.ratios:
            if one.word in words.split():
                raise FindingError(f"{one.of}: {one}, so {one.word}, where the page says that none is ({said})")
        return said

    def count(self, word: str) -> int:
        """The number of ratios whose verdict is `word`."""
        return sum(one.word == word for one in self.ratios)


def link_to(results: Path, file: str) -> str:
    """A page's Markdown link to a result file, which may be stored compressed."""
    stored = file if (results / file).exists() else f"{file}.gz"
    return f"[{file}](../../results/{stored})"


def disturbed_text(result: Result) -> str:
    """A phrase such as ", 3 samples whose time other processes may have changed"; empty where there are none."""
    count = sum(cell.disturbed_samples for cell in result.cells)
    return f", {count} sample{'s' if count > 1 else ''} whose time other processes may have changed" if count else ""


def span(values: Iterable[float], digits: int = DIGITS) -> str:
    """The least and the greatest of some numbers, "0.23 to 0.30"."""
    ordered = sorted(values)
    low, high = figures(ordered[0], digits), figures(ordered[-1], digits)
    return low if low == high else f"{low} to {high}"
