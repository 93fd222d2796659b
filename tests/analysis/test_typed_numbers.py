"""Documents outside docs/findings hold no measured number: those are made from results, these would go stale.

What looks measured, a decimal, a percentage or a number with a unit of time, is declared here with the words round it
and with why it is none. Where the program or the package has the constant, the words are made from it.
"""

from __future__ import annotations

import re

import pytest
from conftest import ROOT

from ptbench.compare.noise import MOST_PLAUSIBLE
from ptbench.convergence.assessment import LEVEL_OF_A_FILE, MOST_HIDDEN
from ptbench.findings.page import measured_in
from ptbench.io.cells import MOST_HOST_SHARE
from ptbench.io.files import LARGEST_INPUT, LARGEST_RESULT
from ptbench.io.limits import limit
from ptbench.stats.estimates import CONFIDENCE, RESAMPLES, THRESHOLD

# The README and docs/findings are made from templates, which test_findings.py holds to the same.
PAGES = {page.stem: page for page in sorted((ROOT / "docs").glob("*.md"))}


def percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def constant(file: str, pattern: str) -> float:
    """A number of the C++ sources."""
    (found,) = re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"))
    return float(found)


LIMIT, FLOOR, SURE, LEVEL = percent(THRESHOLD), percent(MOST_PLAUSIBLE), percent(CONFIDENCE), percent(LEVEL_OF_A_FILE)
HOST = percent(MOST_HOST_SHARE)
ALLOWED = percent(constant("harness/bench/error_book.h", r"allowed_reference_error = ([\d.]+)"))
CONTENDED = f"{limit('most_foreign_ms')} ms"
LOW_CLOCK = f"below {limit('low_clock_share'):g} of the highest"
NODE_COST = constant("variants/builder/sah.h", r"traversal = ([\d.]+)")
STATISTIC = "a rule of the statistics or of the harness"
LAYOUT = "what a field of the result files means"

# Page, words, why: the words must stand there, and no measured number may stand elsewhere.
DECLARED = [
    ("add_an_estimator", "what is 1024 times as bright", "the film's range"),
    ("commands", f"the ratio's {SURE} interval", STATISTIC),
    ("faq", f"render that took over {HOST} longer", STATISTIC),
    ("faq", f"differs from its twin by more than {FLOOR}", STATISTIC),
    ("faq", f"differs from its twin by over {FLOOR}", STATISTIC),
    ("faq", f"a floor above {FLOOR}", STATISTIC),
    ("measuring", f"render took over {HOST} longer", STATISTIC),
    ("measuring", f"medians with a {SURE} bootstrap interval", STATISTIC),
    ("measuring", f"effects with {SURE} intervals", STATISTIC),
    ("measuring", f"is at most {ALLOWED} of the smallest mse", STATISTIC),
    ("method", LOW_CLOCK, STATISTIC),
    ("method", "refuses a clock above 10 GHz", "the schema's"),
    ("method", f"more CPU time than {CONTENDED}", STATISTIC),
    ("method", f"render took over {HOST} longer", STATISTIC),
    ("method", f"bootstrap of the median, {SURE}, {RESAMPLES // 1000} {RESAMPLES % 1000:03} resamples", STATISTIC),
    ("method", f"more than {LIMIT} below or above 1", STATISTIC),
    ("method", f"lies within {LIMIT} of 1", STATISTIC),
    ("method", f"read {SURE} as about that", STATISTIC),
    ("method", f"k = ceil({CONFIDENCE:g} (m + 1))", STATISTIC),
    ("method", f"Below 19 ratios {SURE} is out of reach", STATISTIC),
    ("method", f"within the larger of {LIMIT} and the floor", STATISTIC),
    ("method", f"none is above {FLOOR}", STATISTIC),
    ("method", f"a floor above {FLOOR}", STATISTIC),
    ("method", f"is at most {ALLOWED} of the smallest error", STATISTIC),
    ("method", f"at {LEVEL} over the whole file", STATISTIC),
    ("method", f"at most {percent(MOST_HIDDEN)} of the last squared error", STATISTIC),
    ("method", f"Holm 1979, {LEVEL}", STATISTIC),
    ("method", f"**Intervals**: {SURE}; t over seeds", STATISTIC),
    ("method", "Grubbs, 1 %", STATISTIC),
    ("method", f"with {SURE} intervals", STATISTIC),
    ("other_renderers", "which differ by 0.008 at most", "1/127 at c = 0 and less above"),
    ("scene_format", "leans by 0.3 degrees", "the arc tangent of sqrt(2) / 255"),
    ("scene_format", "Veach 1997, sec. 5.3", "a section"),
    ("result-fields", "Before version 1.0", LAYOUT),
    ("result-fields", "before version 1.0", LAYOUT),
    ("result-fields", "Since version 1.0", LAYOUT),
    ("result-fields", "in ticks (10 ms, as a rule)", LAYOUT),
    ("result-fields", LOW_CLOCK, LAYOUT),
    ("result-fields", f"is above {CONTENDED}", LAYOUT),
    ("result-fields", "fractions (0.05 is 5 %)", LAYOUT),
    ("result-fields", "+0.01)", LAYOUT),
    ("result-fields", "at most 5 % of", LAYOUT),
    ("result-fields", f"{NODE_COST:g} an inner node", LAYOUT),
]
# Whole pages: their numbers come of formulas and of the sources that they name, none of a run of ptbench.
DERIVED = {"numerics": "exact answers of cases and bounds of rounding, each with its source"}
_TIMES = re.compile(r"\d ?(?:µs|ms|[kMG]?rays/s)\b")


def undeclared(page: str, text: str) -> list[str]:
    for _, words, _ in (entry for entry in DECLARED if entry[0] == page):
        text = text.replace(words, "")
    return measured_in(text)


@pytest.mark.parametrize("page", [page for page in PAGES if page not in DERIVED])
def test_no_measured_number_is_typed(page):
    assert undeclared(page, PAGES[page].read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("page", DERIVED)
def test_derived_numbers_are_no_times(page):
    assert _TIMES.findall(PAGES[page].read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(("page", "words", "why"), DECLARED)
def test_what_is_declared_is_there(page, words, why):
    assert words in PAGES[page].read_text(encoding="utf-8")
    assert why


def test_limits_of_files_are_those_of_the_package():
    text = PAGES["faq"].read_text(encoding="utf-8")
    assert f"a file above {LARGEST_RESULT >> 30} GiB ({LARGEST_INPUT >> 20} MiB of" in text


@pytest.mark.parametrize("typed", ["It takes 0.92 of the time.", "It gains 8 %.", "It takes 20 ms.", "7 Mrays/s"])
def test_what_is_typed_is_found(typed):
    assert undeclared("faq", f"Since then: {typed}") != []
