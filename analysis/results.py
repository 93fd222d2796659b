"""Loads a ptbench result file (schema version 1) into small typed objects.

A result file is Google Benchmark JSON plus a top-level key "ptbench". Everything that a figure or a table says comes
from here. What is wrong in a file is told with the file, the JSON path, what was found and what is allowed; keys that
this version does not know are ignored, so that a newer harness may add some.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from analysis.consistency import Contradiction, cell_of, contradictions, is_failure, times_of
from analysis.convergence_file import Checkpoint, Convergence, check_checkpoints, checkpoints_of, convergence_of
from analysis.errors import bad_value
from analysis.nodes import Node, read_json, shown

SCHEMA_VERSION = "1"
CELL_STATUSES = ("ok", "failed", "interrupted")
RUN_STATUSES = ("completed", "interrupted")
STUDY_TYPES = ("time", "convergence")
CLAIMS = ("bitwise", "statistical", "biased")
GPU_BACKEND = "cuda"
# Axes that older files lack, with what every variant was then.
LATER_AXES = {"russian_roulette": "off", "sampler": "pcg4d"}
# The axis after which a variant's name spells those.
_BEFORE_LATER_AXES = "direct_light"
# Counters that a sample may have of its own, as "pt_NAME".
WORK_COUNTERS = ("launches", "graph_nodes", "host_waits")

# The harness's reasons for what is not applicable in a study that is written for more than one backend or choice: their
# codes, and their texts for files that are older than the codes.
_ELSEWHERE_CODE = "not_on_backend"
_NOTHING_TO_TUNE_CODE = "no_such_tunable"
_ELSEWHERE = re.compile(r"(\S+=\S+) is not there on the backend \S+")
# A render on a GPU that took no more than this beyond the device's own time was not kept waiting by a busy host.
MOST_HOST_SHARE = 0.02

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
    involuntary_switches: int | None = None
    checkpoints: tuple[Checkpoint, ...] = ()  # of a convergence cell
    film_hash: str = ""  # of its film; older files have none
    work: dict[str, float] = field(default_factory=dict)  # "launches" and its like, where the file has them a sample

    @property
    def ms_per_spp(self) -> float:
        return self.wall_ms / self.spp

    @property
    def host_share(self) -> float:
        """What of the render's time the device did not work; all of it where there is no device's clock."""
        return 1.0 if self.device_ms is None else max(0.0, 1 - self.device_ms / self.wall_ms)

    @property
    def mega_rays_per_second(self) -> float:
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


def tuned_in(variant: str) -> dict[str, str]:
    """The tunables that are not at their choice's standard: a variant's name spells those and no others."""
    pairs = (part.partition("=") for part in variant.split("+")[1:])
    return {name: value for name, _, value in pairs}


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
    convergence: Convergence | None = None
    failed_repetitions: tuple[int, ...] = ()  # of `errors`, one each

    @property
    def failed(self) -> bool:
        return self.status == "failed" or bool(self.errors)

    @property
    def failure(self) -> str:
        return self.reason or next((error for error in self.errors if error), "") or "no reason given"

    @property
    def measured(self) -> bool:
        """There are times that may be shown. A failed cell's are not: nobody knows what they timed."""
        return not self.failed and bool(self.samples)

    @property
    def ms_per_spp(self) -> np.ndarray:
        return np.array([sample.ms_per_spp for sample in self.samples])

    @property
    def mega_cycles_per_spp(self) -> np.ndarray | None:
        cycles = [sample.mega_cycles_per_spp for sample in self.samples]
        return None if not cycles or None in cycles else np.array(cycles)

    @property
    def low_clock_samples(self) -> int:
        return sum(sample.low_clock for sample in self.samples)

    @property
    def contended_samples(self) -> int:
        return sum(sample.contended for sample in self.samples)

    @property
    def disturbed_samples(self) -> int:
        """Contended ones whose time may be wrong for it: on a GPU the device's clock tells.

        Other processes can only make the host late, and then the render takes longer than the device worked.
        """
        return sum(self.is_disturbed(sample) for sample in self.samples)

    def is_disturbed(self, sample: Sample) -> bool:
        return sample.contended and (self.backend != GPU_BACKEND or sample.host_share > MOST_HOST_SHARE)

    @property
    def resolution_text(self) -> str:
        return f"{self.resolution[0]}x{self.resolution[1]}"

    @property
    def pixels(self) -> int:
        return self.resolution[0] * self.resolution[1]

    @property
    def on_gpu(self) -> bool:
        return self.backend == GPU_BACKEND

    @property
    def tuned(self) -> dict[str, str]:
        return tuned_in(self.variant)

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

    @property
    def is_convergence(self) -> bool:
        return self.type == "convergence"


