"""Measures the cells of a map with the program, and stores every run in one file.

A run holds the times of both choices in one scene and setting. Cells may share a run (times to an image with other
numbers of samples). The file is written after every run, so that an interrupted measurement can resume.
"""

import hashlib
import json
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ptbench.convergence.assessment import assess
from ptbench.convergence.costs import cost_ratio
from ptbench.errors import InputError, bad_value
from ptbench.extras.maps.definition import TO_IMAGE, Definition
from ptbench.extras.maps.refining import Place, next_cells
from ptbench.io.cells import Cell, Result
from ptbench.io.files import write_text
from ptbench.io.nodes import read_json
from ptbench.program import Program
from ptbench.stats.estimates import Estimate, ratio_estimate
from ptbench.studies.disturbed import is_contended

SCHEMA = "ptbench-map-result-1"
SIDES = ("choice", "over")
BUDGET, SETTLED = "the budget is spent", "every bracket is as narrow as asked, or cannot be narrower"

# A run of `ptbench run` at one point of a map, as an object of the map's result file with the keys that `_run_of` sets.
Run = dict
Measure = Callable[[Definition, Place], Run]


@dataclass
class Sheet:
    """All measurements of one map on one machine."""

    definition: Definition
    device: str = ""
    sessions: list[dict] = field(default_factory=list)
    runs: dict[str, Run] = field(default_factory=dict)
    cells: dict[Place, str] = field(default_factory=dict)  # by place on the map, the name of its run in `runs`
    ended: str = ""
    _ratios: dict[tuple[Place, str], Estimate | None] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Seconds of wall time over all runs of the map."""
        return sum(run["seconds"] for run in self.runs.values())

    @property
    def known(self) -> dict[Place, Estimate | None]:
        """The ratio of every measured cell; None where its run gave none."""
        return {place: self.ratio(place) for place in self.cells}

    def ratio(self, place: Place) -> Estimate | None:
        """The map's ratio in a cell with its interval; a disturbed run's ratio has no interval and decides nothing."""
        key = place, self.cells[place]
        if key not in self._ratios:
            self._ratios[key] = self._ratio(place, self.runs[key[1]])
        return self._ratios[key]

    def forget_ratios(self) -> None:
        """Clears cached ratios before runs are removed, as a new run of the same cell has another ratio."""
        self._ratios.clear()

    def _ratio(self, place: Place, run: Run) -> Estimate | None:
        if run["failed"]:
            return None
        if "ratio" in run:
            ratio = Estimate(**run["ratio"])
        else:
            # Where no build times are added, the number of samples cancels out of the ratio of times.
            samples = self.definition.samples(place)
            sides = (run.get(f"{side}_build_ms", 0) + samples * np.array(run[f"{side}_ms"]) for side in SIDES)
            ratio = ratio_estimate(*sides)
        return Estimate(ratio.value, None, None, ratio.n) if run["disturbed"] else ratio

    def document(self) -> dict:
        """The measurements as the JSON document of their file."""
        cells = [{"x": x, "y": y, "run": key} for (x, y), key in sorted(self.cells.items())]
        return {"schema": SCHEMA, "map": self.definition.document, "device": self.device, "ended": self.ended,
                "sessions": self.sessions, "cells": cells, "runs": self.runs}  # fmt: skip


def sheet_of(definition: Definition, file: Path) -> Sheet:
    """Reads the measurements of a map, none if there is no file; raises InputError for a file of another map."""
    if not file.exists():
        return Sheet(definition)
    about = read_json(file).fields()
    if about.get("schema") != SCHEMA or not definition.measured_alike(about["map"]):
        raise bad_value(file, "$.map", "another definition than the map's file", "the same; or remove the result")
    cells = {(one["x"], one["y"]): one["run"] for one in about["cells"]}
    return Sheet(definition, about["device"], about["sessions"], about["runs"], cells, about["ended"])


def write_sheet(sheet: Sheet, file: Path) -> None:
    """Writes the measurements of a map atomically."""
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text(file, json.dumps(sheet.document(), indent=1) + "\n")


def refine(sheet: Sheet, measure: Measure, budget_s: float, kept: Callable[[Sheet], None] = lambda _: None) -> None:
    """Measures cell after cell until every bracket is settled or the next cell would exceed the budget.

    Disturbed and failed runs of an earlier session are repeated.
    """
    again = {key for key, run in sheet.runs.items() if run["disturbed"] or run["failed"]}
    sheet.cells = {place: key for place, key in sheet.cells.items() if key not in again}
    spent, sheet.ended = sheet.seconds, ""
    sheet.runs = {key: run for key, run in sheet.runs.items() if key not in again}
    sheet.forget_ratios()
    count = len(sheet.runs)
    while places := next_cells(sheet.definition.axes, sheet.known, sheet.definition["bracket"]):
        place = places[0]
        key = run_key(sheet.definition, place)
        if key not in sheet.runs:
            if count and spent + spent / count > budget_s:
                sheet.ended = BUDGET
                kept(sheet)
                return
            sheet.runs[key] = measure(sheet.definition, place)
            spent += sheet.runs[key]["seconds"]
            count += 1
        sheet.cells[place] = key
        kept(sheet)
    sheet.ended = SETTLED
    kept(sheet)


def run_key(definition: Definition, place: Place) -> str:
    """A short hash of everything that a cell's run depends on."""
    text = json.dumps([definition.scene(place), definition.study(place, "scene")], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def measured_by(program: Program, told: Callable[[Result], None] = lambda _: None) -> Measure:
    """A function that measures a cell with the program and passes every result to `told`."""

    def measure(definition: Definition, place: Place) -> Run:
        start = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="ptbench-map-") as name:
            folder = Path(name)
            scene = folder / "scene.json"
            scene.write_text(json.dumps(definition.scene(place)), encoding="utf-8")
            suite = {"name": "map_cell", "description": definition["title"], "repetitions": definition["repetitions"],
                     "studies": [definition.study(place, str(scene))]}  # fmt: skip
            try:
                result = program.measure(suite, folder, definition["backend"])
            except InputError as error:
                return {"seconds": time.monotonic() - start, "failed": str(error), "disturbed": False}
        told(result)
        return _run_of(definition, result, time.monotonic() - start)

    return measure


