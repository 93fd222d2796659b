"""Reads files of `ptbench rays`, and those of a peer that traced the same rays (tools/rays/optix_peer.py).

Times are milliseconds of a whole batch. A peer's file is named after its mesh: `optix_tori_4M.json` holds OptiX's times
for the rays of the mesh `tori_4M`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ptbench.errors import bad_value
from ptbench.io.counters import Counters, counters_of
from ptbench.io.nodes import Node, read_json, shown
from ptbench.io.run import OfARun

SCHEMA = "ptbench-rays-1"
QUERIES = ("closest", "any")
_PEER_KEYS = {"mesh", "batches"}
# Words before a peer program's version in the program's name, by the key of the peer's file that holds the version.
_PEER_PROGRAMS = {"mitsuba": "through Mitsuba ", "optix": ""}


@dataclass(frozen=True)
class Batch:
    """The times `ms` of one kernel on one class of rays, one value per repetition."""

    ray_class: str
    kernel: str
    query: str
    rays: int
    ms: tuple[float, ...]
    checksum: str = ""  # checksum over all hits of the batch
    nodes_per_ray: float | None = None
    boxes_per_ray: float | None = None
    triangles_per_ray: float | None = None
    counters: Counters | None = None  # hardware counters, in files of `ptbench rays --counters`

    @property
    def giga_rays_per_second(self) -> np.ndarray:
        """Billions of rays a second, one value a repetition."""
        return self.rays / np.array(self.ms) / 1e6


@dataclass(frozen=True)
class Tree:
    """The tree of one builder encoded for one accelerator."""

    accelerator: str
    builder: str  # name of the builder; empty: the accelerator needs no tree
    nodes: int
    node_bytes: int
    leaf_bytes: int
    sah_cost: float
    build_ms: float
    encode_ms: float
    device_build_ms: tuple[float, ...]  # build times on the GPU without copies; empty: not built on the GPU
    device_encode_ms: tuple[float, ...]
    batches: tuple[Batch, ...]


@dataclass(frozen=True)
class RayMesh:
    """One mesh with its classes of rays and its trees."""

    name: str
    triangles: int
    hash: str
    rays: dict[str, int]  # number of rays in a batch, by class of rays
    agree: dict[str, bool]  # by class of rays, whether all trees and kernels (brute force, too, if run) give equal hits
    trees: tuple[Tree, ...]


@dataclass(frozen=True)
class Rays(OfARun):
    """The contents of one file of `ptbench rays`."""

    path: Path
    context: dict[str, str]
    backend: str
    threads: int
    repetitions: int
    meshes: tuple[RayMesh, ...]

    @property
    def suite(self) -> str:
        """The empty suite name of a file of `ptbench rays`, since ray batches belong to no suite."""
        return ""


@dataclass(frozen=True)
class Peer:
    """Another program's times for the rays of one mesh."""

    path: Path
    name: str
    mesh: str
    by: str  # program that traced the rays, with its version, such as "through Mitsuba 3.9.1"
    hits_differ: int  # difference between the peer's and ptbench's numbers of hits, over all batches
    batches: tuple[Batch, ...]


def is_rays(root: Node) -> bool:
    """Whether a parsed JSON file is one of `ptbench rays`."""
    return isinstance(root.value, dict) and root.value.get("schema") == SCHEMA


def is_peer(root: Node) -> bool:
    """Whether a parsed JSON file holds a peer's times for rays."""
    keys = root.value.keys() if isinstance(root.value, dict) else set()
    return keys >= _PEER_KEYS and not keys.isdisjoint(_PEER_PROGRAMS)


def rays_of(root: Node) -> Rays:
    """Reads and checks a file of `ptbench rays`; raises InputError."""
    root.need("schema").one_of((SCHEMA,))
    fields = root.need("context").fields()
    context = {key: root.need("context").need(key).text() for key in fields}
    meshes = tuple(_mesh(node) for node in root.need("meshes").items())
    return Rays(
        path=root.file,
        context=context,
        backend=root.need("backend").name(),
        threads=root.need("threads").integer(minimum=1),
        repetitions=root.need("repetitions").integer(minimum=1),
        meshes=meshes,
    )


