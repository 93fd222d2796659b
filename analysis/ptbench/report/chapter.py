"""The chapter of a report on one result file, and facts for the other sections: plain values that can be pickled."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.convergence.assessment import LEAST_SEEDS
from ptbench.document.blocks import Block, Bullets, Download, Facts, Lines, Paragraph, Section, anchor_of, blocks_of
from ptbench.io.cells import Result
from ptbench.io.files import one_line, safe_name
from ptbench.io.stability import BROKEN, FAILED, KNOWN_LIMIT, NOT_APPLICABLE, PASSED, Stability
from ptbench.numbers import plural
from ptbench.plots.summary import failed, not_applicable, on_device, stages, study_section
from ptbench.report import tidy
from ptbench.report.drawing import Drawn, draw_stability_figures, draw_study_figures
from ptbench.report.findings import Findings, findings_of, stability_findings
from ptbench.report.forest import draw_overview
from ptbench.report.scenes import SceneUse, scene_uses
from ptbench.report.sources import load
from ptbench.report.verdicts import counts_text, study_verdicts, verdict_counts
from ptbench.stability.layout import Layout, count, failures
from ptbench.stability.summary import family_text, limits, missing, must_pass_failures
from ptbench.stats.estimates import MINIMUM_SAMPLES
from ptbench.studies.disturbed import disturbance_in, disturbance_of
from ptbench.studies.notes import notes_of
from ptbench.studies.rows import measure
from ptbench.studies.withdrawn import concerning

# Facts that describe a machine in a report, by context key; missing keys are omitted.
_MACHINE_FACTS = (
    ("GPU", "cuda_device"), ("Compute capability", "cuda_compute_capability"),
    ("Multiprocessors", "cuda_multiprocessors"), ("GPU clock, MHz", "cuda_clock_mhz"),
    ("GPU memory, MiB", "cuda_memory_mib"), ("Memory clock, MHz", "cuda_memory_clock_mhz"),
    ("Memory bus, bits", "cuda_memory_bus_bits"), ("L2, bytes", "cuda_l2_bytes"), ("ECC", "cuda_ecc"),
    ("CUDA driver", "cuda_driver"), ("CUDA runtime", "cuda_runtime"), ("NVRTC", "cuda_nvrtc"), ("CCCL", "cuda_cccl"),
    ("CPU", "cpu_model"), ("Threads", "threads"), ("CPU quota", "cpu_quota"), ("System", "os"),
)  # fmt: skip
_RUN_FACTS = (
    ("ptbench", "version"), ("Compiler", "compiler"), ("Compiler flags", "compiler_flags"),
    ("Program hash", "program_hash"), ("CUDA kernel sources' hash", "cuda_kernel_source_hash"),
    ("Thrust", "thrust_version"), ("Google Benchmark", "google_benchmark_version"),
    ("OpenMP environment", "openmp_environment"),
)  # fmt: skip


@dataclass(frozen=True)
class Counts:
    """Numbers of cells, samples and the like in a file; `None` where one does not apply."""

    measured: str
    failed: int
    not_applicable: int
    samples: int | None
    disturbed: str | None
    verdicts: str


@dataclass(frozen=True)
class LeftOut:
    """Rows for the report's tables of missing or doubtful results, without the file's name."""

    not_applicable: tuple[tuple[str, str, str], ...] = ()  # variants left out: (study or case, reason, count)
    failed: tuple[tuple[str, str], ...] = ()  # failures: (cell or check, error message)
    not_drawn: tuple[tuple[str, str], ...] = ()  # figures not drawn: (study, reason)
    doubts: tuple[tuple[str, int, str], ...] = ()  # doubts about numbers: (doubt, how many have it, of how many)


@dataclass(frozen=True)
class Chapter:
    """The contents of a report's chapter on one file."""

    title: str
    file: str
    suite: str
    machine: str
    machine_facts: tuple[tuple[str, str], ...]
    backend: str
    status: str
    date: str
    git_sha: str
    dirty: str  # whether the program's sources were modified: "true", "false" or empty
    command: str
    counts: Counts
    left_out: LeftOut
    scenes: tuple[SceneUse, ...]
    downloads: tuple[Download, ...]
    findings: tuple[Block, ...]
    section: Section
    has_gpu: bool = False
    has_convergence: bool = False
    stability_cases: int = 0
    withdrawn: tuple[str, ...] = ()  # withdrawals that concern the file's cells


