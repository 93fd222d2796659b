"""Loads a ptbench result file (schema version 1) into the objects of `ptbench.io.cells`.

A result file is Google Benchmark JSON plus a top-level key "ptbench", and the only input of figures and tables. Errors
name the file, the JSON path, what was found and what is allowed; unknown keys are ignored, so that a newer harness may
add some.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.asked import LIVE_PATHS, asked_by_older, figure_of
from ptbench.io.cells import (
    CELL_STATUSES,
    CLAIMS,
    COMPARISON_REASONS,
    RUN_STATUSES,
    STUDY_TYPES,
    WORDS,
    WORK_COUNTERS,
    Cell,
    Comparison,
    Cuda,
    Instrumented,
    Kernel,
    MemoryBound,
    MeshFacts,
    NotApplicable,
    Result,
    Sample,
    Study,
)
from ptbench.io.consistency import Contradiction, cell_of, contradictions, is_failure, times_of
from ptbench.io.convergence import Convergence, check_checkpoints, checkpoints_of, convergence_of
from ptbench.io.files import LARGEST_RESULT, read_whole, stored_file
from ptbench.io.names import axes_spelled_out, shown_name, tuned_in, with_shown_names
from ptbench.io.nodes import Node, read_json, shown
from ptbench.io.older import SCHEMA_VERSIONS, usual_baselines, with_later_axes


def load(path: Path | str) -> Result:
    """Reads and checks the result file at `path`; raises InputError."""
    return result_of(read_json(Path(path)))


_KEPT: dict[bytes, dict[Path, Result]] = {}  # loaded result files, kept by digest of the contents and by path


def load_kept(path: Path) -> Result:
    """Loads a result file like `load`, but only once per process, because pages use the same file many times.

    A file whose bytes have changed is read again.
    """
    there = stored_file(path)
    kept = _KEPT.setdefault(blake2b(read_whole(there, LARGEST_RESULT)).digest(), {})
    if path not in kept:
        as_read = path.with_suffix("") if path.suffix == ".gz" else path
        kept[path] = replace(next(iter(kept.values())), path=as_read) if kept else load(path)
    return kept[path]


def result_of(root: Node) -> Result:
    """Checks a parsed result file and makes its objects; raises InputError."""
    context = _context(root.need("context"))
    ptbench = root.need("ptbench")
    studies = tuple(_study(node) for node in ptbench.need("studies").items())
    _refuse_twins(ptbench.need("studies"), [study.name for study in studies], "name")
    samples, errors = _samples(root.need("benchmarks"), ptbench.need("cells"))
    study_names = tuple(study.name for study in studies)
    baselines = ptbench.maybe("baselines")
    named = {} if baselines is None else baselines.texts()
    usual = usual_baselines(named)
    cells = tuple(_cell(node, study_names, samples, errors, usual) for node in ptbench.need("cells").items())
    _refuse_twins(ptbench.need("cells"), [cell.name for cell in cells], "cell")
    _refuse(root, contradictions(root))
    absent, retakes = ptbench.maybe("not_applicable"), ptbench.maybe("retakes")
    return Result(
        path=root.file,
        context=context,
        studies=studies,
        cells=cells,
        not_applicable=() if absent is None else tuple(_not_applicable(node, usual) for node in absent.items()),
        baselines=named,
        retaken=0 if retakes is None else sum(1 for _ in retakes.need("samples").items()),
        comparisons=_comparisons(ptbench.maybe("comparisons"), studies, cells),
    )


def _comparisons(
    array: Node | None, studies: Sequence[Study], cells: Sequence[Cell]
) -> dict[tuple[str, str], Comparison] | None:
    if array is None:
        return None
    by_study = {study.name: {cell.name for cell in cells if study.name in cell.studies} for study in studies}
    found: dict[tuple[str, str], Comparison] = {}
    for node in array.items():
        one = _comparison(node, by_study)
        if (one.study, one.cell) in found:
            raise node.need("cell").wrong("each cell of a study once")
        found[one.study, one.cell] = one
    return found


def _comparison(node: Node, by_study: Mapping[str, set[str]]) -> Comparison:
    study = node.need("study").one_of(tuple(by_study))
    members = by_study[study]

    def word(key: str) -> str:
        return "" if node.need(key).value is None else node.need(key).one_of(WORDS)

    def member(key: str) -> str:
        name = node.need(key).text()
        if name not in members:
            raise node.need(key).wrong(f'a cell of the study "{study}"')
        return name

    ends = node.need("interval")
    interval = None if ends.value is None else tuple(item.number(above_zero=True) for item in ends.items())
    if interval is not None and (len(interval) != 2 or interval[0] > interval[1]):
        raise ends.wrong("[low, high]")
    ratio = None if node.need("ratio").value is None else node.need("ratio").number(above_zero=True)
    if (ratio is None) != (not word("word")):
        raise node.need("word").wrong("a word where there is a ratio")
    return Comparison(
        study=study,
        cell=member("cell"),
        baseline="" if node.need("baseline").value is None else member("baseline"),
        ratio=ratio,
        interval=interval,
        word=word("word"),
        reason_code=node.need("reason_code").one_of(COMPARISON_REASONS),
        in_time=word("in_time"),
        in_cycles=word("in_cycles"),
    )


def _refuse(node: Node, found: Iterable[Contradiction]) -> None:
    for one in found:
        raise bad_value(node.file, one.place, one.found, one.allowed)


def _context(node: Node) -> dict[str, str]:
    node.need("ptbench.schema_version").one_of(SCHEMA_VERSIONS)
    status = node.maybe("ptbench.status")
    if status is not None:
        status.one_of(RUN_STATUSES)
    ours = (key for key in node.fields() if key.startswith("ptbench."))
    context = {key: _text_of(node.need(key)) for key in ours}
    context["date"] = node.optional_text("date")
    return context


def _text_of(node: Node) -> str:
    """A context value as text; the hosts of several ranks, an array, are joined by commas."""
    return ", ".join(item.text() for item in node.items()) if isinstance(node.value, list) else node.text()


def _refuse_twins(array: Node, names: list[str], key: str) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise bad_value(array.file, f"{array.place}[{index}].{key}", f"{shown(name)} again", "each name once")
        seen.add(name)


def _study(node: Node) -> Study:
    kind = "time" if node.maybe("type") is None else node.need("type").one_of(STUDY_TYPES)
    compares, along = node.optional_text("compares"), node.optional_text("along")
    figure = figure_of(compares, along, is_convergence=kind == "convergence")
    if node.maybe("figure") is not None:
        figure = node.optional_text("figure")
        compares, along = asked_by_older(figure)
    return Study(
        name=node.need("name").name(),
        figure=figure,
        title=node.optional_text("title"),
        type=kind,
        compares="" if compares == LIVE_PATHS else compares,
        along=along,
    )


def _samples(rows: Node, cells: Node) -> tuple[dict[str, list[Sample]], dict[str, list[tuple[int, str]]]]:
    """Samples, and (repetition, error message), by cell name; Google Benchmark's aggregate rows are skipped."""
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
        throttled_periods=row.optional_integer("pt_throttled_periods"),
        throttled_ms=row.optional_number("pt_throttled_ms"),
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
        own_device_ms=tuple(node.number() for node in row.maybe("pt_own_device_ms").items())
        if row.maybe("pt_own_device_ms") is not None
        else (),
        slowest_device_ms=row.optional_number("pt_slowest_device_ms"),
        device_reduce_ms=row.optional_number("pt_device_reduce_ms"),
        work={key: row.need(f"pt_{key}").number() for key in WORK_COUNTERS if row.maybe(f"pt_{key}") is not None},
    )


