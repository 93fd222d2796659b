"""The contents of a result file as small typed objects: cells with their samples, studies, and what was left out.

`ptbench.io.results` reads them. Times are milliseconds of wall time unless a name says otherwise.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ptbench.io.axes import LAUNCH
from ptbench.io.convergence import Checkpoint, Convergence
from ptbench.io.limits import limit
from ptbench.io.run import OfARun

CELL_STATUSES = ("ok", "failed", "interrupted")
RUN_STATUSES = ("completed", "interrupted")
STUDY_TYPES = ("time", "convergence")
CLAIMS = ("bitwise", "statistical", "biased")
WORDS = ("FASTER", "SLOWER", "SAME", "UNSURE")
# Codes of the reasons why a comparison's verdict is UNSURE or missing.
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
# Counters that each sample may have, in fields named "pt_NAME".
WORK_COUNTERS = ("launches", "graph_nodes", "host_waits")
# A busy host counts as no delay of a GPU render if its wall time exceeds its device time by at most this share of it.
MOST_HOST_SHARE = limit("most_host_share")

# Reasons that the harness gives for leaving a variant out of a study that is written for several backends or choices:
# codes, and the texts in files older than the codes.
_ELSEWHERE_CODE = "not_on_backend"
_NOTHING_TO_TUNE_CODE = "no_such_tunable"
_ELSEWHERE = re.compile(r"(\S+=\S+) is not there on the backend \S+")
_NOTHING_TO_TUNE = " tunes none of the variant's choices"


@dataclass(frozen=True)
class Sample:
    """One timed render of a cell; `wall_ms` is for all of `spp` samples per pixel."""

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
    foreign_cpu_ms: float | None = None  # CPU time of other processes during the render; negative by rounding
    throttled_periods: int | None = None  # scheduling periods during the render in which a CPU quota was exhausted
    throttled_ms: float | None = None
    involuntary_switches: int | None = None
    checkpoints: tuple[Checkpoint, ...] = ()  # checkpoints of a convergence cell's sample
    film_hash: str = ""  # hash of the sample's film; empty in older files
    work: dict[str, float] = field(default_factory=dict)  # work counters by name, such as "launches"; may be empty
    own_device_ms: tuple[float, ...] = ()  # render on several GPUs: time of each in ms without the reduction
    slowest_device_ms: float | None = None  # time in ms until the slowest GPU had rendered
    device_reduce_ms: float | None = None  # time in ms of the film reduction after the slowest GPU

    @property
    def ms_per_spp(self) -> float:
        """Milliseconds of wall time per sample per pixel."""
        return self.wall_ms / self.spp

    @property
    def render_ms(self) -> float:
        """Wall time of a render without the film reduction of several GPUs."""
        return self.slowest_device_ms or self.wall_ms

    @property
    def host_share(self) -> float:
        """Share of a render's wall time in which the device was idle; 1 where no device time is known."""
        return 1.0 if self.device_ms is None else max(0.0, 1 - self.device_ms / self.wall_ms)

    @property
    def mega_rays_per_second(self) -> float:
        """Rate of rays over wall time, in millions per second."""
        return self.rays / self.wall_ms / 1e3

    @property
    def clock(self) -> float | None:
        """Clock frequency in MHz, the mean of before and after the render; None where it is unknown."""
        if not self.clock_mhz_before or not self.clock_mhz_after:
            return None
        return 0.5 * (self.clock_mhz_before + self.clock_mhz_after)

    @property
    def mega_cycles_per_spp(self) -> float | None:
        """Clock cycles per sample per pixel, in millions, at the sampled clock; None where the clock is unknown."""
        return None if self.clock is None else self.ms_per_spp * self.clock / 1e3


@dataclass(frozen=True)
class MemoryBound:
    """What memory allows the passes of a stage: the bytes that they read and write at least, and copies of so many."""

    bytes: float
    ms: float


