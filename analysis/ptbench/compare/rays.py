"""`compare` of files of `ptbench rays`: the rate of every batch that is in both, and whether its hits are the same.

A batch is identified by its mesh's triangles (their hash), its tree's accelerator and builder, its class of rays and
its kernel. Batches whose hits differ get no ratio: other rays were traced, or one result is wrong.
"""

from argparse import Namespace
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ptbench.compare.gate import Outcome
from ptbench.compare.text import MARKS
from ptbench.document.blocks import Section, section
from ptbench.document.table import table_of
from ptbench.errors import InputError, bad_value
from ptbench.io.nodes import read_json
from ptbench.io.rays import Batch, Rays, is_rays, rays_of
from ptbench.numbers import figures, ratio
from ptbench.stats.estimates import (
    FASTER,
    SLOWER,
    Estimate,
    Verdict,
    geometric_mean_of_ratios,
    interval_of_ratio,
    median_estimate,
    ratio_estimate,
    verdict_of_ratio,
)

SCHEMA_VERSION = "1"
_COLUMNS = (
    "Mesh",
    "Accelerator",
    "Builder",
    "Rays",
    "Kernel",
    "A, G rays/s",
    "G rays/s",
    "Time over A's",
    "",
    "Verdict",
)
Key = tuple[str, str, str, str, str, str]  # batch's mesh, triangle hash, accelerator, builder, ray class and kernel


@dataclass(frozen=True)
class Pair:
    """A batch of rays that both compared files contain."""

    key: Key
    one: Batch
    other: Batch

    @property
    def same_hits(self) -> bool:
        """Whether a batch has the same hits in both files, bit for bit."""
        return (self.one.checksum, self.one.rays) == (self.other.checksum, self.other.rays)

    @cached_property
    def ratio(self) -> Estimate:
        """The time of a batch over its time in the reference file."""
        return ratio_estimate(np.array(self.other.ms), np.array(self.one.ms))

    @property
    def verdict(self) -> Verdict:
        """The verdict on a batch by its time alone, as no clock frequency was sampled around it."""
        return verdict_of_ratio(self.ratio)


@dataclass(frozen=True)
class Against:
    """A file of `ptbench rays` compared with the first file."""

    other: Rays
    pairs: tuple[Pair, ...]
    alone: tuple[int, int]  # numbers of batches without a partner, in the reference and in the other file

    @property
    def judged(self) -> tuple[Pair, ...]:
        """The pairs of batches whose hits are the same in both files."""
        return tuple(pair for pair in self.pairs if pair.same_hits)


@dataclass(frozen=True)
class RaysCompared:
    """Everything that a comparison of files of `ptbench rays` found."""

    files: tuple[Rays, ...]
    comparisons: tuple[Against, ...]


def check_rays_options(options: Namespace) -> None:
    """Raises InputError for options of `compare` that do not apply to files of `ptbench rays`."""
    if options.noise or options.films_may_differ or "failed" in options.fail_on:
        raise InputError("compare: found --noise, --films-may-differ or --fail-on failed, allowed: not of ptbench rays")


def compare_rays_files(paths: Sequence[Path]) -> RaysCompared:
    """Loads and compares files of `ptbench rays`; raises InputError also for files without a batch in common."""
    files = []
    for path in paths:
        root = read_json(path)
        if not is_rays(root):
            raise bad_value(path, "$", "another kind of file", "a file of ptbench rays, as the first one is")
        files.append(rays_of(root))
    return RaysCompared(tuple(files), tuple(_against(files[0], other) for other in files[1:]))


def _batches(file: Rays) -> dict[Key, Batch]:
    return {
        (mesh.name, mesh.hash, tree.accelerator, tree.builder, batch.ray_class, batch.kernel): batch
        for mesh in file.meshes
        for tree in mesh.trees
        for batch in tree.batches
    }


def _against(reference: Rays, other: Rays) -> Against:
    ours, theirs = _batches(reference), _batches(other)
    common = [key for key in ours if key in theirs]
    if not common:
        raise bad_value(other.path, "its batches", "none", f"a batch that {reference.path} has, too")
    pairs = tuple(Pair(key, ours[key], theirs[key]) for key in common)
    return Against(other, pairs, (len(ours) - len(common), len(theirs) - len(common)))


