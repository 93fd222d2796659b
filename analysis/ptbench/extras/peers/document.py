"""Reads the file of a `peers` run (schema/ptbench-peers.schema.json), and prints its table."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ptbench.crosscheck.document import AGREES
from ptbench.document.table import table_of
from ptbench.document.text import aligned
from ptbench.extras.peers.statistics import Measured, by_round
from ptbench.io.cells import GPU_BACKEND, MOST_HOST_SHARE
from ptbench.io.limits import limit
from ptbench.numbers import figures, interval
from ptbench.stats.estimates import Estimate, interval_of_ratio

SCHEMA = "ptbench-peers-1"
# Largest share of a render's wall time that other processes may take before its time is in doubt.
MOST_FOREIGN = limit("most_foreign_share")


@dataclass(frozen=True)
class Peer:
    """One renderer (peer) in one scene, from the file."""

    value: dict
    on_gpu: bool

    @property
    def name(self) -> str:
        """The peer's name in tables."""
        return self.value["name"]

    @property
    def kind(self) -> str:
        """The kind of peer: ptbench, mitsuba or program."""
        return self.value["kind"]

    @property
    def estimator(self) -> str:
        """The estimator of the peer: nee_mis (next-event estimation with MIS) or off (BSDF sampling only)."""
        return self.value["estimator"]

    @property
    def verdict(self) -> str:
        """The verdict of comparing the peer's picture with the first peer's; for a failed peer the reason."""
        if self.value["status"] != "ok":
            return f"failed: {self.value['reason']}"
        return self.value["picture"]["verdict"] if "picture" in self.value else "not measured"

    @property
    def compares(self) -> bool:
        """Whether the peer may be given a ratio: it ran, was timed, and its picture agrees with the reference."""
        return self.verdict == AGREES and self.has_times

    @property
    def has_times(self) -> bool:
        """Whether the peer was timed."""
        return bool(self.value["samples"])

    @cached_property
    def measured(self) -> Measured:
        """The peer's times and variances, from which ratios are computed."""
        return Measured(by_round(self.value["samples"]), np.array(self.value["picture"]["variance_of_seeds"]))

    @property
    def disturbed(self) -> int:
        """The number of renders that other processes disturbed; renders of unknown load count."""
        return sum(_is_disturbed(sample, self.on_gpu) for sample in self.value["samples"])


def _is_disturbed(sample: dict, on_gpu: bool) -> bool:
    foreign, device = sample["foreign_cpu_ms"], sample["device_ms"]
    # Other processes delay a GPU's renders only through the host, and never those whose kernels alone are timed.
    if on_gpu and (device is None or 1 - device / sample["ms"] <= MOST_HOST_SHARE):
        return False
    # CPU time of other processes below one tick of the system's clock, 10 ms, proves no disturbance.
    return foreign is None or foreign > max(10.0, MOST_FOREIGN * sample["wall_ms"])


@dataclass(frozen=True)
class Scene:
    """The peers of one scene."""

    value: dict
    on_gpu: bool

    @property
    def name(self) -> str:
        """The scene's name or file, as it was asked for."""
        return self.value["scene"]

    @cached_property
    def peers(self) -> tuple[Peer, ...]:
        """The peers in the order of the call; the first is the reference."""
        return tuple(Peer(value, self.on_gpu) for value in self.value["peers"])

    @property
    def reference(self) -> Peer:
        """The peer against which pictures and efficiencies are compared."""
        return self.peers[0]

    def base_of(self, peer: Peer) -> Peer | None:
        """The first ptbench variant with the same estimator as the peer."""
        own = (one for one in self.peers if one.kind == "ptbench" and one.estimator == peer.estimator and one.compares)
        return next(own, None)

    def time_over(self, peer: Peer) -> Estimate | None:
        """The peer's time per sample over the first ptbench variant's with its estimator; None: not comparable."""
        base = self.base_of(peer)
        return peer.measured.time_over(base.measured) if base is not None and peer.compares else None

    def cost_over(self, peer: Peer) -> Estimate | None:
        """The peer's variance times time over the reference's; None where they are not comparable."""
        return peer.measured.cost_over(self.reference.measured) if peer.compares and self.reference.compares else None


def scenes_of(document: dict) -> list[Scene]:
    """The scenes of a run's document, in order."""
    on_gpu = document["settings"]["backend"] == GPU_BACKEND
    return [Scene(value, on_gpu) for value in document["scenes"]]


def shown_ratio(estimate: Estimate | None) -> str:
    """A ratio as "25.1 [24.9, 25.3]", or a dash."""
    if estimate is None:
        return "—"
    return f"{figures(estimate.value, 3)} {interval_of_ratio(estimate)}".rstrip()


def shown_with_interval(estimate: Estimate) -> str:
    """A value as "1.41 [1.40, 1.42]"."""
    return f"{figures(estimate.value, 3)} {interval(estimate.low, estimate.high, 3)}"


HEAD = ("peer", "ms a spp", "variance a sample", "time over ptbench's", "cost over the first's", "picture")
RULE = (
    "time over ptbench's: of its first variant with the same estimator. cost: variance times time, the reciprocal of "
    "efficiency, over that of the first peer. Above 1: that one is ahead. No ratio unless the pictures agree."
)


def row_of(scene: Scene, peer: Peer) -> tuple[str, ...]:
    """The cells of a peer's row in the table."""
    timed = peer.has_times and "picture" in peer.value
    return (
        peer.name,
        shown_with_interval(peer.measured.time) if timed else "—",
        shown_with_interval(peer.measured.noise) if timed else "—",
        "1" if peer is scene.base_of(peer) else shown_ratio(scene.time_over(peer)),
        "1" if peer is scene.reference and peer.compares else shown_ratio(scene.cost_over(peer)),
        peer.verdict,
    )


def as_text(document: dict) -> list[str]:
    """The tables of all scenes as text, with the meaning of their columns."""
    lines: list[str] = []
    for scene in scenes_of(document):
        table = table_of(HEAD, (row_of(scene, peer) for peer in scene.peers))
        lines += [scene.name, *(f"  {line}" for line in aligned(table)), ""]
    disturbed = sum(peer.disturbed for scene in scenes_of(document) for peer in scene.peers)
    renders = sum(len(peer.value["samples"]) for scene in scenes_of(document) for peer in scene.peers)
    return [*lines, RULE, f"disturbed by other processes: {disturbed} of {renders} timed renders"]
