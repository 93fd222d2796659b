"""Contradictions within a result file of valid values: duplicate or missing samples, inconsistent times and films.

Value types must have been checked before; a complaint names the place, the cell, what was found and what is allowed.
"""

import math
import re
import statistics
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ptbench.io.limits import limit
from ptbench.io.nodes import Node, shown

# Suffixes that Google Benchmark appends to a benchmark's name; the part before is the cell's name.
_BENCHMARK_SUFFIX = re.compile(
    r"(/(iterations|repeats|min_time|min_warmup_time|threads):[^/]*|/(manual|real|process)_time)+$"
)
# Fields of a sample that are times, and must be above 0.
TIMES = ("real_time", "pt_wall_ms", "pt_device_ms", "pt_end_to_end_ms")
_CLOCKS_DIFFER = limit("clocks_differ")
# Fields that must differ between the samples of a cell.
_OWN = ("repetition_index", "pt_seed", "pt_order")
_MOST_NAMED = 3
_ROUNDING = 1e-12  # relative difference allowed between a file's ratios and those recomputed here, for rounding


@dataclass(frozen=True)
class Contradiction:
    """A value in a file that another value of the file rules out."""

    place: str
    found: str
    allowed: str

    def __str__(self) -> str:
        return f"{self.place}: found {self.found}, allowed: {self.allowed}"


def cell_of(row: Node, known: Mapping[str, object]) -> str:
    """The name of a row's cell, one of `known`; raises InputError."""
    named = row.maybe("run_name") or row.need("name")
    cell = named.name() if named.name() in known else _BENCHMARK_SUFFIX.sub("", named.name())
    if cell not in known:
        raise named.wrong("the name of a cell in $.ptbench.cells")
    return cell


def is_failure(row: Node) -> bool:
    """Whether a row stands for a cell or repetition that failed, and therefore has no times."""
    occurred = row.maybe("error_occurred")
    return occurred is not None and occurred.value is not False


@dataclass(frozen=True)
class _Cell:
    """A cell with the rows of its samples, and of their medians."""

    node: Node
    samples: Sequence[Node]
    medians: Sequence[Node]
    failed: bool

    @property
    def shown(self) -> str:
        return f'the cell "{self.node.need("cell").text()}"'

    @property
    def status(self) -> str:
        return self.node.need("status").text()


def contradictions(root: Node) -> Iterator[Contradiction]:
    """All contradictions of a result whose value types are valid; raises InputError where a type is not."""
    names: set[str] = set()
    for node in root.need("ptbench").need("cells").items():
        name = node.need("cell")
        if name.text() in names:
            yield Contradiction(name.place, f"{shown(name.text(), whole=True)} again", "each name once")
        names.add(name.text())
    cells = _cells(root)
    run = root.need("ptbench").maybe("run")
    asked = None if run is None else run.optional_integer("repetitions")
    most = None if run is None else run.optional_integer("most_repetitions")
    status = root.need("context").maybe("ptbench.status")
    for cell in cells:
        for row in cell.samples:
            yield from times_of(row, cell.shown)
        yield from _twice(cell)
        if not cell.failed:
            yield from _missing(cell, asked, most)
        if cell.status == "interrupted" and status is not None and status.value == "completed":
            place = f"{cell.node.place}.status"
            yield Contradiction(place, f"{cell.shown} interrupted", "ok or failed: the run is completed")
    yield from _films(cells, None if run is None else run.optional_integer("seed"))
    retakes = root.need("ptbench").maybe("retakes")
    if retakes is not None:
        for retaken in retakes.need("samples").items():
            yield from _retaken(retaken, cells)
    for cell in cells:
        if not cell.failed:
            yield from _medians(cell)
    comparisons = root.need("ptbench").maybe("comparisons")
    if comparisons is not None:
        medians = {cell.node.need("cell").value: _median(cell) for cell in cells}
        for comparison in comparisons.items():
            yield from _ratio(comparison, medians)


def _median(cell: _Cell) -> float | None:
    """The median milliseconds per sample per pixel over the cell's samples; None: the cell has none."""
    times = [row.need("real_time").value / row.need("pt_spp").value for row in cell.samples]
    return statistics.median(times) if times else None


