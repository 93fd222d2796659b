"""Names of variants: the integrator and what differs from the baseline, whatever the file that says so is called in.

Files since version 1.0 hold such names; older ones spell every choice, joined by dots, and are named from their axes.
"""

import re
from collections.abc import Mapping, Sequence

from ptbench.io.older import before, with_later_axes

INTEGRATOR = "integrator"
_SPELLED_OUT = re.compile(r"\w+(?:\.\w+){3,}(?:\+\w+=\w+)*")


def tuned_in(name: str, axes: Mapping[str, str]) -> dict[str, str]:
    """The tunables that are not at their choice's default, of a variant's name in a file: it says those and no others.

    "wavefront layout=soa jitters=4" or, in an older file, "wavefront.none. ... .robust+jitters=4".
    """
    parts = name.split("+")[1:] if "+" in name or "." in name else name.split()
    pairs = (part.partition("=") for part in parts)
    return {key: value for key, is_named, value in pairs if is_named and key not in axes}


def shown_name(axes: Mapping[str, str], tuned: Mapping[str, str], baselines: Mapping[str, str]) -> str:
    """The integrator, the axes that are not at their baseline, and the tunables that are not at their default.

    An axis without a known baseline is told where it is not what every variant was before there was the axis.
    """
    differing = [
        f"{axis}={choice}"
        for axis, choice in axes.items()
        if axis != INTEGRATOR and choice != (baselines.get(axis) or before(axis))
    ]
    return " ".join([axes.get(INTEGRATOR, "?"), *differing, *(f"{name}={value}" for name, value in tuned.items())])


def axes_spelled_out(name: str, order: Sequence[str]) -> dict[str, str]:
    """The choices of an older file's name, by the axes that the file has; empty where it is no such name."""
    choices = name.partition("+")[0].split(".")
    return with_later_axes(dict(zip(order, choices, strict=True))) if len(choices) == len(order) > 1 else {}


def with_shown_names(text: str, order: Sequence[str], baselines: Mapping[str, str]) -> str:
    """A message of a file with the variants that it names called as they are shown."""

    def shown(match: re.Match) -> str:
        axes = axes_spelled_out(match[0], order)
        return shown_name(axes, tuned_in(match[0], axes), baselines) if axes else match[0]

    return _SPELLED_OUT.sub(shown, text)
