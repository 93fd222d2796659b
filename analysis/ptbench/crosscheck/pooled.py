"""Cross-checks of one scene with different seeds, pooled: whether the image's mean differs.

The unbiased differences of the cross-checks are averaged with weights 1 / error^2. As the weights are estimates, too,
the average is noisier than it looks, which Meier's factor (Biometrics 9, 1953) corrects. Its error's degrees of freedom
follow Welch and Satterthwaite (Biometrics 2, 1946), with each cross-check's those of its smaller side.
"""

from dataclasses import dataclass

import numpy as np

from ptbench.crosscheck.document import AGREES, DIFFERS, WEAK
from ptbench.crosscheck.statistics import POWER
from ptbench.errors import FindingError
from ptbench.stats import special


@dataclass(frozen=True)
class Pooled:
    """The difference of the two renderers' image means by channel, relative to the mean, pooled over cross-checks."""

    bias: tuple[float, ...]
    errors: tuple[float, ...]
    worst_p: float
    limit_p: float
    sees: float  # bias of the worst channel that the test of the pooled image mean detects with probability POWER
    aim: float

    @property
    def verdict(self) -> str:
        """The verdict on the pooled image mean alone, one of three words."""
        if self.worst_p < self.limit_p:
            return DIFFERS
        return AGREES if self.sees <= self.aim else WEAK


def pooled(scenes: list[tuple[dict, int]]) -> Pooled:
    """Pools reports of one scene, with their numbers of seeds; raises FindingError if scenes differ or seeds repeat."""
    _check(scenes)
    images = [scene["image"] for scene, _ in scenes]
    bias, errors = (np.array([image[name] for image in images]) for name in ("bias", "errors"))
    freedom = np.array([seeds - 1 for _, seeds in scenes])[:, None]
    lit = (errors > 0).all(axis=0)  # a channel that is black in both renderers cannot differ
    squares = np.where(lit, errors, 1.0) ** -2
    weights = squares / squares.sum(axis=0)
    mean = np.where(lit, (weights * bias).sum(axis=0), 0.0)
    meier = 1 + 4 * (weights * (1 - weights) / freedom).sum(axis=0)
    error = np.where(lit, np.sqrt(meier / squares.sum(axis=0)), 0.0)
    # Degrees of freedom of the pooled mean by Welch and Satterthwaite: weights are reports' shares of its variance.
    together = 1 / (weights**2 / freedom).sum(axis=0)
    limit_p = min(image["limit_p"] for image in images)
    sees = (special.stdtrit(together, 1 - limit_p / 2) + special.stdtrit(together, POWER)) * error
    return Pooled(
        bias=tuple(map(float, mean)),
        errors=tuple(map(float, error)),
        worst_p=float(np.min(2 * special.stdtr(together, -np.abs(mean / np.where(lit, error, 1.0))))),
        limit_p=limit_p,
        sees=float(sees.max()),
        aim=min(scene["aim"] for scene, _ in scenes),
    )


def _check(scenes: list[tuple[dict, int]]) -> None:
    names = ("scene", "scene_hash", "depth")
    if len({tuple(scene.get(name) for name in names) for scene, _ in scenes}) != 1:
        raise FindingError(
            f"cross-checks of several scenes: {[[scene.get(name) for name in names] for scene, _ in scenes]}"
        )
    seeds = [seed for scene, count in scenes for seed in range(scene["first_seed"], scene["first_seed"] + count)]
    if len(set(seeds)) != len(seeds):
        raise FindingError(f"{scenes[0][0]['scene']}: two cross-checks have a seed in common")
