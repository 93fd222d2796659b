"""The findings of `compare` in words and tables: the same sections as plain text and as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from ptbench.compare.match import MACHINE_KEYS, PROGRAM_KEYS, Alone, Matching, axes_of, choice_of
from ptbench.compare.noise import Floor, Repeat
from ptbench.compare.ranking import Change, Ranking
from ptbench.compare.verdicts import WORDS, Comparison, Mean, Row
from ptbench.document.blocks import Section, section
from ptbench.document.table import Table, table_of
from ptbench.io.cells import GPU_BACKEND, Cell, Result
from ptbench.io.files import one_line
from ptbench.io.stability import Stability
from ptbench.numbers import figures, plural, ratio
from ptbench.stats.estimates import (
    CLOCK_UNKNOWN,
    CONFIDENCE,
    INTERVAL_TEXT,
    MINIMUM_SAMPLES,
    THRESHOLD,
    Estimate,
    interval_of_ratio,
)
from ptbench.studies.disturbed import MOST_DISTURBED_SAID, disturbance_in
from ptbench.studies.withdrawn import among, between

_SHOWN = 5  # largest number of reasons of one kind, or of changes of one ranking, that a comparison lists on stdout
MARKS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def files_section(results: Sequence[Result]) -> Section:
    """The section on the compared files: one row per file, and in what the files differ."""
    rows = [
        (
            mark,
            str(result.path),
            result.about("machine"),
            result.about("backend"),
            device_of(result),
            result.git[:12] + (" (dirty)" if result.git.endswith("(dirty)") else ""),
            result.suite or "none",
            result.context["date"] or "no date",
            str(len(result.cells)),
        )
        for mark, result in zip(MARKS, results, strict=False)
    ]
    columns = ("", "File", "Machine", "Backend", "Device", "git", "Suite", "Date", "Cells")
    lines = []
    for mark, result in zip(MARKS, results, strict=False):
        lines.append(f"{mark}: disturbed: {disturbance_in(result)}.")
        if result.interrupted:
            lines.append(f"{mark} was interrupted: cells and samples may be missing.")
    found = [line for key in (*MACHINE_KEYS, *PROGRAM_KEYS) if (line := differing(key, results))]
    after = ["What else differs between the files:", *found] if found else []
    return section("Files", tuple(lines), table_of(columns, rows, {"Cells"}), tuple(after))


def device_of(result: Result | Stability) -> str:
    """The GPU's name, or the CPU's with its number of threads."""
    if result.about("backend") == GPU_BACKEND:
        return result.about("cuda_device")
    return f"{result.about('cpu_model')}, {plural(result.about('threads'), 'thread')}"


def differing(key: str, results: Sequence[Result | Stability]) -> str:
    """What each file says of `key`, or nothing where they agree or the table of files shows it."""
    if key in ("machine", "backend", "cuda_device", "git_sha", "git_dirty"):
        return ""
    # A CPU result has no value for keys of the GPU, and the other way round.
    said = {
        mark: result.about(key)
        for mark, result in zip(MARKS, results, strict=False)
        if not key.startswith("cuda_") or result.about("backend") == GPU_BACKEND
    }
    if len(set(said.values())) < 2:
        return ""
    marks = {value: ", ".join(mark for mark in said if said[mark] == value) for value in said.values()}
    return f"{key}: " + "; ".join(f"{of} {value}" for value, of in marks.items())


@dataclass(frozen=True)
class Labels:
    """Names of variants by those axes in which the compared cells differ."""

    axes: tuple[str, ...]
    fixed: tuple[str, ...]
    tells_checkpoints: bool  # whether some cells were rendered with checkpoints and some without

    @staticmethod
    def of(cells: Sequence[Cell], axes: Sequence[str]) -> Labels:
        """Chooses labels for cells with these axes."""
        choices = {axis: dict.fromkeys(choice_of(cell, axis) for cell in cells) for axis in axes}
        varying = tuple(axis for axis in axes if len(choices[axis]) > 1) or tuple(axes[:1])
        fixed = tuple(f"{axis}={next(iter(choices[axis]))}" for axis in axes if axis not in varying)
        return Labels(varying, fixed, len({cell.convergence is None for cell in cells}) > 1)

    def __call__(self, cell: Cell) -> str:
        name = ".".join(choice_of(cell, axis) or "?" for axis in self.axes)
        name += "".join(f"+{key}={value}" for key, value in cell.tuned.items())
        return name + (" with checkpoints" if self.tells_checkpoints and cell.convergence is not None else "")


def labels_of(matchings: Sequence[Matching]) -> Labels:
    """Chooses labels for all compared cells."""
    cells = [pair.reference for matching in matchings for pair in matching.pairs]
    results = [matchings[0].reference, *(matching.other for matching in matchings)]
    return Labels.of(cells, axes_of(*results))


def comparison_section(comparison: Comparison, label: Labels, marks: tuple[str, str]) -> Section:
    """The verdicts of one file against the reference; `marks` are the files' letters."""
    one, two = marks
    lines = [
        f"Ratio = median time of {two} / median time of {one}, render wall time per sample per pixel: "
        f"below 1, {two} is faster.",
        *_matched_lines(comparison.matching, marks),
        "Verdicts: " + ", ".join(f"{comparison.count(word)} {word}" for word in WORDS) + ".",
        _mean_line("Geometric mean in time", comparison.time, "the cells of both files", comparison.threshold),
        _mean_line(
            "Geometric mean in cycles (time x clock, each of its own)",
            comparison.cycles,
            "pairs with sampled clocks",
            comparison.threshold,
        ),
        *_normalised_lines(comparison),
        rule(comparison),
        f"Variants: {'.'.join(label.axes)}+tunables" + (f"; all: {', '.join(label.fixed)}." if label.fixed else "."),
    ]
    lines += [f"No verdict holds: {floor.refusal}." for floor in comparison.no_floors]
    lines += [f"Withdrawn: {entry.full}" for entry in among([row.pair.reference for row in comparison.rows])]
    if constant := constant_columns(comparison):
        lines.append("All pairs: " + ", ".join(f"{name.lower()} {value}" for name, value in constant.items()) + ".")
    return section(f"{two} against {one}", tuple(lines), _table(comparison, label, marks))


