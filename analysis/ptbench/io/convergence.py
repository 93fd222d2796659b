"""Convergence data of a cell in a result file: errors at checkpoints, the reference, declared biases.

The times of a checkpoint are the render's until then, without work done at checkpoints; its errors are those of the
samples until then. An error is None where the harness gave none: a pixel was not finite, or the metric is undefined.
"""

import re
from dataclasses import dataclass, field
from itertools import pairwise

from ptbench.errors import bad_value
from ptbench.io.nodes import Node, shown

METRICS = ("mse", "mse_dual", "rel_mse", "rel_mse_dual", "smape", "bias2")
CLOCKS = ("wall_ms", "device_ms", "cpu_ms")


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint: the state of one render after `spp` of its samples."""

    spp: int
    times: dict[str, float]  # render time until the checkpoint, ms by clock; wall_ms is always present
    errors: dict[str, float | None]  # error by metric, such as mse_dual
    mean_error: tuple[float, float, float] | None
    nonfinite: int = 0
    shared: bool = False
    film_hash: str = ""


@dataclass(frozen=True)
class Reference:
    """The reference of the errors: the mean of two independently rendered halves, or a closed form."""

    name: str
    kind: str  # kind of reference: "rendered" or "closed_form"
    scene: str
    variance: float  # variance of the reference (a mean of two halves), averaged over pixels and channels
    mean_square: float
    spp_per_half: int = 0
    variant: str = ""
    formula: str = ""
    dual_error: float | None = None  # standard error that the reference's noise gives every dual error
    depth: int | None = None

    @property
    def is_exact(self) -> bool:
        """Whether the reference has no error of its own."""
        return self.kind == "closed_form"


@dataclass(frozen=True)
class Picture:
    """An image of the first seed; the file's name is relative to the result file's folder."""

    spp: int
    file: str


@dataclass(frozen=True)
class Convergence:
    """The convergence data of a cell with checkpoints."""

    checkpoints: tuple[int, ...]
    reference: Reference
    independent_samples: bool = True
    shared_with: str = ""
    biases: tuple[str, ...] = ()
    metrics: dict[str, str] = field(default_factory=dict)
    pictures: tuple[Picture, ...] = ()
    reference_picture: str = ""


def checkpoints_of(row: Node) -> tuple[Checkpoint, ...]:
    """The checkpoints of one sample; empty where the row has none."""
    array = row.maybe("pt_checkpoints")
    if array is None:
        return ()
    checkpoints: list[Checkpoint] = []
    for node in array.items():
        checkpoint = _checkpoint(node)
        if checkpoints and checkpoint.spp <= checkpoints[-1].spp:
            raise node.need("spp").wrong(f"more than the {checkpoints[-1].spp} of the checkpoint before")
        checkpoints.append(checkpoint)
    return tuple(checkpoints)


def _checkpoint(node: Node) -> Checkpoint:
    mean_error = node.maybe("me_rgb")
    channels = None if mean_error is None else [_signed(channel) for channel in mean_error.items()]
    if channels is not None and len(channels) != 3:
        raise mean_error.wrong("three numbers")
    shared = node.maybe("shared")
    return Checkpoint(
        spp=node.need("spp").integer(minimum=1),
        times={
            "wall_ms": node.need("wall_ms").number(above_zero=True),
            **{clock: node.need(clock).number() for clock in CLOCKS[1:] if node.maybe(clock) is not None},
        },
        errors={metric: _error(node, metric) for metric in METRICS},
        mean_error=None if channels is None or None in channels else tuple(channels),
        nonfinite=node.optional_integer("nonfinite") or 0,
        shared=shared is not None and shared.value is True,
        film_hash=node.optional_text("film_hash"),
    )


def _error(node: Node, metric: str) -> float | None:
    """An error by metric; dual errors may be negative, as they are unbiased but not positive."""
    value = node.maybe(metric)
    return None if value is None else value.number(signed=metric.endswith("dual") or metric == "bias2")


def _signed(node: Node) -> float | None:
    return None if node.value is None else node.number(signed=True)


def convergence_of(cell: Node) -> Convergence | None:
    """The convergence data of a cell; None: the cell has no checkpoints."""
    node = cell.maybe("convergence")
    if node is None:
        return None
    independent, biases = node.maybe("independent_samples"), node.maybe("biases")
    if independent is not None and not isinstance(independent.value, bool):
        raise independent.wrong("true or false")
    metrics, images = node.maybe("metrics"), node.maybe("images")
    return Convergence(
        checkpoints=_increasing(node.need("checkpoints")),
        reference=_reference(node.need("reference")),
        independent_samples=independent is None or independent.value,
        shared_with=node.optional_text("shared_with"),
        biases=() if biases is None else tuple(item.text() for item in biases.items()),
        metrics={} if metrics is None else metrics.texts(),
        pictures=() if images is None else _pictures(images.need("by_spp")),
        reference_picture="" if images is None else _file_name(images.need("reference")),
    )


def _increasing(array: Node) -> tuple[int, ...]:
    spps = [item.integer(minimum=1) for item in array.items()]
    if not spps or any(one >= two for one, two in pairwise(spps)):
        raise array.wrong("samples per pixel that increase, at least one")
    return tuple(spps)


def _reference(node: Node) -> Reference:
    return Reference(
        name=node.need("name").text(),
        kind=node.need("kind").one_of(("rendered", "closed_form")),
        scene=node.optional_text("scene"),
        variance=node.optional_number("variance") or 0.0,
        mean_square=node.optional_number("mean_square") or 0.0,
        spp_per_half=node.optional_integer("spp_per_half") or 0,
        variant=node.optional_text("variant"),
        formula=node.optional_text("formula"),
        dual_error=node.optional_number("dual_error"),
        depth=node.optional_integer("depth"),
    )


def _pictures(node: Node) -> tuple[Picture, ...]:
    for spp in node.fields():
        if not spp.isdecimal():
            raise bad_value(node.file, node.place, shown(spp), "samples per pixel")
    return tuple(Picture(int(spp), _file_name(node.need(spp))) for spp in node.fields())


def _file_name(node: Node) -> str:
    """The name of a file that must lie in a folder beside the result file."""
    name = node.name()
    if not re.fullmatch(r"[^/\\]*[^/\\.][^/\\]*/[^/\\]*[^/\\.][^/\\]*", name):
        raise node.wrong("FOLDER/FILE, beside the result file")
    return name


def check_checkpoints(node: Node, convergence: Convergence, samples: list) -> None:
    """Checks that every sample has the cell's checkpoints, or the first of them if it was interrupted."""
    for sample in samples:
        found = tuple(checkpoint.spp for checkpoint in sample.checkpoints)
        if found != convergence.checkpoints[: len(found)]:
            raise bad_value(
                node.file,
                f"pt_checkpoints of {node.need('cell').name()}, repetition {sample.repetition}",
                shown(list(found)),
                f"the cell's: {shown(list(convergence.checkpoints))}",
            )
