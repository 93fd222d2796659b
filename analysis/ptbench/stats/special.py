"""SciPy's distribution functions, as `special.stdtr(..)`, imported on first use.

Importing SciPy takes a quarter of a second, which commands that need none of its functions save.
"""

from collections.abc import Callable


def __getattr__(name: str) -> Callable:
    """The function of that name in `scipy.special`."""
    from scipy import special

    return getattr(special, name)