def rays_outcome(compared: RaysCompared, what: str) -> Outcome:
    """The outcome of `--fail-on` for files of `ptbench rays`; `what` is slower, different or unmatched."""
    if what == "unmatched":
        alone = sum(one.alone[0] for one in compared.comparisons)
        text, fails = f"{alone} batches of the reference have no partner", alone > 0
    else:
        words = (SLOWER,) if what == "slower" else (SLOWER, FASTER)
        pairs = [pair for one in compared.comparisons for pair in one.pairs]
        found = sum(pair.same_hits and pair.verdict.word in words for pair in pairs)
        apart = sum(not pair.same_hits for pair in pairs)
        text = f"{found} of {len(pairs)} batches {' or '.join(words)}; the hits of {apart} differ"
        fails = found + apart > 0
    return Outcome(fails, f"--fail-on {what}: {'FAILED' if fails else 'passed'}: {text}.")


def rays_sections(compared: RaysCompared) -> list[Section]:
    """The report on files of `ptbench rays`."""
    rows = tuple(
        (
            mark,
            str(file.path),
            file.backend,
            file.about("cuda_device" if file.backend == "cuda" else "cpu_model"),
            file.about("git_sha")[:12],
            file.context.get("date", "no date"),
        )
        for mark, file in zip(MARKS, compared.files, strict=False)
    )
    found = [section("Files", (), table_of(("", "File", "Backend", "Device", "git", "Date"), rows))]
    for mark, against in zip(MARKS[1:], compared.comparisons, strict=False):
        found.append(_section(against, mark))
    return found


def _section(against: Against, mark: str) -> Section:
    judged = against.judged
    lines = [
        f"{len(against.pairs)} batches are in both; {against.alone[0]} are in A alone, {against.alone[1]} in {mark} "
        f"alone. The same hits, bit for bit, have {len(judged)}.",
        "Verdicts are in time alone: no clock was measured round a batch, and no run of A/A tells the noise floor.",
    ]
    if judged:
        mean = _mean(judged)
        lines.append(f"Time, geometric mean of {len(judged)}: {ratio(mean.value)} {interval_of_ratio(mean)} of A's.")
    columns = (*_COLUMNS[:6], f"{mark}, G rays/s", *_COLUMNS[7:])
    table = table_of(columns, tuple(map(_row, against.pairs)), columns[5:8])
    return section(f"{mark} against A", tuple(lines), table)


def _mean(pairs: Sequence[Pair]) -> Estimate:
    return geometric_mean_of_ratios([(np.array(pair.other.ms), np.array(pair.one.ms)) for pair in pairs])


def _rate(batch: Batch) -> float:
    return median_estimate(batch.giga_rays_per_second).value


def _row(pair: Pair) -> tuple[str, ...]:
    mesh, _, accelerator, builder, ray_class, kernel = pair.key
    named = (mesh, accelerator, builder or "—", ray_class, kernel, figures(_rate(pair.one)), figures(_rate(pair.other)))
    if not pair.same_hits:
        return (*named, "—", "", "other hits")
    verdict = pair.verdict
    said = verdict.word + (f": {verdict.said}" if verdict.said else "")
    return (*named, ratio(pair.ratio.value), interval_of_ratio(pair.ratio), said)


def rays_json(compared: RaysCompared) -> dict:
    """The comparison of files of `ptbench rays` as JSON."""
    return {
        "schema_version": SCHEMA_VERSION,
        "files": [{"path": str(file.path), "context": file.context} for file in compared.files],
        "comparisons": [_json_of(against) for against in compared.comparisons],
    }


def _json_of(against: Against) -> dict:
    return {
        "other": str(against.other.path),
        "alone": {"reference": against.alone[0], "other": against.alone[1]},
        "geometric_mean": _estimate(_mean(against.judged)) if against.judged else None,
        "pairs": [
            {
                **dict(zip(("mesh", "hash", "accelerator", "builder", "class", "kernel"), pair.key, strict=True)),
                "giga_rays_per_second": [_rate(pair.one), _rate(pair.other)],
                "same_hits": pair.same_hits,
                "ratio": _estimate(pair.ratio) if pair.same_hits else None,
                "verdict": pair.verdict.word if pair.same_hits else None,
            }
            for pair in against.pairs
        ],
    }


def _estimate(value: Estimate) -> dict:
    return {"value": value.value, "low": value.low, "high": value.high, "n": value.n}
