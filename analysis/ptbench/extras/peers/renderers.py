"""The renderers to be timed: ptbench's variants run as `ptbench render`, all others as persistent processes."""

import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.crosscheck.renders import WHEEL
from ptbench.errors import InputError
from ptbench.extras.peers.mitsuba_peer import MISSING
from ptbench.extras.peers.process import PeerFailed, Talker, busy_ms, process_ms
from ptbench.extras.peers.wanted import Call, Wanted
from ptbench.io.images import read_pfm
from ptbench.program import Program, said_by

_FIELDS = ("ms", "wall_ms", "compile_ms")


@dataclass(frozen=True)
class Place:
    """A scene as given to the renderers; `xml` is Mitsuba's version, or None where the scene cannot be exported."""

    scene: str
    xml: Path | None
    meshes: int  # number of objects that show a mesh
    folder: Path  # folder into which the renderers write their files


@dataclass(frozen=True)
class Timed:
    """One timed render; `ms` is the time that results use."""

    ms: float
    wall_ms: float
    compile_ms: float
    device_ms: float | None  # part of the render time `ms` spent on the device; None where the renderer cannot tell
    foreign_cpu_ms: float | None


class OwnVariant:
    """A variant of ptbench; `ms` is its render wall time, from the first launch to the end of the last."""

    def __init__(self, wanted: Wanted, call: Call) -> None:
        self.wanted, self._call = wanted, call
        self.about: dict = {}
        self._place: Place | None = None

    def load(self, place: Place) -> float | None:
        """Remembers the scene; every `ptbench render` reads it anew, so that there is no loading time."""
        self._place = place
        return None

    def image(self, spp: int, seed: int) -> tuple[np.ndarray, float]:
        """The picture of a seed, and its render time in milliseconds."""
        summary = self._rendered(spp, seed, 0)
        return read_pfm(self._target), 1e3 * summary["render_seconds"]

    def times(self, spp: int, seed: int, repetitions: int) -> list[Timed]:
        """Timed renders of one process; its first render is a warm-up and not included."""
        summary = self._rendered(spp, seed, repetitions)
        return [_timed_here(one, 1e3 * summary["compile_seconds"]) for one in summary["repetitions"]]

    def close(self) -> None:
        """Does nothing, as ptbench leaves no process running."""

    @property
    def _target(self) -> Path:
        return self._place.folder / "own.pfm"

    def _rendered(self, spp: int, seed: int, repetitions: int) -> dict:
        call = self._call
        asked = ["render", "--scene", self._place.scene, "--out", self._target]
        asked += ["--resolution", call.size, "--spp", spp, "--seed", seed, "--backend", call.backend]
        asked += [] if call.depth is None else ["--depth", call.depth]
        asked += [word for axis in self.wanted.axes for word in ("--axis", axis)]
        asked += ["--repetitions", repetitions] if repetitions else []
        done = Program(call.binary).called(*asked)
        if done.returncode != 0:
            raise PeerFailed(said_by(done)[-1])
        summary = json.loads(done.stdout)
        self.about = {name: summary[name] for name in ("scene_hash", "variant", "variant_id", "backend", "depth")}
        return summary


def _timed_here(said: dict, compile_ms: float) -> Timed:
    wall, device, foreign = (1e3 * said[f"{name}_seconds"] for name in ("render", "device", "foreign_cpu"))
    return Timed(wall, wall, compile_ms, device, foreign)


class Talking:
    """A renderer that runs as a persistent process, Mitsuba's or another's, and reports its own `ms`."""

    def __init__(self, wanted: Wanted, call: Call) -> None:
        self.wanted, self._call = wanted, call
        self._talker = Talker(wanted.command, call.most_seconds)
        try:
            said = self._talker.ask(do="about")
            self.about = {name: value for name, value in said.items() if isinstance(value, (str, int, float))}
        except PeerFailed as error:
            if self._talker.close() == MISSING and wanted.kind == "mitsuba":
                where = f"{wanted.command[0]} -m pip install {WHEEL}"
                raise InputError(
                    f"Mitsuba 3 is not installed ({error}): {where}, or --python of one that has it"
                ) from error
            raise
        self._place: Place | None = None

    def load(self, place: Place) -> float | None:
        """Loads the scene, and returns the milliseconds that took."""
        if place.xml is None and self.wanted.kind == "mitsuba":
            raise PeerFailed("Mitsuba has no such scene")
        self._place = place
        said = self._talker.ask(
            do="load",
            scene=place.scene,
            xml=None if place.xml is None else str(place.xml),
            resolution=list(self._call.resolution),
            depth=self._call.depth,
        )
        return _number(said, "load_ms") if "load_ms" in said else None

    def image(self, spp: int, seed: int) -> tuple[np.ndarray, float]:
        """The picture of a seed, and its render time in milliseconds."""
        target = self._place.folder / "other.pfm"
        target.unlink(missing_ok=True)
        said = self._talker.ask(do="image", spp=spp, seed=seed, file=str(target))
        if not target.is_file():
            raise PeerFailed("wrote no picture")
        try:
            return read_pfm(target), _timed(said, None).ms
        except InputError as error:
            raise PeerFailed(str(error)) from error

    def times(self, spp: int, seed: int, repetitions: int) -> list[Timed]:
        """Timed renders by the renderer's own clock, which excludes the requests."""
        begun, before, own_before = time.perf_counter(), busy_ms(), process_ms(self._talker.pid)
        renders = self._talker.ask(do="times", spp=spp, seed=seed, repetitions=repetitions).get("renders")
        whole = 1e3 * (time.perf_counter() - begun)
        after, own_after = busy_ms(), process_ms(self._talker.pid)
        if not isinstance(renders, list) or len(renders) != repetitions:
            raise PeerFailed(f"{repetitions} renders were asked for, others were answered")
        foreign = None
        if None not in (before, own_before, after, own_after):
            foreign = max(0.0, after - before - (own_after - own_before)) / whole
        return [_timed(one, foreign) for one in renders]

    def close(self) -> None:
        """Ends the renderer's process."""
        self._talker.close()


def _timed(said: object, foreign: float | None) -> Timed:
    if not isinstance(said, dict):
        raise PeerFailed("a render is no JSON object")
    ms, wall, compiled = (_number(said, name) for name in _FIELDS)
    if ms <= 0 or wall <= 0:
        raise PeerFailed(f"a render that took {min(ms, wall):g} ms")
    return Timed(ms, wall, compiled, None, None if foreign is None else foreign * wall)


def _number(said: dict, name: str) -> float:
    value = said.get(name)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value < float("inf"):
        raise PeerFailed(f"{name}: found {json.dumps(value)}, allowed: milliseconds")
    return float(value)


def started(wanted: Wanted, call: Call) -> OwnVariant | Talking:
    """Starts the renderer so that it can load a scene; raises PeerFailed or InputError."""
    return OwnVariant(wanted, call) if wanted.kind == "ptbench" else Talking(wanted, call)
