"""`python3 -m ptbench explain`: where the time of two variants differs, and what else differs with it."""

import argparse
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.extras.explain.accounting import accounting_of
from ptbench.extras.explain.facts import facts_of
from ptbench.extras.explain.figure import draw
from ptbench.extras.explain.found import Choice, Found, Pair, Setting
from ptbench.extras.explain.text import explained, page_of
from ptbench.figures import style
from ptbench.figures.saving import save_figure
from ptbench.io.cells import Cell, Result
from ptbench.io.files import make_folder, safe_name, write_text
from ptbench.io.inspection import Inspected, inspected_of, load_inspected
from ptbench.io.nodes import read_json, shown
from ptbench.io.results import result_of
from ptbench.io.stability import is_stability
from ptbench.stats.estimates import FASTER, SLOWER
from ptbench.studies.rows import time_ratio
from ptbench.studies.variants import find_variant, labels_of
from ptbench.terminal import say


def explain(
    path: Path, a: str, b: str, choice: Choice | None = None, counters: Sequence[Path] = (), out: Path | None = None
) -> int:
    """Prints the explanation, and writes it to explain.md with a figure per setting; returns the exit code."""
    root = read_json(path)
    if is_stability(root):
        raise bad_value(path, "$.schema", shown(root.fields()["schema"]), "a result of `ptbench run`, which has times")
    result = result_of(root)
    entries = [entry for file in counters for entry in load_inspected(file)]
    names = find_variant(result, a, "variant A"), find_variant(result, b, "variant B")
    if names[0] == names[1]:
        raise bad_value(path, "the variants", f"{names[0]} for both names", "two variants")
    found = pairs_of(result, names, choice or Choice(), entries)
    folder = out if out is not None else result.path.parent / "figures" / _folder_name(result, names, found)
    make_folder(folder)
    pictures: dict[Setting, str] = {}
    written: list[Path] = []
    for pair in found.pairs:
        name = safe_name(f"{pair.setting}".replace(", ", "_").replace(" ", ""))
        pictures[pair.setting] = f"{name}.png"
        with style.applied():
            written += save_figure(draw(result, pair), folder, name)
    print(explained(result, names, found), end="")
    written.append(write_text(folder / "explain.md", page_of(result, names, found, pictures)))
    for target in written:
        say(target)
    return 0


def explain_command(options: argparse.Namespace) -> int:
    """Runs `explain` with parsed options and returns the exit code; raises InputError."""
    choice = Choice(options.scene, options.depth, options.resolution)
    return explain(options.result, options.a, options.b, choice, options.counters, options.out)


def pairs_of(result: Result, names: tuple[str, str], choice: Choice, entries: Sequence[Inspected] = ()) -> Found:
    """The settings in which both variants ran; raises InputError where there are none."""
    by_setting: list[dict[Setting, list[Cell]]] = [{}, {}]
    for side, name in zip(by_setting, names, strict=True):
        for cell in result.cells:
            if cell.variant == name and _is_chosen(cell, choice):
                side.setdefault(_setting(cell), []).append(cell)
    both = [setting for setting in by_setting[0] if setting in by_setting[1]]
    scenes = list(dict.fromkeys(setting.scene for setting in both))
    common = sorted(both, key=lambda setting: (scenes.index(setting.scene), setting.resolution, setting.depth))
    if not common:
        raise _nothing_in_common(result, names, choice)
    found = Found()
    for setting in common:
        a, b, others = _closest(by_setting[0][setting], by_setting[1][setting])
        found.left_out += [f"{cell.shown}: the pair with the same spp is shown" for cell in others]
        unmeasured = [cell for cell in (a, b) if not cell.measured]
        for cell in unmeasured:
            why = f"failed: {cell.failure}" if cell.failed else "it has no samples"
            found.left_out.append(f"{setting}: nothing to explain, {cell.variant} has no times ({why})")
        if not unmeasured:
            found.pairs.append(_pair(result, setting, a, b, entries, found.left_out))
    for side, other in ((0, 1), (1, 0)):
        alone = [str(setting) for setting in by_setting[side] if setting not in by_setting[other]]
        if alone:
            found.left_out.append(f"only {names[side]} ran with: {'; '.join(alone)}")
    return found


def _setting(cell: Cell) -> Setting:
    return Setting(cell.scene, cell.backend, cell.resolution, cell.depth, cell.convergence is not None)


def _is_chosen(cell: Cell, choice: Choice) -> bool:
    return (
        choice.scene in ("", cell.scene)
        and choice.depth in (None, cell.depth)
        and choice.resolution in (None, cell.resolution)
    )


def _closest(a: Sequence[Cell], b: Sequence[Cell]) -> tuple[Cell, Cell, list[Cell]]:
    """The most comparable two cells of the variants: measured, at equal and many samples per pixel; and the rest."""

    def rank(pair: tuple[Cell, Cell]) -> tuple:
        one, other = pair
        return not (one.measured and other.measured), one.spp != other.spp, -min(one.spp, other.spp)

    one, other = min(((x, y) for x in a for y in b), key=rank)
    return one, other, [cell for cell in (*a, *b) if cell not in (one, other)]


def _pair(
    result: Result, setting: Setting, a: Cell, b: Cell, entries: Sequence[Inspected], left_out: list[str]
) -> Pair:
    ratio, verdict = time_ratio(b, a)
    accounting = accounting_of(a, b)
    counted = inspected_of(a, list(entries)), inspected_of(b, list(entries))
    for cell, of in zip((a, b), counted, strict=True):
        if entries and of is None:
            left_out.append(f"{setting}: the counters' files have none of {cell.variant} in that scene")
    return Pair(
        setting,
        labels_of(a, b),
        ratio,
        verdict,
        accounting,
        tuple(facts_of(result, accounting, has_difference=verdict.word in (FASTER, SLOWER))),
        None if None in counted else counted,
    )


def _nothing_in_common(result: Result, names: tuple[str, str], choice: Choice) -> InputError:
    """The error that no setting has both variants: an option that the file lacks, or variants that never met."""
    scenes = [list(dict.fromkeys(c.scene for c in result.cells if c.variant == name)) for name in names]
    common = [scene for scene in scenes[0] if scene in scenes[1]]
    if choice.scene and choice.scene not in common:
        shown = ", ".join(common) or "none: they ran in no scene together"
        return bad_value(result.path, "the scene", f'"{choice.scene}"', f"one in which both ran: {shown}")
    cells = [cell for cell in result.cells if choice.scene in ("", cell.scene)]
    places = [list(dict.fromkeys(str(_setting(c)) for c in cells if c.variant == name)) for name in names]
    what = " and ".join(f"{_few(of)} for {name}" for name, of in zip(names, places, strict=True))
    return bad_value(result.path, "the variants", what, "scene, backend, resolution and depth that both ran with")


def _few(places: Sequence[str], most: int = 4) -> str:
    rest = len(places) - most
    return "; ".join(places[:most]) + (f"; {rest} more" if rest > 0 else "")


def _folder_name(result: Result, names: tuple[str, str], found: Found) -> str:
    """A readable folder name that is unique to the two variants."""
    labels = found.pairs[0].labels if found.pairs else names
    readable = "-".join("_".join(part.partition("=")[2] or part for part in label.split(", ")) for label in labels)
    digest = sha256("\n".join(names).encode()).hexdigest()[:6]
    return safe_name(f"explain-{result.path.stem}-{readable[:80]}-{digest}")
