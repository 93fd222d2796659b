"""README.md and docs/: links and files that they name are there, and commands are ones that the programs know.

Commands are read, not run: subcommands and options against the programs' own help, choices, scenes and suites against
the repository's files.
"""

from __future__ import annotations

import functools
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

from ptbench.cli.main import parser_of

PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/findings").glob("*.md")),
    *sorted((ROOT / "docs/claims").glob("*.md")),
    *sorted((ROOT / "docs/maps").glob("*.md")),
]
FOLDERS = (
    "analysis",
    "claims",
    "cmake",
    "docs",
    "harness",
    "kernels",
    "maps",
    "packaging",
    "results",
    "scenes",
    "stability",
    "tests",
    "variants",
)
# What a page has its reader write. None may be there: then it would be no example any more.
WRITTEN_BY_THE_READER = {
    "variants/compaction/my_scan.cpp",
    "variants/compaction/my_scan.cuh",
    "tests/unit/my_scan_compaction_test.cpp",
    "kernels/shapes/my_ball.h",
    "tests/unit/my_ball_shape_test.cpp",
    "tests/unit/my_velvet_material_test.cpp",
    "variants/compaction/std_remove_if.cpp",
    "variants/integrator/my_tiles.cuh",
    "variants/integrator/my_tiles.h",
    "tests/unit/my_tiles_integrator_test.cpp",
    "variants/integrator/tiled.h",
    "variants/direct_light/nee_sparse.cpp",
}
EXAMPLE_CHOICES = {Path(file).stem for file in WRITTEN_BY_THE_READER}

_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\]\(([^()\s]+)\)")
_SPAN = re.compile(r"`([^`\n]+)`")
_PATH = re.compile(rf"(?<![\w./])(?:{'|'.join(FOLDERS)})/[\w./-]+")
_COMMAND = re.compile(r"(?:build/|\./)?ptbench (?=[a-z])|python3 -m ptbench |\./run (?=[a-z])")
_PLACEHOLDER = re.compile(r"[A-Z][A-Z0-9_]*(\.json)?$|.*\.\.$|.*\b(NAME|MACHINE|SUITE|FILE)\b.*")


def prose_of(text: str) -> str:
    return _FENCE.sub("", text)


