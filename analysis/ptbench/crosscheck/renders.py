"""The images of a cross-check: ptbench's from its own program, Mitsuba's from a worker process."""

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.crosscheck.mitsuba_worker import MISSING
from ptbench.errors import InputError
from ptbench.io.axes import ACCELERATOR, BUILDER, DIRECT_LIGHT, LEVELS
from ptbench.io.files import package_file, read_whole
from ptbench.io.images import faulty_pixels, read_pfm
from ptbench.program import Program, run_program, said_by

WHEEL = "mitsuba==3.9.1"  # pip package that error messages advise to install; pyproject.toml requires the same version
# Defaults that make ptbench's render of a cross-check fast: the least noisy estimator, which a scene without diffuse
# surfaces refuses, and trees for scenes with meshes. No such choice changes the expected image.
_LEAST_NOISE = f"{DIRECT_LIGHT}=nee_mis"
_FAULTS = ("nonfinite", "negative", "saturated")  # counts of bad samples in a render's summary; none is accepted
_FOLDERS = ("environments", "materials", "textures", "scaling", "meshes")  # folders of scenes that `ptbench list` omits
_TREES = {"cuda": (f"{ACCELERATOR}=cwbvh", f"{BUILDER}=hploc", f"{LEVELS}=two_level")}
_TREES_ELSEWHERE = (f"{ACCELERATOR}=bvh8", f"{LEVELS}=two_level")


class CannotExport(Exception):
    """A scene that Mitsuba cannot render to the same picture; `reasons` are the lines that ptbench's export prints."""

    def __init__(self, reasons: list[str]):
        super().__init__("; ".join(reasons))
        self.reasons = reasons

    @property
    def depth(self) -> int:
        """The depth that ptbench's export asks for; 0 where no depth would make the scene exportable."""
        asked = [re.search(r"allowed: --depth (\d+) or more", reason) for reason in self.reasons]
        return int(asked[0][1]) if asked and all(asked) else 0


@dataclass(frozen=True)
class Settings:
    """The settings with which every image of a cross-check is rendered."""

    binary: Path
    python: Path
    variant: str
    backend: str
    axes: tuple[str, ...]
    seeds: int
    first_seed: int
    spp: int  # samples per pixel of Mitsuba's images, and of ptbench's unless spp_here overrides it
    resolution: tuple[int, int]
    depth: int | None
    scale: float
    spp_here: int | None = None

    @property
    def program(self) -> Program:
        """The ptbench program whose images are compared with Mitsuba's."""
        return Program(self.binary)

    @property
    def size(self) -> str:
        """The image size as the programs take it, WxH."""
        return f"{self.resolution[0]}x{self.resolution[1]}"


@dataclass(frozen=True)
class Images:
    """The images of one renderer (seeds, rows, columns, channels), and the summary of its last render."""

    images: np.ndarray
    about: dict


def shipped_scenes(program: Program) -> list[str]:
    """Names of the shipped scenes but for scenes/stability, which are test cases and no pictures."""
    names = program.output("list", "--names", "scenes").split()
    binary = program.binary.resolve()
    homes = [Path(os.environ["PTBENCH_HOME"])] if "PTBENCH_HOME" in os.environ else [binary.parent, binary.parents[1]]
    scenes = next((home / "scenes" for home in homes if (home / "scenes").is_dir()), homes[0])
    return names + [f"{folder}/{file.stem}" for folder in _FOLDERS for file in sorted((scenes / folder).glob("*.json"))]


def mitsuba_version(settings: Settings) -> dict:
    """Mitsuba's version and the variant that renders; raises InputError where the wheel is missing."""
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
    """Writes a scene as Mitsuba's XML and returns the file; raises CannotExport."""
    target = folder / "scene.xml"
    call = ["export", scene, "--format", "mitsuba", "--out", target, "--overwrite"]
    call += ["--resolution", settings.size, "--spp", settings.spp, "--scale", repr(settings.scale)]
    call += [] if settings.depth is None else ["--depth", settings.depth]
    done = settings.program.called(*call)
    if done.returncode != 0:
        lines = [line.removeprefix(f"{scene}: ") for line in said_by(done)]
        raise CannotExport([line for line in lines if not line.endswith("; nothing is written")] or lines)
    return target


def render_here(scene: str, settings: Settings, folder: Path, *, has_meshes: bool) -> Images:
    """Renders one image per seed by `ptbench render`."""
    target = folder / "here.pfm"
    call = ["render", "--scene", scene, "--out", target, "--resolution", settings.size]
    call += ["--spp", settings.spp if settings.spp_here is None else settings.spp_here]
    call += [] if settings.depth is None else ["--depth", settings.depth]
    call += ["--backend", settings.backend] if settings.backend else []
    trees = [*_TREES.get(settings.backend, _TREES_ELSEWHERE)] if has_meshes else []
    axes = [*settings.axes] or [_LEAST_NOISE, *trees]
    images, about, seconds = [], {}, 0.0
    while len(images) < settings.seeds:
        chosen = [word for axis in axes for word in ("--axis", axis)]
        done = settings.program.called(*call, *chosen, "--seed", settings.first_seed + len(images))
        if done.returncode != 0 and not settings.axes and _LEAST_NOISE in axes and "n/a: " in done.stderr:
            axes = trees
            continue
        if done.returncode != 0:
            raise InputError(said_by(done)[-1])
        about = json.loads(done.stdout)
        seconds += about["render_seconds"]
        seed = settings.first_seed + len(images)
        # Samples that are nonfinite, negative or saturated are left out of the film, so the image does not show them.
        if lost := {name: about[name] for name in _FAULTS if about.get(name)}:
            raise InputError(f"ptbench's image, seed {seed}: found faulty samples {lost}, allowed: none")
        images.append(_finite(read_pfm(target), "ptbench's image", seed))
    return Images(np.stack(images), {**about, "render_seconds": seconds})


def _finite(image: np.ndarray, whose: str, seed: int) -> np.ndarray:
    """Returns the image; raises InputError if pixels are infinite or NaN."""
    if wrong := faulty_pixels(image):
        raise InputError(f"{whose}, seed {seed}: found {wrong} pixels that are infinite or no number, allowed: none")
    return image


def meshes_in(xml: Path) -> int:
    """The number of objects of an exported scene that show a mesh."""
    text = read_whole(xml)
    return text.count(b'type="ply"') + text.count(b'type="instance"')


def has_meshes(xml: Path) -> bool:
    """Whether an exported scene shows any mesh."""
    return meshes_in(xml) > 0


def render_there(xml: Path, settings: Settings, folder: Path) -> Images:
    """Renders one image per seed by Mitsuba."""
    targets = [folder / f"there_{seed}.pfm" for seed in range(settings.seeds)]
    jobs = [[settings.first_seed + seed, str(target)] for seed, target in enumerate(targets)]
    about = _worker(settings, {"xml": str(xml), "spp": settings.spp, "images": jobs})
    images = [
        _finite(read_pfm(target), "Mitsuba's image", seed) for (seed, _), target in zip(jobs, targets, strict=True)
    ]
    return Images(np.stack(images), about)
