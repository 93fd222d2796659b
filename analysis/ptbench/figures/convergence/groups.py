"""Groups of cells that the figures of a convergence study show together, their labels, and the notes below."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ptbench.convergence.assessment import Assessment, assess
from ptbench.convergence.efficiency import baseline_among, by_place, names_in
from ptbench.errors import NotDrawable
from ptbench.figures.caption import note_lines, setting
from ptbench.io.cells import Result, Study
from ptbench.studies.groups import MOST_TOGETHER
from ptbench.studies.notes import Note, withdrawn_notes


@dataclass(frozen=True)
class Group:
    """Cells of one scene and setting; where they fill several panels, the baseline is in each."""

    title: str
    members: tuple[Assessment, ...]
    names: dict[str, str]
    baseline: Assessment | None


@dataclass(frozen=True)
class Groups:
    """The groups of a study's cells, and the notes for each of its figures."""

    groups: tuple[Group, ...]
    notes: tuple[Note, ...]
    remarks: tuple[str, ...]

    @property
    def order(self) -> tuple[str, ...]:
        """The distinct labels of all groups; a label has the same colour and marker in all figures of a study."""
        return tuple(dict.fromkeys(group.names[one.cell.name] for group in self.groups for one in group.members))


def groups_of(result: Result, study: Study, most: int = MOST_TOGETHER) -> Groups:
    """Groups the study's fitted cells; raises NotDrawable where there are none."""
    assessed = assess(result)
    of_study = [assessed[cell.name] for cell in result.cells_of(study) if cell.name in assessed]
    notes = convergence_notes(result, study, of_study)
    fitted = [one for one in of_study if one.fit is not None]
    if not fitted:
        raise NotDrawable("no cell has a curve: " + ("; ".join(note.full for note in notes) or "no convergence cells"))
    places = by_place(fitted)
    groups: list[Group] = []
    for place, members in places.items():
        baseline = baseline_among(result, members)
        names = names_in(members, baseline)
        title = place.title(list(places))
        others = [one for one in members if one is not baseline]
        parts = max(1, math.ceil(len(others) / (most - 1)))
        for part in range(parts):
            chosen = others[part * (most - 1) : (part + 1) * (most - 1)]
            label = f"{title} ({part + 1} of {parts})" if parts > 1 else title
            groups.append(Group(label, (baseline, *chosen), names, baseline))
    remarks = [_baselines(groups), _shared(fitted, groups)]
    return Groups(tuple(groups), tuple(notes), tuple(remark for remark in remarks if remark))


def _baselines(groups: Sequence[Group]) -> str:
    variants: dict[str, None] = {}
    for group in groups:
        label, variant = group.names[group.baseline.cell.name], group.baseline.cell.variant
        variants[variant if label == "baseline" else f"{label} ({variant})"] = None
    return f"Baseline: {'; '.join(variants)}."


def _shared(fitted: Sequence[Assessment], groups: Sequence[Group]) -> str:
    """A sentence on which lines show the same error curve with different times."""
    names = {name: label for group in groups for name, label in group.names.items()}
    curves: dict[str, list[str]] = {}
    for one in fitted:
        origin = one.cell.convergence.shared_with
        if origin in names:
            curves.setdefault(names[origin], []).append(names[one.cell.name])
    parts = [f"{', '.join(dict.fromkeys(labels))} with {origin}" for origin, labels in curves.items()]
    return f"Bit for bit the same images, one error curve on their own clocks: {'; '.join(parts)}." if parts else ""


def convergence_notes(result: Result, study: Study, assessed: Sequence[Assessment]) -> list[Note]:
    """Notes on everything that limits what the study's figures show."""
    notes: list[Note] = []
    if result.interrupted:
        text = "the run was interrupted: cells and samples may be missing"
        notes.append(Note("interrupted run", "Run interrupted: cells and samples may be missing.", text))
    notes += withdrawn_notes(result.cells_of(study))
    for cell in result.cells_of(study):
        if cell.convergence is None:
            notes.append(Note("no checkpoints", f"{cell.variant} has no checkpoints.", f"{cell.shown}: no checkpoints"))
    for one in assessed:
        if one.fit is None:
            where = f"{one.cell.variant} in {one.cell.scene}"
            text = f"{one.verdict.word} ({one.verdict.reason})"
            notes.append(Note("not fitted", f"Left out: {where}, {text}.", f"{one.cell.shown}: {text}"))
        for doubt in one.doubts:
            short = f"{one.cell.variant} in {one.cell.scene}: {doubt}."
            notes.append(Note("doubt", short, f"{one.cell.shown}: {doubt}"))
    for item in result.not_applicable:
        if item.study == study.name and not item.elsewhere:
            text = f"{item.variant} in {item.scene}: {item.reason}"
            notes.append(Note("n/a", f"Not applicable: {text}.", text))
    return notes


def setting_of(result: Result, found: Groups) -> str:
    """The caption of a convergence figure: what was run on which machine, and the notes."""
    cells = [one.cell for group in found.groups for one in group.members]
    once = list({cell.name: cell for cell in cells}.values())
    return "\n".join([setting(result, once, told=False), *note_lines(found.notes)])
