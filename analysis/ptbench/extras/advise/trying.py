"""Tries the advice on generated scenes that it was not fitted to, by measuring all variants in each.

A scene counts as good where the advised variant is within 5 % of the best of all measured variants. Where the interval
is inconclusive, all variants that may be the best are measured again with eight times the repetitions, and that result
counts. A try is refused on a machine with other load, as its times would mean nothing.
"""

import json
import math
import os
import random
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from functools import cache
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.extras.advise.advice import Advised, advise_on, is_timed, models_of, settings_of
from ptbench.extras.advise.check import GOOD, NOT_GOOD, OPEN, Checked, check
from ptbench.extras.advise.evidence import FILE
from ptbench.extras.advise.mapped import whole_book
from ptbench.extras.advise.probe import Probed, probe
from ptbench.extras.maps.scenes import RULES
from ptbench.io.axes import ACCELERATOR
from ptbench.io.files import write_text
from ptbench.io.nodes import read_json
from ptbench.program import Program
from ptbench.stats.estimates import MINIMUM_SAMPLES
from ptbench.terminal import say

SCHEMA = "ptbench-advice-1"
MOST_LOAD = 0.5
CLOSER = 8  # factor on the number of repetitions where the first measurement is inconclusive
DEPTHS = (2, 3, 4, 6, 8, 12, 16, 24, 32)
# Parameters of each scene generator: minimum, maximum, whether it is an integer.
RANGES = {
    "balls": {"materials": (1, 64, True)},
    "openness": {"openness": (0.02, 1.0, False)},
    "lamps": {"lamps": (1, 64, True), "size": (0.1, 1.0, False)},
    "trefoil": {"triangles": (500, 60000, True)},
}


@dataclass(frozen=True)
class Asked:
    """The settings of one try of the advice."""

    scenes: int
    seed: int
    resolution: tuple[int, int]
    spp: int
    out: Path
    loaded: bool = False  # whether to measure despite load from other processes
    resume: bool = False  # whether to resume the file of an interrupted try of the advice, whose scenes are kept


def drawn_scenes(count: int, seed: int) -> Iterator[tuple[dict, int]]:
    """Random scenes and depths, reproducible by the seed; the logarithm of each parameter is uniform."""
    dice = random.Random(seed)
    for index in range(count):
        rule = list(RANGES)[index % len(RANGES)]
        values = {name: _drawn(dice, *span) for name, span in RANGES[rule].items()}
        scene = RULES[rule](**values)
        yield {**scene, "name": f"{index:02}_{scene['name']}"}, dice.choice(DEPTHS)


def _drawn(dice: random.Random, low: float, high: float, is_integer: bool) -> float:
    value = math.exp(dice.uniform(math.log(low), math.log(high)))
    return float(round(value)) if is_integer else float(f"{value:.3g}")


def everything(backend: str, accelerators: Sequence[str]) -> list[dict[str, str]]:
    """All variants that are measured, by each accelerator, or none for a scene without meshes.

    What a scene or a machine lacks falls out as not applicable.
    """
    known = json.loads(FILE.read_text(encoding="utf-8"))["exhaustive"]
    trees = [{ACCELERATOR: one} for one in accelerators] or [{}]
    return [{**one, **tree} for one in known[backend] for tree in trees]


@cache
def fast_accelerators(program: Program) -> list[str]:
    """Every accelerator that the program has but the baseline, which tests every triangle, in the program's order."""
    listed = json.loads(program.output("list", ACCELERATOR, "--json"))
    return [choice["name"] for choice in listed["choices"] if not choice["baseline"]]


