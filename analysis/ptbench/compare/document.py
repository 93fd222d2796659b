"""The findings of `compare` as JSON: every pair of cells, every omitted cell, every place and change of a ranking."""

from dataclasses import asdict

from ptbench.compare.compared import Compared
from ptbench.compare.match import Matching
from ptbench.compare.noise import Floor, Repeat
from ptbench.compare.ranking import Ranking
from ptbench.compare.text import MARKS
from ptbench.compare.verdicts import Comparison, Mean, Row, capacity_of
from ptbench.io.cells import Cell, Result
from ptbench.io.files import picked
from ptbench.stats.estimates import CONFIDENCE, Estimate, Verdict, median_estimate
from ptbench.studies.disturbed import Disturbance, disturbance_of
from ptbench.studies.withdrawn import among

SCHEMA_VERSION = "1"


def as_json(compared: Compared) -> dict:
    """A comparison as JSON: files by index, times in ms per sample per pixel, ratios other over reference."""
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
        # In the JSON of a ranking, "places" and "spp" have one entry per file of "ranked_files", which "at" indexes.
        "ranked_files": [MARKS.index(mark) for mark in compared.ranked],
        "rankings": [_ranking(group) for group in compared.rankings],
    }


def _file(result: Result) -> dict:
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
        **picked(capacity_of(result), "units unit clock_mhz clock_from bandwidth_gb_s"),
    }


def _disturbed(found: Disturbance) -> dict:
    return picked(found, "samples disturbed contended low_clock")


def _estimate(estimate: Estimate | None) -> dict | None:
    return None if estimate is None else asdict(estimate)


def _verdict(verdict: Verdict | None) -> dict:
    word = None if verdict is None else verdict.word
    return {"verdict": word, **picked(verdict or Verdict(""), "reason note withheld")}


def _comparison(comparison: Comparison, index: dict[int, int]) -> dict:
    matching = comparison.matching
    return {
        "reference": index[id(comparison.reference)],
        "other": index[id(comparison.other)],
        **picked(comparison, "one_machine repeated"),
        "across_backends": matching.across_backends,
        "assumed": list(matching.assumed),
        "threshold": comparison.threshold,
        "floors": [_floor(floor) for floor in comparison.floors],
        "floors_refused": [_floor(floor) for floor in comparison.no_floors],
        "withdrawn": [entry.full for entry in among([row.pair.reference for row in comparison.rows])],
        "geometric_mean": {"time": _mean(comparison.time), "cycles": _mean(comparison.cycles)},
        "normalised": [asdict(item) for item in comparison.normalised],
        "pairs": [_row(row) for row in comparison.rows],
        "left_out": _left_out(matching),
    }


def _mean(mean: Mean) -> dict:
    return {
        "ratio": _estimate(mean.estimate),
        **_verdict(mean.verdict),
        **picked(mean, "used left_out smallest largest"),
    }


def _row(row: Row) -> dict:
    cell = row.pair.reference
    return {
        "reference": _side(cell),
        "other": _side(row.pair.other),
        **picked(cell, "scene scene_hash resolution depth"),
        "ratio": _estimate(row.ratio),
        "cycles": _estimate(row.cycles),
        **_verdict(row.verdict),
        "remarks": list(row.remarks),
    }


def _side(cell: Cell) -> dict:
    return {"cell": cell.name, "spp": cell.spp, "ms_per_spp": _estimate(median_estimate(cell.ms_per_spp))}


def _left_out(matching: Matching) -> list[dict]:
    return [
        {"of": "reference" if item.in_reference else "other", "cell": item.cell.name, **picked(item, "kind reason")}
        for item in matching.alone
    ]


def _floor(floor: Floor) -> dict:
    return {
        **picked(floor, "machine value chance"),
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
        **picked(group, "scene resolution depth spp work"),
        "variants": [
            {"cells": [cell.name for cell in cells], "places": list(places)}
            for cells, places in zip(group.cells, group.places, strict=True)
        ],
        "changes": [asdict(change) for change in group.changes],
        "within_noise": group.within_noise,
    }