@dataclass(frozen=True)
class NotApplicable:
    """A variant that was left out of a study before it ran, and why."""

    study: str
    scene: str
    variant: str
    axes: dict[str, str]
    reason: str
    reason_code: str = ""  # empty in older files
    reason_axis: str = ""  # of the choice that does not apply; empty in older files, and where it is no choice's own

    @property
    def tuned(self) -> dict[str, str]:
        return tuned_in(self.variant)

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
        """Left out because its choices lack a tunable of the study."""
        if self.reason_code:
            return self.reason_code == _NOTHING_TO_TUNE_CODE
        return self.reason.endswith(_NOTHING_TO_TUNE)


@dataclass(frozen=True)
class Result:
    """One result file."""

    path: Path
    context: dict[str, str]
    studies: tuple[Study, ...]
    cells: tuple[Cell, ...]
    not_applicable: tuple[NotApplicable, ...]
    baselines: dict[str, str] = field(default_factory=dict)  # by axis, on the file's backend; empty in older files

    def about(self, key: str) -> str:
        """A ptbench context value, or "unknown" where the file does not have it."""
        return self.context.get(f"ptbench.{key}") or "unknown"

    @property
    def suite(self) -> str:
        return self.context.get("ptbench.suite", "")

    @property
    def interrupted(self) -> bool:
        return self.context.get("ptbench.status") == "interrupted"

    @property
    def git(self) -> str:
        dirty = self.context.get("ptbench.git_dirty", "").lower() in ("true", "1")
        return self.about("git_sha") + (" (dirty)" if dirty else "")

    def cells_of(self, study: Study) -> tuple[Cell, ...]:
        return tuple(cell for cell in self.cells if study.name in cell.studies)


def load(path: Path | str) -> Result:
    """The result file at `path`, checked; raises InputError."""
    return result_of(read_json(Path(path)))


def result_of(root: Node) -> Result:
    """The file's content, checked; raises InputError."""
    context = _context(root.need("context"))
    ptbench = root.need("ptbench")
    studies = tuple(_study(node) for node in ptbench.need("studies").items())
    _refuse_twins(ptbench.need("studies"), [study.name for study in studies], "name")
    samples, errors = _samples(root.need("benchmarks"), ptbench.need("cells"))
    study_names = tuple(study.name for study in studies)
    cells = tuple(_cell(node, study_names, samples, errors) for node in ptbench.need("cells").items())
    _refuse_twins(ptbench.need("cells"), [cell.name for cell in cells], "cell")
    _refuse(root, contradictions(root))
    absent = ptbench.maybe("not_applicable")
    baselines = ptbench.maybe("baselines")
    return Result(
        path=root.file,
        context=context,
        studies=studies,
        cells=cells,
        not_applicable=() if absent is None else tuple(_not_applicable(node) for node in absent.items()),
        baselines={} if baselines is None else baselines.texts(),
    )


def _refuse(node: Node, found: Iterable[Contradiction]) -> None:
    for one in found:
        raise bad_value(node.file, one.place, one.found, one.allowed)


def _context(node: Node) -> dict[str, str]:
    node.need("ptbench.schema_version").one_of((SCHEMA_VERSION,))
    status = node.maybe("ptbench.status")
    if status is not None:
        status.one_of(RUN_STATUSES)
    ours = (key for key in node.fields() if key.startswith("ptbench."))
    context = {key: node.need(key).text() for key in ours}
    context["date"] = node.optional_text("date")
    return context


