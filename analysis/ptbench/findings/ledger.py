"""What folders of generated pages share: how a call names them, how a page is rendered, which of them are stale."""

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
    """The options of a command that keeps pages of what was measured (ptbench.command.add_ledger)."""

    root: Path = Path()
    names: Sequence[str] = ()
    results: Path | None = None  # None: the checkout's own
    binary: Path | None = None  # None: the checkout's own
    run: bool = False
    write: bool = False
    check: bool = False

    @property
    def folder(self) -> Path:
        """The folder of results."""
        return self.results or self.root / "results"

    @property
    def program(self) -> Program:
        """The program that measures."""
        return Program(self.binary or self.root / "build" / "ptbench")


def rendered(template: str, **names: object) -> str:
    """A template's text with these names, and `confidence`; raises TemplateError."""
    return _ENVIRONMENT.from_string(template).render(confidence=percent(CONFIDENCE), **names)


def rendered_file(template: Path, **names: object) -> str:
    """The text of a template's file with these names, and `confidence`; raises FindingError."""
    try:
        return rendered(template.read_text(encoding="utf-8"), **names)
    except (OSError, TemplateError) as error:
        raise FindingError(f"{template}: {error}") from error


def write_pages(folder: Path, pages: Mapping[str, str]) -> None:
    """Writes the pages by their names, and removes what else is a page or a figure there."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        write_text(folder / name, text)
    for name in _there(folder) - pages.keys():
        (folder / name).unlink()


def stale_pages(folder: Path, pages: Mapping[str, str], of: str, command: str) -> list[str]:
    """What of the folder is not as it would be written; `of` is what each page is of, a claim or a map."""
    there, advice = _there(folder), f"run python3 -m ptbench {command} --write"
    faults = [f"{folder / name}: no {of} has it; {advice}" for name in sorted(there - pages.keys())]
    for name, text in pages.items():
        if name not in there or (folder / name).read_text(encoding="utf-8") != text:
            faults.append(f"{folder / name}: not what {of}s and results say; {advice}")
    return faults


def _there(folder: Path) -> set[str]:
    return {path.name for path in folder.glob("*") if path.suffix in _PAGES}