def _matched_lines(matching: Matching, marks: tuple[str, str]) -> Iterable[str]:
    one, two = marks
    alone = Counter(item.in_reference for item in matching.alone)
    yield (
        f"{len(matching.pairs)} cells are in both; left out are {alone[True]} of {len(matching.reference.cells)} "
        f"in {one} and {alone[False]} of {len(matching.other.cells)} in {two}."
    )
    if matching.across_backends:
        yield (
            f"The files share no backend ({matching.reference.about('backend')}, {matching.other.about('backend')}): a "
            "cell is held against that of the other backend, at the nearest samples per pixel. The ratios compare two "
            "programs on two machines."
        )
    yield from (f"{sentence}." for sentence in matching.assumed)


def estimate_text(estimate: Estimate, threshold: float = THRESHOLD) -> str:
    """A ratio with its 95 % interval, in digits that tell on which side of the threshold each lies."""
    return f"{ratio(estimate.value)} {interval_of_ratio(estimate, threshold) or 'no interval'}"


def _mean_line(what: str, mean: Mean, of: str, threshold: float) -> str:
    if mean.estimate is None:
        return f"{what}: none, no pair has it ({CLOCK_UNKNOWN}); left out: {mean.left_out}."
    why = f" ({mean.verdict.said})" if mean.verdict.said else ""
    return (
        f"{what}: {estimate_text(mean.estimate, threshold)} {mean.verdict.word}{why}, over {mean.used} pairs ({of}), "
        f"{mean.left_out} left out; ratios from {ratio(mean.smallest)} to {ratio(mean.largest)}."
    )


def _normalised_lines(comparison: Comparison) -> Iterable[str]:
    for item in comparison.normalised:
        if item.ratio is None:
            yield f"Not normalised by {item.by}: {item.how}."
        else:
            yield f"Geometric mean normalised by {item.by}: {estimate_text(item.ratio)} ({item.how})."


def rule(comparison: Comparison) -> str:
    """The rule by which a comparison's verdicts were reached, in sentences."""
    percent = f"{100 * comparison.threshold:.3g} %"
    cycles = (
        "the same rule in cycles must not contradict it"
        if comparison.one_machine
        else "cycles are told and veto nothing, as the machines' clocks are part of the difference"
    )
    usual = f"{100 * THRESHOLD:.3g} %"
    known = [floor.machine for floor in (*comparison.floors, *comparison.no_floors)]
    used = [floor.machine for floor in comparison.floors]
    machines = dict.fromkeys(result.about("machine") for result in (comparison.reference, comparison.other))
    unknown = [machine for machine in machines if machine not in known]
    why = f"{percent} is the larger of {usual} and the noise floor of {' and '.join(used)}." if used else ""
    if comparison.repeated:
        why += " One machine and one program: whatever differs is noise, and any SLOWER or FASTER a false alarm."
    elif unknown:
        why += (
            f" No A/A run of {' or '.join(unknown)} is known (--noise): what changes from run to run there is not in "
            "the intervals."
        )
    return (
        f"Verdict: with at least {MINIMUM_SAMPLES} samples a side, FASTER or SLOWER where the whole 95 % interval lies "
        f"more than {percent} from 1, SAME where all of it lies within, else UNSURE; {cycles}. {why.strip()} "
        f"Intervals: {INTERVAL_TEXT}."
    )