@dataclass(frozen=True)
class Instrumented:
    """The separate counting pass of a cell, whose times are never mixed with those of the timed samples."""

    live_paths: tuple[int, ...]
    paths: int
    spp: int
    stage_ms: dict[str, float]
    wall_ms: float | None
    unaccounted_ms: float | None
    memory_bounds: dict[str, MemoryBound] = field(default_factory=dict)  # by stage that only moves paths

    def live_share(self, depth: int) -> float | None:
        """The share of live paths in the queue slots of all bounces, if ended paths stay in it; None: not counted."""
        return sum(self.live_paths) / (self.paths * depth) if self.live_paths and self.paths else None


@dataclass(frozen=True)
class Kernel:
    """The compiler's resource usage of a CUDA kernel per thread; shared memory per block."""

    registers: int
    local_bytes: int
    shared_bytes: int


@dataclass(frozen=True)
class Cuda:
    """Facts about a cell on a CUDA device."""

    block: int | None
    device_bytes: int | None
    path_bytes: int | None
    prepare_ms: float | None
    options: tuple[str, ...]
    kernels: dict[str, Kernel]
    path_state_bytes: int | None = None  # bytes of one copy of a path's state, part of path_bytes


@dataclass(frozen=True)
class MeshFacts:
    """A cell's meshes and trees, built once before the timed samples; bytes and triangles are totals."""

    triangles: int
    nodes: int
    node_bytes: int
    leaf_bytes: int
    sah_cost: float
    build_ms: float  # time to build a tree on the host's clock, with copies where the GPU builds
    encode_ms: float  # time on the host to encode the tree for its kernels


@dataclass(frozen=True)
class Cell:
    """One variant on one scene, backend and settings, with its timed samples."""

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
    tunables: dict[str, int] = field(default_factory=dict)  # all tunables of the variant's choices, with their values
    counters: dict[str, int] = field(default_factory=dict)  # instrumented pass's counters, for `spp` samples per pixel
    cuda: Cuda | None = None
    meshes: MeshFacts | None = None  # facts about meshes; None for a scene without any
    scene_file: str = ""  # path of a scene file that is not shipped with ptbench, on the host of the run
    convergence: Convergence | None = None
    tuned: dict[str, str] = field(default_factory=dict)  # tunables that differ from their choice's default
    variant_in_file: str = ""  # variant's name in its file; older files list every choice
    failed_repetitions: tuple[int, ...] = ()  # numbers of the repetitions that failed, in the order of `errors`

    @property
    def shown(self) -> str:
        """The cell's name in the style of files since version 1.0, whatever its own file calls the cell."""
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
        """The reason why the cell failed."""
        return self.reason or next((error for error in self.errors if error), "") or "no reason given"

    @property
    def measured(self) -> bool:
        """Whether the cell has valid times. A failed cell has none, as nobody knows what its samples timed."""
        return not self.failed and bool(self.samples)

    @property
    def ms_per_spp(self) -> np.ndarray:
        """Milliseconds of wall time per sample per pixel, one value per timed sample."""
        return np.array([sample.ms_per_spp for sample in self.samples])

    @property
    def mega_cycles_per_spp(self) -> np.ndarray | None:
        """Millions of clock cycles per sample per pixel, one value per timed sample; None where a clock is unknown."""
        cycles = [sample.mega_cycles_per_spp for sample in self.samples]
        return None if not cycles or None in cycles else np.array(cycles)

    @property
    def low_clock_samples(self) -> int:
        """The number of timed samples that ran at a low clock."""
        return sum(sample.low_clock for sample in self.samples)

    @property
    def contended_samples(self) -> int:
        """The number of timed samples from which other processes, or a quota, took CPU time."""
        return sum(sample.contended for sample in self.samples)

    @property
    def throttled_samples(self) -> int:
        """The number of disturbed samples that a CPU quota delayed."""
        return sum(self.is_disturbed(sample) and bool(sample.throttled_periods) for sample in self.samples)

    @property
    def disturbed_samples(self) -> int:
        """The number of contended samples whose time may be wrong; on a GPU the device's clock shows whether it is.

        Other processes can only delay the host, and then the render takes longer than the device worked. Where the
        device waits for the host within the render, its clock cannot show that, and all contended samples count.
        """
        return sum(self.is_disturbed(sample) for sample in self.samples)

    def is_disturbed(self, sample: Sample) -> bool:
        """Whether a sample's time may be wrong, because other processes took CPU time."""
        was_late = sample.host_share > MOST_HOST_SHARE or sample.work.get("host_waits", 0) > 0
        return sample.contended and (self.backend != GPU_BACKEND or was_late)

    @property
    def resolution_text(self) -> str:
        """The resolution as text, "WIDTHxHEIGHT" in pixels."""
        return f"{self.resolution[0]}x{self.resolution[1]}"

    @property
    def pixels(self) -> int:
        """The number of pixels."""
        return self.resolution[0] * self.resolution[1]

    @property
    def on_gpu(self) -> bool:
        """Whether the cell ran on the CUDA backend."""
        return self.backend == GPU_BACKEND

    @property
    def device_share(self) -> float | None:
        """Device time over render wall time, the median over timed samples."""
        shares = [sample.device_ms / sample.wall_ms for sample in self.samples if sample.device_ms is not None]
        return float(np.median(shares)) if shares and len(shares) == len(self.samples) else None

    def work_per_spp(self, counter: str) -> float | None:
        """How often the timed renders did `counter` per sample per pixel; None where the file does not say.

        The timed samples' own counts are used where present, else the instrumented pass's. The latter does not count
        for graph launches: stage-timing events cannot be captured in a graph, so that pass runs without one.
        """
        counts = [sample.work.get(counter) for sample in self.samples]
        if counts and None not in counts:
            return float(np.median(counts)) / self.spp
        if counter not in self.counters:
            return None
        if self.axes.get(LAUNCH, "stream") != "stream" and not self.counters.get("graph_nodes"):
            return None
        return self.counters[counter] / self.spp