def _refuse_twins(array: Node, names: list[str], key: str) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise bad_value(array.file, f"{array.place}[{index}].{key}", f"{shown(name)} again", "each name once")
        seen.add(name)


def _study(node: Node) -> Study:
    kind = node.maybe("type")
    return Study(
        name=node.need("name").name(),
        figure=node.optional_text("figure"),
        title=node.optional_text("title"),
        type="time" if kind is None else kind.one_of(STUDY_TYPES),
    )


def _samples(rows: Node, cells: Node) -> tuple[dict[str, list[Sample]], dict[str, list[tuple[int, str]]]]:
    """Samples, and (repetition, error message), by cell name; Google Benchmark's own aggregates are left alone."""
    known = [cell.need("cell").name() for cell in cells.items()]
    samples: dict[str, list[Sample]] = {name: [] for name in known}
    errors: dict[str, list[tuple[int, str]]] = {name: [] for name in known}
    for row in rows.items():
        if row.need("run_type").one_of(("iteration", "aggregate")) == "aggregate":
            continue
        cell = cell_of(row, samples)
        if is_failure(row):
            errors[cell].append((row.optional_integer("repetition_index") or 0, row.optional_text("error_message")))
        else:
            _refuse(row, times_of(row, f'the cell "{cell}"'))
            samples[cell].append(_sample(row))
    for taken in samples.values():
        taken.sort(key=lambda sample: sample.repetition)
    return samples, errors


def _sample(row: Node) -> Sample:
    low = row.maybe("pt_low_clock")
    contended = row.maybe("pt_contended")
    unknown = row.maybe("pt_clock_unknown")
    is_known = unknown is None or unknown.one_of((0, 1)) == 0
    return Sample(
        repetition=row.optional_integer("repetition_index") or 0,
        wall_ms=row.need("pt_wall_ms").number(above_zero=True),
        spp=row.need("pt_spp").integer(minimum=1),
        rays=row.need("pt_rays").number(),
        paths=row.need("pt_paths").number(),
        device_ms=row.optional_number("pt_device_ms"),
        cpu_ms=_cpu_ms(row),
        foreign_cpu_ms=_signed(row, "pt_foreign_cpu_ms"),
        involuntary_switches=row.optional_integer("pt_involuntary_switches"),
        checkpoints=checkpoints_of(row),
        end_to_end_ms=row.optional_number("pt_end_to_end_ms"),
        seed=row.optional_integer("pt_seed"),
        order=row.optional_integer("pt_order"),
        timestamp=row.optional_number("pt_timestamp"),
        clock_mhz_before=row.optional_number("pt_clock_mhz_before") if is_known else None,
        clock_mhz_after=row.optional_number("pt_clock_mhz_after") if is_known else None,
        film_hash=row.optional_text("film_hash"),
        low_clock=low is not None and low.number() != 0,
        contended=contended is not None and contended.number() != 0,
        work={key: row.need(f"pt_{key}").number() for key in WORK_COUNTERS if row.maybe(f"pt_{key}") is not None},
    )


def _cpu_ms(row: Node) -> float | None:
    """The process's CPU time of the render, all threads: Google Benchmark's own key, if it is in milliseconds."""
    return row.optional_number("cpu_time") if row.optional_text("time_unit") == "ms" else None


def _signed(row: Node, key: str) -> float | None:
    node = row.maybe(key)
    return None if node is None else node.number(signed=True)