def _table(comparison: Comparison, label: Labels, marks: tuple[str, str]) -> Table:
    one, two = marks
    columns: dict[str, Callable[[Row], str]] = {
        "Verdict": lambda row: row.verdict.word,
        "Ratio": lambda row: ratio(row.ratio.value),
        "95 %": lambda row: interval_of_ratio(row.ratio, comparison.threshold) or "—",
        "Cycles": lambda row: "—" if row.cycles is None else ratio(row.cycles.value),
        f"{one} ms/spp": lambda row: _median(row.pair.reference),
        f"{two} ms/spp": lambda row: _median(row.pair.other),
        "Scene": lambda row: row.pair.reference.scene,
        "Resolution": lambda row: row.pair.reference.resolution_text,
        "Depth": lambda row: str(row.pair.reference.depth),
        "spp": lambda row: _either(row.pair.reference.spp, row.pair.other.spp),
        "n": lambda row: _either(len(row.pair.reference.samples), len(row.pair.other.samples)),
        "Variant": lambda row: label(row.pair.reference),
        "Remarks": lambda row: "; ".join(_remarks(row)),
    }
    for name in constant_columns(comparison):
        del columns[name]
    numeric = frozenset(columns) - {"Verdict", "Scene", "Variant", "Remarks"}
    rows = tuple(tuple(text(row) for text in columns.values()) for row in comparison.rows)
    return table_of(columns, rows, numeric)


def constant_columns(comparison: Comparison) -> dict[str, str]:
    """Settings that all pairs of cells share, which are told once."""
    texts: dict[str, Callable[[Row], str]] = {
        "Scene": lambda row: row.pair.reference.scene,
        "Resolution": lambda row: row.pair.reference.resolution_text,
        "Depth": lambda row: str(row.pair.reference.depth),
        "spp": lambda row: _either(row.pair.reference.spp, row.pair.other.spp),
        "n": lambda row: _either(len(row.pair.reference.samples), len(row.pair.other.samples)),
    }
    values = {name: {text(row) for row in comparison.rows} for name, text in texts.items()}
    return {name: found.pop() for name, found in values.items() if len(found) == 1}


def _median(cell: Cell) -> str:
    ordered = sorted(cell.ms_per_spp)
    middle = len(ordered) // 2
    return figures((ordered[middle] + ordered[-1 - middle]) / 2)


def _either(one: int, two: int) -> str:
    return str(one) if one == two else f"{one}|{two}"


def _remarks(row: Row) -> Iterable[str]:
    for remark in row.remarks:
        # Remarks in a table omit the ratio's interval and differing samples per pixel, which have their own columns.
        head, found, tail = remark.partition("] reaches ")
        if found and head.startswith("interval ["):
            yield f"reaches {tail}"
        elif not remark.startswith("spp "):
            yield remark


def left_out_section(matching: Matching, marks: tuple[str, str], whole: bool) -> Section | None:
    """The cells without a partner by reason, or each of them if `whole`; None where every cell has one."""
    if not matching.alone:
        return None
    heading = f"Left out of {marks[1]} against {marks[0]}"
    where = {True: marks[0], False: marks[1]}
    if whole:
        rows = tuple(
            (marks[0] if item.in_reference else marks[1], item.kind, item.reason, item.cell.name)
            for item in matching.alone
        )
        return section(heading, table=table_of(("Of", "Why", "In full", "Cell"), rows))
    kinds: dict[tuple[bool, str], list[Alone]] = {}
    for item in matching.alone:
        kinds.setdefault((item.in_reference, item.kind), []).append(item)
    rows = []
    for (in_reference, kind), items in sorted(kinds.items(), key=lambda entry: (not entry[0][0], -len(entry[1]))):
        reasons = Counter(one_line(item.reason) for item in items).most_common()
        for index, (reason, count) in enumerate(reasons[:_SHOWN]):
            rows.append((where[in_reference], str(len(items)) if index == 0 else "", kind, str(count), reason))
        if len(reasons) > _SHOWN:
            rest = sum(count for _, count in reasons[_SHOWN:])
            text = f"for {len(reasons) - _SHOWN} more reasons of this kind (--out and --json have every cell)"
            rows.append((where[in_reference], "", kind, str(rest), text))
    return section(
        heading,
        table=table_of(("Of", "Cells", "Why", "of them", "In full"), rows, {"Cells", "of them"}),
    )


