"""Measures one scene: compares every peer's picture with the first one's, then times each peer once per round."""

import os
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np

from ptbench.crosscheck.document import AGREES, DIFFERS, WEAK
from ptbench.crosscheck.renders import CannotExport, Settings, export, meshes_in
from ptbench.crosscheck.statistics import Comparison, compare
from ptbench.errors import InputError
from ptbench.extras.peers.process import PeerFailed
from ptbench.extras.peers.renderers import OwnVariant, Place, Talking, started
from ptbench.extras.peers.statistics import variance_of_seeds
from ptbench.extras.peers.wanted import Call, Wanted
from ptbench.io.images import faulty_pixels
from ptbench.stats.estimates import SEED

OK, FAILED = "ok", "failed"


@dataclass(frozen=True)
class Plan:
    """The settings of a `peers` run: scenes, rounds, seeds and limits."""

    call: Call
    python: Path
    rounds: int
    repetitions: int
    render_ms: int
    seeds: int
    spp: int
    scale: float
    aim: float
    allowed: float


def measure_scene(entry: dict, plan: Plan, wanted_of: Callable[[int | None], Sequence[Wanted]], save: Callable) -> None:
    """Measures what a scene's entry lacks, and calls `save` after each step.

    `wanted_of` gives the peers, by the number of objects that show meshes, or by None where that is unknown.
    """
    with TemporaryDirectory(prefix="ptbench-peers-") as name, ExitStack() as stack:
        place, reasons = _placed(entry["scene"], plan, Path(name))
        entry["not_in_mitsuba"] = reasons
        wanted = list(wanted_of(place.meshes if not reasons else None))
        for one in wanted:
            if not any(there["name"] == one.name for there in entry["peers"]):
                entry["peers"].append(_begun(one))
        running = _start(entry, plan, wanted, place, stack)
        _check_pictures(entry, plan, running, save)
        _rounds(entry, plan, running, save)


def _placed(scene: str, plan: Plan, folder: Path) -> tuple[Place, list[str]]:
    call = plan.call
    settings = Settings(
        call.binary, plan.python, "auto", call.backend, (), plan.seeds, 1, plan.spp, call.resolution, call.depth,
        plan.scale,
    )  # fmt: skip
    try:
        xml = export(scene, settings, folder)
    except CannotExport as refusal:
        return Place(scene, None, meshes=0, folder=folder), refusal.reasons
    return Place(scene, xml, meshes=meshes_in(xml), folder=folder), []


def _begun(wanted: Wanted) -> dict:
    return {
        "name": wanted.name,
        "kind": wanted.kind,
        "estimator": wanted.estimator,
        "leaves_out": wanted.leaves_out,
        "status": OK,
        "reason": "",
        "about": {},
        "samples": [],
    }


def _failed(entry: dict, peer: dict, reason: str) -> None:
    peer["status"], peer["reason"] = FAILED, reason
    print(f"{entry['scene']}: {peer['name']}: failed: {reason}", file=sys.stderr)


def _start(
    entry: dict, plan: Plan, wanted: Sequence[Wanted], place: Place, stack: ExitStack
) -> dict[str, OwnVariant | Talking]:
    running = {}
    for peer in entry["peers"]:
        about = next((one for one in wanted if one.name == peer["name"]), None)
        if about is None or peer["status"] != OK:
            continue
        try:
            one = stack.enter_context(closing(started(about, plan.call)))
            load_ms = one.load(place)
        except PeerFailed as error:
            _failed(entry, peer, str(error))
            continue
        if load_ms is not None:
            peer["load_ms"] = load_ms
        running[about.name] = one
    return running


