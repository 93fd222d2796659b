"""What keeps a page from being written."""

from __future__ import annotations


class FindingError(Exception):
    """A sentence that its results contradict, a number that is not there, or results older than the page allows."""
