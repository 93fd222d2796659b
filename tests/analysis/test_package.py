"""How the package is built: no import cycles, layers, folders instead of prefixes, and its older name."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path

import pytest
from builder import Builder, small
from conftest import PACKAGE, RESULTS, ROOT, run_analysis
from stability_builder import FLOAT, StabilityBuilder

from ptbench.cli.main import FOLDERS, commands

MOST_LINES = 400
# From the bottom up: a folder or file at the top imports from those before it and from itself.
LAYERS = (
    "terminal", "command", "errors", "git", "numbers", "io", "found", "program", "document", "stats", "studies",
    "convergence", "stability", "crosscheck", "figures", "compare", "findings", "claims", "submit", "plots",
    "gallery", "report", "tidy", "frames", "measured", "extras", "flat", "validate", "__init__", "cli",
    "__main__",
)  # fmt: skip
SOURCES = sorted(PACKAGE.rglob("*.py"))


def name_of(path: Path) -> str:
    parts = ("ptbench", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): path for path in SOURCES}


def imports_of(text: str, known: Mapping[str, object]) -> Iterator[str]:
    """The package's modules that a text imports anywhere: at the top, in a function, or for types only."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            if node.module in known:
                for alias in node.names:
                    module = f"{node.module}.{alias.name}"
                    yield module if module in known else node.module


def cycle_of(graph: Mapping[str, set[str]]) -> list[str]:
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


GRAPH = {name: set(imports_of(path.read_text(encoding="utf-8"), MODULES)) for name, path in MODULES.items()}


def test_the_graph_is_that_of_the_package():
    assert len(GRAPH) > 70
    assert "ptbench.io.nodes" in GRAPH["ptbench.io.results"]
    assert "ptbench.extras.fleet.figure" in GRAPH["ptbench.extras.fleet.command"]  # within a function
    assert "ptbench.measured" in GRAPH["ptbench"]
    assert "ptbench.figures.style" in GRAPH["ptbench.figures.rows"]  # from ptbench.figures import style


def test_no_module_imports_itself_on_any_way():
    assert cycle_of(GRAPH) == []


def test_a_cycle_would_be_found():
    known = {"a": "def f():\n    from b import x\n", "b": "import c\n", "c": "from a import f\n", "d": "import a\n"}
    graph = {name: set(imports_of(text, known)) for name, text in known.items()}
    assert set(cycle_of(graph)) == {"a", "b", "c"}
    assert cycle_of(graph | {"c": set()}) == []


def test_folders_build_on_those_before_them():
    def layer(module: str) -> int:
        return LAYERS.index(module.split(".")[1] if "." in module else "__init__")

    upward = [(one, other) for one, targets in GRAPH.items() for other in targets
              if layer(other) > layer(one) and (one, other) != ("ptbench.__main__", "ptbench.cli.main")]  # fmt: skip
    assert upward == []


def is_extra(module: str) -> bool:
    return module.startswith("ptbench.extras")


def test_nothing_imports_extras():
    """What pages and results do without is found where it lies: its commands, sources and figures."""
    extras = {name for name in GRAPH if is_extra(name)}
    folders = {name.split(".")[2] for name in extras if name.count(".") > 2}
    assert folders >= {"advise", "explain", "fleet", "maps", "peers"}
    users = {name for name in GRAPH if not is_extra(name) and GRAPH[name] & extras}
    assert users == set()


def test_a_page_is_rendered_without_extras(tmp_path):
    copy = tmp_path / "ptbench"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "extras"))
    names = ("imports", "compaction")
    code = (
        "import sys; from pathlib import Path; from ptbench.findings.page import read_page, render\n"
        "for page, target in zip(sys.argv[2::2], sys.argv[3::2]):\n"
        "    text = render(read_page(Path(page)), Path(sys.argv[1]))\n"
        "    assert text == Path(target).read_text(encoding='utf-8'), page\n"
    )
    pages = [ROOT / folder / f"{name}.md" for name in names for folder in ("docs/templates", "docs/findings")]
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code, RESULTS, *pages], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(tmp_path)}, cwd=tmp_path,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


def test_importing_a_folder_imports_nothing_else():
    """So that a module depends on what it names, and not on its folder's other modules."""
    folders = [name for name, path in MODULES.items() if path.stem == "__init__" and name != "ptbench"]
    assert {name: GRAPH[name] for name in folders if GRAPH[name]} == {}


