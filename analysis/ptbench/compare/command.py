"""`python3 -m ptbench compare A.json B.json ...`: compares result files of two commits, two machines or many GPUs.

Files of `ptbench stability` are compared by ptbench.compare.stability, and files of `ptbench rays` by
ptbench.compare.rays.

Every file is compared with the first. Exit codes: 0 compared; 1 a condition of `--fail-on` was met, or could not be
judged; 2 bad input, which includes a file without a single cell in common with the first.
"""

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ptbench.compare.compared import Compared, check_number, compare_files
from ptbench.compare.document import as_json
from ptbench.compare.gate import Outcome, outcome
from ptbench.compare.rays import check_rays_options, compare_rays_files, rays_json, rays_outcome, rays_sections
from ptbench.compare.stability.matching import check_stability_options, compare_stability_files, stability_outcome
from ptbench.compare.stability.text import stability_json, stability_sections
from ptbench.compare.text import (
    comparison_section,
    files_section,
    left_out_section,
    noise_section,
    ranking_sections,
)
from ptbench.document.blocks import Section
from ptbench.document.markdown import markdown_page
from ptbench.document.text import as_text
from ptbench.errors import InputError
from ptbench.io.files import check_output_file, check_output_folder, make_folder, write_text
from ptbench.io.nodes import read_json
from ptbench.io.rays import is_rays
from ptbench.io.stability import is_stability
from ptbench.terminal import say


def compare_command(options: argparse.Namespace) -> int:
    """Runs `compare` with the options of `ptbench.compare.options`; returns exit code 0 or 1. Raises InputError."""
    if options.json is not None:
        check_output_file(options.json, options.results)
    if options.out is not None:
        check_output_folder(options.out)
    check_number(options.results)
    first = read_json(options.results[0])
    if is_rays(first):
        check_rays_options(options)
        by_batch = compare_rays_files(options.results)
        gates = [rays_outcome(by_batch, what) for what in dict.fromkeys(options.fail_on)]
        report = rays_sections(by_batch)
        return _tell(options, _Told("Ray files compared", report, report, rays_json(by_batch), gates))
    if is_stability(first):
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
    """The result of a comparison in all its output forms."""

    title: str
    brief: list[Section]
    whole: list[Section]
    document: dict
    outcomes: list[Outcome]


def _draw(compared: Compared, folder: Path) -> list[Path]:
    # matplotlib is imported here because loading it takes a moment.
    from ptbench.compare.figure import save_forest

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
        page = markdown_page(told.title, told.whole)
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


def sections(compared: Compared, whole: bool) -> list[Section]:
    """The sections of a comparison's report; `whole` lists every omitted cell and every place in a ranking."""
    found = [files_section(compared.results)]
    for comparison in compared.comparisons:
        pair = compared.marks_of(comparison)
        found.append(comparison_section(comparison, compared.labels, pair))
        left_out = left_out_section(comparison.matching, pair, whole)
        found += [left_out] if left_out is not None else []
    found.append(noise_section(compared.repeats, compared.floors, compared.comparisons))
    return found + ranking_sections(compared.rankings, compared.labels, compared.ranked, whole)
