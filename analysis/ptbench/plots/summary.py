"""Writes summary.md: the figures' numbers as tables, with verdicts, and everything that was not measured."""

from collections.abc import Iterable, Sequence

from ptbench.convergence.tables import convergence_rules, convergence_tables
from ptbench.document.blocks import Lines
from ptbench.document.markdown import markdown
from ptbench.document.table import table_of
from ptbench.io.cells import Cell, Result, Study
from ptbench.io.files import one_line
from ptbench.io.limits import limit
from ptbench.numbers import figures, interval, plural, ratio
from ptbench.stats.estimates import INTERVAL_TEXT, VERDICT_RULE, Estimate, interval_of_ratio, telling_digits
from ptbench.studies.disturbed import disturbance_in
from ptbench.studies.gpu import about_gpu, gpu_line, hottest_kernel
from ptbench.studies.notes import Note, notes_of
from ptbench.studies.questions import question_of, usual_baseline
from ptbench.studies.rows import Row, measure
from ptbench.studies.variants import TableNames, table_names
from ptbench.studies.withdrawn import concerning

_ADD_UP_WITHIN = limit("stages_add_up_within")
_COLUMNS = (
    "Variant", "Scene", "Depth", "Resolution", "Backend", "spp", "n", "ms/spp", "95 % interval", "Mrays/s",
    "Ratio", "Ratio's 95 % interval", "Verdict", "Remarks",
)  # fmt: skip
# Columns that a table has before its remarks if the study ran on a GPU.
_GPU_COLUMNS = ("Device/wall", "Launches/spp", "Host waits/spp", "Hottest kernel's registers")
_NUMERIC = {
    "Depth", "spp", "n", "ms/spp", "95 % interval", "Mrays/s", "Ratio", "Ratio's 95 % interval",
    "Device/wall", "Launches/spp", "Host waits/spp", "Hottest kernel's registers",
}  # fmt: skip
GPU_TEXT = (
    "On a GPU: device time over render wall time is the median of the samples'; launches are kernels, copies and "
    "graphs that the host enqueues, host waits how often it waits for the device meanwhile; the hottest kernel is that "
    "of the longest stage whose kernel is ours."
)


def summary(result: Result, not_drawn: dict[str, Sequence[str]], notes: dict[str, Sequence[Note]]) -> str:
    """The summary page as Markdown; by study name, `not_drawn` tells why a figure is missing, `notes` is on figures."""
    lines: Lines = [f"# {result.suite or result.path.stem}: what was measured", ""]
    lines += [f"- {key}: {one_line(value)}" for key, value in about(result)]
    lines += [""]
    lines += [f"Times are medians of render wall time per sample per pixel. Intervals: {INTERVAL_TEXT}.", ""]
    lines += [VERDICT_RULE, "Low-clock samples are flagged, never dropped.", ""]
    if any(cell.on_gpu for cell in result.cells):
        lines += [GPU_TEXT, ""]
    lines += convergence_rules(result)
    for study in result.studies:
        lines += study_section(
            result, study, f"## {study.title or study.name}", not_drawn.get(study.name, ()), notes.get(study.name)
        )
    if not result.studies:
        lines += ["The file has no studies.", ""]
    if any(not cell.studies for cell in result.cells):
        lines += study_section(result, None, "## Cells of no study", (), None)
    lines += stages(result) + on_device(result) + not_applicable(result) + failed(result.cells)
    return markdown(lines)


def about(result: Result) -> list[tuple[str, str]]:
    """Facts about the whole result file, as (name, text)."""
    on_gpu = any(cell.on_gpu for cell in result.cells)
    host = f"{result.about('cpu_model')}, {plural(result.about('threads'), 'thread')}"
    return [
        ("Result file", result.path.name),
        ("Run", "INTERRUPTED: cells and samples may be missing" if result.interrupted else result.about("status")),
        ("Disturbed", disturbance_in(result)),
        *(("Withdrawn", entry.full) for entry in concerning(result.cells)),
        ("Machine", result.about("machine") + ("" if on_gpu else f": {host}")),
        *(about_gpu(result, host) if on_gpu else ()),
        ("Backend", result.about("backend")),
        (
            "System",
            f"{result.about('os')}; {result.about('compiler')} {result.context.get('ptbench.compiler_flags', '')}",
        ),
        ("ptbench", f"{result.about('version')}, git {result.git}, {result.context['date'] or 'no date'}"),
        ("Command", f"`{result.about('command_line')}`"),
    ]