def _ratio(comparison: Node, medians: Mapping[str, float | None]) -> Iterator[Contradiction]:
    """The contradiction of a comparison whose ratio is not that of the cells' medians."""
    for key in ("cell", "baseline"):
        if (node := comparison.need(key)).value not in medians and (key == "cell" or node.value is not None):
            yield Contradiction(node.place, shown(node.value), "a cell of the file")
            return
    ratio, node = comparison.need("ratio").value, comparison.need("ratio")
    above, below = (medians.get(comparison.need(key).value) for key in ("cell", "baseline"))
    right = above / below if above and below else None
    if ratio is not None and (right is None or not math.isclose(ratio, right, rel_tol=_ROUNDING)):
        of = comparison.need("cell").text()
        allowed = "null: a side has no times" if right is None else f"{shown(right)}, the ratio of the medians"
        yield Contradiction(node.place, f'{shown(ratio)} of the cell "{of}"', allowed)


def _cells(root: Node) -> list[_Cell]:
    nodes = {node.need("cell").text(): node for node in root.need("ptbench").need("cells").items()}
    samples: dict[str, list[Node]] = {name: [] for name in nodes}
    medians: dict[str, list[Node]] = {name: [] for name in nodes}
    failed = {name for name, node in nodes.items() if node.need("status").value == "failed"}
    for row in root.need("benchmarks").items():
        if row.need("run_type").value == "aggregate":
            if row.optional_text("aggregate_name") == "median":
                medians[cell_of(row, nodes)].append(row)
        elif is_failure(row):
            failed.add(cell_of(row, nodes))
        else:
            samples[cell_of(row, nodes)].append(row)
    return [_Cell(node, samples[name], medians[name], name in failed) for name, node in nodes.items()]


def times_of(row: Node, cell: str) -> Iterator[Contradiction]:
    """Contradictions in a row's times: not positive, or impossible together; value types are checked elsewhere."""
    times = {key: row.fields()[key] for key in TIMES if _is_number(row.fields().get(key))}
    wrong = [key for key, value in times.items() if not value > 0]
    for key in wrong:
        yield Contradiction(f"{row.place}.{key}", f"{shown(times[key])} in {cell}", "a time above 0")
    wall = times.get("pt_wall_ms")
    if wall is None or wrong:
        return
    limits = {  # bounds on a sample's times by its wall time, as (least, most, in words)
        "real_time": (wall, wall, f"{shown(wall)}, its pt_wall_ms"),
        "pt_device_ms": (0, wall * (1 + _CLOCKS_DIFFER), f"at most {shown(wall)}, its pt_wall_ms"),
        "pt_end_to_end_ms": (wall, math.inf, f"at least {shown(wall)}, its pt_wall_ms"),
    }
    for key, (least, most, allowed) in limits.items():
        if key in times and not least <= times[key] <= most:
            yield Contradiction(f"{row.place}.{key}", f"{shown(times[key])} in {cell}", allowed)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _retaken(retaken: Node, cells: Sequence[_Cell]) -> Iterator[Contradiction]:
    """Contradictions of a replaced sample: it must have its replacement's seed and film, and possible times."""
    name, index = retaken.need("cell"), retaken.need("repetition_index")
    sample = retaken.need("sample")
    rows = [row for cell in cells if cell.node.need("cell").value == name.value for row in cell.samples]
    counted = next((row for row in rows if row.optional_integer("repetition_index") == index.value), None)
    if counted is None:
        yield Contradiction(index.place, f'{index.value} in the cell "{name.value}"', "the index of one of its samples")
        return
    for key in ("pt_seed", "film_hash"):
        if sample.need(key).value != counted.need(key).value:
            allowed = f"{shown(counted.need(key).value)}, as in the sample that took its place"
            yield Contradiction(sample.need(key).place, shown(sample.need(key).value), allowed)
    yield from times_of(sample, f'the cell "{name.value}"')


