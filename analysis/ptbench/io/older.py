"""What files of an older schema version imply about axes that they do not name.

A file names its axes, and all but the oldest their baselines. The tables below apply only to what a file does not name.
"""

from collections.abc import Mapping

from ptbench.io.axes import known_axes

# The versions of result files that can be read, the newest last.
SCHEMA_VERSIONS = ("1",)


# Baselines for files that name none, in the order of axes, by schema version.
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
# For the first files of a schema version: axes that these lack, each with the axis behind which it is inserted.
_FILLED_AFTER: dict[str, dict[str, str]] = {"1": {"russian_roulette": "direct_light", "sampler": "direct_light"}}
# Baselines of files of `ptbench stability`, which name none, as choices by axis: the plainest formulas; by schema.
_PLAINEST: dict[str, dict[str, str]] = {
    "ptbench-stability-1": {"precision": "float", "arithmetic": "exact", "robustness": "robust"},
}


def usual_baselines(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """The baseline of every axis, in the axes' order: as `named` by the file, else the version's."""
    return _BASELINES.get(version, {}) | dict(named)


def before(axis: str, version: str = SCHEMA_VERSIONS[0]) -> str | None:
    """The choice that all variants implicitly had before an axis existed; None: the version always had the axis."""
    known = known_axes().get(axis) if version in SCHEMA_VERSIONS else None
    return known.as_before or None if known is not None else None


def filled_in(version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """The axes that `with_later_axes` fills in, with the implied choice."""
    return {axis: before(axis, version) or "" for axis in _FILLED_AFTER.get(version, {})}


def with_later_axes(named: Mapping[str, str], version: str = SCHEMA_VERSIONS[0]) -> dict[str, str]:
    """A variant's choices by axis, with the implied choices of axes that the file is too old to name."""
    axes: dict[str, str] = {}
    for axis, choice in named.items():
        axes[axis] = choice
        for later, after in _FILLED_AFTER.get(version, {}).items():
            if after == axis and later not in named:
                axes[later] = before(later, version) or ""
    return axes


def plainest_formulas(schema: str) -> dict[str, str]:
    """The plainest choice of each axis that affects how numbers of a stability file are computed."""
    return _PLAINEST.get(schema, {})
