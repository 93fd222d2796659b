"""`python3 -m ptbench peers SCENE..`: times ptbench's variants and other renderers in turn, on one machine in one run.

Exit codes: 0 all was measured; 1 a picture differs or is too noisy to tell, or a peer failed; 2 a wrong call. The file
is written after every round, and `--resume` continues it.
"""

import argparse
import json
import os
import platform
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.extras.peers.document import SCHEMA, as_text, scenes_of
from ptbench.extras.peers.measure import Plan, measure_scene
from ptbench.extras.peers.wanted import Call, Wanted, chosen_variants, mitsubas, own_variants, programs
from ptbench.io.files import check_output_file, make_folder, picked, write_text
from ptbench.io.nodes import read_json
from ptbench.program import Program, run_program
from ptbench.terminal import say


def peers_command(options: argparse.Namespace) -> int:
    """Runs `peers` and returns the exit code; raises InputError."""
    Program(options.binary).check()
    plan = _plan(options)
    context = _context(plan)
    out = options.out or Path("results") / context["ptbench.machine"] / "peers.json"
    check_output_file(out, options.scenes)
    document = _begun(options, plan, context, out)
    make_folder(out.parent)

    def save() -> None:
        write_text(out, json.dumps(document, indent=1, allow_nan=False) + "\n")

    for entry in document["scenes"]:
        measure_scene(entry, plan, lambda meshes, entry=entry: _wanted(options, meshes, entry), save)
    document["complete"] = True
    save()
    print("\n".join(as_text(document)))
    say(out)
    peers = [peer for scene in scenes_of(document) for peer in scene.peers]
    return 0 if all(peer.compares for peer in peers) else 1


def _plan(options: argparse.Namespace) -> Plan:
    call = Call(options.binary, options.backend, options.resolution, options.depth, options.seconds)
    return Plan(
        call, options.python, options.rounds, options.repetitions, options.render_ms, options.seeds, options.spp,
        options.scale, options.aim, options.allow,
    )  # fmt: skip


def _wanted(options: argparse.Namespace, meshes: int | None, entry: dict) -> Sequence[Wanted]:
    own = chosen_variants(options.variant)
    if not own:
        if meshes is None:
            reasons = "; ".join(entry["not_in_mitsuba"])
            raise InputError(f"{entry['scene']}: Mitsuba has no such scene ({reasons}), and no --variant says what has")
        own = own_variants(options.backend, meshes)
    wanted = [*own, *mitsubas(options.mitsuba, options.backend, options.python), *programs(options.program)]
    names = [one.name for one in wanted]
    if twice := [name for name in dict.fromkeys(names) if names.count(name) > 1]:
        raise InputError(f"peers: found {twice[0]} twice, allowed: a name for each peer")
    return wanted


def _begun(options: argparse.Namespace, plan: Plan, context: dict, out: Path) -> dict:
    """The document of a run so far: a new one, or with `--resume` the existing file of the same call."""
    scenes = list(dict.fromkeys(options.scenes))
    new = {
        "schema": SCHEMA,
        "complete": False,
        "context": context,
        "settings": _settings(options, plan),
        "scenes": [{"scene": scene, "not_in_mitsuba": [], "peers": []} for scene in scenes],
    }
    if not out.exists() or options.overwrite:
        if options.resume:
            raise bad_value(out, "--resume", "no such file", "an unfinished file, without --overwrite")
        return new
    if not options.resume:
        raise bad_value(out, "output file", "one that is there", "another name, --resume or --overwrite")
    # The schema validator is imported only here, as a machine that only measures need not have it.
    from ptbench.io.validate import complaints

    there = read_json(out).value
    if wrong := next(complaints(there, "peers"), ""):
        raise InputError(f"{out}: {wrong}")
    if there["complete"]:
        raise bad_value(out, "--resume", "a complete file", "an unfinished one")
    differing = _differing(there, new)
    if differing:
        raise bad_value(out, "--resume", f"another {differing}", "the call, the machine and the program that began it")
    return there


def _differing(there: dict, new: dict) -> str:
    if there["settings"] != new["settings"]:
        return next(name for name in new["settings"] if there["settings"][name] != new["settings"][name])
    for name in ("ptbench.version", "ptbench.machine", "host"):
        if there["context"][name] != new["context"][name]:
            return name
    return "scenes" if [one["scene"] for one in there["scenes"]] != [one["scene"] for one in new["scenes"]] else ""


def _settings(options: argparse.Namespace, plan: Plan) -> dict:
    return {
        **picked(options, "backend resolution depth"),
        **picked(plan, "rounds repetitions render_ms seeds spp scale aim allowed"),
        "variants": options.variant,
        "mitsuba": options.mitsuba,
        "programs": options.program,
    }


def _context(plan: Plan) -> dict:
    program = Program(plan.call.binary)
    return {
        "date": datetime.now().astimezone().strftime("%Y-%m-%dT%H:%M:%S%z"),
        "ptbench.version": program.output("--version").strip(),
        "ptbench.machine": program.machine(),
        "host": platform.node() or "unknown",
        "processors": os.cpu_count() or 1,
        "device": _device(plan.call.backend),
        "load_avg": list(os.getloadavg()),
    }


def _device(backend: str) -> str:
    """The name of the device that all peers ran on, from the driver or the kernel."""
    if backend == "cuda":
        fields = "name,driver_version,clocks.max.sm"
        try:
            done = run_program(["nvidia-smi", f"--query-gpu={fields}", "--format=csv,noheader"])
        except InputError:
            return "unknown"
        return done.stdout.strip().splitlines()[0] if done.returncode == 0 and done.stdout.strip() else "unknown"
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return "unknown"
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")
