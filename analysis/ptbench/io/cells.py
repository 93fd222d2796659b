"""What a result file holds, as small typed objects: cells with their samples, studies, and what was left out.

`ptbench.io.results` reads them. Times are milliseconds of wall time unless a name says otherwise.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ptbench.io.convergence import Checkpoint, Convergence
from ptbench.io.limits import limit
from ptbench.io.run import OfARun

CELL_STATUSES = ("ok", "failed", "interrupted")
RUN_STATUSES = ("completed", "interrupted")
STUDY_TYPES = ("time", "convergence")
CLAIMS = ("bitwise", "statistical", "biased")
WORDS = ("FASTER", "SLOWER", "SAME", "UNSURE")
# Why a comparison's word is UNSURE or none.
COMPARISON_REASONS = (
    "",
    "few_samples",
    "wide",
    "contended",
    "throttled",
    "clocks_differed",
    "no_baseline",
    "baseline_not_measured",
)
GPU_BACKEND = "cuda"
# Counters that a sample may have of its own, as "pt_NAME".
WORK_COUNTERS = ("launches", "graph_nodes", "host_waits")
# A render on a GPU that took no more than this beyond the device's own time was not kept waiting by a busy host.
MOST_HOST_SHARE = limit("most_host_share")

# The harness's reasons for what is not applicable in a study that is written for more than one backend or choice: their
# codes, and their texts for files that are older than the codes.
_ELSEWHERE_CODE = "not_on_backend"
_NOTHING_TO_TUNE_CODE = "no_such_tunable"
_ELSEWHERE = re.compile(r"(\S+=\S+) is not there on the backend \S+")
_NOTHING_TO_TUNE = " tunes none of the variant's choices"


@dataclass(frozen=True)
class Sample:
    """One timed render of a cell: `wall_ms` holds for `spp` samples in every pixel."""

    repetition: int
    wall_ms: float
    spp: int
    rays: float
    paths: float
    device_ms: float | None = None
    end_to_end_ms: float | None = None
    seed: int | None = None
    order: int | None = None
    timestamp: float | None = None
    clock_mhz_before: float | None = None
    clock_mhz_after: float | None = None
    low_clock: bool = False
    contended: bool = False
    cpu_ms: float | None = None
    foreign_cpu_ms: float | None = None  # that other processes took meanwhile; below zero where clocks round
    throttled_periods: int | None = None  # in which a quota of CPU time was used up meanwhile
    throttled_ms: float | None = None
    involuntary_switches: int | None = None
    checkpoints: tuple[Checkpoint, ...] = ()  # of a convergence cell
    film_hash: str = ""  # of its film; older files have none
    work: dict[str, float] = field(default_factory=dict)  # "launches" and its like, where the file has them a sample
    own_device_ms: tuple[float, ...] = ()  # of a render on several GPUs: each one's time without the reduction
    slowest_device_ms: float | None = None  # until the last of them had rendered
    device_reduce_ms: float | None = None  # from there to the sum of their films

    @property
    def ms_per_spp(self) -> float:
        """Milliseconds of wall time a sample per pixel."""
        return self.wall_ms / self.spp

    @property
    def render_ms(self) -> float:
        """Wall time without the reduction of several GPUs' films."""
        return self.slowest_device_ms or self.wall_ms

    @property
    def host_share(self) -> float:
        """What of the render's time the device did not work; all of it where there is no device's clock."""
        return 1.0 if self.device_ms is None else max(0.0, 1 - self.device_ms / self.wall_ms)

    @property
    def mega_rays_per_second(self) -> float:
        """Millions of rays a second of wall time."""
        return self.rays / self.wall_ms / 1e3

    @property
    def clock(self) -> float | None:
        """MHz, the mean of the clock before and after the render; None where it is unknown."""
        if not self.clock_mhz_before or not self.clock_mhz_after:
            return None
        return 0.5 * (self.clock_mhz_before + self.clock_mhz_after)

    @property
    def mega_cycles_per_spp(self) -> float | None:
        """Time in cycles of the clock as sampled round the render; None where the clock is unknown."""
        return None if self.clock is None else self.ms_per_spp * self.clock / 1e3


@dataclass(frozen=True)
class Instrumented:
    """The separate pass that counts; its times are never mixed with the samples'."""

    live_paths: tuple[int, ...]
    paths: int
    spp: int
    stage_ms: dict[str, float]
    wall_ms: float | None
    unaccounted_ms: float | None

    def live_share(self, depth: int) -> float | None:
        """Share of live paths in the slots of all rounds, paths times depth, if ended paths stay; None: not counted."""
        return sum(self.live_paths) / (self.paths * depth) if self.live_paths and self.paths else None


