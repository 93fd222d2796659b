"""The images that are compared: ptbench's by its program, Mitsuba's by a worker process."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.crosscheck.mitsuba_worker import MISSING
from ptbench.errors import InputError, bad_value
from ptbench.io.files import package_file, read_whole
from ptbench.io.images import read_pfm

WHEEL = "mitsuba==3.9.1"  # pyproject.toml has the same
# What takes least time, where the call says nothing: the estimator with the least noise, which a scene without diffuse
# surfaces does not take, and trees for what has meshes. No axis changes the mean.
_DIRECT_LIGHT = "direct_light=nee_mis"
_TREES = ("accelerator=bvh8", "levels=two_level")


class CannotExport(Exception):
    """A scene that Mitsuba cannot render to the same picture; `reasons` are the program's lines."""

    def __init__(self, reasons: list[str]):
        super().__init__("; ".join(reasons))
        self.reasons = reasons


@dataclass(frozen=True)
class Settings:
    """What every image is rendered with."""

    binary: Path
    python: Path
    variant: str
    backend: str
    axes: tuple[str, ...]
    seeds: int
    first_seed: int
    spp: int
    resolution: tuple[int, int]
    depth: int | None
    scale: float

    @property
    def size(self) -> str:
        """As the programs take it."""
        return f"{self.resolution[0]}x{self.resolution[1]}"


@dataclass(frozen=True)
class Images:
    """Of one renderer: seeds, rows, columns, channels; and what its last summary said."""

    images: np.ndarray
    about: dict


def run_program(command: list[str], text: str = "") -> subprocess.CompletedProcess:
    """What it wrote, and its exit code; raises InputError where it does not run."""
    try:
        return subprocess.run(command, input=text, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise InputError(f"{command[0]}: {error.strerror or error}") from error


def said_by(done: subprocess.CompletedProcess) -> list[str]:
    """What a program wrote to standard error, without empty lines."""
    return [line.strip() for line in done.stderr.splitlines() if line.strip()] or [f"exit code {done.returncode}"]


def check_binary(binary: Path) -> None:
    """Raises InputError where it is no program."""
    if not binary.is_file() or not os.access(binary, os.X_OK):
        found = "a file that cannot be run" if binary.is_file() else "no such file"
        raise bad_value(binary, "--binary", found, "the ptbench program")


def scene_names(binary: Path) -> list[str]:
    """The shipped scenes."""
    return run_program([str(binary.resolve()), "list", "--names", "scenes"]).stdout.split()


def mitsuba_version(settings: Settings) -> dict:
    """The version and the variant that renders; raises InputError where the wheel is missing."""
    return _worker(settings, {})


def _worker(settings: Settings, job: dict) -> dict:
    worker = package_file("crosscheck", "mitsuba_worker.py")
    done = run_program([str(settings.python), str(worker)], json.dumps({"variant": settings.variant, **job}))
    if done.returncode == MISSING:
        where = f"{settings.python} -m pip install {WHEEL}"
        raise InputError(f"Mitsuba 3 is not installed ({said_by(done)[-1]}): {where}, or --python of one that has it")
    if done.returncode != 0:
        raise InputError(f"Mitsuba {settings.variant}: {said_by(done)[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


def export(scene: str, settings: Settings, folder: Path) -> Path:
    """The scene as Mitsuba's XML; raises CannotExport."""
    target = folder / "scene.xml"
    command = [str(settings.binary.resolve()), "export", scene, "--format", "mitsuba", "--out", str(target)]
    command += ["--resolution", settings.size, "--spp", str(settings.spp), "--scale", repr(settings.scale)]
    command += [] if settings.depth is None else ["--depth", str(settings.depth)]
    done = run_program(command)
    if done.returncode != 0:
        lines = [line.removeprefix("ptbench: ").removeprefix(f"{scene}: ") for line in said_by(done)]
        raise CannotExport([line for line in lines if not line.endswith("; nothing is written")] or lines)
    return target


def render_here(scene: str, settings: Settings, folder: Path, *, has_meshes: bool) -> Images:
    """One image a seed by `ptbench render`."""
    target = folder / "here.pfm"
    command = [str(settings.binary.resolve()), "render", "--scene", scene, "--out", str(target)]
    command += ["--resolution", settings.size, "--spp", str(settings.spp)]
    command += [] if settings.depth is None else ["--depth", str(settings.depth)]
    command += ["--backend", settings.backend] if settings.backend else []
    trees = [*_TREES] if has_meshes else []
    axes = [*settings.axes] or [_DIRECT_LIGHT, *trees]
    images, about, seconds = [], {}, 0.0
    while len(images) < settings.seeds:
        chosen = [word for axis in axes for word in ("--axis", axis)]
        done = run_program([*command, *chosen, "--seed", str(settings.first_seed + len(images))])
        if done.returncode != 0 and not settings.axes and _DIRECT_LIGHT in axes and "n/a: " in done.stderr:
            axes = trees
            continue
        if done.returncode != 0:
            raise InputError(said_by(done)[-1].removeprefix("ptbench: "))
        about = json.loads(done.stdout)
        seconds += about["render_seconds"]
        images.append(read_pfm(target))
    return Images(np.stack(images), {**about, "render_seconds": seconds})


def has_meshes(xml: Path) -> bool:
    """Whether an exported scene shows any."""
    return b'type="ply"' in read_whole(xml)


def render_there(xml: Path, settings: Settings, folder: Path) -> Images:
    """One image a seed by Mitsuba."""
    targets = [folder / f"there_{seed}.pfm" for seed in range(settings.seeds)]
    jobs = [[settings.first_seed + seed, str(target)] for seed, target in enumerate(targets)]
    about = _worker(settings, {"xml": str(xml), "spp": settings.spp, "images": jobs})
    return Images(np.stack([read_pfm(target) for target in targets]), about)
