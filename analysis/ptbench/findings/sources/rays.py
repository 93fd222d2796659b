"""A folder of `ptbench rays` with a peer's files as a source for a page: rates, and time ratios for equal rays.

A selection is a few words: "mesh=tori_4M class=primary accelerator=cwbvh builder=hploc kernel=persistent". A word that
is left out matches any value, and `diffuse_*` matches every value with that beginning.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from ptbench.errors import FindingError
from ptbench.figures.rays_by_triangles import family, measured_meshes, peer_name
from ptbench.findings.commits import shown_commit
from ptbench.findings.quantities import Quantity, Ratio, Ratios
from ptbench.findings.source import FOLDER, Source
from ptbench.io.rays import Batch, RayMesh, Tree, load_rays_folder, peer_batch
from ptbench.numbers import figures, share
from ptbench.stats.estimates import Estimate, median_estimate, ratio_estimate, verdict_of_ratio
from ptbench.studies.programs import devices_of, why_not_one
from ptbench.studies.selection import parsed

# Largest share of rays whose hits may differ between programs, as triangle tests do at edges.
MOST_APART = 1e-6
# Throughput ceilings as pages of findings name them, by their names in result files.
CEILINGS = {
    "issue": "issue", "fma": "multiply-adds", "alu": "ALU", "xu": "XU", "l1": "L1", "l2": "L2", "memory": "memory",
}  # fmt: skip
_NAMES = ("mesh", "class", "accelerator", "builder", "kernel")


@dataclass(frozen=True)
class Traced:
    """One batch of rays with its tree, mesh and file."""

    mesh: RayMesh
    tree: Tree
    batch: Batch

    @property
    def counters_row(self) -> str:
        """A table row of counters: lanes, instructions and bytes per ray, occupancy, ceilings, stalls, the nearest."""
        one = self.batch.counters
        if one is None:
            raise FindingError(f"{self.text}: no counters")
        counts = (one.active_lanes, one.thread_instructions_per_ray, one.memory_bytes_per_ray)
        parts = (one.of_ceiling.get(name) for name in ("issue", "alu", "l1", "l2", "memory"))
        return " | ".join(
            (
                *(figures(count, 3) for count in counts),
                share(one.achieved_occupancy),
                *map(share, parts),
                share(one.memory_stalls),
                CEILINGS[one.bound],
            )
        )

    @property
    def names(self) -> dict[str, str]:
        """The values of the batch that a selection may match."""
        values = (self.mesh.name, self.batch.ray_class, self.tree.accelerator, self.tree.builder, self.batch.kernel)
        return dict(zip(_NAMES, values, strict=True))

    @property
    def text(self) -> str:
        """The batch in words, for messages."""
        return " ".join(f"{name}={value}" for name, value in self.names.items())


class RaysFolder(Source, form=FOLDER):
    """All files of a folder of `ptbench rays`; meshes with too few rays to measure a rate are left out."""

    def __init__(self, results: Path, folder: str) -> None:
        super().__init__(results, folder)
        self.files, self.peers = load_rays_folder(results / folder)
        self.meshes = sorted(measured_meshes(self.files), key=lambda mesh: (family(mesh.name), mesh.triangles))
        if wrong := [mesh.name for mesh in self.meshes if not all(mesh.agree.values())]:
            raise FindingError(f"{folder}: hits differ between trees of {', '.join(wrong)}")
        self._traced = [Traced(m, tree, batch) for m in self.meshes for tree in m.trees for batch in tree.batches]

    def traced(self, selection: str = "") -> list[Traced]:
        """Every batch of a selection; raises FindingError for an empty selection or a duplicate batch."""
        chosen = parsed(selection)
        if unknown := chosen.keys() - set(_NAMES):
            raise FindingError(f"{self._shown}: no batch has {', '.join(sorted(unknown))}")
        found = [
            one for one in self._traced if all(fnmatchcase(one.names[name], value) for name, value in chosen.items())
        ]
        if not found:
            raise FindingError(f"{self._shown}: no batch is {selection}")
        texts = [one.text for one in found]
        if twice := [text for text in dict.fromkeys(texts) if texts.count(text) > 1]:
            raise FindingError(f"{self._shown}: measured twice: {twice[0]}")
        return found

    def rate(self, selection: str) -> Quantity:
        """The rate of the one batch of a selection, 1e9 rays per second."""
        one = self._one(selection)
        return Quantity(median_estimate(one.batch.giga_rays_per_second), one.text)

    def rate_if(self, selection: str) -> str:
        """The rate of a selection as text, or a dash where it was not measured."""
        try:
            return str(self.rate(selection))
        except FindingError:
            return "—"

    def best(self, selection: str) -> Traced:
        """The batch of a selection with the highest rate."""
        return max(self.traced(selection), key=lambda one: float(np.median(one.batch.giga_rays_per_second)))

    def rate_of(self, one: Traced) -> Quantity:
        """The rate of a batch, 1e9 rays per second."""
        return Quantity(median_estimate(one.batch.giga_rays_per_second), one.text)

    def peer_rate(self, mesh: str, ray_class: str) -> Quantity:
        """The peer's rate for a class of rays over a mesh, 1e9 rays per second."""
        batch = self._peer(mesh, ray_class)
        return Quantity(median_estimate(batch.giga_rays_per_second), f"{batch.kernel} on {mesh}, {ray_class}")

    def over_peer(self, one: Traced) -> Ratio:
        """The time of a batch over the peer's time for the same rays."""
        batch = self._peer(one.mesh.name, one.batch.ray_class)
        if batch.rays != one.batch.rays:
            raise FindingError(f"{one.text}: {one.batch.rays} rays, but the peer traced {batch.rays}")
        return _ratio(one.batch, batch, f"{one.text} over {batch.kernel}")

    def best_over_peer(self, ray_class: str) -> Ratios:
        """ptbench's least time over the peer's, for each mesh that the peer traced, in one class of rays."""
        meshes = [mesh for mesh in self.meshes if peer_batch(self.peers, mesh.name, ray_class) is not None]
        return Ratios(tuple(self.over_peer(self.best(f"mesh={mesh.name} class={ray_class}")) for mesh in meshes))

    def ratios(self, selection: str, over: str) -> Ratios:
        """Times of a selection's batches, each over the batch that differs by the words of `over`."""
        others = parsed(over)
        found = []
        for one in self.traced(selection):
            wanted = {**one.names, **others}
            if wanted != one.names:
                base = self._one(" ".join(f"{name}={value}" for name, value in wanted.items()))
                found.append(_ratio(one.batch, base.batch, f"{one.text} over {over}"))
        if not found:
            raise FindingError(f"{self._shown}: nothing to hold against {over}: {selection}")
        return Ratios(tuple(found))

    def ratios_over(self, selection: str, other: RaysFolder) -> Ratios:
        """Times of a selection's batches, each over the same batch in another folder, where that exists."""
        files = [*self.files, *other.files]
        if len({devices_of(file) for file in files}) > 1 and (reason := why_not_one(files)):
            raise FindingError(f"{self._shown} and {other._shown} cannot be compared as machines: {reason}")
        there = {one.text: one for one in other.traced()}
        found = []
        for one in self.traced(selection):
            base = there.get(one.text)
            if base is None:
                continue
            if base.batch.rays != one.batch.rays:
                raise FindingError(f"{one.text}: {one.batch.rays} rays here, {base.batch.rays} there")
            found.append(_ratio(one.batch, base.batch, f"{one.text} over {other.device}"))
        if not found:
            raise FindingError(f"{self._shown}: nothing in common: {selection}")
        return Ratios(tuple(found))

    def tree(self, mesh: str, accelerator: str, builder: str) -> Tree:
        """The tree of a mesh with that accelerator and builder."""
        return self.traced(f"mesh={mesh} accelerator={accelerator} builder={builder}")[0].tree

    def device_ms(self, mesh: str, accelerator: str, builder: str, what: str) -> Quantity:
        """Median GPU time to `build` or `encode` a tree, ms."""
        times = getattr(self.tree(mesh, accelerator, builder), f"device_{what}_ms")
        if not times:
            raise FindingError(f"{self._shown}: {mesh} {accelerator} {builder}: no {what} on the GPU")
        return Quantity(median_estimate(np.array(times)), f"{what} of {builder}, {mesh}")

    def host_encode_ms(self, mesh: str, accelerator: str, builder: str) -> Quantity:
        """The host's time to encode a tree, measured once, ms."""
        tree = self.tree(mesh, accelerator, builder)
        return Quantity(Estimate(tree.encode_ms, None, None, 1), f"encoding of {builder}, {mesh}")

    def sah_over(self, mesh: str, accelerator: str, builder: str, over: str) -> Quantity:
        """The SAH cost of one builder's tree over another's."""
        one, base = (self.tree(mesh, accelerator, name).sah_cost for name in (builder, over))
        return Quantity(Estimate(one / base, None, None, 1), f"SAH cost of {builder} over {over}, {mesh}")

    @property
    def counted(self) -> list[Traced]:
        """The batches with hardware counters, in the files' order; raises FindingError if there are none."""
        found = [one for one in self._traced if one.batch.counters is not None]
        if not found:
            raise FindingError(f"{self._shown}: no batch has counters")
        return found

    @property
    def nearest_ceiling(self) -> str:
        """The ceilings that the counted batches come nearest to, and the fraction they reach: "ALU, 47 % to 71 %"."""
        counters = [one.batch.counters for one in self.counted]
        shares = [one.of_ceiling[one.bound] for one in counters]
        names = " or ".join(dict.fromkeys(CEILINGS[one.bound] for one in counters))
        return f"{names}, {' to '.join(dict.fromkeys((share(min(shares)), share(max(shares)))))}"

    @property
    def classes(self) -> list[str]:
        """The classes of rays, in the files' order."""
        return list(dict.fromkeys(name for mesh in self.meshes for name in mesh.rays))

    @property
    def accelerators(self) -> list[str]:
        """The accelerators, in the files' order."""
        return list(dict.fromkeys(one.tree.accelerator for one in self._traced))

    @property
    def peer(self) -> str:
        """The name and version of the peer."""
        return ", ".join(dict.fromkeys(f"{peer_name(peer)} ({peer.by})" for peer in self.peers))

    @property
    def hits_apart(self) -> int:
        """The total difference between ptbench's and the peer's numbers of hits; raises FindingError if too large."""
        apart, rays = sum(peer.hits_differ for peer in self.peers), self.peer_rays
        if apart > MOST_APART * rays:
            raise FindingError(f"{self._shown}: hits differ from the peer's by {apart} of {rays}")
        return apart

    @property
    def peer_rays(self) -> int:
        """The number of rays that the peer traced, over all batches."""
        return sum(batch.rays for peer in self.peers for batch in peer.batches)

    @property
    def rays(self) -> str:
        """The number of rays of a batch, in millions."""
        counts = {count for mesh in self.meshes for count in mesh.rays.values()}
        return " or ".join(f"{count / 1e6:.1f}" for count in sorted(counts))

    @property
    def device(self) -> str:
        """The name of the GPU that traced the rays."""
        return ", ".join(dict.fromkeys(file.about("cuda_device") for file in self.files))

    @property
    def commit(self) -> str:
        """The commit of the earliest file, seven digits."""
        return min(self.files, key=lambda file: file.context.get("date", "")).about("git_sha")[:7]

    @property
    def provenance(self) -> str:
        """A Markdown list item with the folder, its contents and its commits."""
        commits = ", ".join(dict.fromkeys(shown_commit(self._results, file.about("git_sha")) for file in self.files))
        summary = f"{Path(self._shown).parent}/figures/{Path(self._shown).name}/summary.md"
        every_row = f" Every row: [summary](../../results/{summary})." if (self._results / summary).exists() else ""
        return (
            f"- [{self._shown}](../../results/{self._shown}): `ptbench rays`, {len(self.files)} files, and "
            f"{len(self.peers)} of the peer; commit {commits}.{every_row}"
        )

    def _one(self, selection: str) -> Traced:
        found = self.traced(selection)
        if len(found) > 1:
            raise FindingError(f"{self._shown}: {len(found)} batches are {selection}")
        return found[0]

    def _peer(self, mesh: str, ray_class: str) -> Batch:
        found = peer_batch(self.peers, mesh, ray_class)
        if found is None:
            raise FindingError(f"{self._shown}: no peer traced {ray_class} on {mesh}")
        return found[1]


def _ratio(batch: Batch, base: Batch, of: str) -> Ratio:
    estimate = ratio_estimate(np.array(batch.ms), np.array(base.ms))
    return Ratio(estimate, verdict_of_ratio(estimate), of)