@dataclass(frozen=True)
class Kernel:
    """What the compiler made of one CUDA kernel, a thread; shared memory is a block's."""

    registers: int
    local_bytes: int
    shared_bytes: int


@dataclass(frozen=True)
class Cuda:
    """A cell's facts on the device."""

    block: int | None
    device_bytes: int | None
    path_bytes: int | None
    prepare_ms: float | None
    options: tuple[str, ...]
    kernels: dict[str, Kernel]
    path_state_bytes: int | None = None  # of path_bytes, one copy of the path itself


@dataclass(frozen=True)
class MeshFacts:
    """A cell's meshes and their trees, built once before any clock of a sample; bytes and triangles are of all."""

    triangles: int
    nodes: int
    node_bytes: int
    leaf_bytes: int
    sah_cost: float
    build_ms: float  # on the host's clock, with all copies where the GPU builds
    encode_ms: float  # on the host


@dataclass(frozen=True)
class Cell:
    """Scene x backend x variant x settings, with its samples."""

    name: str
    studies: tuple[str, ...]
    scene: str
    scene_hash: str
    backend: str
    variant: str
    axes: dict[str, str]
    resolution: tuple[int, int]
    depth: int
    spp: int
    status: str
    reason: str
    claim: str
    claim_check: str
    film_hash: str
    nonfinite: int
    negative: int
    saturated: int
    unfinished_walks: int
    instrumented: Instrumented | None
    samples: tuple[Sample, ...]
    errors: tuple[str, ...]
    tunables: dict[str, int] = field(default_factory=dict)  # all that its choices have, at the values that they had
    counters: dict[str, int] = field(default_factory=dict)  # of the instrumented pass, `spp` samples a pixel
    cuda: Cuda | None = None
    meshes: MeshFacts | None = None  # of a scene with meshes
    scene_file: str = ""  # of a scene that did not come with the program, on the host of the run
    convergence: Convergence | None = None
    tuned: dict[str, str] = field(default_factory=dict)  # the tunables that are not at their choice's default
    variant_in_file: str = ""  # older files spell every choice
    failed_repetitions: tuple[int, ...] = ()  # of `errors`, one each

    @property
    def shown(self) -> str:
        """The cell's name as files since version 1.0 have it, whatever its own file calls it."""
        variant = self.variant.replace(" ", "/").replace("=", ":")
        checkpoints = "" if self.convergence is None else "/checkpoints:octaves"
        return (
            f"{variant}/scene:{self.scene}/backend:{self.backend}/{self.resolution_text}/depth:{self.depth}"
            f"/spp:{self.spp}{checkpoints}"
        )

    @property
    def failed(self) -> bool:
        """Whether the cell, or one of its samples, failed."""
        return self.status == "failed" or bool(self.errors)

    @property
    def failure(self) -> str:
        """Why it failed."""
        return self.reason or next((error for error in self.errors if error), "") or "no reason given"

    @property
    def measured(self) -> bool:
        """There are times that may be shown. A failed cell's are not: nobody knows what they timed."""
        return not self.failed and bool(self.samples)

    @property
    def ms_per_spp(self) -> np.ndarray:
        """Milliseconds of wall time a sample per pixel, one value a sample."""
        return np.array([sample.ms_per_spp for sample in self.samples])

    @property
    def mega_cycles_per_spp(self) -> np.ndarray | None:
        """Millions of clock cycles a sample per pixel, one value a sample; None where a clock is unknown."""
        cycles = [sample.mega_cycles_per_spp for sample in self.samples]
        return None if not cycles or None in cycles else np.array(cycles)

    @property
    def low_clock_samples(self) -> int:
        """How many samples ran at a low clock."""
        return sum(sample.low_clock for sample in self.samples)

    @property
    def contended_samples(self) -> int:
        """How many samples other processes, or a quota, took CPU time from."""
        return sum(sample.contended for sample in self.samples)

    @property
    def throttled_samples(self) -> int:
        """How many of the disturbed ones a quota of CPU time held up."""
        return sum(self.is_disturbed(sample) and bool(sample.throttled_periods) for sample in self.samples)

    @property
    def disturbed_samples(self) -> int:
        """Contended ones whose time may be wrong for it: on a GPU the device's clock tells.

        Other processes can only make the host late, and then the render takes longer than the device worked. Where the
        device waits for the host within the render, its clock goes on and cannot tell: all contended ones count.
        """
        return sum(self.is_disturbed(sample) for sample in self.samples)

    def is_disturbed(self, sample: Sample) -> bool:
        """Whether the sample's time may be wrong, because other processes took processors."""
        was_late = sample.host_share > MOST_HOST_SHARE or sample.work.get("host_waits", 0) > 0
        return sample.contended and (self.backend != GPU_BACKEND or was_late)

    @property
    def resolution_text(self) -> str:
        """ "WIDTHxHEIGHT" in pixels."""
        return f"{self.resolution[0]}x{self.resolution[1]}"

    @property
    def pixels(self) -> int:
        """Width times height."""
        return self.resolution[0] * self.resolution[1]

    @property
    def on_gpu(self) -> bool:
        """Whether the cell ran on the CUDA backend."""
        return self.backend == GPU_BACKEND

    @property
    def device_share(self) -> float | None:
        """Device time over render wall time, the median of the samples'."""
        shares = [sample.device_ms / sample.wall_ms for sample in self.samples if sample.device_ms is not None]
        return float(np.median(shares)) if shares and len(shares) == len(self.samples) else None

    def work_per_spp(self, counter: str) -> float | None:
        """How often the timed renders did `counter` a sample per pixel; None where the file does not say.

        The samples' own counts where they have them. Otherwise the instrumented pass's, but not a graph launch's: the
        events that time stages cannot be captured, so that pass runs without a graph.
        """
        counts = [sample.work.get(counter) for sample in self.samples]
        if counts and None not in counts:
            return float(np.median(counts)) / self.spp
        if counter not in self.counters:
            return None
        if self.axes.get("launch", "stream") != "stream" and not self.counters.get("graph_nodes"):
            return None
        return self.counters[counter] / self.spp


