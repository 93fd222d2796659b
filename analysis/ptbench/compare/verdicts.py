"""Verdicts on the pairs of two result files: a ratio each, geometric means, and what the machines' capacities explain.

The rules are those of every table (ptbench.stats.estimates), except that a difference within a known noise floor counts
as none, and that cycles do not veto a verdict between machines, as the clock is part of the comparison.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ptbench.compare.match import Matching, Pair, is_repeated, machine_of
from ptbench.compare.noise import Floor
from ptbench.io.cells import GPU_BACKEND, Cell, Result
from ptbench.stats.estimates import (
    CLOCK_UNKNOWN,
    FASTER,
    SAME,
    SLOWER,
    THRESHOLD,
    UNSURE,
    Estimate,
    Verdict,
    confirmed,
    geometric_mean_of_ratios,
    verdict_of_ratio,
    withheld,
)
from ptbench.studies.disturbed import CONTENDED, THROTTLED, disturbance_of
from ptbench.studies.rows import cycles_ratio, time_ratio

WORDS = (SLOWER, UNSURE, SAME, FASTER)  # verdicts of a comparison, the worst first


@dataclass(frozen=True)
class Row:
    """A pair of cells with its ratios, other file over reference: below 1 is faster."""

    pair: Pair
    ratio: Estimate
    cycles: Estimate | None
    verdict: Verdict
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Capacity:
    """What a machine can do: units x clock, and memory bandwidth. None or 0 where the result file does not say."""

    units: int
    unit: str
    clock_mhz: float | None
    clock_from: str
    bandwidth_gb_s: float | None


@dataclass(frozen=True)
class Normalised:
    """A geometric mean of ratios, scaled by how much more the other machine has of a resource; 1: fast for its size."""

    by: str
    factor: float | None
    ratio: Estimate | None
    how: str  # sentence on how the ratio was normalised by the machines' capacity, or why it was not


@dataclass(frozen=True)
class Mean:
    """A geometric mean over `used` pairs; `left_out` pairs lacked the values that it needs."""

    estimate: Estimate | None
    verdict: Verdict | None
    used: int
    left_out: int
    smallest: float | None
    largest: float | None


@dataclass(frozen=True)
class Comparison:
    """Two result files compared; ratios are other over reference."""

    reference: Result
    other: Result
    matching: Matching
    rows: tuple[Row, ...]  # rows of the comparison, the worst first
    threshold: float
    floors: tuple[Floor, ...]
    time: Mean
    cycles: Mean
    normalised: tuple[Normalised, ...]
    one_machine: bool
    repeated: bool  # whether both files are of one machine and one program: an A/A run
    no_floors: tuple[Floor, ...] = ()  # noise floors too large to be plausible; if there is any, no verdict is given

    def count(self, word: str) -> int:
        """The number of cells with a verdict."""
        return sum(row.verdict.word == word for row in self.rows)


def compare(matching: Matching, floors: Sequence[Floor]) -> Comparison:
    """Compares the pairs of a matching, of which there must be one; the larger of the machines' `floors` counts."""
    reference, other = matching.reference, matching.other
    no_floors = tuple(floor for floor in floors if not floor.is_plausible)
    floors = [floor for floor in floors if floor.is_plausible]
    threshold = max([THRESHOLD, *(floor.threshold for floor in floors)])
    refusal = "; ".join(floor.refusal for floor in no_floors)
    one_machine = machine_of(reference) == machine_of(other)
    rows = [_row(pair, threshold, one_machine, refusal) for pair in matching.pairs]
    rows.sort(key=lambda row: (WORDS.index(row.verdict.word), -row.ratio.value, row.pair.reference.name))
    time = _mean([(row.pair.other.ms_per_spp, row.pair.reference.ms_per_spp) for row in rows], len(rows), threshold)
    clocked = [
        (row.pair.other.mega_cycles_per_spp, row.pair.reference.mega_cycles_per_spp)
        for row in rows
        if row.cycles is not None
    ]
    cycles = _mean(clocked, len(rows), threshold)
    if one_machine and cycles.verdict is not None and not cycles.left_out:
        time = replace(time, verdict=confirmed(time.verdict, cycles.verdict))
    elif one_machine:
        time = replace(time, verdict=replace(time.verdict, note=f"{CLOCK_UNKNOWN} in {cycles.left_out} pairs"))
    sides = [[pair.reference for pair in matching.pairs], [pair.other for pair in matching.pairs]]
    if reason := refusal or _too_much(sides):
        time, cycles = (
            mean if mean.verdict is None else replace(mean, verdict=withheld(mean.verdict, reason))
            for mean in (time, cycles)
        )
    return Comparison(
        reference,
        other,
        matching,
        tuple(rows),
        threshold,
        tuple(floors),
        time,
        cycles,
        () if one_machine else (_by_clock(reference, other, time, cycles), _by_bandwidth(reference, other, time)),
        one_machine,
        is_repeated(reference, other),
        no_floors,
    )