def _cell(
    node: Node,
    study_names: tuple[str, ...],
    samples: dict[str, list[Sample]],
    errors: dict[str, list[tuple[int, str]]],
) -> Cell:
    name = node.need("cell").name()
    resolution = [item.integer(minimum=1) for item in node.need("resolution").items()]
    if len(resolution) != 2:
        raise node.need("resolution").wrong("[width, height]")
    studies = node.maybe("studies")
    claim = node.maybe("claim")
    instrumented = node.maybe("instrumented")
    tunables, counters, cuda = node.maybe("tunables"), node.maybe("counters"), node.maybe("cuda")
    convergence = convergence_of(node)
    if convergence is not None:
        check_checkpoints(node, convergence, samples[name])
    return Cell(
        name=name,
        studies=() if studies is None else tuple(item.one_of(study_names) for item in studies.items()),
        scene=node.need("scene").name(),
        scene_hash=node.optional_text("scene_hash"),
        backend=node.need("backend").name(),
        variant=node.need("variant").name(),
        axes=_axes(node.need("axes")),
        resolution=(resolution[0], resolution[1]),
        depth=node.need("depth").integer(minimum=1),
        spp=node.need("spp").integer(minimum=1),
        status=node.need("status").one_of(CELL_STATUSES),
        reason=node.optional_text("reason"),
        claim="" if claim is None or claim.value == "" else claim.one_of(CLAIMS),
        claim_check=node.optional_text("claim_check"),
        film_hash=node.optional_text("film_hash"),
        nonfinite=node.optional_integer("nonfinite") or 0,
        negative=node.optional_integer("negative") or 0,
        saturated=node.optional_integer("saturated") or 0,
        unfinished_walks=node.optional_integer("unfinished_walks") or 0,
        # A cell that never got to its counting pass has none, or an empty object.
        instrumented=None if instrumented is None or instrumented.value == {} else _instrumented(instrumented),
        samples=tuple(samples[name]),
        errors=tuple(message for _, message in errors[name]),
        failed_repetitions=tuple(repetition for repetition, _ in errors[name]),
        tunables={} if tunables is None else tunables.integers(),
        counters={} if counters is None else counters.integers(),
        cuda=None if cuda is None or cuda.value == {} else _cuda(cuda),
        convergence=convergence,
    )


def _axes(node: Node) -> dict[str, str]:
    """A variant's choices; those of axes that the file is too old to name are the ones that there were."""
    named = node.texts()
    axes: dict[str, str] = {}
    for axis, choice in named.items():
        axes[axis] = choice
        if axis == _BEFORE_LATER_AXES:
            axes |= {later: usual for later, usual in LATER_AXES.items() if later not in named}
    return axes


def _cuda(node: Node) -> Cuda:
    options, kernels = node.maybe("options"), node.maybe("kernels")
    return Cuda(
        block=node.optional_integer("block"),
        device_bytes=node.optional_integer("device_bytes"),
        path_bytes=node.optional_integer("path_bytes"),
        prepare_ms=node.optional_number("prepare_ms"),
        options=() if options is None else tuple(item.text() for item in options.items()),
        kernels={} if kernels is None else {name: _kernel(kernels.need(name)) for name in kernels.fields()},
        path_state_bytes=node.optional_integer("path_state_bytes"),
    )


def _kernel(node: Node) -> Kernel:
    return Kernel(
        registers=node.need("registers").integer(),
        local_bytes=node.optional_integer("local_bytes") or 0,
        shared_bytes=node.optional_integer("shared_bytes") or 0,
    )


def _instrumented(node: Node) -> Instrumented:
    stages = node.maybe("stage_ms")
    live = node.maybe("live_paths")
    unaccounted = node.maybe("unaccounted_ms")
    return Instrumented(
        live_paths=() if live is None else tuple(item.integer() for item in live.items()),
        paths=node.need("paths").integer(minimum=1),
        spp=node.need("spp").integer(minimum=1),
        stage_ms={} if stages is None else {key: stages.need(key).number() for key in stages.fields()},
        wall_ms=node.optional_number("wall_ms"),
        # May be below zero: stages that overlap add up to more than the wall time.
        unaccounted_ms=None if unaccounted is None else unaccounted.number(signed=True),
    )


def _not_applicable(node: Node) -> NotApplicable:
    axes = node.maybe("axes")
    return NotApplicable(
        study=node.optional_text("study"),
        scene=node.optional_text("scene"),
        variant=node.need("variant").text(),
        axes={} if axes is None else _axes(axes),
        reason=node.need("reason").text(),
        reason_code=node.optional_text("reason_code"),
        reason_axis=node.optional_text("reason_axis"),
    )