def chapter_of(path: Path, title: str) -> Chapter:
    """Reads, judges and draws a result file for its chapter; raises InputError."""
    loaded = load(path)
    return _stability_chapter(loaded, title) if isinstance(loaded, Stability) else _timing_chapter(loaded, title)


def _common(loaded: Result | Stability, title: str) -> dict:
    context = loaded.context
    facts = [(label, context[f"ptbench.{key}"]) for label, key in _MACHINE_FACTS if context.get(f"ptbench.{key}")]
    return {
        "title": title,
        "file": loaded.path.name,
        "suite": loaded.suite,
        "machine": loaded.about("machine"),
        "machine_facts": tuple(facts),
        "backend": loaded.about("backend"),
        "status": context.get("ptbench.status") or "unknown",
        "date": context.get("date") or "no date",
        "git_sha": loaded.about("git_sha"),
        "dirty": context.get("ptbench.git_dirty", "").lower(),
        "command": loaded.about("command_line"),
    }


def _run_facts(loaded: Result | Stability) -> list[tuple[str, str]]:
    context = loaded.context
    facts = [
        ("File", f"`{loaded.path.name}`"),
        ("Machine", f"{loaded.about('machine')}, backend {loaded.about('backend')}"),
        ("Run", f"{loaded.about('status')}, {context.get('date') or 'no date'}"),
        ("Commit", f"`{loaded.about('git_sha')}`{_dirty_text(context.get('ptbench.git_dirty', ''))}"),
        ("Command", f"`{one_line(loaded.about('command_line'))}`"),
    ]
    return facts + [(label, context[f"ptbench.{key}"]) for label, key in _RUN_FACTS if context.get(f"ptbench.{key}")]


def _dirty_text(dirty: str) -> str:
    return {
        "true": ", with uncommitted changes",
        "1": ", with uncommitted changes",
        "": ", clean or not is not said",
    }.get(dirty.lower(), ", clean")


# The functions that follow make the chapter on a result of `ptbench run`.


def _timing_chapter(result: Result, title: str) -> Chapter:
    prefix = safe_name(title)
    children, not_drawn = [], []
    for study in result.studies:
        drawn = draw_study_figures(result, study, prefix)
        not_drawn += [(study.name, one_line(reason)) for reason in drawn.not_drawn]
        children.append(_study_section(result, study, drawn, title))
    if any(not cell.studies for cell in result.cells):
        lines = study_section(result, None, "", (), None)
        children.append(
            _child(title, "Cells of no study", "no-study", blocks_of(lines, "Cells of no study", fold=True))
        )
    children += _rest(result, title)
    has_convergence = any(cell.convergence is not None for cell in result.cells)
    downloads = [tidy.download(f"{prefix}.samples.csv", tidy.sample_rows(result), "a sample")]
    if has_convergence:
        downloads.append(
            tidy.download(f"{prefix}.checkpoints.csv", tidy.checkpoint_rows(result), "a checkpoint of a sample")
        )
    facts = [
        *_run_facts(result),
        ("Disturbed", disturbance_in(result)),
        *(("Withdrawn", entry.full) for entry in concerning(result.cells)),
        *_options(result),
    ]
    blocks: list[Block] = [Facts(tuple(facts))]
    if not result.studies:
        blocks.append(Paragraph("The file has no studies."))
    return Chapter(
        **_common(result, title),
        counts=_counts(result),
        left_out=LeftOut(_missing_variants(result), _failed_cells(result), tuple(not_drawn), tuple(_doubts(result))),
        scenes=scene_uses(result),
        downloads=tuple(downloads),
        findings=(*_in_words(findings_of(result)), *draw_overview(result, title, prefix)),
        section=Section(title, anchor_of("file", title), tuple(blocks), tuple(children)),
        has_gpu=any(cell.on_gpu for cell in result.cells),
        has_convergence=has_convergence,
        withdrawn=tuple(entry.full for entry in concerning(result.cells)),
    )


def _in_words(found: Findings) -> list[Block]:
    return [Paragraph(found.head), *([Bullets(found.items)] if found.items else [])]


def _child(title: str, heading: str, name: str, blocks: Sequence[Block]) -> Section:
    return Section(heading, anchor_of("file", title, name), tuple(blocks))