@dataclass(frozen=True)
class Study:
    """A question that a suite asks: which cells, drawn how."""

    name: str
    figure: str
    title: str
    type: str = "time"
    # The axis or tunable that is compared; empty where nothing is, and where an older file does not say.
    compares: str = ""
    along: str = ""  # what else varies, so that the comparison is followed along it; empty: nothing

    @property
    def is_convergence(self) -> bool:
        """Whether the study is about error, not time alone."""
        return self.type == "convergence"


@dataclass(frozen=True)
class Comparison:
    """What a run says at its end of a cell against the baseline of its study; the names are those of the file."""

    study: str
    cell: str
    baseline: str  # a cell; empty: there is none
    ratio: float | None
    interval: tuple[float, float] | None
    word: str  # empty: there is no ratio
    reason_code: str
    in_time: str
    in_cycles: str  # empty: a clock is unknown


@dataclass(frozen=True)
class NotApplicable:
    """A variant that was left out of a study before it ran, and why."""

    study: str
    scene: str
    variant: str
    axes: dict[str, str]
    reason: str
    reason_code: str = ""  # empty in older files
    tuned: dict[str, str] = field(default_factory=dict)  # the tunables that were not at their choice's default
    reason_axis: str = ""  # of the choice that does not apply; empty in older files, and where it is no choice's own

    @property
    def elsewhere(self) -> str:
        """ "axis=choice" where the reason is that only another backend has that choice."""
        if self.reason_code:
            if self.reason_code != _ELSEWHERE_CODE:
                return ""
            return f"{self.reason_axis}={self.axes.get(self.reason_axis, '')}"
        match = _ELSEWHERE.fullmatch(self.reason)
        return match[1] if match else ""

    @property
    def has_nothing_to_tune(self) -> bool:
        """Whether the variant was left out because its choices lack a tunable of the study."""
        if self.reason_code:
            return self.reason_code == _NOTHING_TO_TUNE_CODE
        return self.reason.endswith(_NOTHING_TO_TUNE)


@dataclass(frozen=True)
class Result(OfARun):
    """One result file of `ptbench run`."""

    path: Path
    context: dict[str, str]
    studies: tuple[Study, ...]
    cells: tuple[Cell, ...]
    not_applicable: tuple[NotApplicable, ...]
    baselines: dict[str, str] = field(default_factory=dict)  # by axis, on the file's backend; empty in older files
    retaken: int = 0  # disturbed samples whose places others took
    comparisons: dict[tuple[str, str], Comparison] | None = None  # by study and cell; None: the file has none

    @property
    def suite(self) -> str:
        """The suite's name; empty where there was none."""
        return self.context.get("ptbench.suite", "")

    @property
    def interrupted(self) -> bool:
        """Whether the run was interrupted: cells and samples may be missing."""
        return self.context.get("ptbench.status") == "interrupted"

    def cells_of(self, study: Study) -> tuple[Cell, ...]:
        """The study's cells, in the file's order."""
        return tuple(cell for cell in self.cells if study.name in cell.studies)
