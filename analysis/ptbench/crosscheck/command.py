"""`python3 -m ptbench crosscheck SCENE..`: renders scenes in ptbench and in Mitsuba 3, and compares the pictures.

Exit codes: 0 they agree; 1 a picture differs, or its images are too noisy to detect the bias aimed at; 2 a wrong call,
no Mitsuba wheel, or a named scene that cannot be rendered in both. docs/other_renderers.md has the conventions.
"""

import argparse
import json
import math
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import fields, replace
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from ptbench.crosscheck.document import AGREES, REFUSED, WEAK, Checked, as_json, as_scene, as_text
from ptbench.crosscheck.limits import ALL, MOST_SPP
from ptbench.crosscheck.renders import (
    CannotExport,
    Settings,
    export,
    has_meshes,
    mitsuba_version,
    render_here,
    render_there,
    shipped_scenes,
)
from ptbench.crosscheck.statistics import compare, family_of
from ptbench.errors import InputError, bad_value
from ptbench.io.files import check_output_file, picked, write_text
from ptbench.io.nodes import read_json
from ptbench.terminal import say

SCALAR_BLOCK = 32  # block size of Mitsuba's scalar variants, in pixels along a side


def crosscheck_command(options: argparse.Namespace) -> int:
    """Runs `ptbench crosscheck` and returns the exit code; raises InputError."""
    if options.out is not None:
        check_output_file(options.out, options.scenes)
    settings = _settings(options)
    settings.program.check()
    peer = mitsuba_version(settings)
    _check_streams(settings, peer["variant"])
    named = [scene for scene in options.scenes if scene != ALL]
    scenes = list(dict.fromkeys(named + (shipped_scenes(settings.program) if ALL in options.scenes else [])))
    context = _context(settings, peer)
    asked = _asked(options, settings, scenes)
    done = _done(options, as_json([], settings, context, options.allow, asked)) if options.resume else {}
    family = family_of(len(scenes))

    def kept() -> list[dict]:
        # The report is written after each scene, so that an interrupted cross-check keeps what is done.
        checked = [done[scene] for scene in scenes if scene in done]
        if options.out is not None and checked:
            whole = as_json(checked, settings, context, options.allow, asked)
            text = json.dumps(whole, indent=1, allow_nan=False) + "\n"
            write_text(options.out, text)
        return checked

    missing = [scene for scene in scenes if scene not in done]
    _check_all(missing, options.jobs, lambda scene: as_scene(_check(scene, settings, options, family)), done, kept)
    checked = kept()
    print("\n".join(as_text(checked, settings, options.aim)))
    if options.out is not None:
        say(options.out)
    verdicts = {one["scene"]: one["verdict"] for one in checked}
    if any(verdicts[scene] == REFUSED for scene in named):
        return 2
    return 0 if all(verdict in (AGREES, REFUSED) for verdict in verdicts.values()) else 1


def _settings(options: argparse.Namespace) -> Settings:
    given = {field.name: getattr(options, field.name) for field in fields(Settings) if field.name != "axes"}
    return Settings(**given, axes=tuple(options.axis))


def _check_streams(settings: Settings, variant: str) -> None:
    """Raises InputError where images of two seeds would share random numbers.

    Mitsuba's scalar variants number their random streams seed x pixels + block x 32^2 + pixel in the block, in 32 bits:
    blocks that reach over the image's border use numbers of the next seed.
    """
    if not variant.startswith("scalar"):
        return
    width, height = settings.resolution
    if width % SCALAR_BLOCK or height % SCALAR_BLOCK:
        raise InputError(f"--resolution: found {settings.size}, allowed: multiples of {SCALAR_BLOCK} with {variant}")
    if (last := settings.first_seed + settings.seeds) * width * height > 1 << 32:
        most = (1 << 32) // (width * height)
        raise InputError(
            f"--first-seed, --seeds: found {last - 1} as the last seed, allowed: below {most} with {variant}"
        )


def _asked(options: argparse.Namespace, settings: Settings, scenes: list[str]) -> dict:
    """The options, beside `settings`, that must be equal for an unfinished report to be resumed."""
    return {
        "scenes": scenes,
        **picked(settings, "backend axes spp spp_here"),
        "most_spp": options.most_spp,
        "first_seed": settings.first_seed,
        "aim": options.aim,
    }