def slugs_of(text: str) -> set[str]:
    """The anchors that a reader's browser gets from the headings."""
    headings = re.findall(r"^#+ (.*)$", prose_of(text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def commands_of(text: str) -> list[str]:
    """Every command line of the page, in blocks and in running text, without what is said of it behind."""
    lines = [line for language, block in _FENCE.findall(text) if not language for line in block.splitlines()]
    lines += _SPAN.findall(prose_of(text))
    found = []
    for line in lines:
        # Variables may be set in front; in a pipeline each command is one.
        for part in re.split(r" && | \| ", re.split(r"\s{3,}|\s+# ", line.strip())[0]):
            bare = re.sub(r'^(?:[A-Z_]+=(?:"[^"]*"|\$\([^)]*\)|\S+) )+', "", part)
            if _COMMAND.match(bare):
                found.append(bare)
    return found


def broken_links(page: Path, text: str) -> list[str]:
    broken = []
    for target in _LINK.findall(prose_of(text)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if file != page and not file.exists():
            broken.append(f"{target}: not there")
        elif ROOT not in (file, *file.parents) or (ROOT / "shared") in (file, *file.parents):
            broken.append(f"{target}: no part of the repository")
        elif anchor and anchor not in slugs_of(text if file == page else file.read_text(encoding="utf-8")):
            broken.append(f"{target}: no such heading")
    return broken


def missing_files(text: str) -> list[str]:
    """Files of the repository that the text names, in code or out of it, and that are not there."""
    named = {path.rstrip("./") for path in _PATH.findall(re.sub(r"\]\([^()\s]+\)", "]", text))}
    return sorted(path for path in named if path not in WRITTEN_BY_THE_READER and not is_there(path))


def is_there(path: str) -> bool:
    """Whether there is a file or folder of that name; where NAME stands for one of several, whether there are such."""
    name = r"(?<!\w)NAME(?=_[a-z]|\b)"
    if re.search(name, path):
        return bool(list(ROOT.glob(re.sub(name, "*", path))))
    return _PLACEHOLDER.match(path) is not None or bool(list(ROOT.glob(path + "*")))


def is_choice(axis: str, choice: str) -> bool:
    if choice == "all" or choice in EXAMPLE_CHOICES or _PLACEHOLDER.match(choice):
        return True
    return any(path.stem == choice for path in (ROOT / "variants" / axis).iterdir())


def unknown_names(command: str) -> list[str]:
    """Axes, choices, scenes and suites of a command of ptbench that are not in the repository."""
    unknown = []
    for axis, choices in re.findall(r"--(?:axis|against) ([\w]+)=([\w,.]+)", command):
        if _PLACEHOLDER.match(axis):
            continue
        if not (ROOT / "variants" / axis).is_dir():
            unknown.append(f"axis {axis}")
        else:
            unknown += [f"{axis}={choice}" for choice in choices.split(",") if not is_choice(axis, choice)]
    for kind, folder in (("scene", "scenes"), ("suite", "scenes/suites")):
        for names in re.findall(rf"--{kind} ([\w,./]+)", command):
            unknown += [f"{kind} {name}" for name in names.split(",") if not is_named(folder, name)]
    return unknown


def is_named(folder: str, name: str) -> bool:
    return (
        name == "all"
        or name.endswith(".json")
        or _PLACEHOLDER.match(name) is not None
        or (ROOT / folder / f"{name}.json").is_file()
    )


def options_in(command: str) -> set[str]:
    return {name for name in re.findall(r"(?<!\S)\[?(--[a-z][a-z_-]*)", command) if not name.startswith("--benchmark_")}


def wrong_options(command: str, help_of) -> list[str]:
    """`help_of` gives the help of a subcommand, and raises KeyError where there is none."""
    subcommand = command.split()[1]
    try:
        text = help_of(subcommand)
    except KeyError:
        return [f"no subcommand {subcommand}"]
    known = set(re.findall(r"--[a-z][a-z_-]*", text))
    return [f"{subcommand} has no {option}" for option in sorted(options_in(command) - known)]


def analysis_complaint(command: str) -> str:
    """What argparse says of a call without placeholders; nothing if it is good."""
    words = shlex.split(command)[3:]
    try:
        parser_of().parse_args(words)
    except SystemExit as leaving:
        return f"exit code {leaving.code}"
    return ""


@pytest.fixture(scope="module")
def help_of_ptbench():
    folder = ROOT / os.environ.get("PTBENCH_BUILD_DIR", "build")
    binary = folder / "ptbench"
    if not binary.is_file():
        pytest.skip(f"{binary} is not built")

    def said(*arguments: str) -> str:
        return subprocess.run([binary, *arguments], capture_output=True, text=True, check=True, timeout=60).stdout

    subcommands = set(re.findall(r"^  ([a-z]+) {2,}", said("--help").split("Subcommands:")[1], re.MULTILINE))

    @functools.cache
    def help_of(subcommand: str) -> str:
        if subcommand not in subcommands:
            raise KeyError(subcommand)
        return said(subcommand, "--help")

    return help_of


def pages(check) -> dict[str, list[str]]:
    """What is wrong, by page; pages without a fault are left out."""
    faults = {page.name: check(page, page.read_text(encoding="utf-8")) for page in PAGES}
    return {name: found for name, found in faults.items() if found}


def test_there_are_pages():
    assert {"tutorial.md", "method.md", "faq.md"} <= {page.name for page in PAGES}


def test_every_page_is_found_from_the_readme():
    reached, ahead = set(), [PAGES[0]]
    while ahead:
        page = ahead.pop()
        reached.add(page)
        targets = {(page.parent / target).resolve() for target in _LINK.findall(page.read_text(encoding="utf-8"))}
        ahead += [target for target in targets & set(PAGES) if target not in reached]
    assert [page.name for page in PAGES if page not in reached] == []


def test_links_lead_somewhere():
    assert pages(broken_links) == {}


def test_named_files_are_there():
    assert pages(lambda page, text: missing_files(text)) == {}
    assert [file for file in sorted(WRITTEN_BY_THE_READER) if (ROOT / file).exists()] == []


def named_in_picture(svg: str) -> tuple[set[str], set[str], set[str]]:
    """(headers of kernels/, folders, axes) that the picture of the rooms names."""
    words = re.findall(r"<text[^>]*>([^<]*)</text>", svg)
    headers = {name for word in words for name in re.findall(r"\b\w+\.h\b", word)}
    axes = set(re.findall(r'<text class="tiny"[^>]*>(\w+)</text>', svg))
    return headers, {word for word in words if re.fullmatch(r"[\w/]+/", word)}, axes


def test_the_picture_of_the_rooms_shows_what_is_there():
    headers, folders, axes = named_in_picture((ROOT / "docs" / "architecture.svg").read_text(encoding="utf-8"))
    assert {"shade.h", "film.h"} <= headers
    assert {name for name in headers if not (ROOT / "kernels" / name).is_file()} == set()
    floors = [ROOT, ROOT / "harness", ROOT / "variants"]
    assert {name for name in folders if not any((floor / name).is_dir() for floor in floors)} == set()
    assert axes == {header.parent.name for header in (ROOT / "variants").glob("*/axis.h")}


def test_nothing_is_said_of_what_is_not_in_the_repository():
    assert pages(lambda page, text: re.findall(r"\S*\bshared/\S*", text)) == {}


def test_commands_name_what_there_is():
    assert pages(lambda page, text: [name for line in commands_of(text) for name in unknown_names(line)]) == {}


def test_run_has_the_commands():
    usage = (ROOT / "run").read_text(encoding="utf-8").split("TEXT\n")[0]
    known = set(re.findall(r"^  ([a-z]+)\b", usage, re.MULTILINE))
    commands = {line.split()[1] for page in PAGES for line in commands_of(page.read_text(encoding="utf-8"))
                if line.startswith("./run ")}  # fmt: skip
    assert commands
    assert commands - known == set()


def test_ptbench_has_the_options(help_of_ptbench):
    def check(page: Path, text: str) -> list[str]:
        lines = [line for line in commands_of(text) if "ptbench" in line.split()[0]]
        return [fault for line in lines for fault in wrong_options(line, help_of_ptbench)]

    assert pages(check) == {}


def test_analysis_takes_the_calls():
    def check(page: Path, text: str) -> list[str]:
        lines = [line for line in commands_of(text) if line.startswith("python3 -m ptbench ")]
        # A synopsis has brackets round what may be left out; what is in them is part of a call too.
        bare = [re.sub(r"[][]", "", line) for line in lines if "|" not in line and line.split()[3:]]
        return [f"{line}: {complaint}" for line in bare if (complaint := analysis_complaint(line))]

    assert pages(check) == {}


def test_faults_are_found():
    text = "# A page\n\nSee [this](nowhere.md), [that](#a-page), [there](#b) and `analysis/gone.py`.\n"
    assert broken_links(ROOT / "page.md", text) == ["nowhere.md: not there", "#b: no such heading"]
    assert broken_links(ROOT / "page.md", "[up](../)") == ["../: no part of the repository"]
    assert missing_files(text + "`analysis/ptbench/errors.py`, `results/MACHINE/a.json`") == ["analysis/gone.py"]
    assert missing_files("`variants/layout/NAME.h`, `variants/gone/NAME.h`") == ["variants/gone/NAME.h"]
    assert missing_files("`variants/integrator/NAME_fetching.cuh`, `variants/layout/NAME_gone.h`") == [
        "variants/layout/NAME_gone.h"
    ]
    block = (
        "```\nA=1 build/ptbench run --scene s --axis frob=x  # why\npython3 -m ptbench plots a.json   is said\n```\n"
    )
    assert commands_of(block) == ["build/ptbench run --scene s --axis frob=x", "python3 -m ptbench plots a.json"]
    assert unknown_names("build/ptbench run --scene s,cornell_open --axis compaction=none,no --axis frob=x") == [
        "compaction=no",
        "axis frob",
        "scene s",
    ]

    def help_of(subcommand: str) -> str:
        return {"run": "  --scene TEXT\n"}[subcommand]

    assert wrong_options("build/ptbench run --scene s --frob 1 --benchmark_filter=a", help_of) == ["run has no --frob"]
    assert wrong_options("build/ptbench frob", help_of) == ["no subcommand frob"]
    assert analysis_complaint("python3 -m ptbench plots") != ""
    assert analysis_complaint("python3 -m ptbench plots a.json --out b") == ""
