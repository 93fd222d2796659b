"""Folders of C++ and CUDA include each other in one direction: the graph of folders has no circle."""

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# A floor may include itself and those before it.
FLOORS = ("kernels", "variants", "harness", "stability")
SUFFIXES = {".h", ".cpp", ".cu", ".cuh"}


def includes(root: Path) -> list[tuple[str, str]]:
    """(file, included file) of each include line that names a file of the repository."""
    files = [file for floor in FLOORS for file in sorted((root / floor).rglob("*")) if file.suffix in SUFFIXES]
    return [
        (file.relative_to(root).as_posix(), included)
        for file in files
        for included in re.findall(r'^\s*#\s*include "([^"]+)"', file.read_text(encoding="utf-8"), re.MULTILINE)
        if (root / included).is_file()
    ]


def check_folders(root: Path) -> None:
    """Raises CycleError with the folders of a circle."""
    folders: dict[str, set[str]] = {}
    for file, included in includes(root):
        source, target = Path(file).parent.as_posix(), Path(included).parent.as_posix()
        if source != target:
            folders.setdefault(source, set()).add(target)
    TopologicalSorter(folders).prepare()


def upward(root: Path) -> list[str]:
    """The includes of a floor that lies above: kernels/, for one, knows no variants."""
    return [
        f"{file} includes {included}"
        for file, included in includes(root)
        if FLOORS.index(file.split("/")[0]) < FLOORS.index(included.split("/")[0])
    ]


def write_files(root: Path, texts: dict[str, str]) -> Path:
    for name, text in texts.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def test_folders_make_no_circle():
    assert len(includes(ROOT)) > 1500
    check_folders(ROOT)


def test_no_floor_includes_a_higher_one():
    assert upward(ROOT) == []


def test_a_circle_of_folders_is_found(tmp_path):
    files = {
        "harness/scene/scene.h": '#include "harness/render/exr.h"\n',
        "harness/render/exr.h": "",
        "harness/render/film.h": '#include "harness/scene/scene.h"\n',
    }
    with pytest.raises(CycleError):
        check_folders(write_files(tmp_path, files))


def test_an_include_upwards_is_found(tmp_path):
    files = {"kernels/shade.h": '#  include "variants/axes.h"\n', "variants/axes.h": ""}
    assert upward(write_files(tmp_path, files)) == ["kernels/shade.h includes variants/axes.h"]
