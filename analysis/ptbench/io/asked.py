"""Which figure a study is drawn as, told by what it compares and along what.

Files of before 1.1 name the figure itself.
"""

LIVE_PATHS = "live_paths"
CONVERGENCE = "convergence"
# What studies of older files compare, and along what, by the figure that they name. Any other figure of those files is
# along nothing, and is called as what it compares.
_OLDER = {
    "sorting_by_depth": ("sorting", "depth"),
    "first_bounce_by_depth": ("first_bounce", "depth"),
    "scaling_by_resolution": ("", "resolution"),
    "scaling_by_depth": ("", "depth"),
    "scaling_by_materials": ("", "materials"),
    "scaling_by_shading_fmas": ("", "shading_fmas"),
}


def figure_of(compares: str, along: str, *, is_convergence: bool) -> str:
    """The figure's name; empty where nothing is compared. An axis may have one of its own along something."""
    if is_convergence:
        return CONVERGENCE
    if compares == LIVE_PATHS:
        return "remaining_paths"
    return f"scaling_by_{along}" if along else compares


def asked_by_older(figure: str) -> tuple[str, str]:
    """What an older file's study compares along something, and along what; empty: it does not say, or nothing."""
    return _OLDER.get(figure, ("", ""))
