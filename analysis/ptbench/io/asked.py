"""The figure that a study is drawn as, derived from what the study compares and along what.

Files older than version 1.1 name the figure itself.
"""

from ptbench.io.axes import FIRST_BOUNCE, SORTING

LIVE_PATHS = "live_paths"
CONVERGENCE = "convergence"
# Older files name only a study's figure: by that name, what the study compares (empty: not said) and along which
# parameter. A study with any other figure is along no parameter, and compares what the figure is named after.
_OLDER = {
    "sorting_by_depth": (SORTING, "depth"),
    "first_bounce_by_depth": (FIRST_BOUNCE, "depth"),
    "scaling_by_resolution": ("", "resolution"),
    "scaling_by_depth": ("", "depth"),
    "scaling_by_materials": ("", "materials"),
    "scaling_by_shading_fmas": ("", "shading_fmas"),
}


def figure_of(compares: str, along: str, *, is_convergence: bool) -> str:
    """The name of a study's figure; empty where nothing is compared. An axis may have a figure along a parameter."""
    if is_convergence:
        return CONVERGENCE
    if compares == LIVE_PATHS:
        return "remaining_paths"
    return f"scaling_by_{along}" if along else compares


def asked_by_older(figure: str) -> tuple[str, str]:
    """What a study of an older file compares, and along what; empty where the file does not say."""
    return _OLDER.get(figure, ("", ""))
