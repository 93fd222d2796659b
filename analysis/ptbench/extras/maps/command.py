"""`map`: measures or looks up crossover maps, tells where the choices break even, and writes docs/maps."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from ptbench.extras.maps.definition import Definition, maps_in
from ptbench.extras.maps.figure import can_be_drawn, draw, words_of
from ptbench.extras.maps.measuring import Sheet, measured_by, refine, sheet_of, write_sheet
from ptbench.extras.maps.refining import OPEN, Bracket, spans_of, verdict_of
from ptbench.figures import style
from ptbench.figures.saving import svg_of
from ptbench.findings import ledger
from ptbench.io.cells import Result
from ptbench.io.nodes import read_json
from ptbench.numbers import figures, interval
from ptbench.terminal import say

_DIGITS = 3
CUT_SHORT = "the run was cut short"


@dataclass(frozen=True)
class Call(ledger.Call):
    """The options of one call of `map`."""

    budget_s: float | None = None  # seconds to spend on each map; None: the budget of the map's own file


@dataclass(frozen=True)
class Told:
    """A map and one machine's measurements of it; without a sheet nothing was measured."""

    definition: Definition
    machine: str = ""
    sheet: Sheet | None = None

    @property
    def figure(self) -> str:
        """The file name of the map's figure; empty: there is none."""
        is_drawn = self.sheet is not None and can_be_drawn(self.sheet)
        return f"{self.definition.name}_{self.machine}.svg" if is_drawn else ""

    @property
    def sentences(self) -> list[str]:
        """Sentences on where the two choices of the map break even."""
        return [] if self.sheet is None else list(_sentences(self.sheet))

    @property
    def command(self) -> str:
        """The command that measures the map."""
        return f"python3 -m ptbench map {self.definition.name} --run"

    @property
    def variants(self) -> tuple[str, str]:
        """The map's two choices, as the program takes them."""
        return words_of(self.definition["choice"]), words_of(self.definition["over"])


def maps(call: Call) -> int:
    """Runs the command `map`; exit code 1: a page does not match its data, else 0."""
    definitions = maps_in(call.root / "maps", call.names)
    if call.run:
        _run(call, definitions)
    told = [one for definition in definitions for one in told_of(definition, call.folder)]
    for one in told:
        where = f" on {one.sheet.device}" if one.sheet is not None else f": not measured yet ({one.command})"
        say(f"{one.definition.name}{where}")
        for sentence in one.sentences:
            say(f"  {sentence}")
    if not call.write and not call.check:
        return 0
    everything = [one for definition in maps_in(call.root / "maps") for one in told_of(definition, call.folder)]
    return _pages(call, everything)


def told_of(definition: Definition, results: Path) -> list[Told]:
    """The measurements of a map on each machine."""
    files = sorted(results.glob(f"*/maps/{definition.name}.json"))
    return [Told(definition, file.parts[-3], sheet_of(definition, file)) for file in files] or [Told(definition)]


def _run(call: Call, definitions: Sequence[Definition]) -> None:
    program = call.program
    machine = program.machine()
    for definition in definitions:
        file = call.folder / machine / "maps" / f"{definition.name}.json"
        sheet = sheet_of(definition, file)
        load = [round(one, 2) for one in os.getloadavg()]
        sheet.sessions = [*sheet.sessions, {"date": datetime.now(timezone.utc).isoformat("T", "seconds"), "load": load}]

        def heard(result: Result, sheet: Sheet = sheet) -> None:
            sheet.device = result.about("cuda_device" if sheet.definition["backend"] == "cuda" else "cpu_model")
            sheet.sessions[-1] |= {key: result.about(key) for key in ("git_sha", "git_dirty")}

        def kept(sheet: Sheet, file: Path = file) -> None:
            write_sheet(sheet, file)
            say(f"{sheet.definition.name}: {len(sheet.cells)} cells, {sheet.seconds:.0f} s")

        refine(sheet, measured_by(program, heard), call.budget_s or definition["budget_s"], kept)
        say(f"{definition.name}: {sheet.ended}")


def _sentences(sheet: Sheet) -> Iterator[str]:
    known = sheet.known
    numbers = [one for one in known.values() if one is not None]
    disturbed = sum(run["disturbed"] for run in sheet.runs.values())
    failed = [run["failed"] for run in sheet.runs.values() if run["failed"]]
    sides = [verdict_of(one) for one in numbers]
    counts = ", ".join(f"{sides.count(side)} {side}" for side in dict.fromkeys(sides))
    yield f"{len(known)} cells: {counts}; {sheet.ended or CUT_SHORT} ({figures(sheet.seconds, _DIGITS)} s)"
    if disturbed:
        yield f"{disturbed} runs were disturbed by other processes: they settle nothing until they are measured again"
    if failed:
        yield f"{len(failed)} runs failed: {failed[0]}"
    if numbers:
        low, high = (pick(numbers, key=lambda one: one.value) for pick in (min, max))
        ends = [f"{figures(one.value, _DIGITS)} {interval(one.low, one.high, _DIGITS)}" for one in (low, high)]
        yield f"ratios from {ends[0]} to {ends[1]}"
    spans = spans_of(sheet.definition.axes, known)
    for one in spans:
        yield _span_text(sheet, one)
    if numbers and not spans:
        yield f"no row or column has cells on both sides of 1 ({sides.count(OPEN)} of {len(sides)} are {OPEN})"


def _span_text(sheet: Sheet, one: Bracket) -> str:
    along, other = sheet.definition.axes[one.along], sheet.definition.axes[1 - one.along]
    wide = ""
    if one.width > sheet.definition["bracket"]:
        between = [
            cell for cell in sheet.known if cell[1 - one.along] == one.at and one.low < cell[one.along] < one.high
        ]
        wide = f", wider than asked{': the cells between are open' if between else ''}"
    return (
        f"at {other.name} {figures(one.at, _DIGITS)} the line lies between {along.name} {figures(one.low, _DIGITS)} "
        f"and {figures(one.high, _DIGITS)}{wide}"
    )


def advice_in(results: Path) -> list[dict]:
    """The results of `advise --try` of every machine."""
    files = sorted(results.glob("*/advice.json"))
    return [{**read_json(file).fields(), "file": file.relative_to(results).as_posix()} for file in files]


def pages_of(root: Path, told: Sequence[Told], advice: Sequence[dict]) -> dict[str, str]:
    """Every file of docs/maps, by name."""
    page = ledger.rendered_file(root / "docs" / "templates" / "maps" / "README.md", told=told, advice=advice)
    with style.applied():
        drawn = {one.figure: svg_of(draw(one.sheet)) for one in told if one.figure and one.sheet is not None}
    return {"README.md": page, **drawn}


def _pages(call: Call, told: Sequence[Told]) -> int:
    folder = call.root / "docs" / "maps"
    pages = pages_of(call.root, told, advice_in(call.folder))
    if call.write:
        ledger.write_pages(folder, pages)
        say(f"{folder}: {len(pages)} files")
        return 0
    faults = ledger.stale_pages(folder, pages, "map", "map")
    for fault in faults:
        say(fault)
    return 1 if faults else 0