def test_names_have_folders_instead_of_prefixes():
    """No compare_text.py beside compare.py or compare/, and no two files of one prefix in one folder."""
    for folder in {path.parent for path in SOURCES}:
        there = [path for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()]
        names = sorted(path.stem for path in there if not path.stem.startswith("_"))
        prefixes = [name.partition("_")[0] for name in names if "_" in name]
        twins = {prefix for prefix in prefixes if prefixes.count(prefix) > 1 or prefix in names}
        assert twins == set(), folder
    for folder in (path for path in PACKAGE.rglob("*") if (path / "__init__.py").is_file() and path != PACKAGE):
        parents = {parent.name for parent in folder.parents}
        assert not [path.name for path in folder.glob("[!_]*_*.py") if path.stem.partition("_")[0] in parents], folder


def test_no_file_is_long():
    lines = {str(path): path.read_text(encoding="utf-8").count("\n") for path in SOURCES}
    assert {path: count for path, count in lines.items() if count > MOST_LINES} == {}


def test_what_is_public_says_what_it_is():
    def is_told(node: ast.AST) -> bool:
        return node.name.startswith("_") or ast.get_docstring(node) is not None

    kinds = (ast.FunctionDef, ast.ClassDef)
    untold = []
    for name, path in MODULES.items():
        module = ast.parse(path.read_text(encoding="utf-8"))
        assert ast.get_docstring(module), name
        public = [node for node in module.body if isinstance(node, kinds) and not node.name.startswith("_")]
        classes = [node for node in public if isinstance(node, ast.ClassDef)]
        members = [(node, member) for node in classes for member in node.body if isinstance(member, ast.FunctionDef)]
        untold += [f"{name}.{node.name}" for node in public if not is_told(node)]
        untold += [f"{name}.{node.name}.{member.name}" for node, member in members if not is_told(member)]
    assert untold == []


def test_axes_and_baselines_are_kept_in_one_place():
    """Result files carry the names of baselines: only ptbench.io.older, for files without them, has a table of them."""
    axes = sorted(path.parent.name for path in (ROOT / "variants").glob("*/axis.h"))
    assert {"compaction", "sampler", "precision"} <= set(axes)
    choices = {axis: {file.stem for file in (ROOT / "variants" / axis).iterdir()} for axis in axes}
    found = set()
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Dict):
                continue
            told = [(key.value, value) for key, value in zip(node.keys, node.values, strict=True)
                    if isinstance(key, ast.Constant) and key.value in choices]  # fmt: skip
            of_axes = [
                key for key, value in told
                if any(isinstance(leaf, ast.Constant) and leaf.value in choices[key] for leaf in ast.walk(value))
            ]  # fmt: skip
            if len(of_axes) > 1:
                found.add(path.relative_to(PACKAGE).as_posix())
    assert found == {"io/older.py"}


# ---- What is found where it lies ----


def package_copy(folder: Path) -> Path:
    """The package in a folder, where a test may add to it."""
    copied = shutil.copytree(PACKAGE, folder / "ptbench", ignore=shutil.ignore_patterns("__pycache__"))
    return Path(copied)


def run_copy(folder: Path, *words: str) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of `python3 -m ptbench` as the copy in that folder has it."""
    command = [sys.executable, "-W", "error", "-m", "ptbench", *words]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=folder)
    return done.returncode, done.stdout, done.stderr


# ---- Commands ----


def test_every_folder_with_a_command_is_collected():
    found = {path.parent.relative_to(PACKAGE).as_posix().replace("/", ".") for path in PACKAGE.rglob("options.py")}
    assert found == set(FOLDERS)
    assert len(FOLDERS) == len(found)
    assert sum(len(import_module(f"ptbench.{folder}.options").COMMANDS) for folder in FOLDERS) == len(commands())


def test_the_command_line_names_no_command():
    """What is told of a command, its name, its options, what it calls, stands in its folder."""
    main = (PACKAGE / "cli" / "main.py").read_text(encoding="utf-8")
    module = ast.parse(main)
    body = [node for node in module.body if not (isinstance(node, ast.Assign) and node.targets[0].id == "FOLDERS")]
    assert len(body) == len(module.body) - 1
    words = {leaf.value for node in body for leaf in ast.walk(node) if isinstance(leaf, ast.Constant)}
    assert words & commands().keys() == set()


def test_a_command_is_added_by_its_folder_and_a_line(tmp_path):
    copy = package_copy(tmp_path)
    (copy / "greet").mkdir()
    (copy / "greet" / "__init__.py").write_text("")
    (copy / "greet" / "options.py").write_text(
        "from ptbench.command import Command\n"
        "def add(parser):\n    parser.add_argument('whom')\n"
        "def fault(options):\n    return 'found yourself' if options.whom == 'me' else ''\n"
        "COMMANDS = (Command('greet', 'says hello', add, fault=fault),)\n"
    )
    (copy / "greet" / "command.py").write_text(
        "def greet(whom, program):\n    print(f'{program}: hello, {whom}')\n    return 1\n"
    )
    main = copy / "cli" / "main.py"
    main.write_text(main.read_text(encoding="utf-8").replace("FOLDERS = (", 'FOLDERS = ("greet",', 1), encoding="utf-8")

    assert run_copy(tmp_path, "greet", "you") == (1, "python3 -m ptbench: hello, you\n", "")
    assert run_copy(tmp_path, "greet", "me") == (2, "", "python3 -m ptbench greet: found yourself; see --help\n")
    assert "says hello" in run_copy(tmp_path, "--help")[1]


# ---- Figures ----

SLOWEST = """
from dataclasses import dataclass
from ptbench.figures import style
from ptbench.figures.declaration import StabilityFigure, StudyFigure

