"""A file of `python3 -m ptbench crosscheck` as a source of numbers for a page."""

from __future__ import annotations

from pathlib import Path

from ptbench.crosscheck.document import spp_of
from ptbench.crosscheck.pooled import Pooled, pooled
from ptbench.errors import FindingError
from ptbench.findings.commits import commit_of
from ptbench.findings.source import Source
from ptbench.numbers import figures

_ALIKE = ("resolution", "scale", "allowed")  # settings that must be equal in cross-checks that are pooled


def _percent(share: float, digits: int = 2) -> str:
    return f"{figures(100 * share, digits)} %"


class CrosscheckSource(Source, form="ptbench-crosscheck-1"):
    """Scenes that were cross-checked against Mitsuba, with their verdicts."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        value = self._value
        self._context, self._settings, self._scenes = value["context"], value["settings"], value["scenes"]
        self._first_seed: int = value.get("call", {}).get("first_seed", 1)

    @property
    def commit(self) -> str:
        """The commit of the ptbench program that was cross-checked."""
        return commit_of(self._context["ptbench.version"])

    def _of(self, *verdicts: str) -> list[dict]:
        return [scene for scene in self._scenes if scene["verdict"] in verdicts]

    @property
    def compared(self) -> int:
        """The number of scenes that were rendered in both renderers."""
        return len(self._of("agrees", "differs", "too weak"))

    @property
    def agreeing(self) -> int:
        """The number of scenes that agree, at the requested statistical power."""
        return len(self._of("agrees"))

    @property
    def weak(self) -> list[str]:
        """Scenes in which a bias as large as the aim may have been missed."""
        return [scene["scene"] for scene in self._of("too weak")]

    @property
    def differing(self) -> list[str]:
        """Scenes whose images differ between the renderers."""
        return [scene["scene"] for scene in self._of("differs")]

    def must_agree(self, said: str) -> str:
        """Returns `said` if no scene differs; otherwise raises FindingError."""
        if self.differing:
            raise FindingError(f"{self._shown}: {', '.join(self.differing)} differ; the page says: {said}")
        return said

    @staticmethod
    def must_be_one(found: Pooled, said: str) -> str:
        """Returns `said` unless the pooled cross-checks differ; otherwise raises FindingError."""
        if found.verdict == "differs":
            raise FindingError(f"calls taken together differ by {found.bias}; the page says: {said}")
        return said

    @staticmethod
    def worst(found: Pooled) -> str:
        """The largest bias of a channel, relative to the mean, with its standard error."""
        channel = max(range(len(found.bias)), key=lambda i: abs(found.bias[i]))
        bias, error = found.bias[channel], found.errors[channel]
        return f"{'+' if bias > 0 else ''}{_percent(bias)} ± {_percent(error)}"

    @staticmethod
    def seen(found: Pooled) -> str:
        """The bias that the pooled test would have detected."""
        return _percent(found.sees)

    def together(self, scene: str, *others: CrosscheckSource) -> Pooled:
        """A scene of this file pooled with its cross-checks in other files, which have other seeds."""
        found = [
            (one, source._settings["seeds"])
            for source in (self, *others)
            for one in source._of("agrees", "differs", "too weak")
            if one["scene"] == scene
        ]
        ways = {tuple(str(source._settings[name]) for name in _ALIKE) for source in (self, *others)}
        if len(ways) != 1 or self._settings["allowed"] != 0:
            raise FindingError(f"{self._shown} and others: {', '.join(_ALIKE)} are not alike, or not all is told")
        if len(found) != 1 + len(others):
            raise FindingError(f"{self._shown} and others: {scene} is in {len(found)} of {1 + len(others)} files")
        return pooled(found)

    @property
    def mitsuba(self) -> str:
        """Mitsuba's version and variant, as text."""
        return f"{self._context['mitsuba.version']} (`{self._context['mitsuba.variant']}`)"

    @property
    def variant(self) -> str:
        """Mitsuba's variant."""
        return self._context["mitsuba.variant"]

    @property
    def settings(self) -> str:
        """The settings of every render of the cross-check, as text."""
        width, height = self._settings["resolution"]
        return f"{width}x{height}, {self._settings['seeds']} seeds in each renderer"

    @property
    def aim(self) -> str:
        """The bias that the cross-check was to detect."""
        return _percent(max(scene["aim"] for scene in self._scenes))

    @property
    def power(self) -> str:
        """The probability of detecting a bias as large as the aim."""
        return _percent(self._settings["power"])

    @property
    def family(self) -> str:
        """The probability of a false alarm over all scenes of the call.

        A scene that was first too noisy had another chance of a false alarm each time that it was rendered again.
        """
        scenes = self._settings["family_scenes"]
        again = sum(self._renders(scene) - 1 for scene in self._scenes)
        return _percent(self._settings["family"] * (scenes + again) / scenes)

    def _renders(self, scene: dict) -> int:
        """How often a scene was rendered: once, and again with later seeds where it was too noisy."""
        return 1 + (scene.get("first_seed", 1) - self._first_seed) // self._settings["seeds"]

    def told_apart(self, *others: CrosscheckSource, with_pooled: Pooled | None = None) -> str:
        """Upper bound on the probability that equal renderers are told apart in any scene of these files, or in a pool.

        A scene has its call's share each time that it was rendered. A share smaller than another call's only widens
        limits, so calls with different numbers of scenes can be combined.
        """
        shares = (
            one._settings["family"] / one._settings["family_scenes"] * one._renders(scene)
            for one in (self, *others)
            for scene in one._scenes
            if "image" in scene
        )
        return _percent(sum(shares) + (len(with_pooled.bias) * with_pooled.limit_p if with_pooled else 0))

    def shared_by(self, *others: CrosscheckSource) -> int:
        """The number of scenes that share `family`; raises FindingError for files of calls that do not share one."""
        counts = {one._settings.get("family_scenes") for one in (self, *others)}
        names = [scene["scene"] for one in (self, *others) for scene in one._scenes if "image" in scene]
        if len(counts) != 1 or None in counts or len(set(names)) < len(names):
            raise FindingError(f"{self._shown}: its scenes and the other files' do not share one probability")
        return counts.pop()

    @property
    def missing(self) -> int:
        """The number of scenes of the call that are not rendered yet."""
        return self._settings["family_scenes"] - len(self._scenes)

    @property
    def largest_bias(self) -> str:
        """The largest bias of the image means among scenes that agree."""
        biases = [bias for scene in self._of("agrees") for bias in scene["image"]["bias"]]
        return _percent(max(map(abs, biases)))

    @property
    def blocks_beyond(self) -> int:
        """The number of block means beyond their limit, each channel by itself."""
        return sum(scene["blocks"]["beyond"] for scene in self._scenes if "blocks" in scene)

    @property
    def blocks(self) -> int:
        """The number of block means that were compared, each channel by itself."""
        return sum(scene["blocks"]["count"] for scene in self._scenes if "blocks" in scene)

    @property
    def rows(self) -> list[str]:
        """The rows of the table of scenes."""
        return [_row(scene) for scene in self._scenes if "image" in scene]

    def refused(self, *others: CrosscheckSource) -> list[str]:
        """A line for each scene that Mitsuba cannot render to the same picture, and that no other file has."""
        had = {scene["scene"] for other in others for scene in other._scenes if "image" in scene}
        told = [scene for scene in self._of("not expressible") if scene["scene"] not in had]
        return [f"`{scene['scene']}`: {_short(scene['reasons'])}" for scene in told]

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file, its machine, date and version."""
        date = self._context["date"][:10]
        version = self._context["ptbench.version"]
        return f"- {self._link}: {self._context['ptbench.machine']}, {date}, {version}."


def _short(reasons: list[str]) -> str:
    """The places and values of refusals, without what is allowed."""
    return "; ".join(f"`{place}` {found}" for place, found in map(_place_and_found, reasons))


def _place_and_found(reason: str) -> tuple[str, str]:
    place, _, rest = reason.partition(": found ")
    return place, rest.partition(", allowed: ")[0]


def _row(scene: dict) -> str:
    image, blocks = scene["image"], scene["blocks"]
    worst = max(range(3), key=lambda channel: abs(image["bias"][channel]))
    bias, error = image["bias"][worst], image["errors"][worst]
    cells = (
        Path(scene["scene"]).stem,
        spp_of(scene),
        f"{'+' if bias > 0 else ''}{_percent(bias)} ± {_percent(error)}",
        _percent(image["sees"]),
        f"{abs(blocks['worst']):.1f} of {blocks['limit']:.1f}",
        _percent(blocks["sees"]),
        f"{scene['pixels']['z']:+.1f}",
        scene["verdict"],
    )
    return " | ".join(cells)
