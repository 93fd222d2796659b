"""What is committed has to travel: to a GPU machine goes at most 64 MiB, with the package and its kernels."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

MOST_BYTES = 30_000_000
# A result file that is larger is compressed (gzip -9n), and read under its name without .gz.
MOST_PLAIN = 100_000
_NO_TIME_NOR_NAME = b"\x1f\x8b\x08\x00" + b"\x00" * 4
_IMAGES = (".png", ".svg", ".webp", ".jpg", ".pfm", ".exr")


@pytest.fixture(scope="module")
def tracked() -> list[Path]:
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    except OSError as error:
        pytest.skip(f"git does not run: {error}")
    if listed.returncode != 0:
        pytest.skip("no checkout of git: nothing says which files are committed")
    return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]


def in_results(tracked: list[Path]) -> list[Path]:
    return [path for path in tracked if path.is_relative_to(ROOT / "results")]


def test_tracked_files_fit(tracked):
    total = sum(path.stat().st_size for path in tracked)
    largest = sorted(tracked, key=lambda path: -path.stat().st_size)[:5]
    assert total <= MOST_BYTES, f"{total} bytes; the largest: {', '.join(map(str, largest))}"


def test_large_results_are_compressed_to_the_same_bytes_anywhere(tracked):
    results = in_results(tracked)
    assert [path for path in results if path.suffix == ".json" and path.stat().st_size > MOST_PLAIN] == []
    packed = [path for path in results if path.suffix == ".gz"]
    assert len(packed) > 50
    assert [path for path in packed if path.read_bytes()[:8] != _NO_TIME_NOR_NAME] == []
    assert [path for path in packed if path.with_suffix("").exists()] == []


def test_images_of_results_are_committed_where_a_page_shows_them(tracked):
    """All else is drawn on demand, by `python3 -m ptbench plots` or `./run gallery`."""
    pages = [ROOT / "README.md", *(path for path in tracked if path.is_relative_to(ROOT / "docs"))]
    shown = {
        (page.parent / target).resolve()
        for page in pages
        if page.suffix == ".md"
        for target in re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", page.read_text(encoding="utf-8"))
    }
    images = {path for path in in_results(tracked) if path.suffix in _IMAGES} - {ROOT / "results/gallery/gallery.webp"}
    assert len(images) > 20
    assert images == {path for path in shown if path.is_relative_to(ROOT / "results")}
