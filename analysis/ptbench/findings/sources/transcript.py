"""The committed output of a command, as a source for a page."""

from pathlib import Path

from ptbench.findings.source import TEXT, Source


class Transcript(Source, form=TEXT):
    """The text of a command's output, which a page shows as a block."""

    def __init__(self, results: Path, file: str) -> None:
        super().__init__(results, file)
        self._text = (results / file).read_text(encoding="utf-8").rstrip("\n")

    def __str__(self) -> str:
        return self._text
