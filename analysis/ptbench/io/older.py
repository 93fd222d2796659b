"""What files of a schema version leave unsaid of the axes.

A file names its axes, and all but the oldest their baselines. What is here holds for what a file of that version does
not name; a file that names it is believed.
"""

from collections.abc import Mapping

from ptbench.io.axes import known_axes

# The versions of result files that can be read, the newest last.
SCHEMA_VERSIONS = ("1",)


# The baselines of a file that names none, in the order of its axes, by its schema's version.
_BASELINES: dict[str, dict[str, str]] = {
    "1": {
        "integrator": "wavefront",
        "compaction": "none",
        "sorting": "none",
        "sort_key": "material",
        "first_bounce": "off",
        "direct_light": "off",
        "russian_roulette": "off",
        "sampler": "pcg4d",
        "layout": "aos",
        "specialisation": "features",
        "launch": "stream",
        "arithmetic": "precise",
        "precision": "float",
    },
}
# Axes that the first files of a version lack, by the axis behind which their cells get what every variant was then.
_FILLED_AFTER: dict[str, dict[str, str]] = {"1": {"russian_roulette": "direct_light", "sampler": "direct_light"}}
# The plainest formulas for files of `ptbench stability`, which name no baselines, by their schema.
_PLAINEST: dict[str, dict[str, str]] = {
    "ptbench-stability-1": {"precision": "float", "arithmetic": "exact", "robustness": "robust"},
}


def usual_baselines(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """Every axis's baseline, in the order of the axes: the ones `named` by the file, the version's for the others."""
    return _BASELINES.get(version, {}) | dict(named)


def before(axis: str, version: str = SCHEMA_VERSIONS[0]) -> str | None:
    """What every variant was before there was the axis; None: the version always had it, or does not know it."""
    known = known_axes().get(axis) if version in SCHEMA_VERSIONS else None
    return known.as_before or None if known is not None else None


def filled_in(version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """The axes that `with_later_axes` fills in, with what a cell gets."""
    return {axis: before(axis, version) or "" for axis in _FILLED_AFTER.get(version, {})}


def with_later_axes(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """A variant's choices by axis; those of axes that the file is too old to name are the ones that there were."""
    axes: dict[str, str] = {}
    for axis, choice in named.items():
        axes[axis] = choice
        for later, after in _FILLED_AFTER.get(version, {}).items():
            if after == axis and later not in named:
                axes[later] = before(later, version) or ""
    return axes


def plainest_formulas(schema: str) -> dict[str, str]:
    """The plainest choice of each axis that says how a stability file's numbers are computed."""
    return _PLAINEST.get(schema, {})
