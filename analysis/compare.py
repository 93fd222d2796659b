"""`python3 -m analysis compare A.json B.json ...`: result files of two commits, two machines or many GPUs.

Files of `ptbench stability` are held against each other, too, by analysis/compare_stability.py.

Every file is held against the first. Exit codes: 0 compared; 1 what `--fail-on` names was found, or could not be
judged; 2 bad input, which a file without a single cell in common with the first is, too.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.compare_gate import Outcome, outcome
from analysis.compare_json import as_json
from analysis.compare_match import Matching, machine_of, match
from analysis.compare_noise import Floor, Repeat, check_noise_files, floor_of, repeats_of
from analysis.compare_ranking import Ranking, rankings
from analysis.compare_sections import Section, as_markdown, as_text
from analysis.compare_stability import (
    check_stability_options,
    compare_stability_files,
    stability_outcome,
)
from analysis.compare_stability_text import stability_json, stability_sections
from analysis.compare_text import (
    MARKS,
    Labels,
    comparison_section,
    files_section,
    labels_of,
    left_out_section,
    noise_section,
    ranking_sections,
)
from analysis.compare_verdicts import Comparison, compare
from analysis.errors import InputError
from analysis.files import check_output_file, check_output_folder, make_folder, write_text
from analysis.nodes import read_json
from analysis.results import Result, result_of
from analysis.stability_file import is_stability
from analysis.statistics import THRESHOLD
from analysis.terminal import say


@dataclass(frozen=True)
class Compared:
    """All that one call found."""

    results: tuple[Result, ...]
    comparisons: tuple[Comparison, ...]
    repeats: tuple[Repeat, ...]
    floors: tuple[Floor, ...]  # one a machine of which there is an A/A run
    rankings: tuple[Ranking, ...]
    ranked: tuple[str, ...]  # the marks of the files whose variants are ranked
    labels: Labels

    def marks_of(self, comparison: Comparison) -> tuple[str, str]:
        return MARKS[0], MARKS[next(i for i, result in enumerate(self.results) if result is comparison.other)]


def compare_command(options: argparse.Namespace) -> int:
    if options.json is not None:
        check_output_file(options.json)
    if options.out is not None:
        check_output_folder(options.out)
    _check_number(options.results)
    if is_stability(read_json(options.results[0])):
        check_stability_options(options)
        found = compare_stability_files(options.results)
        outcomes = [stability_outcome(found, what) for what in dict.fromkeys(options.fail_on)]
        brief, whole = stability_sections(found, whole=False), stability_sections(found, whole=True)
        return _tell(options, _Told("Stability files compared", brief, whole, stability_json(found), outcomes))
    if "failed" in options.fail_on:
        allowed = "files of `ptbench stability`, whose rows pass or fail"
        raise InputError(f"--fail-on failed: found result files of `ptbench run`, allowed: {allowed}")
    compared = compare_files(options.results, options.noise, films_may_differ=options.films_may_differ)
    outcomes = [outcome(compared.comparisons, what) for what in dict.fromkeys(options.fail_on)]
    brief, whole = sections(compared, whole=False), sections(compared, whole=True)
    told = _Told("Result files compared", brief, whole, as_json(compared), outcomes)
    return _tell(options, told, lambda folder: _draw(compared, folder))


@dataclass(frozen=True)
class _Told:
    """What a comparison says, in all its forms."""

    title: str
    brief: list[Section]
    whole: list[Section]
    document: dict
    outcomes: list[Outcome]


def _draw(compared: Compared, folder: Path) -> list[Path]:
    # Drawing libraries take a moment to load.
    from analysis.compare_figure import save_forest

    return [path for index in range(len(compared.comparisons)) for path in save_forest(compared, index, folder)]


def _tell(options: argparse.Namespace, told: _Told, draw: Callable[[Path], list[Path]] = lambda _: []) -> int:
    for folder in (options.out, options.json and options.json.parent):
        if folder is not None:
            make_folder(folder)
    print(as_text(told.brief), end="")
    written = []
    if options.json is not None:
        text = json.dumps(told.document, indent=1, allow_nan=False) + "\n"
        written.append(write_text(options.json, text))
    if options.out is not None:
        figures = draw(options.out)
        page = as_markdown(told.title, told.whole)
        if pictures := [f"![{path.stem}]({path.name})" for path in figures if path.suffix == ".png"]:
            page += "\n" + "\n\n".join(pictures) + "\n"
        written += [*figures, write_text(options.out / "compare.md", page)]
    if written:
        print()
        for target in written:
            say(target)
    if told.outcomes:
        print()
        print("\n".join(one.text for one in told.outcomes))
    return 1 if any(one.fails for one in told.outcomes) else 0


def _check_number(paths: Sequence[Path]) -> None:
    if len(paths) < 2:
        raise InputError(f"{paths[0]}: found one result file, allowed: two or more to compare")
    if len(paths) > len(MARKS):
        raise InputError(f"{paths[-1]}: found {len(paths)} result files, allowed: at most {len(MARKS)}")


def compare_files(paths: Sequence[Path], noise: Sequence[Path] = (), *, films_may_differ: bool = False) -> Compared:
    """Loads and compares; raises InputError."""
    _check_number(paths)
    results = [_load(path) for path in paths]
    noise_results = [_load(path) for path in noise]
    check_noise_files(noise_results, results)
    matchings = [match(results[0], other, films_may_differ=films_may_differ) for other in results[1:]]
    for matching in matchings:
        _refuse_strangers(matching)
    repeats = repeats_of([*results, *noise_results])
    comparisons = [_judged(matching, repeats) for matching in matchings]

    def threshold(result: Result) -> float:
        # Two cells of one run differ by less than two runs do: the floor is on the safe side.
        floor = floor_of(result, repeats)
        return THRESHOLD if floor is None else floor.threshold

    # A second run of the reference's program tells noise; as a machine of its own it would only thin out the ranking.
    ranked = [index for index, one in enumerate(comparisons) if not one.repeated] or list(range(len(comparisons)))
    return Compared(
        tuple(results),
        tuple(comparisons),
        tuple(repeats),
        _floors([*results, *noise_results], repeats),
        tuple(rankings([matchings[index] for index in ranked], threshold)),
        (MARKS[0], *(MARKS[index + 1] for index in ranked)),
        labels_of(matchings),
    )


def _load(path: Path) -> Result:
    root = read_json(path)
    if is_stability(root):
        raise InputError(f"{path}: found a file of `ptbench stability`, allowed: a result file of `ptbench run`")
    return result_of(root)


def _refuse_strangers(matching: Matching) -> None:
    if matching.pairs:
        return
    kinds = Counter(item.kind for item in matching.alone if item.in_reference)
    why = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common()) or "no cells"
    raise InputError(
        f"{matching.other.path}: found no cell to hold against one of {matching.reference.path} ({why}), "
        "allowed: files that measured some work in common"
    )


def _judged(matching: Matching, repeats: Sequence[Repeat]) -> Comparison:
    sides = (matching.reference, matching.other)
    return compare(matching, _floors(sides, repeats, without=sides))


def _floors(results: Sequence[Result], repeats: Sequence[Repeat], without: Sequence[Result] = ()) -> tuple[Floor, ...]:
    """Those of the files' machines, each once."""
    machines = {machine_of(result): result for result in results}
    found = (floor_of(result, repeats, without) for result in machines.values())
    return tuple(floor for floor in found if floor is not None)


def sections(compared: Compared, whole: bool) -> list[Section]:
    """The report; `whole` names every cell that was left out and every place in a ranking."""
    found = [files_section(compared.results)]
    for comparison in compared.comparisons:
        pair = compared.marks_of(comparison)
        found.append(comparison_section(comparison, compared.labels, pair))
        left_out = left_out_section(comparison.matching, pair, whole)
        found += [left_out] if left_out is not None else []
    found.append(noise_section(compared.repeats, compared.floors, compared.comparisons))
    return found + ranking_sections(compared.rankings, compared.labels, compared.ranked, whole)
