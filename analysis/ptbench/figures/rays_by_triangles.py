"""Rays per second over the number of triangles: a line per tree and kernel, a panel per ray class and mesh family.

The data are files of `ptbench rays`, with a peer's line (OptiX) where it traced the same rays. Meshes whose names
differ only in the size form a family: `tori_262k` and `tori_4M`.
"""

from collections.abc import Sequence

from ptbench.errors import NotDrawable
from ptbench.figures import series
from ptbench.io.rays import Batch, Peer, RayMesh, Rays
from ptbench.stats.estimates import INTERVAL_TEXT, median_estimate

# Least rays of a batch to fill a GPU: a file with fewer is a correctness check, not a rate measurement.
LEAST_RAYS = 1 << 20
_BUILDER = "sah_binned"
_NAMES = {"optix": "OptiX", "optix-alone": "OptiX alone"}


def measured_meshes(files: Sequence[Rays]) -> list[RayMesh]:
    """The meshes of all files that were traced with enough rays to measure a rate."""
    return [mesh for file in files for mesh in file.meshes if min(mesh.rays.values()) >= LEAST_RAYS]


def family(mesh: str) -> str:
    """A mesh's name without its size."""
    return mesh.rpartition("_")[0] or mesh.partition(":")[0]


def peer_name(peer: Peer) -> str:
    """The display name of a peer."""
    return _NAMES.get(peer.name, peer.name)


def collect(files: Sequence[Rays], peers: Sequence[Peer]) -> series.Data:
    """The lines of one builder's trees; raises NotDrawable where no file has enough rays."""
    meshes = measured_meshes(files)
    if not meshes:
        raise NotDrawable(f"no mesh was traced by {LEAST_RAYS} rays or more")
    builders = dict.fromkeys(tree.builder for mesh in meshes for tree in mesh.trees if tree.builder)
    builder = _BUILDER if _BUILDER in builders else next(iter(builders), "")
    classes = list(dict.fromkeys(name for mesh in meshes for name in mesh.rays))
    families = list(dict.fromkeys(family(mesh.name) for mesh in meshes))
    lines: dict[tuple[str, str], dict[str, dict[int, Batch]]] = {}
    for mesh in meshes:
        for ray_class in mesh.rays:
            panel = lines.setdefault((ray_class, family(mesh.name)), {})
            for label, batch in _batches(mesh, builder, ray_class, peers):
                panel.setdefault(label, {})[mesh.triangles] = batch
    panels = [
        series.Panel(f"{name.replace('_', ' ')}: {of}", _lines(lines[name, of]))
        for name in classes
        for of in families
        if (name, of) in lines
    ]
    order = dict.fromkeys(one.label for panel in panels for one in panel.series)
    # Lines of OptiX, the reference, come first, so that their colours and markers are the same in all figures.
    order = sorted(order, key=lambda label: label not in _NAMES.values())
    return series.Data(
        "Rays a second by number of triangles",
        _caption(files, peers, meshes, builder),
        (),
        tuple(order),
        tuple(panels),
        "Triangles (log scale)",
        "G rays/s (log scale)",
        {float(mesh.triangles): series.count_text(mesh.triangles) for mesh in meshes},
    )


def _batches(mesh: RayMesh, builder: str, ray_class: str, peers: Sequence[Peer]) -> list[tuple[str, Batch]]:
    found = [
        (f"{tree.accelerator}, {batch.kernel.replace('_', ' ')}", batch)
        for tree in mesh.trees
        if tree.builder in ("", builder)
        for batch in tree.batches
        if batch.ray_class == ray_class
    ]
    of_peers = [
        (peer_name(peer), batch)
        for peer in peers
        if peer.mesh == mesh.name
        for batch in peer.batches
        if batch.ray_class == ray_class
    ]
    return [*of_peers, *found]


def _lines(panel: dict[str, dict[int, Batch]]) -> tuple[series.Series, ...]:
    return tuple(
        series.Series(
            label,
            tuple(sorted(points)),
            tuple(median_estimate(points[x].giga_rays_per_second) for x in sorted(points)),
        )
        for label, points in panel.items()
    )


def _caption(files: Sequence[Rays], peers: Sequence[Peer], meshes: Sequence[RayMesh], builder: str) -> str:
    counts = dict.fromkeys(count for mesh in meshes for count in mesh.rays.values())
    rays = ", ".join(f"{count:,}".replace(",", " ") for count in counts)
    kernels = list(dict.fromkeys(b.kernel for m in meshes for tree in m.trees for b in tree.batches))
    said = {
        "persistent": "persistent: warps that fetch rays and vote on the next step",
        "persistent_no_vote": "persistent no vote: the same without the vote",
        "plain": "plain: one thread a ray, the loop of path kernels",
    }
    devices = ", ".join(dict.fromkeys(map(_device, files)))
    commits = ", ".join(dict.fromkeys(file.about("git_sha")[:7] for file in files))
    parts = [
        f"{devices}; {rays} rays a batch, medians of {max(file.repetitions for file in files)}; bars: {INTERVAL_TEXT}, "
        f"mostly hidden by the marker. Trees of {builder}; closest hits, or any where the class asks for any. "
        + "; ".join(said[name] for name in kernels if name in said)
        + ".",
        f"ptbench {commits}.",
    ]
    if peers:
        versions = ", ".join(dict.fromkeys(f"{peer_name(peer)} {peer.by}" for peer in peers))
        parts.append(f"{versions}: the same rays and triangles in the same session on the same GPU.")
    return " ".join(parts)


def _device(file: Rays) -> str:
    return file.about("cuda_device" if file.backend == "cuda" else "cpu_model")