def _check_pictures(entry: dict, plan: Plan, running: dict, save: Callable) -> None:
    """Compares the pictures of the peers with the first peer's and fills their `picture`."""
    missing = [peer for peer in entry["peers"] if peer["name"] in running and "picture" not in peer]
    if not missing:
        return
    first = entry["peers"][0]
    if first["name"] not in running:
        raise InputError(f"{entry['scene']}: {first['name']}: {first['reason']}; all others are held against it")
    try:
        reference, _ = _pictures(running[first["name"]], plan)
    except PeerFailed as error:
        raise InputError(f"{entry['scene']}: {first['name']}: {error}; all others are held against it") from error
    for peer in missing:
        one = running[peer["name"]]
        try:
            images, ms_per_spp = _pictures(one, plan)
            if images.shape != reference.shape:
                raise PeerFailed(f"a picture of {images.shape[2]}x{images.shape[1]}, which was not asked for")
        except PeerFailed as error:
            _failed(entry, peer, str(error))
            del running[peer["name"]]
            save()
            continue
        found = compare(reference, images, plan.allowed)
        peer["picture"] = _picture(found, images, plan, is_first=peer is first)
        peer["about"] = one.about
        peer["spp"] = _spp_of_a_render(ms_per_spp, one.wanted, plan)
        print(f"{entry['scene']}: {peer['name']}: {peer['picture']['verdict']}", file=sys.stderr)
        save()


def _pictures(one: OwnVariant | Talking, plan: Plan) -> tuple[np.ndarray, float]:
    """One picture per seed, and the least time per sample in milliseconds."""
    width, height = plan.call.resolution
    passes = 1
    # A peer that holds all samples of a render in memory renders in several passes if it cannot hold the image's.
    while plan.spp * width * height > passes * one.wanted.most_lanes and plan.spp % (2 * passes) == 0:
        passes *= 2
    images, times = [], []
    for seed in range(plan.seeds):
        parts = [one.image(plan.spp // passes, 1 + seed * passes + part) for part in range(passes)]
        if wrong := sum(faulty_pixels(image) for image, _ in parts):
            raise PeerFailed(f"a picture with {wrong} pixels that are infinite or no number")
        images.append(np.mean([image.astype(np.float64) for image, _ in parts], axis=0))
        times += [ms / (plan.spp // passes) for _, ms in parts]
    return np.stack(images), min(times)


def _picture(found: Comparison, images: np.ndarray, plan: Plan, *, is_first: bool) -> dict:
    verdict = DIFFERS if found.differs else AGREES if is_first or found.image.sees <= plan.aim else WEAK
    return {
        "verdict": verdict,
        "mean_rgb": images.mean(axis=(0, 1, 2)).tolist(),
        "bias": list(found.image.bias),
        "sees": found.image.sees,
        "worst_block": found.blocks.worst,
        "limit_of_blocks": found.blocks.limit,
        "pixels_z": found.pixels.z,
        "variance_of_seeds": variance_of_seeds(images, plan.spp),
    }


def _spp_of_a_render(ms_per_spp: float, wanted: Wanted, plan: Plan) -> int:
    """The power of two of samples per pixel with which a render takes the planned time and fits in memory."""
    width, height = plan.call.resolution
    most = max(1, wanted.most_lanes // (width * height))
    spp = 1
    while 1.5 * spp * ms_per_spp < plan.render_ms and 2 * spp <= most:
        spp *= 2
    return spp


def _rounds(entry: dict, plan: Plan, running: dict, save: Callable) -> None:
    for number in range(1, plan.rounds + 1):
        order = [peer for peer in entry["peers"] if peer["name"] in running and peer["status"] == OK]
        # The order of peers is random, so that none always follows the same one; the seed lets a resumed run repeat it.
        Random(f"{SEED} {number}").shuffle(order)
        for place, peer in enumerate(order, start=1):
            if any(sample["round"] == number for sample in peer["samples"]):
                continue
            load = os.getloadavg()[0]
            try:
                # Timed renders use seeds from 10,000 on, which no picture uses.
                timed = running[peer["name"]].times(peer["spp"], 10_000 + number, plan.repetitions)
            except PeerFailed as error:
                _failed(entry, peer, str(error))
                continue
            peer["samples"] += [
                {"round": number, "order": place, "spp": peer["spp"], "load": load, **asdict(one)} for one in timed
            ]
        print(f"{entry['scene']}: round {number} of {plan.rounds}", file=sys.stderr)
        save()
