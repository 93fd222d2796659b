"""The findings of `fleet` in words and tables."""

from collections.abc import Iterable

import numpy as np

from ptbench.compare.text import MARKS, Labels, estimate_text, files_section, ranking_sections
from ptbench.compare.verdicts import WORDS
from ptbench.document.blocks import Section, section
from ptbench.document.table import table_of
from ptbench.extras.fleet.evidence import NEAR
from ptbench.extras.fleet.fleet import BAR, NEAR_ENOUGH, Fleet, Other, Prediction
from ptbench.extras.fleet.gpus import Gpu
from ptbench.extras.fleet.model import MEMORY, USED
from ptbench.extras.fleet.verdicts import crossover, ran_one_program, verdict_pairs
from ptbench.io.axes import INTEGRATOR
from ptbench.io.inspection import Inspected, KernelCounters
from ptbench.numbers import figures, interval, ratio

MODEL = (
    "Model: t' / t = e B / B' + (1 - e) C / C', a kernel; e = m (1 - u) / (1 - m u): the part of time in which memory "
    "works and pipes do not; m, u: the parts of the memory's ceiling and of the nearest pipe's that it reached on the "
    "first GPU; B: bandwidth; C: multiprocessors x clock x instructions a clock of the nearest other ceiling; primes: "
    "the other GPU. A variant's ratio is its kernels' by their time; the host's part of a render stays. Caches of "
    "another size are not modelled."
)


def sections(fleet: Fleet, *, whole: bool) -> list[Section]:
    """The report of `fleet`; `whole` lists every cell."""
    compared = fleet.compared
    found = [files_section(compared.results), gpus_section(fleet)]
    for mark, other in zip(MARKS[1:], fleet.others, strict=False):
        found += [ratios_section(mark, other), verdicts_section(mark, other, compared.labels)]
    found += ranking_sections(compared.rankings, compared.labels, compared.ranked, whole)
    found.append(changes_section(fleet))
    for mark, other in zip(MARKS[1:], fleet.others, strict=False):
        found += prediction_sections(mark, other, compared.labels)
    if fleet.unowned:
        found.append(unowned_section(fleet))
    if fleet.static:
        found.append(static_section(fleet.static))
    return found


def gpus_section(fleet: Fleet) -> Section:
    """The section on the peak rates of each GPU."""
    gpus = [fleet.first, *(other.gpu for other in fleet.others), *(one.gpu for one in fleet.unowned)]
    rows = [
        (
            mark,
            gpu.name,
            gpu.capability,
            str(gpu.multiprocessors),
            figures(gpu.clock_mhz),
            figures(gpu.gb_per_second),
            figures(gpu.l2_bytes / (1 << 20), 3),
            _over(gpu, fleet.first),
            gpu.source,
        )
        for mark, gpu in zip([*MARKS[: 1 + len(fleet.others)], *[""] * len(fleet.unowned)], gpus, strict=True)
    ]
    columns = ("", "GPU", "Capability", "SMs", "MHz", "GB/s", "L2 MiB", "SMs x clock, bandwidth of A's", "From")
    return section("GPUs", (), table_of(columns, rows, columns[3:7]))


def _over(gpu: Gpu, first: Gpu) -> str:
    return f"{ratio(gpu.rate('issue') / first.rate('issue'))}, {ratio(gpu.gb_per_second / first.gb_per_second)}"


def ratios_section(mark: str, other: Other) -> Section:
    """The section on time ratios of two GPUs by integrator; `compare` lists every cell."""
    by_integrator: dict[str, list] = {}
    for row in other.comparison.rows:
        by_integrator.setdefault(row.pair.reference.axes[INTEGRATOR], []).append(row)
    rows = []
    for integrator, found in sorted(by_integrator.items()):
        values = [row.ratio.value for row in found]
        counts = [sum(row.verdict.word == word for row in found) for word in WORDS]
        rows.append(
            (
                integrator,
                str(len(found)),
                *map(ratio, (min(values), float(np.median(values)), max(values))),
                *map(str, counts),
            )
        )
    columns = ("Integrator", "Cells", "Least", "Median", "Greatest", *WORDS)
    mean = other.comparison.time
    told = "none" if mean.estimate is None else estimate_text(mean.estimate, other.comparison.threshold)
    lines = (
        f"Ratio = median time on {mark} ({other.gpu.name}) / median time on {MARKS[0]}; below 1, {mark} is faster. "
        f"Geometric mean {told} over {mean.used} cells that both have.",
    )
    return section(f"{mark} against {MARKS[0]}", lines, table_of(columns, rows, columns[1:]))


