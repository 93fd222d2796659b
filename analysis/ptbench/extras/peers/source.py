"""A file of `python3 -m ptbench peers` as a source of numbers for a page."""

from collections.abc import Iterator
from pathlib import Path

from ptbench.errors import FindingError
from ptbench.extras.peers.document import SCHEMA, Peer, Scene, row_of, scenes_of, shown_ratio
from ptbench.findings.commits import commit_of
from ptbench.findings.quantities import Quantity
from ptbench.findings.source import Source
from ptbench.numbers import figures


class PeersSource(Source, form=SCHEMA):
    """The scenes of a `peers` file, and the renderers timed in them."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        if not self._value["complete"]:
            raise FindingError(f"{file}: an unfinished run; go on with --resume")
        self._context, self._settings = self._value["context"], self._value["settings"]
        self.scenes: list[Scene] = scenes_of(self._value)

    @property
    def commit(self) -> str:
        """The commit of the ptbench program that was timed."""
        return commit_of(self._context["ptbench.version"])

    @property
    def folder(self) -> str:
        """The folder of the file's figures, under results/."""
        file = Path(self._shown)
        return f"{file.parent}/figures/{file.name.partition('.')[0]}"

    @property
    def settings(self) -> str:
        """The settings of every render in the file, in words."""
        width, height = self._settings["resolution"]
        return (
            f"{width}x{height}, {self._settings['rounds']} rounds, pictures of {self._settings['seeds']} seeds with "
            f"{self._settings['spp']} samples a pixel each"
        )

    @property
    def device(self) -> str:
        """The device that all peers ran on."""
        threads = f", {self._context['processors']} processors" if self._settings["backend"] == "cpu" else ""
        return f"{self._context['device']}{threads}"

    @property
    def aim(self) -> str:
        """The bias of the mean that the comparison must be able to detect before a ratio is given."""
        return f"{figures(100 * self._settings['aim'], 2)} %"

    @property
    def allowed(self) -> str:
        """The bias of the mean that counts as none."""
        return f"{figures(100 * self._settings['allowed'], 2)} %"

    def rows(self, scene: Scene) -> list[str]:
        """The rows of a scene's table, one per peer."""
        return [" | ".join(row_of(scene, peer)) for peer in scene.peers]

    @property
    def left_out(self) -> list[str]:
        """For each peer, a line on what its times exclude and which version it is."""
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
        """A line for each peer without a ratio, with the reason."""
        return [
            f"{scene.name}: {peer.name}: {peer.verdict}"
            for scene in self.scenes
            for peer in scene.peers
            if not peer.compares
        ]

    @property
    def best_others(self) -> list[str]:
        """A line for each scene: the other renderer with the least cost, beside ptbench's variant with the least."""
        return [
            f"`{scene.name}`: {other.name} at {shown_ratio(other.measured.cost_over(best.measured))} times the cost of "
            f"{best.name}"
            for scene, best, other in self._leaders()
        ]

    def _leaders(self) -> Iterator[tuple[Scene, Peer, Peer]]:
        """For each scene, the ptbench variant and the other renderer with the least costs."""
        for scene in self.scenes:
            own = [peer for peer in scene.peers if peer.kind == "ptbench" and peer.compares]
            others = [peer for peer in scene.peers if peer.kind != "ptbench" and peer.compares]
            if own and others:
                yield scene, *(min(group, key=lambda peer: peer.measured.cost) for group in (own, others))

    def must_lead(self, factor: float, said: str) -> str:
        """Returns `said` if in every scene all others cost at least `factor` times ptbench's, by the whole interval."""
        ratios = [other.measured.cost_over(best.measured) for _, best, other in self._leaders()]
        if len(ratios) < len(self.scenes) or any(one.low is None or one.low < factor for one in ratios):
            raise FindingError(f"{self._shown}: costs are not {factor:g} times ptbench's; the page says: {said}")
        return said

    @property
    def disturbed(self) -> str:
        """How many of all timed renders other processes disturbed."""
        renders = sum(len(peer.value["samples"]) for peer in self._peers)
        return f"{sum(peer.disturbed for peer in self._peers)} of {renders}"

    def time_over(self, scene: str, peer: str) -> Quantity:
        """A peer's time per sample over that of the first ptbench variant with the same estimator."""
        place, one = self._named(scene, peer)
        return self._given(place.time_over(one), scene, one)

    def cost_over(self, scene: str, peer: str) -> Quantity:
        """A peer's variance times time over that of the scene's first peer."""
        place, one = self._named(scene, peer)
        return self._given(place.cost_over(one), scene, one)

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its device, date and version."""
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
