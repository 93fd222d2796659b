"""A result of `ptbench run`, as a page asks it: by the words of a selection (studies/selection.py)."""

from ptbench.findings.source import SUITE
from ptbench.findings.suite.errors import Errors
from ptbench.findings.suite.made import Made
from ptbench.findings.suite.times import Times


class SuiteSource(Times, Errors, Made, form=SUITE):
    """Times, errors, and what made them."""