def study_section(
    result: Result, study: Study | None, heading: str, not_drawn: Sequence[str], notes: Sequence[Note] | None
) -> Lines:
    """The table and notes of a study; without a study, those of the cells that belong to none."""
    rows = measure(result, study)
    lines: Lines = [heading, ""]
    question = question_of(result, study)
    if question is not None:
        usual = usual_baseline(result, question.axis)
        instead = "" if usual in (None, question.baseline) else f" The study was not run with {question.axis}={usual}."
        lines += [f"Baseline: {question.axis}={question.baseline}, all else equal.{instead}", ""]
    for reason in not_drawn:
        lines += [f"Not drawn: {one_line(reason)}", ""]
    if study is not None and any(row.cell.convergence is not None for row in rows):
        lines += convergence_tables(result, study)
    elif rows:
        on_gpu = any(row.cell.on_gpu for row in rows)
        columns = (*_COLUMNS[:-1], *_GPU_COLUMNS, _COLUMNS[-1]) if on_gpu else _COLUMNS
        named = table_names(result, [row.cell for row in rows])
        lines += named.above()
        lines += [table_of(columns, (_table_row(row, on_gpu, named) for row in rows), _NUMERIC), ""]
        if on_gpu:
            lines += [gpu_line(result, [row.cell for row in rows]), ""]
    else:
        lines += ["No cells.", ""]
    notes = notes_of(result, study, rows) if notes is None else notes
    if notes:
        lines += [f"- {note.kind}: {one_line(note.full)}" for note in notes] + [""]
    return lines


def _table_row(row: Row, on_gpu: bool, named: TableNames) -> list[str]:
    cell = row.cell
    verdict = "baseline" if row.is_baseline and row.estimate else row.verdict.word if row.verdict else "—"
    return [
        named.names[cell.name],
        cell.scene,
        str(cell.depth),
        cell.resolution_text,
        cell.backend,
        str(cell.spp),
        str(len(cell.samples)),
        figures(row.estimate.value) if row.estimate else "—",
        _ends(row.estimate),
        figures(row.mega_rays_per_second.value) if row.mega_rays_per_second else "—",
        ratio(row.ratio.value) if row.ratio else "—",
        (interval_of_ratio(row.ratio) if row.ratio else "") or "—",
        "FAILED" if cell.failed else verdict,
        *(_gpu_columns(cell) if on_gpu else ()),
        "; ".join(_remarks(row)),
    ]


def _gpu_columns(cell: Cell) -> list[str]:
    launches, nodes, waits = (cell.work_per_spp(name) for name in ("launches", "graph_nodes", "host_waits"))
    return [
        "—" if cell.device_share is None else f"{cell.device_share:.3f}",
        "—" if launches is None else f"{launches:.4g}" + (f" ({nodes:.4g} graph nodes)" if nodes else ""),
        "—" if waits is None else f"{waits:.4g}",
        hottest_kernel(cell) or "—",
    ]


def _ends(estimate: Estimate | None) -> str:
    return "—" if estimate is None else interval(estimate.low, estimate.high)


def _remarks(row: Row) -> Iterable[str]:
    cell = row.cell
    if cell.failed:
        yield cell.failure
    if cell.status == "interrupted":
        yield "interrupted" + (f": {cell.reason}" if cell.reason else "")
    if not cell.failed and not cell.samples:
        yield "no samples"
    if row.verdict and row.verdict.said:
        yield row.verdict.said
    if cell.low_clock_samples:
        yield f"{cell.low_clock_samples} low-clock"
    if cell.contended_samples:
        yield f"{cell.contended_samples} contended"
    if cell.claim == "biased":
        yield "biased" + (f": {cell.reason or cell.claim_check}" if cell.reason or cell.claim_check else "")
    for counter in ("nonfinite", "negative", "saturated", "unfinished_walks"):
        if getattr(cell, counter):
            yield f"{counter.replace('_', ' ')} {getattr(cell, counter)}"


