"""A result of `ptbench run` as a source for a page, looked up by the words of a selection (studies/selection.py)."""

from ptbench.findings.source import SUITE
from ptbench.findings.suite.errors import Errors
from ptbench.findings.suite.made import Made
from ptbench.findings.suite.times import Times


class SuiteSource(Times, Errors, Made, form=SUITE):
    """The times, error curves and build facts of a result of `ptbench run`."""
