"""The figure and the table of files of `ptbench rays`: of one file, or of a folder with a peer's."""

from collections.abc import Sequence
from pathlib import Path

from ptbench.document.blocks import Lines
from ptbench.document.markdown import markdown
from ptbench.document.table import table_of
from ptbench.figures import rays_by_triangles, series
from ptbench.figures.saving import save_if_drawable
from ptbench.io.files import make_folder, write_text
from ptbench.io.rays import Peer, RayMesh, Rays, peer_batch
from ptbench.numbers import figures, interval, share
from ptbench.stats.estimates import INTERVAL_TEXT, median_estimate
from ptbench.terminal import say

FIGURE = "rays_by_triangles"
_COLUMNS = (
    "Mesh", "Triangles", "Accelerator", "Builder", "Class", "Kernel", "G rays/s", "95 % interval", "Over the peer",
    "Nodes/ray", "Boxes/ray", "Triangles/ray",
)  # fmt: skip
_TREES = (
    "Mesh", "Accelerator", "Builder", "SAH cost", "Nodes, MB", "Leaves, MB", "Build, ms", "Encode, ms",
    "Build on the GPU, ms", "Encode on the GPU, ms",
)  # fmt: skip
_COUNTERS = (
    "Mesh", "Accelerator", "Builder", "Class", "Kernel", "Active lanes", "Instructions/ray", "Bytes/ray", "Occupancy",
    "Issue", "ALU", "L1", "L2", "Memory", "L1 hits", "L2 hits", "Waiting for memory", "Nearest ceiling",
)  # fmt: skip


def rays_plots(files: Sequence[Rays], peers: Sequence[Peer], folder: Path) -> int:
    """Draws and writes the figures into `folder`; returns the exit code."""
    make_folder(folder)
    reason = save_if_drawable(lambda: series.draw(rays_by_triangles.collect(files, peers)), folder, FIGURE)
    say(write_text(folder / "summary.md", summary(files, peers, reason)))
    return 0


def summary(files: Sequence[Rays], peers: Sequence[Peer], not_drawn: str = "") -> str:
    """The summary page of ray rates as Markdown."""
    lines: Lines = ["# rays: what was measured", ""]
    for file in files:
        device = file.about("cuda_device" if file.backend == "cuda" else "cpu_model")
        lines.append(
            f"- {file.path.name}: {device}, {file.repetitions} repetitions; ptbench {file.about('version')}, "
            f"git {file.about('git_sha')}, {file.context.get('date', 'no date')}; `{file.about('command_line')}`"
        )
    lines += [f"- {peer.path.name}: {peer.by}, {peer.hits_differ} hits differ" for peer in peers]
    how = (
        f"Rates are rays over the median time of a batch. Intervals: {INTERVAL_TEXT}. Builds and encodings by the host "
        "were timed once; those on the GPU are medians."
    )
    lines += ["", how, ""]
    if not_drawn:
        lines += [f"Not drawn: {not_drawn}", ""]
    meshes = [mesh for file in files for mesh in file.meshes]
    lines += ["## Batches", "", table_of(_COLUMNS, _batches(meshes, peers), set(_COLUMNS[6:]) | {"Triangles"}), ""]
    if counted := _counted(meshes):
        about = "By ncu: parts of ceilings that the same call measured, of the caches of ncu's own peaks."
        lines += ["## Counters", "", about, "", table_of(_COUNTERS, counted, set(_COUNTERS[5:-1])), ""]
    lines += ["## Trees", "", table_of(_TREES, _trees(meshes), set(_TREES[3:])), ""]
    return markdown(lines)


def _batches(meshes: Sequence[RayMesh], peers: Sequence[Peer]) -> list[tuple[str, ...]]:
    rows = []
    for mesh in meshes:
        for tree in mesh.trees:
            for batch in tree.batches:
                rate = median_estimate(batch.giga_rays_per_second)
                peer = peer_batch(peers, mesh.name, batch.ray_class)
                other = "—" if peer is None else figures(rate.value / _rate(peer[1].giga_rays_per_second), 3)
                counts = (batch.nodes_per_ray, batch.boxes_per_ray, batch.triangles_per_ray)
                rows.append(
                    (
                        mesh.name, str(mesh.triangles), tree.accelerator, tree.builder or "—", batch.ray_class,
                        batch.kernel, figures(rate.value), interval(rate.low, rate.high), other,
                        *("—" if count is None else figures(count) for count in counts),
                    )
                )  # fmt: skip
    return rows


def _counted(meshes: Sequence[RayMesh]) -> list[tuple[str, ...]]:
    return [
        (
            mesh.name, tree.accelerator, tree.builder or "—", batch.ray_class, batch.kernel,
            *(figures(value, 3) for value in (
                counters.active_lanes, counters.thread_instructions_per_ray, counters.memory_bytes_per_ray,
            )),
            share(counters.achieved_occupancy),
            *(share(counters.of_ceiling.get(name)) for name in ("issue", "alu", "l1", "l2", "memory")),
            *(share(value) for value in (counters.l1_hit_rate, counters.l2_hit_rate, counters.memory_stalls)),
            counters.bound,
        )
        for mesh in meshes
        for tree in mesh.trees
        for batch in tree.batches
        if (counters := batch.counters) is not None
    ]  # fmt: skip


def _rate(values) -> float:
    return median_estimate(values).value


def _trees(meshes: Sequence[RayMesh]) -> list[tuple[str, ...]]:
    return [
        (
            mesh.name, tree.accelerator, tree.builder or "—", figures(tree.sah_cost), figures(tree.node_bytes / 1e6),
            figures(tree.leaf_bytes / 1e6), figures(tree.build_ms), figures(tree.encode_ms),
            *("—" if not times else figures(_rate(times)) for times in (tree.device_build_ms, tree.device_encode_ms)),
        )
        for mesh in meshes
        for tree in mesh.trees
    ]  # fmt: skip
