"""Runs `report`: reads and draws in one process per processor, and writes report.html and report.md."""

import multiprocessing
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from ptbench.document.markdown import SCENES, linked_files, report_page, write_files
from ptbench.errors import bad_value
from ptbench.io.files import check_output_file, check_output_folder, make_folder, write_text
from ptbench.report.chapter import Chapter, chapter_of
from ptbench.report.html import html_page
from ptbench.report.overview import report_sections, title_of
from ptbench.report.scenes import Renderer, scene_pictures
from ptbench.report.sources import Sources, find_sources
from ptbench.terminal import say, visible

# Total file size in bytes from which on worker processes pay off: each takes a second or more to import matplotlib.
WORTH_PROCESSES = 1 << 20
_MADE_BY = "by python3 -m ptbench report."  # end of the subtitle, by which earlier reports are recognised


def report(named: Sequence[Path], out: Path, binary: Path | None, spp: int, side: int) -> int:
    """Writes the report of the files `named` into the folder `out`; raises InputError."""
    renderer = None if binary is None else Renderer(binary, spp, side, out / SCENES / "rendered")
    if renderer is not None:
        renderer.check()
    check_output_folder(out)
    sources = find_sources(named)
    chapters = _chapters(sources)
    make_folder(out)
    if renderer is not None:
        make_folder(renderer.folder)
    pictures = scene_pictures([use for chapter in chapters for use in chapter.scenes], renderer)
    for picture in pictures:
        if picture.image is None:
            say(f"scene without a picture: {picture.scene}: {picture.failure}")
    for chapter in chapters:
        for study, reason in chapter.left_out.not_drawn:
            say(f"not drawn: {chapter.title}: {study}: {reason}")
    sections = report_sections(chapters, pictures, sources.passed_over)
    title, subtitle = title_of(chapters), _subtitle(sources)
    files = list(linked_files(out, sections))
    _refuse_foreign(out, [out / "report.md", out / "report.html", *(path for path, _ in files)])
    write_files(files)
    say(write_text(out / "report.md", report_page(title, subtitle, sections)))
    say(write_text(out / "report.html", html_page(title, subtitle, sections)))
    return 0


def _refuse_foreign(folder: Path, targets: Sequence[Path]) -> None:
    """Raises InputError if files would be replaced and the folder holds no earlier report."""
    page = folder / "report.md"
    if page.is_file() and _MADE_BY in page.read_text(encoding="utf-8", errors="replace"):
        return
    for target in targets:
        check_output_file(target)
        if os.path.lexists(target):
            allowed = "a folder of its own, or one with an earlier report"
            raise bad_value(target, "output file", "a file that is there, and no report of ptbench", allowed)


def _subtitle(sources: Sources) -> str:
    return "Made from " + ", ".join(visible(path.name) for path in sources.paths) + f" {_MADE_BY}"


def _size(path: Path) -> int:
    """The size of a file in bytes; 0 for a missing file, which is reported when it is read."""
    return path.stat().st_size if os.path.exists(path) else 0


def _chapters(sources: Sources) -> list[Chapter]:
    jobs = min(len(sources.paths), len(os.sched_getaffinity(0)))
    if jobs < 2 or sum(map(_size, sources.paths)) < WORTH_PROCESSES:
        return [chapter_of(path, title) for path, title in zip(sources.paths, sources.titles, strict=True)]
    # The largest result files are started first, so that no worker process has one left at the end.
    order = sorted(range(len(sources.paths)), key=lambda index: -_size(sources.paths[index]))
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        started = {index: pool.submit(chapter_of, sources.paths[index], sources.titles[index]) for index in order}
        try:
            return [started[index].result() for index in range(len(sources.paths))]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