@dataclass(frozen=True)
class Study:
    """A study: a question that a suite asks, with the cells that answer it and their figure."""

    name: str
    figure: str
    title: str
    type: str = "time"
    # The axis or tunable whose choices a study compares; empty if it compares none, or if an older file does not say.
    compares: str = ""
    along: str = ""  # parameter over whose values the study compares choices, such as depth; empty: none

    @property
    def is_convergence(self) -> bool:
        """Whether the study is about error rather than time alone."""
        return self.type == "convergence"


@dataclass(frozen=True)
class Comparison:
    """The comparison of a cell with its study's baseline that a run prints at its end; names are the file's."""

    study: str
    cell: str
    baseline: str  # name of the baseline cell that the ratio is relative to; empty: there is none
    ratio: float | None
    interval: tuple[float, float] | None
    word: str  # verdict on the ratio as one word; empty: there is no ratio
    reason_code: str
    in_time: str
    in_cycles: str  # verdict on the ratio in clock cycles as one word; empty: a clock is unknown


@dataclass(frozen=True)
class NotApplicable:
    """A variant that was left out of a study before it ran, and why."""

    study: str
    scene: str
    variant: str
    axes: dict[str, str]
    reason: str
    reason_code: str = ""  # code of why the variant was left out; empty in older files
    tuned: dict[str, str] = field(default_factory=dict)  # tunables that differed from their choice's default value
    reason_axis: str = ""  # axis of the choice that made the variant inapplicable; empty: unknown (older files) or none

    @property
    def elsewhere(self) -> str:
        """The choice as "axis=choice" that only another backend has, if that is the reason; else empty."""
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
    baselines: dict[str, str] = field(default_factory=dict)  # the backend's baseline by axis; empty in older files
    retaken: int = 0  # number of disturbed samples that were measured again and replaced
    comparisons: dict[tuple[str, str], Comparison] | None = None  # comparisons by study and cell; None: not in the file

    @property
    def suite(self) -> str:
        """The suite's name; empty where the run had none."""
        return self.context.get("ptbench.suite", "")

    @property
    def interrupted(self) -> bool:
        """Whether the run was interrupted, so that cells and samples may be missing."""
        return self.context.get("ptbench.status") == "interrupted"

    def cells_of(self, study: Study) -> tuple[Cell, ...]:
        """The cells of a study, in the file's order."""
        return tuple(cell for cell in self.cells if study.name in cell.studies)