def stages(result: Result) -> Lines:
    """The table of stage times: each stage's share of the instrumented pass, whose total time is no result."""
    cells = [cell for cell in result.cells if cell.instrumented is not None and cell.instrumented.wall_ms]
    if not cells:
        return []
    names = list(dict.fromkeys(name for cell in cells for name in cell.instrumented.stage_ms))
    lines: Lines = ["## Where the time goes", ""]
    lines += ["Shares of the instrumented pass's wall time. Where they miss it by more than 5 %, the row says so.", ""]
    # The resolution gets a column only where cells differ in it, which keeps summaries of older files unchanged.
    sizes = len({cell.resolution for cell in cells}) > 1
    head = ["Variant", "Scene", "Depth", *(["Resolution"] if sizes else []), *names, "rest", "Remarks"]
    named = table_names(result, cells)
    lines += named.above()
    rows = []
    for cell in cells:
        wall = cell.instrumented.wall_ms
        times = [cell.instrumented.stage_ms.get(name) for name in names]
        rest = 1 - sum(ms for ms in times if ms is not None) / wall
        shares = ["—" if ms is None else f"{100 * ms / wall:.1f} %" for ms in times]
        remark = "stages do not add up to the wall time" if abs(rest) > _ADD_UP_WITHIN else ""
        ends = [-100 * _ADD_UP_WITHIN, 100 * _ADD_UP_WITHIN]
        digits = telling_digits([100 * rest], ends, lambda value, count: f"{value:.{count}f}", least=1)
        size = [cell.resolution_text] if sizes else []
        rows.append(
            (named.names[cell.name], cell.scene, str(cell.depth), *size, *shares, f"{100 * rest:.{digits}f} %", remark)
        )
    numeric = set(head) - {"Variant", "Scene", "Resolution", "Remarks"}
    return [*lines, table_of(head, rows, numeric), ""]


def on_device(result: Result) -> Lines:
    """The table of device memory and times of each cell, and of the compiler's resource usage for its kernels."""
    cells = [cell for cell in result.cells if cell.cuda is not None]
    if not cells:
        return []
    head = ("Variant", "Scene", "Resolution", "Threads a block", "Device MiB", "Bytes a path", "Prepare ms", "Kernels")
    lines: Lines = ["## On the device", ""]
    lines += [
        "Kernels: registers a thread, bytes of local memory a thread (arrays, spills), bytes of shared memory a block.",
        "",
    ]
    named = table_names(result, cells)
    lines += named.above()
    rows = []
    for cell in cells:
        cuda = cell.cuda
        kernels = [f"{name} {k.registers}/{k.local_bytes}/{k.shared_bytes}" for name, k in cuda.kernels.items()]
        rows.append(
            (
                named.names[cell.name],
                cell.scene,
                cell.resolution_text,
                "—" if cuda.block is None else str(cuda.block),
                "—" if cuda.device_bytes is None else f"{cuda.device_bytes / 2**20:.1f}",
                "—" if cuda.path_bytes is None else str(cuda.path_bytes),
                "—" if cuda.prepare_ms is None else figures(cuda.prepare_ms),
                ", ".join(kernels) or "—",
            )
        )
    return [*lines, table_of(head, rows, head[3:7]), ""]


def not_applicable(result: Result) -> Lines:
    """The section on variants that were left out before the run, with reasons."""
    lines: Lines = ["## Not applicable", ""]
    if not result.not_applicable:
        return [*lines, "None.", ""]
    entries = dict.fromkeys((item.study, item.scene, item.variant, item.reason) for item in result.not_applicable)
    return [*lines, table_of(("Study", "Scene", "Variant", "Reason"), entries), ""]


def failed(cells: Sequence[Cell]) -> Lines:
    """The section on cells that failed, with reasons."""
    bad = [cell for cell in cells if cell.failed]
    if not bad:
        return ["## Failed", "", "None.", ""]
    return ["## Failed", "", *(f"- {one_line(cell.shown)}: {one_line(cell.failure)}" for cell in bad), ""]
