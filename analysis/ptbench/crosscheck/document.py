"""The report of a cross-check as a file (schema/ptbench-crosscheck.schema.json) and as a table for a terminal."""

from dataclasses import asdict, dataclass

from ptbench.crosscheck.limits import SIDE
from ptbench.crosscheck.renders import Images, Settings
from ptbench.crosscheck.statistics import EDGES, LEVEL_OF_A_CALL, POWER, Comparison
from ptbench.document.table import table_of
from ptbench.document.text import aligned
from ptbench.io.files import picked

AGREES, DIFFERS, WEAK, REFUSED = "agrees", "differs", "too weak", "not expressible"


@dataclass(frozen=True)
class Checked:
    """A scene rendered in both renderers; without a comparison, the reasons why the other renderer cannot show it."""

    scene: str
    settings: Settings
    comparison: Comparison | None
    aim: float  # bias of the image's mean that the test must be able to detect, as a fraction of the mean
    here: Images | None = None
    there: Images | None = None
    reasons: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """The verdict on a cross-checked scene, one of four words."""
        if self.comparison is None:
            return REFUSED
        if self.comparison.differs:
            return DIFFERS
        return AGREES if self.comparison.image.sees <= self.aim else WEAK


def as_json(scenes: list[dict], settings: Settings, context: dict, allowed: float, asked: dict) -> dict:
    """The whole report: `scenes` are results of the scenes asked for, `asked` the settings they began with."""
    count = len(asked["scenes"])
    return {
        "schema": "ptbench-crosscheck-1",
        "context": context,
        "settings": {
            **picked(settings, "seeds resolution depth scale"),
            "allowed": allowed,
            "family": LEVEL_OF_A_CALL,
            "family_scenes": count,
            "power": POWER,
            "block": SIDE,
            "z_edges": list(EDGES),
        },
        "call": asked,
        "scenes": scenes,
    }


def as_scene(checked: Checked) -> dict:
    """The result of one scene as it stands in the report file."""
    found = {"scene": checked.scene, "verdict": checked.verdict, "reasons": list(checked.reasons), "aim": checked.aim}
    if checked.comparison is None or checked.here is None or checked.there is None:
        return found
    about = checked.here.about
    return found | {
        "scene_hash": about["scene_hash"],
        "variant": about["variant"],
        "depth": about["depth"],
        "spp": checked.settings.spp,
        **({} if checked.settings.spp_here is None else {"spp_here": checked.settings.spp_here}),
        "first_seed": checked.settings.first_seed,
        "seconds_here": about["render_seconds"],
        "seconds_there": checked.there.about["seconds"],
        "image": _fields(checked.comparison.image),
        "blocks": _fields(checked.comparison.blocks),
        "pixels": _fields(checked.comparison.pixels),
    }


def spp_of(scene: dict) -> str:
    """Samples per pixel of a scene in a report, as a table shows them."""
    return f"{scene['spp_here']} here, {scene['spp']} there" if "spp_here" in scene else str(scene["spp"])


def _fields(test: object) -> dict:
    # JSON has no tuples, so they become lists.
    return {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(test).items()}


_HEAD = (
    "scene",
    "spp",
    "mean here",
    "there",
    "difference",
    "sees",
    "worst block",
    "limit",
    "sees",
    "pixels z",
    "verdict",
)


def _percent(share: float) -> str:
    return f"{100 * share:.3f} %"


def row_of(scene: dict) -> tuple[str, ...]:
    """A row of the report's table: the channel that differs most, and the worst block in standard errors."""
    if "image" not in scene:
        return (scene["scene"], *[""] * (len(_HEAD) - 2), scene["verdict"])
    image, blocks = scene["image"], scene["blocks"]
    return (
        scene["scene"],
        spp_of(scene),
        *(f"{sum(image[side]) / len(image[side]):.5g}" for side in ("here", "there")),
        f"{100 * max(image['bias'], key=abs):+.3f} %",
        _percent(image["sees"]),
        f"{blocks['worst']:+.1f}",
        f"{blocks['limit']:.1f}",
        f"{100 * blocks['sees']:.1f} %",
        f"{scene['pixels']['z']:+.1f}",
        scene["verdict"],
    )


def as_text(scenes: list[dict], settings: Settings, aim: float) -> list[str]:
    """The cross-check's report as text: its table and the meaning of the columns."""
    lines = [
        *aligned(table_of(_HEAD, map(row_of, scenes))),
        "",
        f"{settings.size}, {settings.seeds} seeds in each renderer. sees: the bias that would"
        f" have been found with probability {POWER:g}, of the image's mean (aim: {_percent(aim)}) and of a block's, the"
        " median.",
        f"All tests of all scenes together tell equal renderers apart with probability {LEVEL_OF_A_CALL:g} at most.",
    ]
    lines += [f"{one['scene']}: {reason}" for one in scenes for reason in one["reasons"]]
    return lines