def _too_much(sides: Sequence[Sequence[Cell]]) -> str:
    """Why a mean has no verdict: the rule for one cell, over all samples (contention only; cycles cover the clock)."""
    for cells in sides:
        found = disturbance_of(cells)
        if replace(found, disturbed=found.contended).is_too_much:
            return THROTTLED if found.throttled else CONTENDED
    return ""


def _row(pair: Pair, threshold: float, one_machine: bool, refusal: str) -> Row:
    ratio, verdict = time_ratio(pair.other, pair.reference, threshold, one_clock=one_machine)
    if refusal and not verdict.withheld:
        verdict = withheld(verdict, refusal)
    remarks = [*((verdict.said,) if verdict.said else ()), *pair.remarks]
    for name, cell in (("reference", pair.reference), ("other", pair.other)):
        for kind, count in (("low-clock", cell.low_clock_samples), ("contended", cell.contended_samples)):
            if count:
                remarks.append(f"{count} {kind} ({name})")
        if cell.status == "interrupted":
            remarks.append(f"interrupted ({name})")
    if pair.reference.claim == "biased":
        remarks.append("biased")
    return Row(pair, ratio, cycles_ratio(pair.other, pair.reference), verdict, tuple(remarks))


def _mean(sides: Sequence[tuple[np.ndarray, np.ndarray]], of: int, threshold: float) -> Mean:
    if not sides:
        return Mean(None, None, 0, of, None, None)
    estimate = geometric_mean_of_ratios(sides)
    ratios = [float(np.median(values) / np.median(baseline)) for values, baseline in sides]
    verdict = verdict_of_ratio(estimate, threshold)
    return Mean(estimate, verdict, len(sides), of - len(sides), min(ratios), max(ratios))


def capacity_of(result: Result) -> Capacity:
    """A machine's multiprocessors (CPU: threads) and their clock: as sampled around the renders, else as rated."""
    on_gpu = result.about("backend") == GPU_BACKEND
    clocks = [
        0.5 * (sample.clock_mhz_before + sample.clock_mhz_after)
        for cell in result.cells
        for sample in cell.samples
        if sample.clock_mhz_before and sample.clock_mhz_after
    ]
    rated = _number(result, "cuda_clock_mhz") if on_gpu else None
    clock = float(np.median(clocks)) if clocks else rated
    units = _number(result, "cuda_multiprocessors" if on_gpu else "threads")
    memory, bus = _number(result, "cuda_memory_clock_mhz"), _number(result, "cuda_memory_bus_bits")
    return Capacity(
        int(units or 0),
        "SMs" if on_gpu else "threads",
        clock,
        "sampled" if clocks else "rated",
        # Peak memory bandwidth in GB/s at two transfers per clock, as the CUDA runtime computes this figure.
        2 * memory * 1e6 * bus / 8 / 1e9 if on_gpu and memory and bus else None,
    )


def _number(result: Result, key: str) -> float | None:
    try:
        value = float(result.about(key))
    except ValueError:
        return None
    return value if value > 0 and np.isfinite(value) else None


def _by_clock(reference: Result, other: Result, time: Mean, cycles: Mean) -> Normalised:
    mine, theirs = capacity_of(reference), capacity_of(other)
    by = "SM x clock" if mine.unit == theirs.unit == "SMs" else "threads x clock"
    if mine.unit != theirs.unit:
        by = "units x clock"
        return Normalised(by, None, None, f"{mine.units} {mine.unit} and {theirs.units} {theirs.unit} do not compare")
    if not mine.units or not theirs.units:
        return Normalised(by, None, None, f"a file does not say how many {mine.unit} its machine has")
    factor = theirs.units / mine.units
    if cycles.estimate is not None and not cycles.left_out:
        how = f"cycles x {theirs.units} {theirs.unit} over cycles x {mine.units}, clocks as sampled round each render"
        return Normalised(by, factor, _scaled(cycles.estimate, factor), how)
    if mine.clock_mhz is None or theirs.clock_mhz is None:
        return Normalised(by, None, None, "a file does not say the clock of its machine")
    factor *= theirs.clock_mhz / mine.clock_mhz
    how = (
        f"time x {theirs.units} {theirs.unit} x {theirs.clock_mhz:.0f} MHz ({theirs.clock_from}) over "
        f"time x {mine.units} x {mine.clock_mhz:.0f} MHz ({mine.clock_from})"
    )
    return Normalised(by, factor, _scaled(time.estimate, factor), how)


def _by_bandwidth(reference: Result, other: Result, time: Mean) -> Normalised:
    mine, theirs = capacity_of(reference).bandwidth_gb_s, capacity_of(other).bandwidth_gb_s
    if mine is None or theirs is None:
        silent = reference if mine is None else other
        how = f"{silent.path} does not say its memory's clock and bus"
        return Normalised("memory bandwidth", None, None, how)
    how = f"time x {theirs:.0f} GB/s over time x {mine:.0f} GB/s; peak = 2 x memory clock x bus width"
    return Normalised("memory bandwidth", theirs / mine, _scaled(time.estimate, theirs / mine), how)


def _scaled(estimate: Estimate, factor: float) -> Estimate:
    low, high = (None if end is None else end * factor for end in (estimate.low, estimate.high))
    return Estimate(estimate.value * factor, low, high, estimate.n)