def _study_section(result: Result, study, drawn: Drawn, title: str) -> Section:
    head, items = study_verdicts(result, study)
    notes = notes_of(result, study, measure(result, study)) if drawn.notes is None else drawn.notes
    lines = study_section(result, study, "## ", drawn.not_drawn, notes)
    blocks: list[Block] = [Paragraph(head)]
    if items:
        blocks.append(Bullets(tuple(items)))
    blocks += drawn.images
    blocks += blocks_of(lines, study.title or study.name, fold=True)
    return _child(title, study.title or study.name, f"study-{study.name}", blocks)


def _rest(result: Result, title: str) -> list[Section]:
    parts: list[tuple[str, str, Lines]] = [
        ("Where the time goes", "stages", stages(result)),
        ("On the device", "device", on_device(result)),
        ("Not applicable", "not-applicable", not_applicable(result)),
        ("Failed", "failed", failed(result.cells)),
    ]
    return [
        _child(title, heading, name, blocks_of(lines, heading, fold=True)) for heading, name, lines in parts if lines
    ]


def _options(result: Result) -> list[tuple[str, str]]:
    options = [cell.cuda.options for cell in result.cells if cell.cuda is not None]
    common = [option for option in options[0] if all(option in of for of in options)] if options else []
    return [("NVRTC options of every cell", f"`{' '.join(common)}`")] if common else []


def _counts(result: Result) -> Counts:
    cells = result.cells
    verdicts = counts_text(verdict_counts(result))
    return Counts(
        measured=f"{sum(cell.measured for cell in cells)} of {plural(len(cells), 'cell')}",
        failed=sum(cell.failed for cell in cells),
        not_applicable=len(result.not_applicable),
        samples=sum(len(cell.samples) for cell in cells),
        disturbed=str(disturbance_of(cells)),
        verdicts=verdicts,
    )


def _missing_variants(result: Result) -> tuple[tuple[str, str, str], ...]:
    groups = Counter((item.study or "—", one_line(item.reason)) for item in result.not_applicable)
    return tuple((study, reason, plural(count, "variant")) for (study, reason), count in groups.items())


def _failed_cells(result: Result) -> tuple[tuple[str, str], ...]:
    return tuple((one_line(cell.shown), one_line(cell.failure)) for cell in result.cells if cell.failed)


def _doubts(result: Result) -> list[tuple[str, int, str]]:
    """All doubts about a file's numbers that occur, each as (doubt, count, total)."""
    cells = result.cells
    samples = plural(sum(len(cell.samples) for cell in cells), "sample")
    of_cells = plural(len(cells), "cell")
    measured = [cell for cell in cells if cell.measured]
    few = [cell for cell in measured if cell.convergence is None and len(cell.samples) < MINIMUM_SAMPLES]
    few_seeds = [cell for cell in measured if cell.convergence is not None and len(cell.samples) < LEAST_SEEDS]
    without = [cell for cell in cells if not cell.failed and not cell.samples]
    found = [
        ("run interrupted: cells and samples may be missing", int(result.interrupted), "1 run"),
        ("samples at a low clock, kept", sum(cell.low_clock_samples for cell in cells), samples),
        ("samples while other processes used the host, kept", sum(cell.contended_samples for cell in cells), samples),
        ("of those, samples that a CPU quota held up", sum(cell.throttled_samples for cell in cells), samples),
        ("of those, samples whose time may be wrong for it", sum(cell.disturbed_samples for cell in cells), samples),
        (
            "samples whose clock is unknown: no verdict of theirs is held against cycles",
            sum(sample.mega_cycles_per_spp is None for cell in cells for sample in cell.samples),
            samples,
        ),
        ("samples that failed", sum(len(cell.errors) for cell in cells), samples),
        ("cells interrupted while measuring", sum(cell.status == "interrupted" for cell in cells), of_cells),
        ("cells without a sample", len(without), of_cells),
        (f"cells with fewer than {MINIMUM_SAMPLES} samples, too few for a verdict on times", len(few), of_cells),
        (f"cells with fewer than {LEAST_SEEDS} seeds, too few for every verdict on errors", len(few_seeds), of_cells),
        ("cells whose variant is declared biased", sum(cell.claim == "biased" for cell in cells), of_cells),
        ("cells with film values that are not finite", sum(cell.nonfinite > 0 for cell in cells), of_cells),
        ("cells with negative film values", sum(cell.negative > 0 for cell in cells), of_cells),
        ("cells with saturated film values", sum(cell.saturated > 0 for cell in cells), of_cells),
        ("cells with unfinished walks", sum(cell.unfinished_walks > 0 for cell in cells), of_cells),
    ]
    return [row for row in found if row[1]]


