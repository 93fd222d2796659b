"""Raw rows of a report as CSV: one row per sample, checkpoint or check, with all identifying values in columns."""

import csv
import gzip
import io
from collections.abc import Iterable, Sequence

from ptbench.document.blocks import Download
from ptbench.io.cells import WORK_COUNTERS, Cell, Result, Sample
from ptbench.io.convergence import CLOCKS, METRICS
from ptbench.io.stability import Row, Stability
from ptbench.terminal import visible

_FILE = ("file", "suite", "machine", "git_sha", "git_dirty", "date")
_CELL = (
    "cell", "studies", "scene", "scene_hash", "backend", "variant", "width", "height", "depth", "spp", "status",
    "claim", "film_hash",
)  # fmt: skip
_SAMPLE = (
    "repetition", "seed", "order", "timestamp", "wall_ms", "device_ms", "cpu_ms", "end_to_end_ms", "ms_per_spp",
    "rays", "paths", "clock_mhz_before", "clock_mhz_after", "low_clock", "contended",
)  # fmt: skip
_CHECKPOINT = ("checkpoint_spp", *CLOCKS, *METRICS, "me_red", "me_green", "me_blue", "nonfinite", "shared", "film_hash")


def _file_values(result: Result | Stability) -> list[str]:
    about = [result.context.get(f"ptbench.{key}", "") for key in ("machine", "git_sha", "git_dirty")]
    return [visible(result.path.name), result.suite, *about, result.context.get("date", "")]


def sample_rows(result: Result) -> Iterable[Sequence[object]]:
    """The CSV header and a row per sample; failed samples have an `error` and no times."""
    axes = list(dict.fromkeys(axis for cell in result.cells for axis in cell.axes))
    tunables = list(dict.fromkeys(name for cell in result.cells for name in cell.tunables))
    yield (*_FILE, *_CELL, *axes, *(f"tunable_{name}" for name in tunables), *_SAMPLE, *WORK_COUNTERS, "error")
    file = _file_values(result)
    for cell in result.cells:
        about = [*file, *_cell_values(cell), *(cell.axes.get(axis, "") for axis in axes)]
        about += [cell.tunables.get(name, "") for name in tunables]
        for sample in cell.samples:
            work = [sample.work.get(name) for name in WORK_COUNTERS]
            yield (*about, *_sample_values(sample), *work, "")
        for error in cell.errors:
            yield (*about, *[""] * (len(_SAMPLE) + len(WORK_COUNTERS)), error or "no message")


def _cell_values(cell: Cell) -> list[object]:
    return [
        cell.name, ";".join(cell.studies), cell.scene, cell.scene_hash, cell.backend, cell.variant, *cell.resolution,
        cell.depth, cell.spp, cell.status, cell.claim, cell.film_hash,
    ]  # fmt: skip


def _sample_values(sample: Sample) -> list[object]:
    values = [getattr(sample, name) for name in _SAMPLE]
    return [int(value) if isinstance(value, bool) else value for value in values]


def checkpoint_rows(result: Result) -> Iterable[Sequence[object]]:
    """The CSV header and a row per checkpoint of each sample, with cell and repetition as in `sample_rows`."""
    yield (*_FILE, "cell", "repetition", "seed", *_CHECKPOINT)
    file = _file_values(result)
    for cell in result.cells:
        for sample in cell.samples:
            for point in sample.checkpoints:
                yield (
                    *file, cell.name, sample.repetition, sample.seed, point.spp,
                    *(point.times.get(clock) for clock in CLOCKS), *(point.errors[metric] for metric in METRICS),
                    *(point.mean_error or (None,) * 3), point.nonfinite, int(point.shared), point.film_hash,
                )  # fmt: skip


def check_rows(stability: Stability) -> Iterable[Sequence[object]]:
    """The CSV header and a row per stability check; parameters as NAME=VALUE, separated by semicolons."""
    axes = list(dict.fromkeys(axis for row in stability.rows for axis in row.axes))
    numbers = ("quantity", "relation", "value", "exact", "error", "allowed", "standard_error")
    yield (
        *_FILE, "case", "catalogue", "family", "point", "variant", *axes, "status", "must_pass", *numbers, "looks",
        "reason",
    )  # fmt: skip
    file = _file_values(stability)
    for row in stability.rows:
        measured = [getattr(row.measured, name) if row.measured is not None else None for name in numbers]
        yield (
            *file, row.case.name, row.case.catalogue, row.case.family, _point(row), row.variant,
            *(row.axes.get(axis, "") for axis in axes), row.status, int(row.must_pass), *measured, row.looks,
            row.reason,
        )  # fmt: skip


def _point(row: Row) -> str:
    return ";".join(f"{name}={value!r}" for name, value in row.point)


def download(name: str, rows: Iterable[Sequence[object]], about: str) -> Download:
    """Rows as a compressed CSV download; numbers survive a round trip, and equal rows give equal bytes (no date)."""
    with io.StringIO(newline="") as text:
        count = 0
        writer = csv.writer(text, lineterminator="\n")
        for count, row in enumerate(rows):  # noqa: B007 - the head is row 0
            writer.writerow(row)
        return Download(name, gzip.compress(text.getvalue().encode(), mtime=0), count, about)