def _medians(cell: _Cell) -> Iterator[Contradiction]:
    """Contradictions of rows of medians that do not match the cell's samples."""
    for row in cell.medians:
        for key in ("real_time", "cpu_time"):
            values = [sample.fields().get(key) for sample in cell.samples]
            if not values or not all(map(_is_number, [*values, row.fields().get(key)])):
                continue
            median, found = statistics.median(values), row.need(key)
            # An even number's middle samples may be halved before or after they are added, which rounds differently.
            if not math.isclose(found.value, median, rel_tol=1e-14):
                allowed = f"{shown(median)}, the median of its {len(values)} samples"
                yield Contradiction(found.place, f"{shown(found.value)} in {cell.shown}", allowed)


def _twice(cell: _Cell) -> Iterator[Contradiction]:
    taken: dict[str, dict[int, Node]] = {key: {} for key in _OWN}
    for row in cell.samples:
        own = {key: row.need(key).integer() for key in _OWN if row.maybe(key) is not None}
        again = next((key for key, value in own.items() if value in taken[key]), None)
        if again is not None:
            first = taken[again][own[again]].place
            found = f"{own[again]}, which {first} has, in {cell.shown}"
            yield Contradiction(f"{row.place}.{again}", found, "each sample of a cell once")
        for key, value in own.items():
            taken[key].setdefault(value, row)


def _missing(cell: _Cell, asked: int | None, most: int | None) -> Iterator[Contradiction]:
    """Contradictions of a sample count: `ok` cells have all samples, or up to `most`, interrupted ones the first."""
    wanted = asked
    for row in cell.samples:
        named = row.maybe("repetitions")
        if named is None:
            continue
        if wanted is not None and named.integer() != wanted:
            found = f"{named.integer()} in {cell.shown}"
            yield Contradiction(named.place, found, f"{wanted}, as the file has it of the others")
            return
        wanted = named.integer()
    indices = [row.maybe("repetition_index") for row in cell.samples]
    there = {index.integer() for index in indices if index is not None}
    if not cell.samples:
        if cell.status == "ok":
            yield Contradiction(cell.node.place, f"no sample of {cell.shown}, which is ok", "all of its repetitions")
        return
    if None in indices:
        return
    whole = cell.status == "ok" and wanted is not None
    gaps = [index for index in range(max(wanted if whole else 0, max(there) + 1)) if index not in there]
    if gaps:
        more = f" and {len(gaps) - _MOST_NAMED} more" if len(gaps) > _MOST_NAMED else ""
        which = f"{', '.join(map(str, gaps[:_MOST_NAMED]))}{more}"
        found = f"no sample {which} of {cell.shown}, which is {cell.status} and has {len(there)}"
        allowed = f"samples 0 to {wanted - 1}" if whole else "samples from 0 on without a gap"
        yield Contradiction(cell.node.place, found, allowed)
    elif wanted is not None and max(there) >= (limit := most or wanted):
        found = f"sample {max(there)} of {cell.shown}"
        yield Contradiction(cell.node.place, found, f"samples 0 to {limit - 1}: {limit} were asked for")


# What identifies a film: group of cells, seed, samples per pixel so far. Films of equal key must be equal bit for bit.
_Film = tuple[object, int | None, int | None]


def _films(cells: Iterable[_Cell], first_seed: int | None) -> Iterator[Contradiction]:
    """Contradictions of films that must be equal bit for bit and are not.

    Cells that claim bitwise equality leave equal films where scene, backend, size, depth and samples agree, for each
    seed. A variant that claims only an equal mean is compared with no other; only its final film is compared with that
    of its last checkpoint, which must be equal.
    """
    known: dict[_Film, tuple[str, _Cell]] = {}
    for cell in cells:
        if cell.failed:  # a failed cell's film may be the wrong one
            continue
        bitwise = cell.node.need("claim").value == "bitwise" if cell.node.maybe("claim") is not None else False
        group: object = _settings(cell.node) if bitwise else cell.node.need("cell").text()
        films = [film for row in cell.samples for film in _films_of(row)]
        if bitwise:
            films += _first_film(cell, first_seed)
        for (seed, spp), node in films:
            value, owner = known.setdefault((group, seed, spp), (node.text(), cell))
            if node.value != value:
                found = f"{shown(node.value)} in {cell.shown}"
                allowed = f"{shown(value)}, the film of the same seed in {owner.shown}"
                yield Contradiction(node.place, found, allowed)


