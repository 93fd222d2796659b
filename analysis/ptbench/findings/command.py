"""`findings`: renders the pages of findings and the README from their templates, and draws the overview.

A page is written only if all its numbers are found and all its verdicts hold. `--check` writes nothing and tells which
pages on disk differ from what their results give.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import FindingError, bad_value
from ptbench.figures import style
from ptbench.figures.saving import png_of, svg_of
from ptbench.findings.overview import draw, overview_of
from ptbench.findings.page import Page, read_page, render, too_old, typed_by_hand
from ptbench.io.files import write_text, write_whole

OVERVIEW = "overview"
_DPI = 130


@dataclass(frozen=True)
class House:
    """The folders of templates, pages and results in a checkout."""

    root: Path

    @property
    def templates(self) -> Path:
        """The folder of the page templates."""
        return self.root / "docs" / "templates"

    @property
    def results(self) -> Path:
        """The folder of results in the checkout."""
        return self.root / "results"

    def target(self, template: Path) -> Path:
        """The file of a page: README.md at the root, all other pages in docs/findings."""
        return self.root / "README.md" if template.stem == "README" else self.root / "docs/findings" / template.name

    def pages(self, names: Sequence[str] = ()) -> list[Page]:
        """Every template, or those named; raises InputError for a missing one."""
        templates = sorted(self.templates.glob("*.md"))
        if not templates:
            raise bad_value(self.templates, "folder", "no template", "the root of a checkout as --root")
        known = [template.stem for template in templates]
        if unknown := [name for name in names if name not in [*known, OVERVIEW]]:
            raise bad_value(self.templates, "page", ", ".join(unknown), ", ".join([*known, OVERVIEW]))
        return [read_page(template) for template in templates if not names or template.stem in names]


def findings(root: Path, names: Sequence[str], *, check: bool) -> int:
    """Writes or checks the pages; exit code 0: all agree with their results, 1: some do not. Prints each fault."""
    house = House(root)
    if not check:
        (root / "docs/findings").mkdir(parents=True, exist_ok=True)
    faults: list[str] = []
    for page in house.pages(names):
        target = house.target(page.template)
        found = [f"{page.template}: typed by hand: {text}" for text in typed_by_hand(page)]
        found += too_old(page, house.results, root)
        try:
            text = render(page, house.results)
        except FindingError as error:
            faults += [*found, str(error)]
            continue
        if check and (not target.exists() or target.read_text(encoding="utf-8") != text):
            found.append(f"{target}: not what its template and results say; run python3 -m ptbench findings")
        if not check and not found:
            print(write_text(target, text))
        faults += found
    if not names or OVERVIEW in names:
        faults += _overview(house, check=check)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


def _overview(house: House, *, check: bool) -> list[str]:
    template, folder = house.templates / f"{OVERVIEW}.json", house.root / "docs/findings"
    faults = too_old(Page(template, json.loads(template.read_text(encoding="utf-8")), ""), house.results, house.root)
    try:
        with style.applied():
            figure = draw(overview_of(template, house.results))
            svg = svg_of(figure)
            if not check and not faults:
                print(write_text(folder / f"{OVERVIEW}.svg", svg))
                png = png_of(figure, _DPI, few_colours=True)
                print(write_whole(folder / f"{OVERVIEW}.png", lambda path: path.write_bytes(png) and None))
    except FindingError as error:
        return [*faults, str(error)]
    drawn = folder / f"{OVERVIEW}.svg"
    if check and (not drawn.exists() or drawn.read_text(encoding="utf-8") != svg):
        faults.append(f"{drawn}: not what its results say; run python3 -m ptbench findings")
    return faults
