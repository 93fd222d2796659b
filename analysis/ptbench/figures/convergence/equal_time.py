"""Image crops of variants at equal render time beside the reference, with their signed error.

The images lie in a folder beside the result file and are named by the cells. All variants show the same crop: where
they miss the reference most.
"""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ptbench import numbers
from ptbench.convergence.assessment import Assessment
from ptbench.convergence.efficiency import render_times
from ptbench.errors import NotDrawable, bad_value
from ptbench.figures import style
from ptbench.figures.convergence.groups import Group, groups_of, setting_of
from ptbench.figures.declaration import StudyFigure
from ptbench.io.asked import CONVERGENCE
from ptbench.io.cells import Result, Study
from ptbench.io.convergence import Picture
from ptbench.io.images import TONE_MAPPING, displayed, exposure_of, flip, read_pfm
from ptbench.studies.notes import Note

_CROP = 96  # width and height in pixels of the window cut from a larger image
_PICTURE, _BETWEEN = 1.6, 0.14  # inches: side of a picture and gap between pictures
_COLUMNS = 5
_LINES = 4  # most lines of a variant's name above its picture
_LABEL = 8.0
_LONGEST_EQUAL = 1.25


@dataclass(frozen=True)
class Shot:
    """The image of one variant at equal time; `error` is its signed error, averaged over channels."""

    label: str
    facts: str
    picture: np.ndarray
    error: np.ndarray | None  # signed error image; None: this picture is the reference's


@dataclass(frozen=True)
class Sheet:
    """The pictures of one scene and setting, at equal time."""

    title: str
    shots: tuple[Shot, ...]
    limit: float  # largest signed error on the colour scale of the error images


@dataclass(frozen=True)
class Data:
    """The contents of the figure of image crops at equal time."""

    title: str
    caption: str
    notes: tuple[Note, ...]
    sheets: tuple[Sheet, ...]


def collect(result: Result, study: Study) -> Data:
    """Collects a sheet of crops per scene and setting; raises NotDrawable."""
    found = groups_of(result, study, 10**6)
    folder = result.path.parent
    notes, sheets, flips, reasons = list(found.notes), [], {}, []
    for group in found.groups:
        with_images = [one for one in group.members if one.cell.convergence.pictures]
        if not with_images:
            reasons.append(f"{group.title}: no cell names an image")
            continue
        time, chosen = _at_equal_time(with_images)
        names = {with_images[0].cell.convergence.reference_picture, *(picture.file for picture, _ in chosen)}
        missing = sorted(name for name in names if not os.path.lexists(folder / name))
        if missing:
            more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
            reasons.append(f"{group.title}: {folder / missing[0]}{more} is not there")
            continue
        if len(with_images) < len(group.members):
            text = f"{group.title}: {len(group.members) - len(with_images)} variants without images"
            notes.append(Note("no image", f"{text}.", text))
        sheet, settings, failure = _sheet(folder, group, with_images, time, chosen)
        sheets.append(sheet)
        if settings:
            flips[settings] = None
        if failure:
            notes.append(Note("no FLIP", f"{failure}.", failure))
    if not sheets:
        raise NotDrawable("; ".join(reasons))
    for reason in reasons:
        notes.append(Note("no image", f"{reason}.", reason))
    _, how = render_times([one for group in found.groups for one in group.members])
    caption = [
        f"Each variant's last image within the time that all have one at; its own stands above it: {how}. "
        f"{TONE_MAPPING} "
        "Below: signed error, mean over channels, in units of the reference's white; red too bright, blue too dark, "
        "all of a scene on one scale. RMSE: of the whole image, against the mean reference.",
        *(f"FLIP: of the whole image, {settings}." for settings in flips),
        setting_of(result, replace(found, notes=tuple(dict.fromkeys(notes)))),
    ]
    return Data(_title(study), "\n".join(caption), tuple(dict.fromkeys(notes)), tuple(sheets))


def _title(study: Study) -> str:
    return f"{study.title}: crops at equal time" if study.title else "Crops at equal render time"


def _at_equal_time(members: Sequence[Assessment]) -> tuple[float, list[tuple[Picture, float]]]:
    """The latest time at which all cells have an image, and each one's last image by then, or its first."""
    timed = [_timed(one, ms) for one, ms in zip(members, render_times(members)[0], strict=True)]
    time = min(max(times.values()) for times in timed)
    chosen = []
    for times in timed:
        within = [picture for picture in times if times[picture] <= time * (1 + 1e-9)]
        picture = max(within, key=times.get) if within else min(times, key=times.get)
        chosen.append((picture, times[picture]))
    return time, chosen