@dataclass(frozen=True)
class Data:
    title: str
    caption: str
    notes: tuple = ()
    name: str = "slowest"

def collect(result, study):
    return Data("The slowest of " + study.name, max(result.cells_of(study), key=lambda cell: cell.ms_per_spp[0]).name)

def draw(data):
    return style.Page(6.0, 1.0, data.title, data.caption).figure

FIGURES = (
    StudyFigure("slowest", collect),
    StudyFigure("compaction", collect, part="slowest"),
    StabilityFigure("slowest", lambda stability: [Data("Stability", "all of it")], draw),
)
"""


def test_a_figure_is_added_by_its_module(tmp_path):
    builder = Builder("added").on_gpu().study("slowest").study("compaction").study("mystery", "pie_chart")
    for depth, study in enumerate(("slowest", "compaction", "mystery"), 1):
        builder.cell(study, depth=depth)
        builder.cell(study, depth=depth, ms_per_spp=9.0, axes={"compaction": "slow"})
    builder.write(tmp_path / "added.json")
    StabilityBuilder().case().row(FLOAT, 0).write(tmp_path / "stability.json")
    copy = package_copy(tmp_path)

    def drawn(file: str) -> tuple[list[str], str]:
        code, out, err = run_copy(tmp_path, "plots", file, "--out", "drawn")
        assert (code, err) == (0, "")
        names = sorted(path.name for path in (tmp_path / "drawn").glob("*slowest.svg"))
        shutil.rmtree(tmp_path / "drawn")
        return names, out

    names, out = drawn("added.json")
    assert names == []
    assert 'not drawn: slowest: no figure is called "slowest"; there are remaining_paths, ' in out
    assert drawn("stability.json")[0] == []

    (copy / "figures" / "slowest.py").write_text(SLOWEST, encoding="utf-8")
    names, out = drawn("added.json")
    assert names == ["compaction_slowest.svg", "slowest.svg"]
    listed = out.partition('not drawn: mystery: no figure is called "pie_chart"; there are ')[2].partition("\n")[0]
    assert listed.startswith("remaining_paths, sorting_by_depth, ")
    assert "scaling_by_shading_fmas, slowest, integrator, " in listed
    assert drawn("stability.json")[0] == ["slowest.svg"]


def test_two_figures_of_one_name_are_refused(tmp_path):
    copy = package_copy(tmp_path)
    for name in ("one", "two"):
        (copy / "figures" / f"{name}.py").write_text(SLOWEST, encoding="utf-8")
    small().write(tmp_path / "small.json")
    code, _, err = run_copy(tmp_path, "plots", "small.json")
    assert code != 0
    assert 'two figures are called "slowest" with the part ""' in err


# ---- The older name ----


def run_older_name(*arguments: object) -> subprocess.CompletedProcess:
    """`python3 -m analysis` as in a checkout without an installation, in the repository's root."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    command = [sys.executable, "-W", "error", "-m", "analysis", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=kept, cwd=ROOT)


@pytest.mark.parametrize("arguments", [("--version",), ("validate", "{good}"), ("validate", "{bad}"), ("plotz",), ()])
def test_the_older_name_says_so_and_does_the_same(tmp_path, arguments):
    (tmp_path / "bad.json").write_text("{}", encoding="utf-8")
    places = {"good": small().write(tmp_path / "good.json"), "bad": tmp_path / "bad.json"}
    call = [argument.format(**places) for argument in arguments]
    now, then = run_analysis(*call), run_older_name(*call)
    notice, _, rest = then.stderr.partition("\n")
    assert re.fullmatch(r"python3 -m analysis: .*python3 -m ptbench.*", notice)
    assert (then.returncode, then.stdout) == (now.returncode, now.stdout)
    assert rest.replace("python3 -m analysis", "python3 -m ptbench") == now.stderr