def _cpu_ms(row: Node) -> float | None:
    """The process's CPU time of the render over all threads, by Google Benchmark's own key, if in milliseconds."""
    return row.optional_number("cpu_time") if row.optional_text("time_unit") == "ms" else None


def _signed(row: Node, key: str) -> float | None:
    node = row.maybe(key)
    return None if node is None else node.number(signed=True)


def _cell(
    node: Node,
    study_names: tuple[str, ...],
    samples: dict[str, list[Sample]],
    errors: dict[str, list[tuple[int, str]]],
    usual: Mapping[str, str],
) -> Cell:
    name = node.need("cell").name()
    in_file, axes = node.need("variant").name(), with_later_axes(node.need("axes").texts())
    tuned, order = tuned_in(in_file, axes), tuple(node.need("axes").fields())
    resolution = [item.integer(minimum=1) for item in node.need("resolution").items()]
    if len(resolution) != 2:
        raise node.need("resolution").wrong("[width, height]")
    studies = node.maybe("studies")
    claim = node.maybe("claim")
    instrumented = node.maybe("instrumented")
    tunables, counters, cuda = node.maybe("tunables"), node.maybe("counters"), node.maybe("cuda")
    meshes = node.maybe("meshes")
    convergence = _with_named_reference(convergence_of(node), order, usual)
    if convergence is not None:
        check_checkpoints(node, convergence, samples[name])
    return Cell(
        name=name,
        studies=() if studies is None else tuple(item.one_of(study_names) for item in studies.items()),
        scene=node.need("scene").name(),
        scene_hash=node.optional_text("scene_hash"),
        scene_file=node.optional_text("scene_file"),
        backend=node.need("backend").name(),
        variant=shown_name(axes, tuned, usual),
        variant_in_file=in_file,
        axes=axes,
        tuned=tuned,
        resolution=(resolution[0], resolution[1]),
        depth=node.need("depth").integer(minimum=1),
        spp=node.need("spp").integer(minimum=1),
        status=node.need("status").one_of(CELL_STATUSES),
        reason=with_shown_names(node.optional_text("reason"), order, usual),
        claim="" if claim is None or claim.value == "" else claim.one_of(CLAIMS),
        claim_check=with_shown_names(node.optional_text("claim_check"), order, usual),
        film_hash=node.optional_text("film_hash"),
        nonfinite=node.optional_integer("nonfinite") or 0,
        negative=node.optional_integer("negative") or 0,
        saturated=node.optional_integer("saturated") or 0,
        unfinished_walks=node.optional_integer("unfinished_walks") or 0,
        # The counting pass of a cell interrupted before it has no object in the file, or an empty one.
        instrumented=None if instrumented is None or instrumented.value == {} else _instrumented(instrumented),
        samples=tuple(samples[name]),
        errors=tuple(with_shown_names(message, order, usual) for _, message in errors[name]),
        failed_repetitions=tuple(repetition for repetition, _ in errors[name]),
        tunables={} if tunables is None else tunables.integers(),
        counters={} if counters is None else counters.integers(),
        cuda=None if cuda is None or cuda.value == {} else _cuda(cuda),
        meshes=None if meshes is None or meshes.value == {} else _meshes(meshes),
        convergence=convergence,
    )


