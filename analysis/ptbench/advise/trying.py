"""Tries the advice on scenes that it was not fitted on: made by rules, measured exhaustively, counted.

A scene counts as good where the advised variant is within 5 % of the best of all that were measured. Times of a
machine that others use say nothing, so a try is refused there.
"""

from __future__ import annotations

import json
import math
import os
import random
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from ptbench.advise.advice import advise_on, is_timed, models_of, settings_of
from ptbench.advise.check import GOOD, NOT_GOOD, OPEN, Checked, check
from ptbench.advise.evidence import FILE
from ptbench.advise.mapped import whole_book
from ptbench.advise.probe import probe
from ptbench.errors import InputError
from ptbench.io.files import write_text
from ptbench.maps.scenes import RULES
from ptbench.program import Program
from ptbench.terminal import say

SCHEMA = "ptbench-advice-1"
MOST_LOAD = 0.5
DEPTHS = (2, 3, 4, 6, 8, 12, 16, 24, 32)
# Of each parameter of a rule: the least, the greatest, whether it is an integer.
RANGES = {
    "balls": {"materials": (1, 64, True)},
    "openness": {"openness": (0.02, 1.0, False)},
    "lamps": {"lamps": (1, 64, True), "size": (0.1, 1.0, False)},
    "trefoil": {"triangles": (500, 60000, True)},
}


@dataclass(frozen=True)
class Asked:
    """What a try is made with."""

    scenes: int
    seed: int
    resolution: tuple[int, int]
    spp: int
    out: Path
    loaded: bool = False  # whether other processes on the machine are put up with


def drawn_scenes(count: int, seed: int) -> Iterator[tuple[dict, int]]:
    """Scenes and depths, the same for the same seed; a parameter's logarithm is uniform."""
    dice = random.Random(seed)
    for index in range(count):
        rule = list(RANGES)[index % len(RANGES)]
        values = {name: _drawn(dice, *span) for name, span in RANGES[rule].items()}
        scene = RULES[rule](**values)
        yield {**scene, "name": f"{index:02}_{scene['name']}"}, dice.choice(DEPTHS)


def _drawn(dice: random.Random, low: float, high: float, is_integer: bool) -> float:
    value = math.exp(dice.uniform(math.log(low), math.log(high)))
    return float(round(value)) if is_integer else float(f"{value:.3g}")


def everything(backend: str, *, has_mesh: bool) -> list[dict[str, str]]:
    """All variants that are measured; what a scene or a machine lacks falls out as not applicable."""
    known = json.loads(FILE.read_text(encoding="utf-8"))["exhaustive"]
    trees = [{"accelerator": one} for one in known["accelerators"]] if has_mesh else [{}]
    return [{**one, **tree} for one in known[backend] for tree in trees]


def try_advice(program: Program, root: Path, results: Path, machine: str, backend: str, asked: Asked) -> int:
    """Writes what came of it; exit code 1 where fewer than nine of ten scenes were good."""
    load = os.getloadavg()[0]
    if load >= MOST_LOAD and not asked.loaded:
        raise InputError(f"this machine: load: found {load:.2f}, allowed: below {MOST_LOAD} (--loaded: nonetheless)")
    book = whole_book(root, results, machine, backend)
    models = models_of(book)
    rows = []
    for scene, depth in drawn_scenes(asked.scenes, asked.seed):
        with tempfile.TemporaryDirectory(prefix="ptbench-try-") as name:
            folder = Path(name)
            file = folder / f"{scene['name']}.json"
            file.write_text(json.dumps(scene), encoding="utf-8")
            probed = probe(program, file, backend, depth, asked.resolution)
            advised = advise_on(models, probed.features, probed.barred, book.baselines)
            pick = settings_of([one for one in advised if is_timed(one)])
            others = [one for one in everything(backend, has_mesh=probed.has_mesh) if one != pick]
            if probed.has_mesh and "accelerator" not in pick:  # nothing was measured: some tree there must be
                pick = {**pick, "accelerator": others[0]["accelerator"]}
            variants = [pick, *(one for one in others if one != pick)]
            checked = check(program, probed, variants, backend, folder, asked.spp)
        say(f"{scene['name']}, depth {depth}: {checked.word}; advised {checked.advised}; best {checked.best}")
        rows.append(_row(scene["name"], depth, checked))
    document = _document(rows, machine, backend, asked, load, program)
    write_text(asked.out, json.dumps(document, indent=1) + "\n")
    say(summary_of(document))
    return 0 if document["good"] >= 0.9 * document["of"] else 1


def _row(scene: str, depth: int, checked: Checked) -> dict:
    ratio = checked.ratio
    ends = {} if ratio is None else {"ratio": ratio.value, "low": ratio.low, "high": ratio.high}
    return {"scene": scene, "depth": depth, "advised": checked.advised, "best": checked.best, "word": checked.word,
            "measured": checked.measured, "reason": checked.reason, **ends}  # fmt: skip


def _document(rows: Sequence[dict], machine: str, backend: str, asked: Asked, load: float, program: Program) -> dict:
    words = [row["word"] for row in rows]
    return {
        "schema": SCHEMA, "date": datetime.now(timezone.utc).isoformat("T", "seconds"), "load": round(load, 2),
        "measured_on": program.machine(), "advised_from": machine, "backend": backend, "seed": asked.seed,
        "resolution": list(asked.resolution), "spp": asked.spp, "of": len(rows), "good": words.count(GOOD),
        "not_good": words.count(NOT_GOOD), "undecided": words.count(OPEN), "scenes": list(rows),
    }  # fmt: skip


def summary_of(document: dict) -> str:
    """In a line."""
    return (
        f"within 5 % of the best on {document['good']} of {document['of']} scenes "
        f"({document['not_good']} not, {document['undecided']} undecided)"
    )