def _settings(cell: Node) -> tuple:
    named = (cell.need(key).value for key in ("scene", "backend", "depth", "spp"))
    return (*named, cell.optional_text("scene_hash"), *(side.integer() for side in cell.need("resolution").items()))


def _films_of(row: Node) -> Iterator[tuple[tuple[int | None, int | None], Node]]:
    """The film hashes of a sample: the final one, and those at its checkpoints."""
    seed = row.optional_integer("pt_seed")
    if seed is None:
        return
    spp = row.optional_integer("pt_spp")
    checkpoints = row.maybe("pt_checkpoints")
    for node in () if checkpoints is None else checkpoints.items():
        if node.optional_text("film_hash"):
            yield (seed, node.optional_integer("spp")), node.need("film_hash")
    if row.optional_text("film_hash"):
        yield (seed, spp), row.need("film_hash")


def _first_film(cell: _Cell, first_seed: int | None) -> list[tuple[tuple[int | None, int | None], Node]]:
    """The film hash of the instrumented pass, which uses the run's first seed."""
    if not cell.node.optional_text("film_hash"):
        return []
    if first_seed is None:
        seeds = (
            row.need("pt_seed").integer() - row.need("repetition_index").integer()
            for row in cell.samples
            if row.maybe("pt_seed") is not None and row.maybe("repetition_index") is not None
        )
        first_seed = next(seeds, None)
    instrumented = cell.node.maybe("instrumented")
    spp = None if instrumented is None else instrumented.optional_integer("spp")
    return [((first_seed, spp), cell.node.need("film_hash"))]


class JournalBook:
    """Checks the lines of a journal, entered in order, against each other."""

    def __init__(self) -> None:
        self._identity: Node | None = None
        self._seeds: dict[str, dict[int, Node]] = {}

    def enter(self, line: Node) -> Iterator[Contradiction]:
        """The contradictions that the next line of the journal brings."""
        kind = line.need("type").value
        if kind == "run" and self._identity is None:
            self._identity = line.need("identity")
        elif kind == "run":
            yield Contradiction(f"{line.place}.type", '"run" again', "one run a journal")
        elif kind == "sample" and self._identity is not None:
            yield from self._sample(line.need("cell").text(), line.need("sample"))
        elif kind == "retake":
            yield from self._retake(line.need("cell").text(), line.need("sample"))

    def _sample(self, name: str, sample: Node) -> Iterator[Contradiction]:
        """Contradictions of a sample's seed: a cell's samples count up from the run's first seed."""
        cell = f'the cell "{name}"'
        seeds = self._seeds.setdefault(name, {})
        seed = sample.need("pt_seed")
        wanted = self._identity.need("seed").integer() + len(seeds)
        if seed.integer() in seeds:
            found = f"{seed.integer()}, which {seeds[seed.integer()].place} has, in {cell}"
            yield Contradiction(seed.place, found, "each sample of a cell once")
        elif seed.integer() != wanted:
            yield Contradiction(seed.place, f"{seed.integer()} in {cell}", f"{wanted}, its next sample's")
        elif len(seeds) == (
            self._identity.optional_integer("most_repetitions") or self._identity.need("repetitions").integer()
        ):
            found = f"sample {len(seeds)} of {cell}"
            yield Contradiction(sample.place, found, f"samples 0 to {len(seeds) - 1}: {len(seeds)} were asked for")
        yield from times_of(sample, cell)
        seeds.setdefault(seed.integer(), sample)

    def _retake(self, name: str, sample: Node) -> Iterator[Contradiction]:
        """Contradictions of a repeated sample, which must have an earlier sample's place and film."""
        cell, seed = f'the cell "{name}"', sample.need("pt_seed")
        before = self._seeds.get(name, {}).get(seed.integer())
        if before is None:
            yield Contradiction(seed.place, f"{seed.integer()} in {cell}", "a seed of one of its samples")
            return
        film, other = sample.need("film_hash"), before.need("film_hash")
        if film.value != other.value:
            allowed = f"{shown(other.value)}, the film of the same seed before"
            yield Contradiction(film.place, f"{shown(film.value)} in {cell}", allowed)
        yield from times_of(sample, cell)