def _run_of(definition: Definition, result: Result, seconds: float) -> Run:
    base = {"seconds": round(seconds, 3), "failed": "", "disturbed": False}
    sides = []
    for name in SIDES:
        found = [cell for cell in result.cells if _is(cell, definition[name])]
        if len(found) != 1 or not found[0].measured:
            why = found[0].failure if found else f"{name} does not apply"
            return {**base, "failed": why}
        sides.append(found[0])
    choice, over = sides
    base |= _counts_of(over)
    if definition.of_error:
        ratio = cost_ratio(definition["statistic"], assess(result), choice, over)
        if ratio is None:
            return {**base, "failed": "no error curve could be fitted"}
        return {**base, "ratio": {"value": ratio.value, "low": ratio.low, "high": ratio.high, "n": ratio.n}}
    run = {**base, "disturbed": is_contended(choice) or is_contended(over),
           "choice_ms": _rounded(choice), "over_ms": _rounded(over)}  # fmt: skip
    if definition["statistic"] == TO_IMAGE:
        run |= {"choice_build_ms": _build(choice), "over_build_ms": _build(over)}
    return run


def _counts_of(cell: Cell) -> dict[str, float]:
    """Path statistics of a cell's scene, for finding similar scenes."""
    if cell.instrumented is None or not cell.instrumented.paths:
        return {}
    segments = sum(cell.instrumented.live_paths) / cell.instrumented.paths
    triangles = 0 if cell.meshes is None else cell.meshes.triangles
    return {"segments": round(segments, 6), "triangles": triangles, "depth": cell.depth, "pixels": cell.pixels}


def _is(cell: Cell, wanted: Mapping) -> bool:
    return all(cell.axes.get(axis) == value for axis, value in wanted["axes"].items())


def _rounded(cell: Cell) -> list[float]:
    return [float(f"{value:.7g}") for value in cell.ms_per_spp]


def _build(cell: Cell) -> float:
    return 0.0 if cell.meshes is None else cell.meshes.build_ms + cell.meshes.encode_ms
