"""Renders one page of findings from its template.

A template begins with a JSON object between two lines of `---`:

    {"title": "...", "sources": {"compaction": {"file": "nvidia-h200/compaction.json", "where": "arithmetic=exact",
     "kernels_behind": 250}}, "constants": {"aim": "0.05"}}

Every source is a variable of the page (findings/sources), and so is every constant: an unmeasured number, such as an
aim or a version, which a page may not contain otherwise. A folder is a source of `ptbench rays`; a source with
"against": [files of other GPUs], "inspect": [files] and "models": [unmeasured GPUs] is a fleet; a missing source with
"optional": true is None. `kernels_behind` is the number of commits to kernels/ and variants/ allowed since the result's
commit (findings/commits.py); beyond it the page must be reviewed.
"""

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from jinja2 import TemplateError

from ptbench.errors import FindingError
from ptbench.findings.commits import age_fault
from ptbench.findings.ledger import rendered
from ptbench.findings.quantities import span
from ptbench.findings.source import source_of
from ptbench.numbers import percent
from ptbench.stats.estimates import FASTER, SAME, SLOWER, THRESHOLD, UNSURE

_HEAD = re.compile(r"\A---\n(\{.*?\n\})\n---\n", re.DOTALL)
_EXPRESSION = re.compile(r"\{\{.*?\}\}|\{%.*?%\}|\{#.*?#\}", re.DOTALL)
_FILE = r"(?![\w.]*\.(?:json|md|py|png|svg|txt))"
_DECIMAL = re.compile(rf"(?<![\w.=])\d+(?:[.,]\d+)+{_FILE}")
# Numbers with a decimal point or a unit, which a page of findings takes from result files, never from its own text.
_MEASURED = re.compile(
    rf"(?<![\w.])\d+(?:[.,]\d+)+{_FILE}|(?<![\w.,])\d+ ?(?:%|(?:ns|µs|ms|s|times|[kMG]?rays/s|[MG]Hz)\b)"
)
_VERDICT = re.compile(rf"\b(?:{FASTER}|{SLOWER}|{SAME}|{UNSURE})\b")
_CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.DOTALL | re.MULTILINE)
_TARGET = re.compile(r"\]\([^)]*\)")


@dataclass(frozen=True)
class Page:
    """The template of a page: its JSON head and its text."""

    template: Path
    head: Mapping
    text: str

    @property
    def sources(self) -> Mapping[str, Mapping]:
        """The sources of a page by their names, as the template's head declares them."""
        return self.head.get("sources", {})


def read_page(template: Path) -> Page:
    """Reads a template; raises FindingError where its head is malformed."""
    text = template.read_text(encoding="utf-8")
    match = _HEAD.match(text)
    if not match:
        raise FindingError(f"{template}: it does not begin with a JSON object between two lines of ---")
    try:
        head = json.loads(match[1])
    except json.JSONDecodeError as error:
        raise FindingError(f"{template}: its head is no JSON: {error}") from error
    return Page(template, head, text[match.end() :])


def render(page: Page, results: Path) -> str:
    """The page as Markdown; raises FindingError where a number is missing or a sentence contradicts the data."""
    names = {name: source_of(results, about) for name, about in page.sources.items()}
    try:
        constants = page.head.get("constants", {})
        return rendered(page.text, **names, **constants, span=span, root=math.sqrt, margin=percent(THRESHOLD))
    except (TemplateError, FindingError) as error:
        raise FindingError(f"{page.template}: {error}") from error


def measured_in(prose: str) -> list[str]:
    """Numbers in Markdown prose that look measured: decimals, percentages, and numbers with a unit."""
    return _MEASURED.findall(_CODE.sub("", _TARGET.sub("]", prose)))


def typed_by_hand(page: Page) -> list[str]:
    """Measured numbers and verdict words that a template contains literally; a valid template has none.

    Expressions must not contain such numbers either: an unmeasured number is a constant of the head. In code a decimal
    is allowed only as an option's value, such as a=0.03.
    """
    prose = _EXPRESSION.sub("", page.text)
    typed = [number for made in _EXPRESSION.findall(page.text) for number in _DECIMAL.findall(made[2:-2])]
    typed += [number for code in _CODE.findall(prose) for number in _DECIMAL.findall(code)]
    return measured_in(prose) + typed + _VERDICT.findall(_CODE.sub("", _TARGET.sub("]", prose)))


def too_old(page: Page, results: Path, repository: Path) -> list[str]:
    """Complaints on sources of a page that are older, in commits to the kernels, than the page allows."""
    found = []
    for name, about in page.sources.items():
        source = source_of(results, about)
        commit = "" if source is None else source.commit
        fault = age_fault(repository, results, commit, about["kernels_behind"]) if commit else ""
        if fault:
            found.append(f"{page.template}: {name} ({about['file']}) {fault}")
    return found