# The functions that follow make the chapter on a result of `ptbench stability`.


def _stability_chapter(stability: Stability, title: str) -> Chapter:
    prefix = safe_name(title)
    layout = Layout(stability)
    drawn = draw_stability_figures(stability, prefix)
    families = [family_text(stability, layout, family) for family in stability.families]
    parts: list[tuple[str, str, list[Block]]] = [
        ("By family", "families", [Bullets(tuple(families)) if families else Paragraph("The file has no cases.")]),
        ("Figures", "figures", list(drawn.images)),
        ("Known limits", "limits", blocks_of(limits(stability, layout), "Known limits", fold=True)),
        (
            "Failures of what must pass",
            "failures",
            blocks_of(must_pass_failures(stability, layout), "Failures of what must pass", fold=True),
        ),
        ("Cases without checks", "missing", _cases_without(stability)),
    ]
    for reason in drawn.not_drawn:
        parts[1][2].append(Paragraph(f"Not drawn: {one_line(reason)}"))
    facts = _run_facts(stability)
    facts.append(("Extent", "quick run" if stability.is_quick else "full run"))
    if stability.seed is not None:
        facts.append(("Seed", str(stability.seed)))
    rows = stability.rows
    bad = failures(rows)
    applicable = [row for row in rows if row.status != NOT_APPLICABLE]
    return Chapter(
        **_common(stability, title),
        counts=Counts(
            measured=f"{len(applicable)} of {plural(len(rows), 'check')}",
            failed=len(bad),
            not_applicable=count(rows, NOT_APPLICABLE),
            samples=None,
            disturbed=None,
            verdicts=_stability_words(stability),
        ),
        left_out=LeftOut(
            _missing_checks(stability),
            tuple((f"{row.case.shown} {row.variant}", one_line(row.reason) or row.status) for row in bad),
            tuple(("figures", one_line(reason)) for reason in drawn.not_drawn),
            tuple(_stability_doubts(stability)),
        ),
        scenes=(),
        downloads=(tidy.download(f"{prefix}.checks.csv", tidy.check_rows(stability), "a check"),),
        findings=tuple(_in_words(stability_findings(stability))),
        section=Section(
            title,
            anchor_of("file", title),
            (Facts(tuple(facts)),),
            tuple(_child(title, heading, name, blocks) for heading, name, blocks in parts if blocks),
        ),
        stability_cases=len(stability.cases),
    )


def _stability_words(stability: Stability) -> str:
    """The outcome of required checks, and separately of checks that exist for comparison and may fail."""
    groups = {
        "": [row for row in stability.rows if row.must_pass],
        " to compare": [row for row in stability.rows if not row.must_pass],
    }
    words = [
        f"{number} {status}{which}"
        for which, rows in groups.items()
        for status in (PASSED, FAILED, BROKEN, KNOWN_LIMIT)
        if (number := count(rows, status))
    ]
    return ", ".join(words) or "none"


def _cases_without(stability: Stability) -> list[Block]:
    return blocks_of(missing(stability), "Cases without checks", skip_heading=False)


def _missing_checks(stability: Stability) -> tuple[tuple[str, str, str], ...]:
    rows = [row for row in stability.rows if row.status == NOT_APPLICABLE]
    groups = Counter((row.case.shown, one_line(row.reason) or "no reason given") for row in rows)
    found = [(case, reason, plural(number, "check")) for (case, reason), number in groups.items()]
    lacking = [
        (case.shown, one_line(case.missing_feature), "the case") for case in stability.cases if case.missing_feature
    ]
    return (*found, *lacking)


def _stability_doubts(stability: Stability) -> list[tuple[str, int, str]]:
    checks = plural(len(stability.rows), "check")
    to_compare = sum(row.is_failure and not row.must_pass for row in stability.rows)
    found = [
        ("run not complete: checks may be missing", int(not stability.is_complete), "1 run"),
        ("checks that are known limits", count(stability.rows, KNOWN_LIMIT), checks),
        ("checks that failed or broke in variants that are there to compare", to_compare, checks),
    ]
    return [row for row in found if row[1]]
