"""`findings`: renders the pages of findings and the README from their templates, and draws the overview.

A page is written only if every number of it is found and every verdict holds. `--check` writes nothing and says which
pages on disk are not what their results say.
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
    """Where templates, pages and results lie in a checkout."""

    root: Path

    @property
    def templates(self) -> Path:
        """Where the templates lie."""
        return self.root / "docs" / "templates"

    @property
    def results(self) -> Path:
        """Where the results lie."""
        return self.root / "results"

    def target(self, template: Path) -> Path:
        """README.md lies at the root, all other pages in docs/findings."""
        return self.root / "README.md" if template.stem == "README" else self.root / "docs/findings" / template.name

    def pages(self, names: Sequence[str] = ()) -> list[Page]:
        """Every template, or those of these names; raises InputError for one that is not there."""
        templates = sorted(self.templates.glob("*.md"))
        if not templates:
            raise bad_value(self.templates, "folder", "no template", "the root of a checkout as --root")
        known = [template.stem for template in templates]
        if unknown := [name for name in names if name not in [*known, OVERVIEW]]:
            raise bad_value(self.templates, "page", ", ".join(unknown), ", ".join([*known, OVERVIEW]))
        return [read_page(template) for template in templates if not names or template.stem in names]


def findings(root: Path, names: Sequence[str], *, check: bool) -> int:
    """Exit code: 0 all is as its results say, 1 something is not. Every fault is told, a line each."""
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
