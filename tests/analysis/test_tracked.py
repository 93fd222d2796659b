"""What is committed has to travel: to a GPU machine goes at most 64 MiB, with the package and its kernels."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import RESULTS, ROOT, tracked_files

MOST_BYTES = 30_000_000
# A result file that is larger is compressed (gzip -9n), and read under its name without .gz.
MOST_PLAIN = 100_000
_NO_TIME_NOR_NAME = b"\x1f\x8b\x08\x00" + b"\x00" * 4
_IMAGES = (".png", ".svg", ".webp", ".jpg", ".pfm", ".exr")


@pytest.fixture(scope="module")
def tracked() -> list[Path]:
    listed = tracked_files()
    if listed is None:
        pytest.skip("no checkout of git: nothing says which files are committed")
    return listed


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


def test_what_tests_read_as_committed_results_is_that(tracked):
    """And nothing that a user measured beside them."""
    read = {path.resolve() for path in RESULTS.rglob("*") if path.is_file()}
    assert read == {path.resolve() for path in in_results(tracked)}


def test_no_test_reads_results_that_a_user_may_have_measured():
    past = re.compile(r"""(ROOT|HOUSE\.root|parents\[\d\]\)?) / f?["']results\b""")
    own = {"conftest.py", "test_tracked.py"}
    files = [path for path in sorted((ROOT / "tests/analysis").rglob("*.py")) if path.name not in own]
    assert len(files) > 50
    found = [f"{path.name}: {line}" for path in files for line in path.read_text().splitlines() if past.search(line)]
    assert found == [], "RESULTS of conftest.py is what git has"
