"""Names of variants: the integrator and the differences from the baseline, whatever a file's own format.

Files since version 1.0 contain such names; older ones join all choices by dots, and get a name from their axes.
"""

import re
from collections.abc import Mapping, Sequence

from ptbench.io.axes import INTEGRATOR
from ptbench.io.older import before, with_later_axes

_SPELLED_OUT = re.compile(r"\w+(?:\.\w+){3,}(?:\+\w+=\w+)*")


def tuned_in(name: str, axes: Mapping[str, str]) -> dict[str, str]:
    """The tunables in a variant's name, which are those that differ from their choice's default.

    Examples of names are "wavefront layout=soa jitters=4" and, in older files, "wavefront.none. ... .robust+jitters=4".
    """
    parts = name.split("+")[1:] if "+" in name or "." in name else name.split()
    pairs = (part.partition("=") for part in parts)
    return {key: value for key, is_named, value in pairs if is_named and key not in axes}


def shown_name(axes: Mapping[str, str], tuned: Mapping[str, str], baselines: Mapping[str, str]) -> str:
    """The name of a variant: its integrator, the axes off their baseline, and the tunables off their default.

    An axis without a known baseline is included unless it has the choice that was implied before the axis existed.
    """
    differing = [
        f"{axis}={choice}"
        for axis, choice in axes.items()
        if axis != INTEGRATOR and choice != (baselines.get(axis) or before(axis))
    ]
    return " ".join([axes.get(INTEGRATOR, "?"), *differing, *(f"{name}={value}" for name, value in tuned.items())])


def axes_spelled_out(name: str, order: Sequence[str]) -> dict[str, str]:
    """The choices in an older file's variant name, by the file's axes; empty where the name is of another form."""
    choices = name.partition("+")[0].split(".")
    return with_later_axes(dict(zip(order, choices, strict=True))) if len(choices) == len(order) > 1 else {}


def with_shown_names(text: str, order: Sequence[str], baselines: Mapping[str, str]) -> str:
    """A message of a file in which variants are renamed to their displayed names."""

    def shown(match: re.Match) -> str:
        axes = axes_spelled_out(match[0], order)
        return shown_name(axes, tuned_in(match[0], axes), baselines) if axes else match[0]

    return _SPELLED_OUT.sub(shown, text)
