"""SciPy's functions of distributions, `special.stdtr(..)`, loaded by the first call.

SciPy takes a quarter of a second to load, which a command that calls none of them should not wait for.
"""

from collections.abc import Callable


def __getattr__(name: str) -> Callable:
    """The function of `scipy.special` of that name."""
    from scipy import special

    return getattr(special, name)