def _done(options: argparse.Namespace, planned: dict) -> dict[str, dict]:
    """The finished scenes of a report to be resumed; raises InputError where it was begun by another call."""
    if options.out is None:
        raise InputError("--resume: found no --out, allowed: --out of the file to go on with")
    if not options.out.is_file():
        return {}
    begun = read_json(options.out).value
    if not isinstance(begun, dict):
        raise bad_value(options.out, "$", type(begun).__name__, "a file of crosscheck, to go on with it")
    for part in ("context", "settings", "call"):
        kept = begun.get(part, {})
        for name, wanted in planned[part].items():
            if name != "date" and kept.get(name) != wanted:
                found = json.dumps(kept.get(name))
                raise bad_value(options.out, f"$.{part}.{name}", found, f"{json.dumps(wanted)}, to go on with it")
    return {scene["scene"]: scene for scene in begun["scenes"]}


def _check_all(scenes: list[str], jobs: int, check: Callable[[str], dict], done: dict, kept: Callable) -> None:
    """Fills `done` with `jobs` scenes at a time; a failing scene's InputError is raised when the others are through."""
    failures = []
    pool = ThreadPoolExecutor(jobs)  # scenes are checked in threads, which only wait for renderers' processes
    try:
        running = {pool.submit(check, scene): scene for scene in scenes}
        for one in as_completed(running):
            try:
                done[running[one]] = one.result()
            except InputError as error:
                failures.append(InputError(f"{running[one]}: {str(error).removeprefix(f'{running[one]}: ')}"))
                continue
            kept()
    finally:
        pool.shutdown(cancel_futures=True)
    if failures:
        raise failures[0]


def _check(scene: str, settings: Settings, options: argparse.Namespace, family: float) -> Checked:
    with TemporaryDirectory(prefix="ptbench-crosscheck-") as name:
        scratch = Path(name)
        try:
            settings, xml = _exported(scene, settings, scratch)
        except CannotExport as refusal:
            return Checked(scene, settings, None, options.aim, reasons=tuple(refusal.reasons))
        checked = _rendered(scene, xml, settings, options, scratch, family)
        while (spp := _wanted(checked, _most(settings, options.most_spp))) > checked.settings.spp:
            # Images rendered again with more samples use new seeds: the first images only served to estimate noise.
            more = _more(checked.settings, spp)
            checked = _rendered(scene, xml, more, options, scratch, family)
    print(f"{scene}: {checked.verdict}", file=sys.stderr)
    return checked


def _most(settings: Settings, most: int) -> int:
    """The most samples per pixel that the call allows in either renderer."""
    here = settings.spp if settings.spp_here is None else settings.spp_here
    return min(most, MOST_SPP * settings.spp // here)


def _more(settings: Settings, spp: int) -> Settings:
    """Settings with more samples per pixel in both renderers and with other seeds."""
    here = None if settings.spp_here is None else math.ceil(settings.spp_here * spp / settings.spp)
    return replace(settings, spp=spp, spp_here=here, first_seed=settings.first_seed + settings.seeds)


def _exported(scene: str, settings: Settings, scratch: Path) -> tuple[Settings, Path]:
    """Exports a scene, with the depth it asks for if the call names none; raises CannotExport."""
    try:
        return settings, export(scene, settings, scratch)
    except CannotExport as refusal:
        if settings.depth is not None or not refusal.depth:
            raise
        deep = replace(settings, depth=refusal.depth)
        return deep, export(scene, deep, scratch)


def _rendered(
    scene: str, xml: Path, settings: Settings, options: argparse.Namespace, scratch: Path, family: float
) -> Checked:
    here = render_here(scene, settings, scratch, has_meshes=has_meshes(xml))
    there = render_there(xml, settings, scratch)
    found = compare(here.images, there.images, options.allow, family)
    return Checked(scene, settings, found, options.aim, here, there)


def _wanted(checked: Checked, most: int) -> int:
    """Samples per pixel with which a scene that is too noisy should detect the bias aimed at; 0: no more are needed."""
    if checked.verdict != WEAK or checked.comparison is None or checked.aim <= 0:
        return 0
    needed = 1.5 * checked.settings.spp * (checked.comparison.image.sees / checked.aim) ** 2
    return min(most, 1 << max(0, math.ceil(math.log2(needed))))


def _context(settings: Settings, peer: dict) -> dict:
    return {
        "date": datetime.now().astimezone().strftime("%Y-%m-%dT%H:%M:%S%z"),
        "ptbench.version": settings.program.output("--version").strip(),
        "ptbench.machine": settings.program.machine(),
        "mitsuba.version": peer["version"],
        "mitsuba.variant": peer["variant"],
    }
