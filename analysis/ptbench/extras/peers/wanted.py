"""The renderers that a call of `peers` compares, by their names."""

import shlex
from dataclasses import dataclass
from pathlib import Path

from ptbench.io.axes import (
    ACCELERATOR,
    ARITHMETIC,
    COMPACTION,
    DIRECT_LIGHT,
    INTEGRATOR,
    LAYOUT,
    LEVELS,
    LIGHT_SAMPLING,
    TRAVERSAL,
)
from ptbench.io.files import package_file

MEGAKERNEL, EVALUATED = "megakernel", "evaluated"
# Estimators of direct light: next-event estimation combined with BSDF sampling by MIS, and BSDF sampling alone.
LIGHTS, CHANCE = "nee_mis", "off"
_OWN_ESTIMATOR = f"{DIRECT_LIGHT}="
_MOST_IN_TURN = 16  # most mesh objects to intersect without a tree over them (renderer.h: most_objects_in_turn)
OF_MITSUBA = {"path": LIGHTS, "bsdf": CHANCE}


@dataclass(frozen=True)
class Wanted:
    """A renderer to be timed, by name; `leaves_out` tells what its times exclude."""

    name: str
    kind: str  # kind of renderer: ptbench, mitsuba or program
    estimator: str
    axes: tuple[str, ...] = ()  # choices of a ptbench variant, as axis=choice
    command: tuple[str, ...] = ()  # command line of a persistent renderer process
    leaves_out: str = ""
    most_lanes: int = 1 << 30  # most samples over all pixels that one render can hold


@dataclass(frozen=True)
class Call:
    """Settings that all peers of a call share."""

    binary: Path
    backend: str
    resolution: tuple[int, int]
    depth: int | None
    most_seconds: float  # longest wait in seconds for an answer of a peer

    @property
    def size(self) -> str:
        """The image size as the programs take it, WxH."""
        return f"{self.resolution[0]}x{self.resolution[1]}"


def own_variants(backend: str, meshes: int) -> list[Wanted]:
    """The default ptbench variants of a call: the fastest known, and on the CPU Embree's trees.

    `meshes` is the number of objects that show a mesh. A tree over objects costs time where there are few.
    """
    if backend == "cuda":
        return _own_on_gpu(meshes)
    if not meshes:
        faces = (f"{INTEGRATOR}=packet", f"{DIRECT_LIGHT}={LIGHTS}", f"{LIGHT_SAMPLING}=projected")
        return [_own(f"packet {LIGHTS} projected", *faces)] + [
            _own(f"{name} {light}", f"{INTEGRATOR}={name}", f"{DIRECT_LIGHT}={light}")
            for light in (LIGHTS, CHANCE)
            for name in ("packet", "depth_first")
        ]
    base = (f"{INTEGRATOR}=depth_first", f"{LEVELS}=two_level")
    own = [
        _own(f"bvh8 {light}", *base, f"{ACCELERATOR}=bvh8", f"{DIRECT_LIGHT}={light}") for light in (LIGHTS, CHANCE)
    ]  # fmt: skip
    embree = (f"{INTEGRATOR}=depth_first", f"{ACCELERATOR}=embree_native")
    return [*own, *(_own(f"embree_native {light}", *embree, f"{DIRECT_LIGHT}={light}") for light in (LIGHTS, CHANCE))]


def _own_on_gpu(meshes: int) -> list[Wanted]:
    base, lit = (f"{ARITHMETIC}=precise",), (f"{DIRECT_LIGHT}={LIGHTS}", f"{LIGHT_SAMPLING}=projected")
    by_tree = meshes > _MOST_IN_TURN
    kernel = (f"{INTEGRATOR}=persistent", *base)
    if meshes:
        # Speculative traversal postpones leaves until all lanes have one; over large meshes no megakernel is faster.
        kernel += (f"{ACCELERATOR}=cwbvh", f"{TRAVERSAL}=speculative", *((f"{LEVELS}=two_level",) if by_tree else ()))
    own = [_own(f"persistent {LIGHTS} projected", *kernel, *lit)]
    own += [_own(f"persistent {light}", *kernel, f"{DIRECT_LIGHT}={light}") for light in (LIGHTS, CHANCE)]
    if not meshes or by_tree:
        return own
    # A wavefront with persistent traversal is no slower over large meshes, but has no tree over a scene's mesh objects.
    queue = (f"{INTEGRATOR}=wavefront", f"{COMPACTION}=cub_select_flagged", f"{LAYOUT}=soa", *base)
    queue += (f"{ACCELERATOR}=cwbvh", f"{TRAVERSAL}=persistent")
    return [
        *own,
        _own(f"queue {LIGHTS} projected", *queue, *lit),
        _own(f"queue {CHANCE}", *queue, f"{DIRECT_LIGHT}=off"),
    ]


def _own(name: str, *axes: str) -> Wanted:
    lights = [axis.removeprefix(_OWN_ESTIMATOR) for axis in axes if axis.startswith(_OWN_ESTIMATOR)]
    leaves_out = "reading the scene, building trees, compiling kernels"
    return Wanted(name, "ptbench", lights[0] if lights else CHANCE, axes, leaves_out=leaves_out)


def mitsubas(texts: list[str], backend: str, python: Path) -> list[Wanted]:
    """The Mitsuba peers of `--mitsuba`, or the backend's default ones."""
    usual = {"cuda": ["cuda_ad_rgb", "cuda_ad_rgb:bsdf", "cuda_ad_rgb:path:evaluated"]}
    usual["cpu"] = ["llvm_ad_rgb", "llvm_ad_rgb:bsdf", "llvm_ad_rgb:path:evaluated", "scalar_rgb"]
    return [_mitsuba(text, python) for text in (texts or usual[backend]) if text != "none"]


def _mitsuba(text: str, python: Path) -> Wanted:
    variant, estimator, mode = (*text.split(":"), *["", ""])[:3]
    estimator, mode = estimator or "path", mode or MEGAKERNEL
    script = str(package_file("extras", "peers", "mitsuba_peer.py"))
    name = " ".join(["Mitsuba", variant, estimator, *([] if mode == MEGAKERNEL else [mode])])
    compiles = "scalar" not in variant
    leaves_out = "reading the scene, building trees"
    leaves_out += ", tracing and compiling kernels, launching them" if compiles else ""
    # A megakernel of Mitsuba keeps no path state in memory; evaluated loops keep the state of every path.
    lanes = 1 << (24 if mode == EVALUATED else 28)
    command = (str(python), script, variant, estimator, mode)
    return Wanted(name, "mitsuba", OF_MITSUBA[estimator], (), command, leaves_out, lanes)


def programs(texts: list[str]) -> list[Wanted]:
    """The other renderers of `--program`: NAME[:ESTIMATOR]=COMMAND."""
    found = []
    for text in texts:
        named, _, command = text.partition("=")
        name, _, estimator = named.partition(":")
        words = tuple(shlex.split(command))
        found.append(Wanted(name, "program", estimator or CHANCE, (), words, "what its own clock leaves out"))
    return found


def chosen_variants(texts: list[str]) -> list[Wanted]:
    """The ptbench variants of `--variant`: NAME:AXIS=CHOICE,.."""
    pairs = (text.split(":", 1) for text in texts)
    return [_own(name, *axes.split(",")) for name, axes in pairs]
