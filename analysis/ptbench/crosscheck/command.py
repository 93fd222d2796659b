"""`python3 -m ptbench crosscheck SCENE..`: the same scenes here and in Mitsuba 3, and whether the pictures agree.

Exit codes: 0 they agree; 1 one differs, or its images are too noisy for the aim; 2 a wrong call, no wheel, or a scene
that was named and cannot be rendered in both. docs/other_renderers.md has the conventions.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from ptbench.crosscheck.document import AGREES, REFUSED, WEAK, Checked, as_json, as_text
from ptbench.crosscheck.options import ALL
from ptbench.crosscheck.renders import (
    CannotExport,
    Settings,
    check_binary,
    export,
    has_meshes,
    mitsuba_version,
    render_here,
    render_there,
    run_program,
    scene_names,
)
from ptbench.crosscheck.statistics import compare
from ptbench.io.files import check_output_file, write_text
from ptbench.terminal import say


def crosscheck_command(options: argparse.Namespace) -> int:
    """The exit code; raises InputError."""
    if options.out is not None:
        check_output_file(options.out)
    check_binary(options.binary)
    settings = Settings(
        binary=options.binary,
        python=options.python,
        variant=options.variant,
        backend=options.backend,
        axes=tuple(options.axis),
        seeds=options.seeds,
        first_seed=1,
        spp=options.spp,
        resolution=options.resolution,
        depth=options.depth,
        scale=options.scale,
    )
    peer = mitsuba_version(settings)
    named = [scene for scene in options.scenes if scene != ALL]
    scenes = list(dict.fromkeys(named + (scene_names(options.binary) if ALL in options.scenes else [])))
    context = _context(settings, peer)
    checked: list[Checked] = []
    for scene in scenes:
        checked.append(_check(scene, settings, options))
        if options.out is not None:
            # After each scene: all of them take long, and what is done is not lost.
            text = json.dumps(as_json(checked, settings, context, options.allow), indent=1) + "\n"
            write_text(options.out, text)
    print("\n".join(as_text(checked, settings, options.aim)))
    if options.out is not None:
        say(options.out)
    if any(one.verdict == REFUSED and one.scene in named for one in checked):
        return 2
    return 0 if all(one.verdict in (AGREES, REFUSED) for one in checked) else 1


def _check(scene: str, settings: Settings, options: argparse.Namespace) -> Checked:
    with TemporaryDirectory(prefix="ptbench-crosscheck-") as name:
        scratch = Path(name)
        try:
            xml = export(scene, settings, scratch)
        except CannotExport as refusal:
            return Checked(scene, settings, None, options.aim, reasons=tuple(refusal.reasons))
        checked = _rendered(scene, xml, settings, options, scratch)
        spp = _wanted(checked, options.most_spp)
        if spp > settings.spp:
            # By other seeds: the first images only said how much noise there is.
            more = replace(settings, spp=spp, first_seed=settings.first_seed + settings.seeds)
            checked = _rendered(scene, xml, more, options, scratch)
    print(f"{scene}: {checked.verdict}", file=sys.stderr)
    return checked


def _rendered(scene: str, xml: Path, settings: Settings, options: argparse.Namespace, scratch: Path) -> Checked:
    here = render_here(scene, settings, scratch, has_meshes=has_meshes(xml))
    there = render_there(xml, settings, scratch)
    return Checked(scene, settings, compare(here.images, there.images, options.allow), options.aim, here, there)


def _wanted(checked: Checked, most: int) -> int:
    """Samples a pixel with which a scene that is too weak should see the aim, with a little to spare."""
    if checked.verdict != WEAK or checked.comparison is None or checked.aim <= 0:
        return 0
    needed = 1.5 * checked.settings.spp * (checked.comparison.image.sees / checked.aim) ** 2
    return min(most, 1 << max(0, math.ceil(math.log2(needed))))


def _context(settings: Settings, peer: dict) -> dict:
    binary = str(settings.binary.resolve())
    said = [run_program([binary, word]).stdout.strip() for word in ("--version", "machine")]
    return {
        "date": datetime.now().astimezone().strftime("%Y-%m-%dT%H:%M:%S%z"),
        "ptbench.version": said[0],
        "ptbench.machine": said[1],
        "mitsuba.version": peer["version"],
        "mitsuba.variant": peer["variant"],
    }
