"""Builds results of `ptbench stability` in memory: the documented format, with errors that a test can foretell."""

from __future__ import annotations

import json
import math
from pathlib import Path

AXES = {
    "integrator": "depth_first",
    "compaction": "none",
    "sorting": "none",
    "sort_key": "material",
    "first_bounce": "off",
    "direct_light": "off",
    "russian_roulette": "off",
    "sampler": "pcg4d",
    "layout": "aos",
    "specialisation": "generic",
    "launch": "stream",
    "arithmetic": "exact",
    "precision": "float",
    "robustness": "robust",
}
FLOAT, NAIVE, MIXED, DOUBLE = {}, {"robustness": "naive"}, {"precision": "double_intersection"}, {"precision": "double"}
FAST, WAVEFRONT = {"arithmetic": "fast"}, {"integrator": "wavefront"}
FAMILIES = (
    "cavities",
    "irradiance",
    "geometry",
    "dielectrics",
    "media",
    "throughput",
    "film",
    "identity",
    "meshes",
    "own",
)


def _json(value: float):
    return value if math.isfinite(value) else "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"


class StabilityBuilder:
    """A result file under construction."""

    def __init__(self, quick: bool = False):
        self.context = {
            "date": "2025-03-01T12:00:00+00:00",
            "ptbench.version": "0.1.0",
            "ptbench.git_sha": "0123abcd4567",
            "ptbench.git_dirty": "false",
            "ptbench.machine": "amd-epyc-2-cores",
            "ptbench.cpu_model": "AMD EPYC 7763 64-Core Processor",
            "ptbench.threads": "2",
            "ptbench.backend": "cpu",
            "quick": quick,
            "seed": 1,
            "ptbench.command_line": "ptbench stability --out stability.json",
            "ptbench.status": "completed",
        }
        self.cases: list[dict] = []
        self.rows: list[dict] = []

    def case(self, name: str = "lamp", family: str = "cavities", sweep: str = "a", **changes) -> StabilityBuilder:
        """`parameters` by name: their standards."""
        parameters = changes.pop("parameters", {"a": 0.1, "depth": 9.0})
        self.cases.append(
            {
                "name": name,
                "catalogue": f"S{len(self.cases) + 1}",
                "family": family,
                "title": f"what {name} is",
                "stiff": "the smaller, the stiffer",
                "formula": "a closed one",
                "parameters": [
                    {"name": key, "standard": value, "lowest": 0, "highest": 1e9, "summary": f"what {key} is"}
                    for key, value in parameters.items()
                ],
                "sweep": sweep,
                "kind": "render",
                **changes,
            }
        )
        return self

    def _row(self, axes: dict, case: str | None, point: dict, status: str, reason: str) -> dict:
        described = self.cases[-1] if case is None else next(c for c in self.cases if c["name"] == case)
        standards = {p["name"]: p["standard"] for p in described["parameters"]}
        chosen = {**AXES, **axes}
        row = {
            "case": described["name"],
            "point": {**standards, **point},
            "backend": "cpu",
            "variant": ".".join(chosen.values()),
            "axes": chosen,
            "status": status,
            "must_pass": chosen["robustness"] == "robust" and chosen["arithmetic"] != "fast",
        }
        if reason:
            row["reason"] = reason
        self.rows.append(row)
        return row

    def none(
        self, axes: dict, status: str = "n/a", reason: str = "", case: str | None = None, **point
    ) -> StabilityBuilder:
        """A row without a number."""
        self._row(axes, case, point, status, reason)
        return self

    def row(
        self,
        axes: dict,
        error: float,
        allowed: float = 1e-6,
        *,
        status: str = "",
        reason: str = "",
        quantity: str = "radiance",
        relation: str = "equal",
        exact: float = 2.0,
        standard_error: float = 0.0,
        case: str | None = None,
        **point,
    ) -> StabilityBuilder:
        """One check of the latest case (or of `case`); it passes or fails by its error unless told otherwise."""
        row = self._row(axes, case, point, status or ("passed" if error <= allowed else "failed"), reason)
        row |= {
            "quantity": quantity,
            "relation": relation,
            "measured": _json(exact + error),
            "exact": exact,
            "error": _json(error),
            "allowed": _json(allowed),
            "tolerance": _json(allowed - 4 * standard_error),
            "tolerance_origin": "numerics.md",
            "standard_error": standard_error,
            "looks": 1,
            "paths": 16384,
            "rays": 147456,
            "seconds": 0.1,
        }
        return self

    def document(self) -> dict:
        return {"schema": "ptbench-stability-1", "context": self.context, "cases": self.cases, "rows": self.rows}

    def write(self, path: Path) -> Path:
        path.write_text(json.dumps(self.document()), encoding="utf-8")
        return path