def verdicts_section(mark: str, other: Other, label: Labels) -> Section:
    """The section on verdicts of the suite's studies that differ on the other GPU."""
    pairs = verdict_pairs(other.comparison)
    changed = [pair for pair in pairs if pair.is_changed]
    rows = [
        (
            f"{pair.study.name}: over {pair.axis}={pair.baseline}",
            pair.first.cell.scene,
            str(pair.first.cell.depth),
            label(pair.first.cell),
            f"{estimate_text(pair.first.ratio)} {pair.first.verdict.word}",
            f"{estimate_text(pair.other.ratio)} {pair.other.verdict.word}",
        )
        for pair in sorted(changed, key=lambda pair: not pair.is_turned)
    ]
    lines = (
        f"{sum(pair.is_decided for pair in pairs)} verdicts of studies say something on both {MARKS[0]} and {mark}; "
        f"{len(changed)} are another word there, {sum(pair.is_turned for pair in pairs)} turn from FASTER to SLOWER or "
        "back.",
    )
    columns = ("Study", "Scene", "Depth", "Variant", f"On {MARKS[0]}", f"On {mark}")
    table = table_of(columns, rows, {"Depth"}) if rows else None
    return section(f"Verdicts that change on {mark}", lines, table)


def changes_section(fleet: Fleet) -> Section:
    """The section on changed rankings, with the bandwidth of each change where GPUs differ in memory alone."""
    compared = fleet.compared
    gpus = [fleet.first, *(other.gpu for other in fleet.others)]
    ranked = tuple(gpu for mark, gpu in zip(MARKS, gpus, strict=False) if mark in compared.ranked)
    one_program = ran_one_program(compared.results)
    rows = []
    for group in compared.rankings:
        for change in group.changes:
            cells = [group.cells[variant][0] for variant in (change.ahead, change.behind)]
            at = crossover(group, change, ranked) if one_program else None
            told = "" if at is None else f"{figures(at.value)} {interval(at.low, at.high)}"
            ratios = f"{estimate_text(change.ratio)}", f"{estimate_text(change.turned_ratio)}"
            marks = [f" on {compared.ranked[file]}" for file in (change.at, change.turned_at)]
            rows.append(
                (group.scene, str(group.depth), *map(compared.labels, cells), ratios[0] + marks[0],
                 ratios[1] + marks[1], told)
            )  # fmt: skip
    lines = (
        "Equal at: the bandwidth, GB/s, at which the two variants of a change take equal time, if time is a + b / "
        "bandwidth; of two GPUs that differ in their memory alone (its caches' size counts as its bandwidth) and ran "
        "one program."
        + ("" if one_program else " These files are of several: a turn may be the program's as well as the GPU's."),
    )
    columns = ("Scene", "Depth", "Ahead", "Behind", "Ratio", "Turned", "Equal at")
    return section("Where the order turns", lines, table_of(columns, rows, {"Depth"}) if rows else None)


def prediction_sections(mark: str, other: Other, label: Labels) -> Iterable[Section]:
    """The sections on how well the rules predict, with every cell that has counters."""
    if not other.predictions:
        yield section(f"{mark} predicted", ("No variant has counters (--inspect).",))
        return
    yield _scores(mark, other)
    rows = sorted(other.predictions, key=lambda one: (one.cell.scene, -one.shares[MEMORY]))
    columns = (
        "Scene", "Depth", "Variant", "MB", "Bound", "Of memory's ceiling", "Of issue's", "Predicted", "Measured",
        "95 %", "Error", "Counters",
    )  # fmt: skip
    table = table_of(columns, tuple(_row(one, label) for one in rows), ("Depth", "MB", *columns[5:9], "Error"))
    alone = len(other.unpredicted)
    yield section(
        f"{mark} predicted, by variant",
        (
            f"{len(rows)} cells with counters; {alone} without, which are not predicted. Counters near: of the variant "
            "with other tunables, or in a render of another depth or resolution. MB: what the render keeps on the GPU.",
        ),
        table,
    )


