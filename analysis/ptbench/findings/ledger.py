"""Common parts of commands that keep generated pages: options, rendering of templates, finding stale pages."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, StrictUndefined, TemplateError

from ptbench.errors import FindingError
from ptbench.io.files import write_text
from ptbench.numbers import percent
from ptbench.program import Program
from ptbench.stats.estimates import CONFIDENCE

_ENVIRONMENT = Environment(undefined=StrictUndefined, keep_trailing_newline=True, trim_blocks=True, lstrip_blocks=True)
_PAGES = (".md", ".svg")


@dataclass(frozen=True)
class Call:
    """The options of a command that keeps pages of measurements (ptbench.command.add_ledger)."""

    root: Path = Path()
    names: Sequence[str] = ()
    results: Path | None = None  # folder of benchmark results; None: the checkout's own
    binary: Path | None = None  # path of the ptbench program; None: the checkout's own
    run: bool = False
    write: bool = False
    check: bool = False

    @property
    def folder(self) -> Path:
        """The folder of results."""
        return self.results or self.root / "results"

    @property
    def program(self) -> Program:
        """The ptbench program that measures."""
        return Program(self.binary or self.root / "build" / "ptbench")


def rendered(template: str, **names: object) -> str:
    """Renders a template with these variables and `confidence`; raises TemplateError."""
    return _ENVIRONMENT.from_string(template).render(confidence=percent(CONFIDENCE), **names)


def rendered_file(template: Path, **names: object) -> str:
    """Renders a template's file with these variables and `confidence`; raises FindingError."""
    try:
        return rendered(template.read_text(encoding="utf-8"), **names)
    except (OSError, TemplateError) as error:
        raise FindingError(f"{template}: {error}") from error


def write_pages(folder: Path, pages: Mapping[str, str]) -> None:
    """Writes pages by name, and removes other pages and figures from the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        write_text(folder / name, text)
    for name in _there(folder) - pages.keys():
        (folder / name).unlink()


def stale_pages(folder: Path, pages: Mapping[str, str], of: str, command: str) -> list[str]:
    """Complaints on pages that differ from what would be written; `of` is what a page is about, a claim or a map."""
    there, advice = _there(folder), f"run python3 -m ptbench {command} --write"
    faults = [f"{folder / name}: no {of} has it; {advice}" for name in sorted(there - pages.keys())]
    for name, text in pages.items():
        if name not in there or (folder / name).read_text(encoding="utf-8") != text:
            faults.append(f"{folder / name}: not what {of}s and results say; {advice}")
    return faults


def _there(folder: Path) -> set[str]:
    return {path.name for path in folder.glob("*") if path.suffix in _PAGES}
