"""The package installs with pip and runs outside the repository, without a network."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest
from builder import Builder, small
from conftest import PACKAGE, RESULTS, ROOT
from packaging.requirements import Requirement

from ptbench import __version__
from ptbench.flat.command import PYARROW
from ptbench.io.files import read_stored

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _run(*command: object, cwd: Path, **environment: str) -> subprocess.CompletedProcess:
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PIP_"))}
    return subprocess.run(
        list(map(str, command)), cwd=cwd, env={**kept, **environment}, capture_output=True, text=True, check=False
    )


def _copy_of_sources(folder: Path) -> Path:
    """So that nothing is left in the repository."""
    shutil.copytree(ROOT / "analysis", folder / "analysis", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder / name)
    return folder


def _environment(folder: Path) -> Path:
    """A virtual environment's interpreter; the libraries are those of this environment."""
    venv.create(folder, with_pip=False, symlinks=True)
    python = folder / "bin" / "python"
    site = Path(_run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder).stdout.strip())
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python


@pytest.fixture(scope="session")
def wheel(tmp_path_factory) -> Path:
    """The wheel of the sources as they are."""
    folder = tmp_path_factory.mktemp("wheel")
    sources = _copy_of_sources(folder / "sources")
    offline = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check", "--no-cache-dir")
    built = _run(sys.executable, "-m", "pip", "wheel", *offline, "--wheel-dir", folder, sources, cwd=folder)
    assert built.returncode == 0, built.stdout + built.stderr
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="session")
def installed(wheel, tmp_path_factory) -> Path:
    """A virtual environment's folder of programs, with the wheel in it."""
    folder = tmp_path_factory.mktemp("venv")
    python = _environment(folder)
    # The libraries' environment has the package, too.
    offline = ("--no-deps", "--no-index", "--disable-pip-version-check", "--ignore-installed")
    done = _run(sys.executable, "-m", "pip", "--python", python, "install", *offline, wheel, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "bin"


def test_the_wheel_has_all_that_the_folder_has(wheel):
    there = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    files = (path for path in PACKAGE.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    wanted = {path.relative_to(PACKAGE.parent).as_posix() for path in files}
    assert there == wanted | {"analysis.py"}  # the older name


def test_it_draws_outside_the_repository(installed, tmp_path):
    # An empty folder of the same name must not hide the installed package from its command.
    (tmp_path / "ptbench").mkdir()
    said = _run(installed / "ptbench-analysis", "plots", "--help", cwd=tmp_path)
    assert said.returncode == 0, said.stderr
    assert said.stdout.startswith("usage: ptbench-analysis plots")
    builder = Builder().study("compaction")
    builder.cell("compaction")
    file = builder.write(tmp_path / "quick.json")
    drawn = _run(installed / "ptbench-analysis", "plots", file, "--out", tmp_path / "out", cwd=tmp_path)
    assert drawn.returncode == 0, drawn.stderr
    assert (tmp_path / "out" / "summary.md").is_file()
    wrong = _run(installed / "ptbench-analysis", "plots", tmp_path / "nothing.json", cwd=tmp_path)
    assert (wrong.returncode, wrong.stderr.count("\n")) == (2, 1)
    assert wrong.stderr.startswith("ptbench-analysis: ")


@pytest.mark.parametrize("program", [("python", "-m", "ptbench"), ("ptbench-analysis",)], ids=["module", "command"])
def test_it_works_from_any_folder(installed, tmp_path, program):
    """The installed program checks files by relative names, far from the repository, by the package's schemas."""
    for source in ("packet.json", "stability.json"):
        (tmp_path / source).write_bytes(read_stored(RESULTS / "amd-epyc-2-threads" / source, 1 << 30)[1])
    for source in ("tuning.json", "inspect_cornell_open_45.json"):
        (tmp_path / source).write_bytes(read_stored(RESULTS / "nvidia-h200" / source, 1 << 30)[1])

    def run(*arguments: str) -> subprocess.CompletedProcess:
        return _run(installed / program[0], *program[1:], *arguments, cwd=tmp_path)

    names = ("packet.json", "stability.json", "tuning.json", "inspect_cornell_open_45.json")
    checked = run("validate", *names)
    assert (checked.returncode, checked.stderr) == (0, "")
    assert checked.stdout.splitlines() == [f"{name}: good" for name in names]
    builder = Builder().study("compaction")
    builder.cell("compaction")
    builder.write(tmp_path / "quick.json")
    drawn = run("plots", "quick.json")
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert "summary.md" in drawn.stdout
    reported = run("report", "quick.json", "--out", "report")
    assert (reported.returncode, reported.stderr) == (0, "")
    assert (tmp_path / "report" / "report.html").is_file()
    assert run("--version").stdout == f"ptbench-analysis {PROJECT['version']}\n"


def test_it_is_imported_from_the_wheel(installed, tmp_path):
    file = small().write(tmp_path / "quick.json")
    code = (
        f"import ptbench; print(ptbench.__file__); print(len(ptbench.load({str(file)!r}).frame())); "
        "from ptbench.io.files import package_file; print(package_file('gallery.json').is_file())"
    )
    done = _run(installed / "python", "-c", code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    where, rows, has_data = done.stdout.split("\n")[:3]
    assert Path(where).is_relative_to(installed.parent)
    assert int(rows) == sum(row["run_type"] == "iteration" for row in small().rows)
    assert has_data == "True"


def test_it_is_installed_as_run_does(tmp_path):
    """Editable: found in its folder, also where the current folder has one of its name, such as a clone."""
    python = _environment(tmp_path / "venv")
    sources = _copy_of_sources(tmp_path / "sources")
    (command,) = re.findall(
        r'-m pip install \\\n\s+(.*) --editable "\$root"', (ROOT / "tools/setup.sh").read_text(encoding="utf-8")
    )
    pip = (sys.executable, "-m", "pip", "--python", python, "install", "--no-index", "--ignore-installed")
    done = _run(*pip, *command.split(), "--editable", sources, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    (tmp_path / "ptbench").mkdir()
    for module in ("ptbench", "analysis"):
        done = _run(python, "-m", module, "--version", cwd=tmp_path)
        assert done.stdout == f"ptbench-analysis {PROJECT['version']}\n", done.stderr
    done = _run(python, "-c", "import ptbench; print(ptbench.__file__)", cwd=tmp_path)
    assert done.stdout == f"{sources / 'analysis' / 'ptbench' / '__init__.py'}\n"


def test_the_older_name_is_installed_too(installed, tmp_path):
    done = _run(installed / "python", "-m", "analysis", "--version", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, f"ptbench-analysis {PROJECT['version']}\n")
    assert (done.stderr.count("\n"), "python3 -m ptbench" in done.stderr) == (1, True)


def test_what_it_depends_on_is_pinned_and_allowed():
    lines = (ROOT / "analysis" / "requirements.txt").read_text(encoding="utf-8").splitlines()
    pins = {
        pin.name.lower(): pin
        for line in lines
        if (text := line.partition("#")[0].strip())
        for pin in [Requirement(text)]
    }
    # Large packages are installed by who asks for them alone, so their extra is the pin.
    on_demand = ("crosscheck", "parquet")
    extras = {name: texts for name, texts in PROJECT["optional-dependencies"].items() if name not in on_demand}
    assert all("==" in text for name in on_demand for text in PROJECT["optional-dependencies"][name])
    assert PROJECT["optional-dependencies"]["parquet"] == [PYARROW]
    wanted = [*PROJECT["dependencies"], *(text for texts in extras.values() for text in texts)]
    for need in map(Requirement, wanted):
        (version,) = (str(spec.version) for spec in pins[need.name.lower()].specifier)
        assert need.specifier.contains(version), need


def test_its_version_is_the_programs():
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    assert re.search(r"project\(ptbench VERSION (\S+)", cmake)[1] == PROJECT["version"]
    assert __version__ == PROJECT["version"]