VARIANTS = (
    FLOAT, NAIVE, FAST, FAST | NAIVE, MIXED, DOUBLE, DOUBLE | NAIVE, MIXED | NAIVE, MIXED | FAST, DOUBLE | FAST,
    WAVEFRONT, {"integrator": "wavefront_fused"}, {"integrator": "megakernel_regen"},
)  # fmt: skip
_WORDS = ("furnace_sphere", "lamp", "thin_plates", "far_from_origin", "grazing_incidence", "nested_absorbers", "needle")


def large(cases: int = 50, points: int = 4) -> StabilityBuilder:
    """Cases of all families, swept over decades, where errors grow with 1/a by a law of each formula."""
    builder = StabilityBuilder()
    for index in range(cases):
        family = FAMILIES[index * len(FAMILIES) // cases]
        builder.case(f"{_WORDS[index % len(_WORDS)]}_{index}", family, **({"sweep": ""} if index % 5 == 4 else {}))
        for step in range(points):
            _point(builder, index, 2.0 ** -(5 * step) if index % 2 else 10.0**-step)
    builder.case("caustic_of_spheres", "own", sweep="", kind="missing", missing_feature="ptbench has no such light")
    for axes in VARIANTS:
        builder.none(axes, reason="ptbench has no such light")
    return builder


def _point(builder: StabilityBuilder, index: int, a: float) -> None:
    estimators = [{}, {"direct_light": "nee"}] if index % 7 == 1 else [{}]
    for estimator in estimators:
        for axes in VARIANTS:
            is_mixed_naive = axes.get("precision") == "double_intersection" and "robustness" in axes
            if is_mixed_naive or (index % 6 == 5 and "integrator" in axes):
                builder.none(axes | estimator, reason="needs precision=float or double", a=a)
                continue
            _checks(builder, index, a, axes, estimator)


def _checks(builder: StabilityBuilder, index: int, a: float, axes: dict, estimator: dict) -> None:
    unit = 2.0**-53 if axes.get("precision") == "double" else 2.0**-24
    error = unit * (1 + index % 3) / (a**2 if "robustness" in axes else a**0.2)
    noise = 1e-5 * (1 + index % 4) if index % 4 == 1 else 0.0
    error = 0.0 if index % 9 == 2 and a == 1 else error + 0.7 * noise
    at = {"a": a}
    status = reason = ""
    if index % 13 == 6 and a < 1e-2 and "robustness" not in axes and "precision" not in axes:
        error, status, reason = 1e-3, "known limit", "the sum of a path has 24 bits; a double film would cure it"
        status = "" if axes.get("arithmetic") == "fast" else status
    if index % 17 == 3 and a < 1e-3 and axes == NAIVE:
        error = math.inf
    if index % 11 == 7 and axes == NAIVE:
        status, reason = "broken", "12 nonfinite"
    if index == 20 and a < 1e-2 and axes == MIXED:
        error = 1e-2
    builder.row(
        axes | estimator, error, 20 * unit + 4 * noise, status=status, reason=reason, standard_error=noise, **at
    )
    if index % 3 == 0:
        builder.row(axes | estimator, 0.0, 0.0, quantity="segments missing of a path", exact=0.0, **at)