def _row(one: Prediction, label: Labels) -> tuple[str, ...]:
    low, high = one.row.ratio.low, one.row.ratio.high
    return (
        one.cell.scene,
        str(one.cell.depth),
        label(one.cell),
        "" if (cuda := one.cell.cuda) is None or cuda.device_bytes is None else f"{cuda.device_bytes / 1e6:.0f}",
        one.bound,
        _percent(one.shares[MEMORY]),
        _percent(one.shares["issue"]),
        ratio(one.ratios[USED.name]),
        ratio(one.row.ratio.value),
        "" if low is None or high is None else f"[{ratio(low)}, {ratio(high)}]",
        _signed(one.error()),
        NEAR if not one.is_own else "own",
    )


def _scores(mark: str, other: Other) -> Section:
    rows = []
    for own in (True, False):
        for score in other.scores(own=own):
            rows.append(
                (
                    "its own" if own else "its own or near",
                    f"{score.rule.name}: {score.rule.said}",
                    f"{score.within} of {score.count}",
                    _percent(score.share),
                    _percent(score.mean),
                    _signed(score.worst),
                )
            )
    columns = ("Counters", "Rule", f"Within {NEAR_ENOUGH:.0%}", "Share", "Mean error", "Worst")
    own = other.scores(own=True)
    aim = f"Aim: within {NEAR_ENOUGH:.0%} of what was measured for at least {BAR:.0%} of the variants"
    verdict = "no variant was itself counted" if not own else "reached" if own[0].share >= BAR else "missed"
    lines = (MODEL, f"{aim}: {verdict}.", f"Counters are of {MARKS[0]}; nothing of {mark} was used but its data sheet.")
    return section(f"{mark} predicted from {MARKS[0]}", lines, table_of(columns, rows, columns[2:]))


def unowned_section(fleet: Fleet) -> Section:
    """The section on GPUs that are predicted from their data sheets alone."""
    label = fleet.compared.labels
    cells = [cell for cell in fleet.compared.results[0].cells if cell.name in fleet.unowned[0].ratios]
    rows = [
        (cell.scene, str(cell.depth), label(cell), *(ratio(one.ratios[cell.name]) for one in fleet.unowned))
        for cell in cells
    ]
    columns = ("Scene", "Depth", "Variant", *(one.gpu.name for one in fleet.unowned))
    lines = (
        f"Predicted from data sheets alone, never measured: time over that on {MARKS[0]}. Registers, occupancy and "
        "caches are taken to be the first GPU's, so the further an architecture is from it, the less this says.",
    )
    return section("GPUs that nobody here has", lines, table_of(columns, rows, (*columns[3:], "Depth")))


def static_section(entries: Iterable[Inspected]) -> Section:
    """The section on registers and occupancy of each kernel, by architecture."""
    by_kernel: dict[tuple[str, str, str], dict[str, KernelCounters]] = {}
    for entry in entries:
        for kernel in entry.kernels:
            by_kernel.setdefault((entry.scene, entry.variant, kernel.name), {})[entry.architecture] = kernel
    architectures = sorted({name for of in by_kernel.values() for name in of}, key=lambda name: (len(name), name))
    rows = [
        (*names, *(_kernel_text(of.get(architecture)) for architecture in architectures))
        for names, of in by_kernel.items()
    ]
    lines = (
        "Static: what the compiler makes for each architecture (`ptbench inspect --arch`), which needs no such GPU; "
        "nothing ran. Registers a thread, spilled bytes, occupancy that they allow, machine instructions where "
        "nvdisasm was there.",
    )
    return section("By architecture", lines, table_of(("Scene", "Variant", "Kernel", *architectures), rows))


def _kernel_text(kernel: KernelCounters | None) -> str:
    if kernel is None:
        return "—"
    spilled = f" + {kernel.spill_bytes} B" if kernel.spill_bytes else ""
    code = "" if kernel.instructions is None else f", {kernel.instructions}"
    return f"{kernel.registers}{spilled}, {_percent(kernel.occupancy)}{code}"


def _percent(share: float) -> str:
    return f"{figures(100 * share, 2)} %"


def _signed(share: float) -> str:
    return f"{100 * share:+.1f} %"
