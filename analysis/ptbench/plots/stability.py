"""Draws the figures and writes the summary.md of a stability result."""

from pathlib import Path

from ptbench.errors import NotDrawable
from ptbench.figures import style
from ptbench.figures.registry import stability_figures
from ptbench.figures.saving import save_figure
from ptbench.io.files import make_folder, one_line, safe_name, write_text
from ptbench.io.stability import Stability
from ptbench.stability.summary import summary
from ptbench.terminal import say


def stability_plots(stability: Stability, folder: Path) -> int:
    """Draws and writes the figures and summary.md; returns the exit code."""
    make_folder(folder)
    not_drawn: list[str] = []
    for figure in stability_figures():
        try:
            pages = figure.collect(stability)
        except NotDrawable as reason:
            not_drawn.append(f"{figure.name}: {reason}")
            say(f"not drawn: {figure.name}: {one_line(str(reason))}")
            continue
        for page in pages:
            with style.applied():
                for written in save_figure(figure.draw(page), folder, safe_name(page.name)):
                    say(written)
    say(write_text(folder / "summary.md", summary(stability, not_drawn)))
    return 0