def peer_of(root: Node) -> Peer:
    """Reads and checks the file of a peer's ray times; raises InputError."""
    name, _, mesh = root.file.stem.partition("_")
    written = Path(root.need("mesh").name()).stem
    if not mesh or mesh != written:
        raise bad_value(root.file, "$.mesh", shown(written), "the mesh of the file's name, PEER_MESH.json")
    nodes = list(root.need("batches").items())
    program = next(key for key in _PEER_PROGRAMS if key in root.value)
    return Peer(
        path=root.file,
        name=name,
        mesh=mesh,
        by=f"{_PEER_PROGRAMS[program]}{root.need(program).name()}",
        hits_differ=sum(node.need("hits_differ").integer() for node in nodes),
        batches=tuple(
            Batch(
                ray_class=node.need("class").name(),
                kernel=name,
                query=node.need("query").one_of(QUERIES),
                rays=node.need("rays").integer(minimum=1),
                ms=_times(node.need("ms")),
            )
            for node in nodes
        ),
    )


def load_rays_folder(folder: Path) -> tuple[tuple[Rays, ...], tuple[Peer, ...]]:
    """Reads every file of `ptbench rays` and of peers in a folder, by name; raises InputError where there is none."""
    roots = [read_json(path) for path in sorted(folder.glob("*.json*"))]
    found = tuple(rays_of(root) for root in roots if is_rays(root))
    if not found:
        raise bad_value(folder, "the folder", "no such file", "files of ptbench rays")
    return found, tuple(peer_of(root) for root in roots if is_peer(root))


def _mesh(node: Node) -> RayMesh:
    sets = list(node.need("ray_sets").items())
    rays = {one.need("class").name(): one.need("rays").integer(minimum=1) for one in sets}
    return RayMesh(
        name=node.need("mesh").name(),
        triangles=node.need("triangles").integer(minimum=1),
        hash=node.need("hash").name(),
        rays=rays,
        agree={one.need("class").name(): bool(one.need("agree").one_of((True, False))) for one in sets},
        trees=tuple(_tree(tree, rays) for tree in node.need("trees").items()),
    )


def _tree(node: Node, rays: dict[str, int]) -> Tree:
    return Tree(
        accelerator=node.need("accelerator").name(),
        builder=node.optional_text("builder"),
        nodes=node.need("nodes").integer(),
        node_bytes=node.need("node_bytes").integer(),
        leaf_bytes=node.need("leaf_bytes").integer(),
        sah_cost=node.need("sah_cost").number(),
        build_ms=node.need("build_ms").number(),
        encode_ms=node.need("encode_ms").number(),
        device_build_ms=_maybe_times(node, "device_build_ms"),
        device_encode_ms=_maybe_times(node, "device_encode_ms"),
        batches=tuple(_batch(batch, rays) for batch in node.need("batches").items()),
    )


def _batch(node: Node, rays: dict[str, int]) -> Batch:
    ray_class, counters = node.need("class").one_of(tuple(rays)), node.maybe("counters")
    return Batch(
        ray_class=ray_class,
        kernel=node.need("kernel").name(),
        query=node.need("query").one_of(QUERIES),
        rays=rays[ray_class],
        ms=_times(node.need("ms")),
        checksum=node.need("checksum").name(),
        nodes_per_ray=node.optional_number("nodes_per_ray"),
        boxes_per_ray=node.optional_number("boxes_per_ray"),
        triangles_per_ray=node.optional_number("triangles_per_ray"),
        counters=None if counters is None else counters_of(counters),
    )


def _times(node: Node) -> tuple[float, ...]:
    times = tuple(item.number(above_zero=True) for item in node.items())
    if not times:
        raise node.wrong("a time or more")
    return times


def _maybe_times(node: Node, key: str) -> tuple[float, ...]:
    times = node.maybe(key)
    return () if times is None else _times(times)


def peer_batch(peers: Sequence[Peer], mesh: str, ray_class: str) -> tuple[Peer, Batch] | None:
    """The peer's batch for a mesh and a class of rays, with its peer; None where no peer traced it."""
    for peer in peers:
        for batch in peer.batches:
            if (peer.mesh, batch.ray_class) == (mesh, ray_class):
                return peer, batch
    return None
