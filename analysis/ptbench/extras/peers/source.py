"""A file of `python3 -m ptbench peers`, as a page asks it."""

from collections.abc import Iterator
from pathlib import Path

from ptbench.errors import FindingError
from ptbench.extras.peers.document import SCHEMA, Peer, Scene, row_of, scenes_of, shown_ratio
from ptbench.findings.commits import commit_of
from ptbench.findings.quantities import Quantity
from ptbench.findings.source import Source
from ptbench.numbers import figures


class PeersSource(Source, form=SCHEMA):
    """Scenes, and who was timed in them."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        if not self._value["complete"]:
            raise FindingError(f"{file}: an unfinished run; go on with --resume")
        self._context, self._settings = self._value["context"], self._value["settings"]
        self.scenes: list[Scene] = scenes_of(self._value)

    @property
    def commit(self) -> str:
        """The program's."""
        return commit_of(self._context["ptbench.version"])

    @property
    def folder(self) -> str:
        """Where its figures lie, under results/."""
        file = Path(self._shown)
        return f"{file.parent}/figures/{file.name.partition('.')[0]}"

    @property
    def settings(self) -> str:
        """What every scene was rendered with."""
        width, height = self._settings["resolution"]
        return (
            f"{width}x{height}, {self._settings['rounds']} rounds, pictures of {self._settings['seeds']} seeds with "
            f"{self._settings['spp']} samples a pixel each"
        )

    @property
    def device(self) -> str:
        """What all ran on."""
        threads = f", {self._context['processors']} processors" if self._settings["backend"] == "cpu" else ""
        return f"{self._context['device']}{threads}"

    @property
    def aim(self) -> str:
        """The bias of a mean that must be seen before there is a ratio."""
        return f"{figures(100 * self._settings['aim'], 2)} %"

    @property
    def allowed(self) -> str:
        """The bias that counts as none."""
        return f"{figures(100 * self._settings['allowed'], 2)} %"

    def rows(self, scene: Scene) -> list[str]:
        """The cells of a table: a peer a row."""
        return [" | ".join(row_of(scene, peer)) for peer in scene.peers]

    @property
    def left_out(self) -> list[str]:
        """What the times of each peer do not hold, and what it says of itself: a line each."""
        found: dict[str, str] = {}
        for peer in self._peers:
            about = {name: peer.value["about"][name] for name in ("version", "drjit") if name in peer.value["about"]}
            versions = ", ".join(f"{name} {value}" for name, value in about.items())
            found.setdefault(
                peer.name, f"{peer.name}{f' ({versions})' if versions else ''}: {peer.value['leaves_out']}"
            )
        return list(found.values())

    @property
    def without_ratio(self) -> list[str]:
        """Peers that no ratio may be given of, and why: a line each."""
        return [
            f"{scene.name}: {peer.name}: {peer.verdict}"
            for scene in self.scenes
            for peer in scene.peers
            if not peer.compares
        ]

    @property
    def best_others(self) -> list[str]:
        """A line for each scene: the other renderer whose cost is least, beside ptbench's variant whose cost is."""
        return [
            f"`{scene.name}`: {other.name} at {shown_ratio(other.measured.cost_over(best.measured))} times the cost of "
            f"{best.name}"
            for scene, best, other in self._leaders()
        ]

    def _leaders(self) -> Iterator[tuple[Scene, Peer, Peer]]:
        """For each scene, ptbench's variant and the other renderer with the least costs."""
        for scene in self.scenes:
            own = [peer for peer in scene.peers if peer.kind == "ptbench" and peer.compares]
            others = [peer for peer in scene.peers if peer.kind != "ptbench" and peer.compares]
            if own and others:
                yield scene, *(min(group, key=lambda peer: peer.measured.cost) for group in (own, others))

    def must_lead(self, factor: float, said: str) -> str:
        """`said`, if in every scene all others' cost is at least that many times ptbench's, by the whole interval."""
        ratios = [other.measured.cost_over(best.measured) for _, best, other in self._leaders()]
        if len(ratios) < len(self.scenes) or any(one.low is None or one.low < factor for one in ratios):
            raise FindingError(f"{self._shown}: costs are not {factor:g} times ptbench's; the page says: {said}")
        return said

    @property
    def disturbed(self) -> str:
        """How many of how many timed renders other processes took processors from."""
        renders = sum(len(peer.value["samples"]) for peer in self._peers)
        return f"{sum(peer.disturbed for peer in self._peers)} of {renders}"

    def time_over(self, scene: str, peer: str) -> Quantity:
        """Time a sample over that of ptbench's first variant with the same estimator."""
        place, one = self._named(scene, peer)
        return self._given(place.time_over(one), scene, one)

    def cost_over(self, scene: str, peer: str) -> Quantity:
        """Variance times time over that of the scene's first peer."""
        place, one = self._named(scene, peer)
        return self._given(place.cost_over(one), scene, one)

    @property
    def provenance(self) -> str:
        """A line of a list."""
        return f"- {self._link}: {self.device}, {self._context['date'][:10]}, {self._context['ptbench.version']}."

    @property
    def _peers(self) -> list[Peer]:
        return [peer for scene in self.scenes for peer in scene.peers]

    def _named(self, scene: str, peer: str) -> tuple[Scene, Peer]:
        for place in self.scenes:
            for one in place.peers:
                if (place.name, one.name) == (scene, peer):
                    return place, one
        raise FindingError(f"{self._shown}: no {peer} in {scene}")

    def _given(self, estimate, scene: str, peer: Peer) -> Quantity:
        if estimate is None:
            raise FindingError(f"{self._shown}: no ratio of {peer.name} in {scene} may be given: {peer.verdict}")
        return Quantity(estimate, f"{peer.name} in {scene}")
