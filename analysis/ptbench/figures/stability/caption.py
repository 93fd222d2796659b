"""The caption under every figure of a stability file."""

from collections.abc import Sequence

from ptbench.io.stability import Stability
from ptbench.stability.summary import setting


def caption(stability: Stability, what: str, remarks: Sequence[str] = ()) -> str:
    """The caption: how to read the figure, what ran where, and whether the run is complete."""
    notes = [] if stability.is_complete else [f"Note: the run is not complete ({stability.about('status')})."]
    return "\n".join([what, *remarks, setting(stability), *notes])
