"""Which figure a study is drawn as, told by what it compares.

Files of before 1.1 name the figure itself.
"""

LIVE_PATHS = "live_paths"
# Axes that have a figure of their own along the depth of paths.
_BY_DEPTH = ("sorting", "first_bounce")


def figure_of(compares: str, along: str, *, is_convergence: bool) -> str:
    """The figure's name; empty where nothing is compared."""
    if is_convergence:
        return "convergence"
    if compares == LIVE_PATHS:
        return "remaining_paths"
    if along == "depth" and compares in _BY_DEPTH:
        return f"{compares}_by_depth"
    return f"scaling_by_{along}" if along else compares