def _with_named_reference(
    convergence: Convergence | None, order: Sequence[str], usual: Mapping[str, str]
) -> Convergence | None:
    """Convergence data whose reference variant is renamed to its displayed name; older files list its choices."""
    if convergence is None:
        return None
    axes = axes_spelled_out(convergence.reference.variant, order)
    tuned = tuned_in(convergence.reference.variant, axes)
    variant = shown_name(axes, tuned, usual) if axes else convergence.reference.variant
    return replace(convergence, reference=replace(convergence.reference, variant=variant))


def _meshes(node: Node) -> MeshFacts:
    counts = {name: node.need(name).integer() for name in ("triangles", "nodes", "node_bytes", "leaf_bytes")}
    return MeshFacts(**counts, **{name: node.need(name).number() for name in ("sah_cost", "build_ms", "encode_ms")})


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
    live = node.maybe("live_paths")
    unaccounted = node.maybe("unaccounted_ms")
    bounds = node.maybe("memory_bounds")
    return Instrumented(
        live_paths=() if live is None else tuple(item.integer() for item in live.items()),
        paths=node.need("paths").integer(minimum=1),
        spp=node.need("spp").integer(minimum=1),
        stage_ms=node.optional_numbers("stage_ms"),
        wall_ms=node.optional_number("wall_ms"),
        # Unaccounted time is negative where overlapping stages add up to more than the wall time.
        unaccounted_ms=None if unaccounted is None else unaccounted.number(signed=True),
        memory_bounds={} if bounds is None else {name: _bound(bounds.need(name)) for name in bounds.fields()},
    )


def _bound(node: Node) -> MemoryBound:
    return MemoryBound(bytes=node.need("bytes").number(), ms=node.need("ms").number())


def _not_applicable(node: Node, usual: Mapping[str, str]) -> NotApplicable:
    named, in_file = node.maybe("axes"), node.need("variant").text()
    axes = {} if named is None else with_later_axes(named.texts())
    tuned = tuned_in(in_file, axes)
    return NotApplicable(
        study=node.optional_text("study"),
        scene=node.optional_text("scene"),
        variant=shown_name(axes, tuned, usual) if axes else in_file,
        axes=axes,
        tuned=tuned,
        reason=node.need("reason").text(),
        reason_code=node.optional_text("reason_code"),
        reason_axis=node.optional_text("reason_axis"),
    )
