"""What files of a schema version leave unsaid of the axes.

A file names its axes, and all but the oldest their baselines. What is here holds for what a file of that version does
not name; a file that names it is believed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

# The versions of result files that can be read, the newest last.
SCHEMA_VERSIONS = ("1",)


@dataclass(frozen=True)
class OlderAxis:
    """An axis as files of a version have it; an empty text: such a file always says it itself."""

    baseline: str = ""  # of a file that names no baselines
    before: str = ""  # what every variant was while there was no such axis
    filled_after: str = ""  # cells without the axis get `before` when they are read, behind this axis


# The axes that older files leave out, in the order in which a variant's name spells them.
_AXES: dict[str, dict[str, OlderAxis]] = {
    "1": {
        "integrator": OlderAxis("wavefront"),
        "compaction": OlderAxis("none"),
        "sorting": OlderAxis("none"),
        "sort_key": OlderAxis("material", before="material"),
        "first_bounce": OlderAxis("off"),
        "direct_light": OlderAxis("off"),
        "russian_roulette": OlderAxis("off", before="off", filled_after="direct_light"),
        "sampler": OlderAxis("pcg4d", before="pcg4d", filled_after="direct_light"),
        "layout": OlderAxis("aos"),
        "specialisation": OlderAxis("features"),
        "launch": OlderAxis("stream", before="stream"),
        "arithmetic": OlderAxis("precise", before="exact"),
        "precision": OlderAxis("float", before="float"),
        "robustness": OlderAxis(before="robust"),
        "accelerator": OlderAxis(before="brute_force"),
        "builder": OlderAxis(before="sah_binned"),
        "traversal": OlderAxis(before="while_while"),
        "traversal_stack": OlderAxis(before="local"),
        "levels": OlderAxis(before="each_object"),
        "light_sampling": OlderAxis(before="solid_angle"),
        "devices": OlderAxis(before="1"),
        "partition": OlderAxis(before="samples"),
        "light_selection": OlderAxis(before="uniform"),
        "subsurface_sampling": OlderAxis(before="classical"),
    },
}
# The plainest formulas for files of `ptbench stability`, which name no baselines, by their schema.
_PLAINEST: dict[str, dict[str, str]] = {
    "ptbench-stability-1": {"precision": "float", "arithmetic": "exact", "robustness": "robust"},
}


def usual_baselines(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """Every axis's baseline, in the order of the axes: the ones `named` by the file, the version's for the others."""
    known = {axis: of.baseline for axis, of in _AXES.get(version, {}).items() if of.baseline}
    return known | dict(named)


def before(axis: str, version: str = SCHEMA_VERSIONS[0]) -> str | None:
    """What every variant was before there was the axis; None: the version always had it, or does not know it."""
    known = _AXES.get(version, {}).get(axis)
    return known.before or None if known is not None else None


def filled_in(version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """The axes that `with_later_axes` fills in, with what a cell gets."""
    return {axis: of.before for axis, of in _AXES.get(version, {}).items() if of.filled_after}


def with_later_axes(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """A variant's choices by axis; those of axes that the file is too old to name are the ones that there were."""
    axes: dict[str, str] = {}
    for axis, choice in named.items():
        axes[axis] = choice
        for later, of in _AXES.get(version, {}).items():
            if of.filled_after == axis and later not in named:
                axes[later] = of.before
    return axes


def plainest_formulas(schema: str) -> dict[str, str]:
    """The plainest choice of each axis that says how a stability file's numbers are computed."""
    return _PLAINEST.get(schema, {})
