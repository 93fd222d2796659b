"""What `compare` found as JSON, for programs: every pair, every cell that was left out, every place and change."""

from ptbench.compare.compared import Compared
from ptbench.compare.match import Matching
from ptbench.compare.noise import Floor, Repeat
from ptbench.compare.ranking import Ranking
from ptbench.compare.text import MARKS
from ptbench.compare.verdicts import Comparison, Mean, Row, capacity_of
from ptbench.io.cells import Cell, Result
from ptbench.stats.estimates import CONFIDENCE, Estimate, median_estimate
from ptbench.studies.disturbed import Disturbance, disturbance_of
from ptbench.studies.withdrawn import among

SCHEMA_VERSION = "1"


def as_json(compared: Compared) -> dict:
    """Files are named by their index in "files"; times are ms per sample per pixel, ratios other over reference."""
    index = {id(result): number for number, result in enumerate(compared.results)}
    return {
        "schema": "ptbench.compare",
        "schema_version": SCHEMA_VERSION,
        "confidence": CONFIDENCE,
        "files": [_file(result) for result in compared.results],
        "comparisons": [_comparison(one, index) for one in compared.comparisons],
        "noise": {
            "runs": [_repeat(repeat) for repeat in compared.repeats],
            "floors": [_floor(floor) for floor in compared.floors],
        },
        "ranked_files": [MARKS.index(mark) for mark in compared.ranked],  # "places", "spp", "at" are in their order
        "rankings": [_ranking(group) for group in compared.rankings],
    }


def _file(result: Result) -> dict:
    capacity = capacity_of(result)
    return {
        "path": str(result.path),
        "machine": result.about("machine"),
        "backend": result.about("backend"),
        "git": result.git,
        "program_hash": result.about("program_hash"),
        "suite": result.suite,
        "date": result.context["date"],
        "interrupted": result.interrupted,
        "cells": len(result.cells),
        "disturbed": _disturbed(disturbance_of(result.cells)),
        "units": capacity.units,
        "unit": capacity.unit,
        "clock_mhz": capacity.clock_mhz,
        "clock_from": capacity.clock_from,
        "bandwidth_gb_s": capacity.bandwidth_gb_s,
    }


def _disturbed(found: Disturbance) -> dict:
    return {
        "samples": found.samples,
        "disturbed": found.disturbed,
        "contended": found.contended,
        "low_clock": found.low_clock,
    }


def _estimate(estimate: Estimate | None) -> dict | None:
    if estimate is None:
        return None
    return {"value": estimate.value, "low": estimate.low, "high": estimate.high, "n": estimate.n}


def _comparison(comparison: Comparison, index: dict[int, int]) -> dict:
    matching = comparison.matching
    return {
        "reference": index[id(comparison.reference)],
        "other": index[id(comparison.other)],
        "one_machine": comparison.one_machine,
        "repeated": comparison.repeated,
        "across_backends": matching.across_backends,
        "assumed": list(matching.assumed),
        "threshold": comparison.threshold,
        "floors": [_floor(floor) for floor in comparison.floors],
        "floors_refused": [_floor(floor) for floor in comparison.no_floors],
        "withdrawn": [entry.full for entry in among([row.pair.reference for row in comparison.rows])],
        "geometric_mean": {"time": _mean(comparison.time), "cycles": _mean(comparison.cycles)},
        "normalised": [
            {"by": item.by, "factor": item.factor, "ratio": _estimate(item.ratio), "how": item.how}
            for item in comparison.normalised
        ],
        "pairs": [_row(row) for row in comparison.rows],
        "left_out": _left_out(matching),
    }


def _mean(mean: Mean) -> dict:
    return {
        "ratio": _estimate(mean.estimate),
        "verdict": None if mean.verdict is None else mean.verdict.word,
        "reason": "" if mean.verdict is None else mean.verdict.reason,
        "note": "" if mean.verdict is None else mean.verdict.note,
        "withheld": "" if mean.verdict is None else mean.verdict.withheld,
        "used": mean.used,
        "left_out": mean.left_out,
        "smallest": mean.smallest,
        "largest": mean.largest,
    }


def _row(row: Row) -> dict:
    cell = row.pair.reference
    return {
        "reference": _side(cell),
        "other": _side(row.pair.other),
        "scene": cell.scene,
        "scene_hash": cell.scene_hash,
        "resolution": list(cell.resolution),
        "depth": cell.depth,
        "ratio": _estimate(row.ratio),
        "cycles": _estimate(row.cycles),
        "verdict": row.verdict.word,
        "reason": row.verdict.reason,
        "note": row.verdict.note,
        "withheld": row.verdict.withheld,
        "remarks": list(row.remarks),
    }


def _side(cell: Cell) -> dict:
    return {"cell": cell.name, "spp": cell.spp, "ms_per_spp": _estimate(median_estimate(cell.ms_per_spp))}


def _left_out(matching: Matching) -> list[dict]:
    return [
        {
            "of": "reference" if item.in_reference else "other",
            "cell": item.cell.name,
            "kind": item.kind,
            "reason": item.reason,
        }
        for item in matching.alone
    ]


def _floor(floor: Floor) -> dict:
    return {
        "machine": floor.machine,
        "value": floor.value,
        "chance": floor.chance,
        "ratios": len(floor.ratios),
        "refused": floor.refusal,
        "runs": [[str(repeat.one.path), str(repeat.other.path)] for repeat in floor.repeats],
    }


def _repeat(repeat: Repeat) -> dict:
    return {
        "machine": repeat.one.about("machine"),
        "files": [str(repeat.one.path), str(repeat.other.path)],
        "ratios": list(repeat.ratios),
        "refused": repeat.refusal,
        "disturbed": [_disturbed(found) for found in repeat.disturbed],
        "geometric_mean": _estimate(repeat.geometric_mean),
    }


def _ranking(group: Ranking) -> dict:
    return {
        "scene": group.scene,
        "resolution": group.resolution,
        "depth": group.depth,
        "spp": list(group.spp),
        "work": group.work,
        "variants": [
            {"cells": [cell.name for cell in cells], "places": list(places)}
            for cells, places in zip(group.cells, group.places, strict=True)
        ],
        "changes": [
            {
                "ahead": change.ahead,
                "behind": change.behind,
                "at": change.at,
                "turned_at": change.turned_at,
                "ratio": _estimate(change.ratio),
                "turned_ratio": _estimate(change.turned_ratio),
            }
            for change in group.changes
        ],
        "within_noise": group.within_noise,
    }
