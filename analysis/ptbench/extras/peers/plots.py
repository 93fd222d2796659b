"""The figure and the tables of a file of `python3 -m ptbench peers`."""

from pathlib import Path

from ptbench.document.blocks import Lines
from ptbench.document.markdown import markdown
from ptbench.document.table import table_of
from ptbench.extras.peers import figure
from ptbench.extras.peers.document import HEAD, RULE, SCHEMA, row_of, scenes_of
from ptbench.figures.saving import save_if_drawable
from ptbench.io.files import make_folder, write_text
from ptbench.studies.withdrawn import withdrawals
from ptbench.terminal import say

__all__ = ["SCHEMA", "plots"]  # names that plots/command.py looks up in this module
FIGURE = "variance_by_time"


def plots(document: dict, folder: Path) -> int:
    """Draws the figure and writes the summary into `folder`; returns the exit code."""
    make_folder(folder)
    reason = save_if_drawable(lambda: figure.draw(figure.collect(document)), folder, FIGURE)
    say(write_text(folder / "summary.md", _summary(document, reason)))
    return 0


def _summary(document: dict, not_drawn: str) -> str:
    context, settings = document["context"], document["settings"]
    width, height = settings["resolution"]
    lines: Lines = [
        "# peers: what was measured",
        "",
        f"{context['device']}, {context['date']}, {context['ptbench.version']}; {width}x{height}, {settings['rounds']} "
        f"rounds, {settings['seeds']} seeds of {settings['spp']} spp.{'' if document['complete'] else ' Unfinished.'}",
        "",
        RULE,
        "",
    ]
    estimators = {peer.value["estimator"] for scene in scenes_of(document) for peer in scene.peers}
    for entry in withdrawals():
        if settings["backend"] in entry.backends and estimators & set(entry.choices):
            lines += [f"Withdrawn: {entry.full}", ""]
    if not_drawn:
        lines += [f"Not drawn: {not_drawn}", ""]
    for scene in scenes_of(document):
        rows = [(*row_of(scene, peer), peer.value["leaves_out"]) for peer in scene.peers]
        lines += [f"## {scene.name}", "", table_of((*HEAD, "left out of its time"), rows, set(HEAD[1:5])), ""]
    return markdown(lines)