def _sheet(
    folder: Path,
    group: Group,
    members: Sequence[Assessment],
    time: float,
    chosen: Sequence[tuple[Picture, float]],
) -> tuple[Sheet, str, str]:
    """The sheet of crops, FLIP's settings, and why FLIP values are missing, if so."""
    reference = read_pfm(folder / members[0].cell.convergence.reference_picture)
    exposure = exposure_of(reference)
    images, facts, settings, failure = [], [], "", ""
    for picture, own in chosen:
        file = folder / picture.file
        image = read_pfm(file)
        if image.shape != reference.shape:
            size, needed = ("x".join(map(str, array.shape[1::-1])) for array in (image, reference))
            raise bad_value(file, "the image", size, f"the reference's size, {needed}")
        images.append(image)
        rmse = float(np.sqrt(np.mean((image.astype(float) - reference) ** 2)))
        late = " (first image)" if own > _LONGEST_EQUAL * time else ""
        text = f"{picture.spp} spp, {numbers.figures(own, 3)} ms{late}\nRMSE {numbers.figures(rmse, 3)}"
        try:
            measured = flip(reference, image)
            text += f", FLIP {measured.mean:.3f}"
            settings = measured.settings
        except NotDrawable as reason:
            failure = str(reason)
        facts.append(text)
    errors = [np.mean(image - reference, axis=2) * exposure for image in images]
    window = _window(errors)
    shots = [
        Shot(
            "reference", members[0].curve.reference.kind.replace("_", " "), displayed(reference, exposure)[window], None
        )
    ]
    for one, image, text, error in zip(members, images, facts, errors, strict=True):
        shots.append(Shot(group.names[one.cell.name], text, displayed(image, exposure)[window], error[window]))
    shown = np.abs([error[window] for error in errors])
    # The limit of the colour scale ignores pixels without error: if most are exact, the others would lack contrast.
    limit = float(np.percentile(shown[shown > 0], 98)) if shown.any() else 1.0
    return Sheet(f"{group.title}, after {numbers.figures(time, 3)} ms", tuple(shots), limit), settings, failure


def _timed(one: Assessment, ms: np.ndarray) -> dict[Picture, float]:
    """Render wall time by picture, from the times `ms` of all checkpoints."""
    times = dict(zip(one.curve.spp.astype(int), ms, strict=True))
    timed = {picture: float(times[picture.spp]) for picture in one.cell.convergence.pictures if picture.spp in times}
    if not timed:
        spps = ", ".join(str(picture.spp) for picture in one.cell.convergence.pictures)
        raise NotDrawable(f"{one.cell.shown}: images at {spps} spp, but no checkpoint there")
    return timed


def _window(errors: Sequence[np.ndarray]) -> tuple[slice, slice]:
    """The crop with the largest error of all images, each relative to its own mean; the whole of a small image."""
    height, width = errors[0].shape
    squares = sum(error**2 / max(float(np.mean(error**2)), 1e-300) for error in errors)
    rows, columns = min(_CROP, height), min(_CROP, width)
    total = np.pad(squares, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    sums = total[rows:, columns:] - total[:-rows, columns:] - total[rows:, :-columns] + total[:-rows, :-columns]
    y, x = np.unravel_index(int(np.argmax(sums)), sums.shape)
    return slice(y, y + rows), slice(x, x + columns)


def draw(data: Data) -> Figure:
    """Draws the page of crops at equal time, from the data of `collect`."""
    columns = min(_COLUMNS, max(len(sheet.shots) for sheet in data.sheets))
    names = {
        shot.label: style.wrapped(shot.label, _LABEL, _PICTURE, "bold")[:_LINES]
        for sheet in data.sheets
        for shot in sheet.shots
    }
    name_height = style.text_height(_LABEL, max(map(len, names.values())))
    fact_height = style.text_height(_LABEL - 0.5, 2)
    block = name_height + fact_height + 2 * _PICTURE + 0.3
    blocks = [math.ceil(len(sheet.shots) / columns) for sheet in data.sheets]
    head = 0.36
    body = sum(head + block * count for count in blocks)
    width = max(2 * style.MARGIN + columns * (_PICTURE + _BETWEEN) + 0.75, 7.5)
    page = style.Page(width, body, data.title, data.caption)
    top = body
    for sheet, count in zip(data.sheets, blocks, strict=True):
        page.text(style.MARGIN, top - 0.12, sheet.title, size=style.BASE_SIZE + 0.5, weight="bold", va="center")
        top -= head
        last = None
        for index, shot in enumerate(sheet.shots):
            x = style.MARGIN + index % columns * (_PICTURE + _BETWEEN)
            y = top - index // columns * block
            page.text(x, y, "\n".join(names[shot.label]), size=_LABEL, va="top", weight="bold")
            page.text(x, y - name_height, shot.facts, size=_LABEL - 0.5, va="top")
            bottom = y - name_height - fact_height - 0.05 - _PICTURE
            _show(page, x, bottom, shot.picture)
            if shot.error is not None:
                last = _show(page, x, bottom - _PICTURE - 0.06, shot.error, cmap="RdBu_r", limit=sheet.limit)
        _colour_bar(page, last, x + _PICTURE + 0.1, bottom - _PICTURE - 0.06)
        top -= count * block
    return page.figure


def _show(page: style.Page, x: float, y: float, picture: np.ndarray, cmap: str | None = None, limit: float = 1.0):
    axes = page.axes(x, y, _PICTURE, _PICTURE)
    axes.set_axis_off()
    if cmap is None:
        return axes.imshow(picture, interpolation="nearest")
    return axes.imshow(picture, interpolation="nearest", cmap=cmap, vmin=-limit, vmax=limit)


def _colour_bar(page: style.Page, image, x: float, y: float) -> None:
    axes = page.axes(x, y, 0.09, _PICTURE)
    bar = page.figure.colorbar(image, cax=axes)
    bar.set_ticks([image.norm.vmin, 0, image.norm.vmax])
    bar.set_ticklabels([f"{image.norm.vmin:.2g}", "0", f"+{image.norm.vmax:.2g}"], fontsize=_LABEL - 0.5)


FIGURES = (StudyFigure(CONVERGENCE, collect, part="equal_time", place=1, has_photographs=True),)