def noise_section(repeats: Sequence[Repeat], floors: Sequence[Floor], comparisons: Sequence[Comparison]) -> Section:
    """The section on noise: the A/A runs, how they differ, and which judged a verdict; `floors` has one per machine."""
    lines = []
    for repeat in repeats:
        shift = repeat.geometric_mean
        lines.append(
            f"A/A run on {repeat.one.about('machine')} (one machine, one program): {repeat.other.path} over "
            f"{repeat.one.path}: {len(repeat.ratios)} ratios from {min(repeat.ratios):.4f} to "
            f"{max(repeat.ratios):.4f}, geometric mean {shift.value:.4f}."
        )
        if repeat.refusal:
            lines.append(
                f"Not used for a noise floor, because more than {MOST_DISTURBED_SAID} of the samples were disturbed: "
                f"{repeat.refusal}."
            )
    for floor in floors:
        if not floor.is_plausible:
            lines.append(f"No noise floor of {floor.machine}: {floor.refusal}.")
            continue
        lines.append(
            f"Noise floor of {floor.machine}: {100 * floor.value:.3g} % (of {len(floor.ratios)} ratios of two runs; "
            f"a further one lies within it with probability {floor.chance:.3f})."
        )
        if floor.chance < CONFIDENCE:
            lines.append(f"{len(floor.ratios)} ratios are too few for 95 %: the largest is taken.")
    judging = [repeat for one in comparisons for floor in (*one.floors, *one.no_floors) for repeat in floor.repeats]
    for repeat in repeats:
        if not repeat.refusal and repeat not in judging:
            lines.append(
                f"{repeat.other.path} over {repeat.one.path} judges no verdict above: it would be judged by itself."
            )
    if not lines:
        lines.append(
            "No two of the files are of one machine and one program, so no noise floor is known; --noise FILE FILE."
        )
    return section("Noise between runs", tuple(lines))


def ranking_sections(found: Sequence[Ranking], label: Labels, marks: Sequence[str], whole: bool) -> list[Section]:
    """The order of variants on each machine; `whole` adds a table of every place."""
    if not found:
        return [section("Ranking of variants", ("No two variants of one scene and settings are in all files.",))]
    changed = [group for group in found if group.changes]
    ranked = sum(len(group.cells) for group in found)
    within_noise = sum(group.within_noise for group in found)
    withdrawn = dict.fromkeys(entry.full for group in found for entry in among([cells[0] for cells in group.cells]))
    lines = [
        f"{ranked} variants in {len(found)} groups of one scene and settings are in all of {', '.join(marks)}; "
        f"verdicts support a change of order in {len(changed)} groups. A change needs FASTER on one and SLOWER on the "
        f"other; {within_noise} pairs change places within the noise, which is none. Left out: variants that are not "
        "in all of these files or alone in their group.",
        "Times only: they say nothing of the error that a variant leaves.",
        *(f"Withdrawn: {text}" for text in withdrawn),
    ]
    same = [_group_name(group, marks) for group in found if not group.changes]
    if same:
        lines.append(f"No change in {'; '.join(same)}.")
    sections = [section("Ranking of variants", tuple(lines))]
    for group in found if whole else changed:
        changes = [_change_text(group, change, label, marks) for change in group.changes]
        if not whole and len(changes) > _SHOWN:
            changes[_SHOWN:] = [f"And {len(changes) - _SHOWN} more changes (--out and --json have all)."]
        table = _places(group, label, marks) if whole else None
        sections.append(section(f"Ranking in {_group_name(group, marks)}", tuple(changes), table))
    return sections


def _group_name(group: Ranking, marks: Sequence[str]) -> str:
    spp = (
        f"{group.spp[0]} spp"
        if len(set(group.spp)) == 1
        else "spp " + ", ".join(f"{mark} {spp}" for mark, spp in zip(marks, group.spp, strict=True))
    )
    return f"{group.scene}, {group.resolution}, depth {group.depth}, {spp}" + (f", {group.work}" if group.work else "")


def _change_text(group: Ranking, change: Change, label: Labels, marks: Sequence[str]) -> str:
    notes = between(group.cells[change.ahead][0], group.cells[change.behind][0])
    ahead, behind = (label(group.cells[variant][0]) for variant in (change.ahead, change.behind))
    return (
        f"CHANGED: {ahead} against {behind} takes {estimate_text(change.ratio)} on {marks[change.at]} and "
        f"{estimate_text(change.turned_ratio)} on {marks[change.turned_at]}{''.join(f'; {one.mark}' for one in notes)}."
    )


def _places(group: Ranking, label: Labels, marks: Sequence[str]) -> Table:
    columns = ["Variant"]
    for mark in marks:
        columns += [f"{mark} place", f"{mark} ms/spp"]
    changed = {variant for change in group.changes for variant in (change.ahead, change.behind)}
    rows = []
    for variant in sorted(range(len(group.cells)), key=lambda index: group.places[index][0]):
        cells = group.cells[variant]
        name = label(cells[0]) + (" (biased)" if cells[0].claim == "biased" else "")
        row = [f"**{name}**" if variant in changed else name]
        for cell, place in zip(cells, group.places[variant], strict=True):
            row += [str(place), _median(cell)]
        rows.append(tuple(row))
    return table_of(columns, rows, columns[1:])