def try_advice(program: Program, root: Path, results: Path, machine: str, backend: str, asked: Asked) -> int:
    """Tries the advice and writes the result; exit code 1 where fewer than nine of ten scenes were good."""
    load = os.getloadavg()[0]
    if load >= MOST_LOAD and not asked.loaded:
        raise InputError(f"this machine: load: found {load:.2f}, allowed: below {MOST_LOAD} (--loaded: nonetheless)")
    book = whole_book(root, results, machine, backend)
    models = models_of(book)
    about = {"measured_on": program.machine(), "advised_from": machine, "backend": backend, "seed": asked.seed,
             "resolution": list(asked.resolution), "spp": asked.spp}  # fmt: skip
    kept = _decided(asked.out, about) if asked.resume else {}
    scenes = list(drawn_scenes(asked.scenes, asked.seed))
    document = _document(kept, scenes, about, load)
    for scene, depth in scenes:
        if scene["name"] in kept:
            continue
        with tempfile.TemporaryDirectory(prefix="ptbench-try-") as name:
            folder = Path(name)
            file = folder / f"{scene['name']}.json"
            file.write_text(json.dumps(scene), encoding="utf-8")
            probed = probe(program, file, backend, depth, asked.resolution)
            advised = advise_on(models, probed.features, probed.barred, book.baselines)
            variants = everything(backend, fast_accelerators(program) if probed.has_mesh else [])
            checked = _checked(program, probed, _in_order(variants, advised), backend, folder, asked.spp)
        say(f"{scene['name']}, depth {depth}: {checked.word}; advised {checked.advised}; best {checked.best}")
        kept[scene["name"]] = _row(scene["name"], depth, checked)
        # The result file is written after each scene, so that an interrupted try of the advice keeps what is done.
        document = _document(kept, scenes, about, load)
        write_text(asked.out, json.dumps(document, indent=1) + "\n")
    say(summary_of(document))
    return 0 if document["good"] >= 0.9 * document["of"] else 1


def _decided(file: Path, about: dict) -> dict[str, dict]:
    """The decided scenes of an unfinished try, by name; raises InputError for a file of another try."""
    if not file.is_file():
        return {}
    there = read_json(file).fields()
    if differing := next((key for key, value in about.items() if there.get(key) != value), ""):
        raise bad_value(file, f"$.{differing}", str(there.get(differing)), f"{about[differing]}, to go on with it")
    return {row["scene"]: row for row in there["scenes"] if row["word"] != OPEN}


def _in_order(variants: Sequence[dict[str, str]], advised: Sequence[Advised]) -> list[dict[str, str]]:
    """The variants, the advised one first."""
    pick = settings_of([one for one in advised if is_timed(one)])
    if ACCELERATOR in variants[0]:  # advice learnt only from scenes without meshes leaves the axis open
        pick = {ACCELERATOR: variants[0][ACCELERATOR], **pick}
    return [pick, *(one for one in variants if one != pick)]


def _checked(
    program: Program, probed: Probed, variants: Sequence[dict[str, str]], backend: str, folder: Path, spp: int
) -> Checked:
    first = check(program, probed, variants, backend, folder, spp)
    if first.word != OPEN or first.ratio is None:
        return first
    closer = check(program, probed, first.close, backend, folder, spp, CLOSER * MINIMUM_SAMPLES)
    return replace(closer, measured=first.measured)


def _row(scene: str, depth: int, checked: Checked) -> dict:
    ratio = checked.ratio
    ends = {} if ratio is None else {"ratio": ratio.value, "low": ratio.low, "high": ratio.high}
    return {"scene": scene, "depth": depth, "advised": checked.advised, "best": checked.best, "word": checked.word,
            "measured": checked.measured, "reason": checked.reason, **ends}  # fmt: skip


def _document(rows: Mapping[str, dict], scenes: Sequence[tuple[dict, int]], about: dict, load: float) -> dict:
    found = [rows[scene["name"]] for scene, _ in scenes if scene["name"] in rows]
    words = [row["word"] for row in found]
    return {
        "schema": SCHEMA, "date": datetime.now(timezone.utc).isoformat("T", "seconds"), "load": round(load, 2), **about,
        "of": len(found), "good": words.count(GOOD), "not_good": words.count(NOT_GOOD),
        "undecided": words.count(OPEN), "scenes": found,
    }  # fmt: skip


def summary_of(document: dict) -> str:
    """The result of a try in one line."""
    return (
        f"within 5 % of the best on {document['good']} of {document['of']} scenes "
        f"({document['not_good']} not, {document['undecided']} undecided)"
    )
