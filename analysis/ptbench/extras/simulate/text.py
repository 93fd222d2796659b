"""The findings of the simulation in words and tables: measurements, assumptions, and what is unchecked."""

from collections.abc import Iterable

from ptbench.document.blocks import Section, section
from ptbench.document.table import Table, table_of
from ptbench.extras.simulate.model import BANDS, PARTITIONS, TILES
from ptbench.extras.simulate.parts import Point
from ptbench.extras.simulate.study import Spread, Study
from ptbench.numbers import figures

SHOWN_RANKS = (2, 4, 8, 64, 256, 1024)


def assumptions(study: Study) -> list[str]:
    """The assumptions of a simulation, one line each."""
    parts = study.parts
    cost, seen = parts.cost, parts.reduction
    return [
        f"One GPU ({parts.device}): {figures(1e3 * cost.fixed_ms, 3)} µs a render and {figures(cost.ms_per_mega, 3)} "
        f"ms a million samples of pixels, a line through {len(parts.cost_points)} sizes, at most "
        f"{_percent(max(abs(point.error) for point in parts.cost_points))} off.",
        f"Noise: each GPU's time is multiplied by a draw from {parts.noise.size} renders over their cell's median "
        f"({parts.noise_cells} cells of one GPU: {figures(parts.noise[0], 3)} to {figures(parts.noise[-1], 4)}). So "
        "GPUs are as like each other as one is to itself, and none fails.",
        f"Work by block of 16 pixels a side: rays a path in {parts.work_scene}, counted by rendering; a ray takes the "
        "same time everywhere.",
        *(
            f"{network.name}: {figures(1e3 * network.alpha_ms, 2)} µs and {figures(network.gb_per_second, 3)} GB/s a "
            f"message: {network.source}."
            for network in parts.networks.values()
        ),
        f"Adding up films: a binomial tree or a reduce-scatter, whichever is shorter; the formula was fitted to two "
        f"ranks on a CPU ({figures(1e3 * seen.alpha_ms, 2)} µs, {figures(seen.gb_per_second, 3)} GB/s with the "
        "additions).",
        f"Seed {parts.definition['seed']}, {parts.definition['trials']} trials; medians.",
    ]


def sections(study: Study) -> list[Section]:
    """The report of the simulation."""
    return [
        section("Assumptions", tuple(assumptions(study))),
        section(
            f"Efficiency at {study.side}x{study.side}",
            (
                f"One GPU's time over P times that of P GPUs, over {study.far.name}; the middle 90 % of trials lie "
                "within a few units of the last digit unless an interval is given.",
            ),
            efficiency_table(study),
        ),
        section("Adding up films, ms", (f"Over {study.far.name}.",), reduction_table(study)),
        section("From how many samples a pixel on samples are as fast as tiles", (), even_table(study)),
        section("Imbalance and stragglers", (), straggler_table(study)),
        section("Checked", checked_lines(study), check_table(study)),
    ]


def shown_ranks(study: Study) -> list[int]:
    """The simulated numbers of GPUs that tables show."""
    return [count for count in SHOWN_RANKS if count in study.parts.definition["ranks"]]


def efficiency_table(study: Study) -> Table:
    """The table of parallel efficiency by samples per pixel and partition."""
    ranks = shown_ranks(study)
    rows = [
        (str(spp), partition, *(_spread_text(study.efficiencies[partition, spp, count]) for count in ranks))
        for spp in study.parts.definition["spp"]
        for partition in PARTITIONS
    ]
    columns = ("spp", "Partition", *(f"P = {count}" for count in ranks))
    return table_of(columns, rows, (columns[0], *columns[2:]))


def reduction_table(study: Study) -> Table:
    """The table of film reduction times by image size."""
    ranks = shown_ranks(study)
    sides = study.parts.definition["sides"]
    rows = [(f"{side}x{side}", *(figures(study.reductions[side, count], 3) for count in ranks)) for side in sides]
    columns = ("Image", *(f"P = {count}" for count in ranks))
    return table_of(columns, rows, columns[1:])


def even_table(study: Study) -> Table:
    """The least spp at which dividing samples is as fast as dividing tiles, by image size and number of GPUs."""
    ranks = shown_ranks(study)
    sides = study.parts.definition["sides"]
    rows = [
        (f"{side}x{side}", *("never" if (at := study.even[side, count]) is None else str(at) for count in ranks))
        for side in sides
    ]
    columns = ("Image", *(f"P = {count}" for count in ranks))
    return table_of(columns, rows, columns[1:])


def straggler_table(study: Study) -> Table:
    """The table of what imbalance, noise and a slow GPU cost, each by itself."""
    ranks = shown_ranks(study)
    slow = f"{100 * study.parts.definition['slow']:.0f} %"
    lines = [
        ("slowest of P renders, over the median", [study.stragglers[count] for count in ranks]),
        *(
            (f"greatest share of work over the mean, {partition}",
             [study.imbalance[partition, count] for count in ranks])
            for partition in (TILES, BANDS)
        ),
        *(
            (f"efficiency where one GPU has {slow} of its speed, {partition}, most spp",
             [study.slow_one[partition, count] for count in ranks])
            for partition in PARTITIONS
        ),
    ]  # fmt: skip
    columns = ("", *(f"P = {count}" for count in ranks))
    rows = tuple((name, *(f"{value:.3f}" for value in values)) for name, values in lines)
    return table_of(columns, rows, columns[1:])


def checked_lines(study: Study) -> tuple[str, ...]:
    """Lines on which parts of the simulation were checked against measurements, and which were not."""
    lines = [
        f"The formula of adding up films, fitted to 2 ranks and held against others: "
        f"{len(study.parts.reduction_checks)} points.",
        f"Efficiencies of several GPUs: {len(study.checks)} points."
        if study.checks
        else "Efficiencies of several GPUs: no result is there, so nothing of them is checked.",
        "Not checked: any network between hosts, more than one host, more GPUs than are named here.",
    ]
    return tuple(lines)


def check_table(study: Study) -> Table:
    """The table of simulated against measured values."""
    groups = (
        ("fit: one GPU, ms", study.parts.cost_points),
        ("fit: adding up, ms", study.parts.reduction_points),
        ("check: adding up, ms", study.parts.reduction_checks),
        ("check: efficiency", study.checks),
    )
    rows = [row for name, points in groups for row in _point_rows(name, points)]
    columns = ("What", "Of", "Formula", "Measured", "Error")
    return table_of(columns, rows, columns[2:])


def _point_rows(name: str, points: Iterable[Point]) -> Iterable[tuple[str, ...]]:
    for point in points:
        yield name, point.name, figures(point.said, 3), figures(point.measured, 3), f"{100 * point.error:+.1f} %"


def _spread_text(spread: Spread) -> str:
    text = f"{spread.value:.3f}"
    wide = spread.high - spread.low > 0.01
    return f"{text} [{spread.low:.3f}, {spread.high:.3f}]" if wide else text


def _percent(share: float) -> str:
    return f"{figures(100 * share, 2)} %"


# Functions that make the simulation's tables, by the table names that pages of findings use.
TABLES = {
    "efficiency": efficiency_table,
    "reduction": reduction_table,
    "even": even_table,
    "straggler": straggler_table,
    "check": check_table,
}
