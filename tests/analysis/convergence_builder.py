"""Convergence cells for Builder: errors drawn from images with a known sigma^2 and bias^2, or exactly on the law.

An image is P pixels of normal noise of standard deviation `sigma` a sample, round a truth of 0 plus a bias that is the
same in all pixels or has either sign in half of them each, so that the image's mean is right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from builder import GPU_AXES, Builder

SPPS = [2**k for k in range(11)]


@dataclass(frozen=True)
class Law:
    """bias^2 + sigma^2 / n in every seed, unless `noisy`; with `power`, sigma^2 / n^power."""

    sigma2: float = 0.25
    bias2: float = 0.0
    noisy: bool = True
    power: float = 1.0
    reference_variance: float = 0.0
    mean_bias: float = 0.0
    pixels: int = 4096


def images(law: Law, seed: int, spps: list[int]) -> dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Errors of the mean image and of its halves at each spp; a run of more samples holds those of fewer."""
    random = np.random.default_rng(seed)
    bias = np.sqrt(law.bias2) * np.where(np.arange(law.pixels) % 2, 1, -1) + law.mean_bias
    sums, done, sigma = np.zeros(law.pixels), 0, np.sqrt(law.sigma2)
    by_spp, before = {}, None
    for spp in spps:
        sums = sums + random.normal(0, sigma * np.sqrt(spp - done), law.pixels)
        whole = sums / spp
        halves = (before, (sums - done * before) / (spp - done)) if spp == 2 * done else (None, None)
        by_spp[spp] = tuple(None if image is None else image + bias for image in (whole, *halves))
        before, done = whole, spp
    return by_spp


def rows_of_errors(law: Law, seed: int, spps: list[int], reference_seed: int = 99) -> list[dict]:
    """Checkpoints without times."""
    if not law.noisy:
        errors = [law.bias2 + law.sigma2 / spp**law.power for spp in spps]
        bias2 = [None] + [law.bias2] * (len(spps) - 1)
        return [_row(s, e, e, b, [law.mean_bias] * 3) for s, e, b in zip(spps, errors, bias2, strict=True)]
    random = np.random.default_rng(reference_seed)
    # The halves of the reference, of which each has twice the variance of their mean.
    r1, r2 = random.normal(0, np.sqrt(2 * law.reference_variance), (2, law.pixels))
    rows = []
    for spp, (x, first, second) in images(law, seed, spps).items():
        # A slope of its own, without a new image: the noise shrinks or grows with n.
        x = x * spp ** ((1 - law.power) / 2)
        bias2 = None
        if first is not None and law.power == 1:
            bias2 = float(np.mean(((first - r1) * (second - r2) + (first - r2) * (second - r1)) / 2))
        mean = float(np.mean(x - (r1 + r2) / 2))
        mse, dual = float(np.mean((x - (r1 + r2) / 2) ** 2)), float(np.mean((x - r1) * (x - r2)))
        rows.append(_row(spp, mse, dual, bias2, [mean] * 3))
    return rows


def _row(spp: int, mse: float, dual: float, bias2: float | None, mean: list[float]) -> dict:
    return {
        "spp": spp,
        "film_hash": f"{spp:016x}",
        "nonfinite": 0,
        "me_rgb": mean,
        "mse": mse,
        "mse_dual": dual,
        "rel_mse": 2 * mse,
        "rel_mse_dual": 2 * dual,
        "smape": min(1.0, mse**0.5),
        "bias2": bias2,
        "shared": False,
    }


def convergence_study(builder: Builder, name: str = "cornell", title: str = "") -> Builder:
    builder.study(name, "convergence", title)
    builder.studies[-1]["type"] = "convergence"
    return builder


def convergence_cell(
    builder: Builder,
    law: Law = Law(),  # noqa: B008 - it cannot be changed
    *,
    study: str = "cornell",
    seeds: int = 8,
    spps: list[int] | None = None,
    ms_per_spp: float = 2.0,
    axes: dict[str, str] | None = None,
    tunables: dict[str, int] | None = None,
    scene: str = "cornell_open",
    biases: list[str] | None = None,
    independent: bool = True,
    shared_with: dict | None = None,
    closed_form: bool = False,
    time_noise: float = 0.01,
    first_seed: int = 1,
    reference: dict | None = None,
    **fields,
) -> dict:
    """A convergence cell; `shared_with`, another cell, gives it that one's errors."""
    spps = spps or SPPS
    side = round(law.pixels**0.5)
    cell = builder.cell(
        study, scene, ms_per_spp, spp=spps[-1], n=seeds, noise=time_noise, axes=axes, tunables=tunables,
        resolution=[side, side], **fields,
    )  # fmt: skip
    plain = cell["cell"]
    cell["cell"] = f"{plain}/checkpoints:octaves"
    cell["convergence"] = {
        "checkpoints": spps,
        "independent_samples": independent,
        "reference": {
            "name": scene, "scene": scene, "scene_hash": "0123456789abcdef", "depth": 8,
            "kind": "closed_form" if closed_form else "rendered", "spp_per_half": 65536,
            "variance": law.reference_variance, "mean_square": 0.1, "variant": "depth_first", "seeds": [1, 2],
            **(reference or {}),
        },
        "metrics": {"mse": "mean over pixels and channels of (x - r)^2"},
        "shared_with": shared_with["cell"] if shared_with else "",
        "biases": biases or [],
    }  # fmt: skip
    others = {}
    if shared_with:
        others = {row["pt_seed"]: row for row in builder.rows if row["name"] == shared_with["cell"]}
    builder.rows[:] = [
        row for row in builder.rows if not (row["name"].startswith(plain + "_") and row["run_type"] == "aggregate")
    ]
    for row in builder.rows:
        if row["name"] != plain:
            continue
        row["name"] = row["run_name"] = cell["cell"]
        if "error_message" in row:
            continue
        row["pt_seed"] = float(first_seed + row["repetition_index"])
        errors = rows_of_errors(law, int(row["pt_seed"]), spps)
        if shared_with:
            errors = others[row["pt_seed"]]["pt_checkpoints"]
        row["pt_checkpoints"] = [
            {**error, "shared": bool(shared_with), **_times(row, error["spp"] / spps[-1])} for error in errors
        ]
    return cell


def without_checkpoints(builder: Builder, cell: dict, ms_per_spp: float, noise: float = 0.0, **fields) -> dict:
    """Adds the cell's render without checkpoints to `cornell_without_checkpoints`, a study made if need be."""
    name = "cornell_without_checkpoints"
    if all(study["name"] != name for study in builder.studies):
        builder.study(name, "")
    return builder.cell(name, ms_per_spp=ms_per_spp, n=8, noise=noise, resolution=cell["resolution"], **fields)


def _times(row: dict, share: float) -> dict:
    wall = row["pt_wall_ms"] * share
    return {"wall_ms": wall, "device_ms": row["pt_device_ms"] * share, "cpu_ms": 2 * wall}


def on_gpu(suite: str = "convergence") -> Builder:
    builder = Builder(suite).on_gpu()
    assert builder.axes == GPU_AXES
    return builder
