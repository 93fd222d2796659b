"""A small picture of each measured scene: a convergence study's reference, or a render made for the report."""

import io
import os
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image as Raster

from ptbench.document.blocks import Image
from ptbench.errors import InputError
from ptbench.gallery import command as gallery
from ptbench.io.axes import DIRECT_LIGHT
from ptbench.io.cells import Result
from ptbench.io.files import LARGEST_IMAGE, one_line, read_whole, safe_name, scratch_folder, write_whole
from ptbench.io.images import displayed, exposure_of, read_pfm
from ptbench.program import Program

_SCENES = Path(__file__).resolve().parents[3] / "scenes"
_LONGEST_REASON = 160  # most characters of a reason for a missing picture
_LESS_NOISE = {DIRECT_LIGHT: "nee_mis"}
_JPEG_QUALITY = 88
_SHOWN = 200  # width of a picture in CSS pixels


@dataclass(frozen=True)
class SceneUse:
    """A scene in a result file; `reference` is its image file from a convergence study, if there is one."""

    scene: str
    scene_hash: str
    resolutions: tuple[str, ...]
    reference: Path | None = None
    reference_variant: str = ""
    reference_spp: int = 0
    file: str = ""  # path of a scene file that is not shipped with ptbench


@dataclass(frozen=True)
class Renderer:
    """The program and quality for rendering pictures of scenes, which are kept in `folder`."""

    binary: Path
    spp: int
    side: int
    folder: Path

    def check(self) -> None:
        """Raises InputError if the program cannot be run."""
        Program(self.binary).check()


@dataclass(frozen=True)
class ScenePicture:
    """The picture of a scene and how it was made, or `failure`: why there is none."""

    scene: str
    scene_hash: str
    sizes: str  # resolutions at which the scene was measured
    image: Image | None = None
    how: str = ""
    failure: str = ""

    @property
    def caption(self) -> str:
        """The caption of a scene's picture: name, hash, measured resolutions, and how the picture was made."""
        return f"`{self.scene}`, hash `{self.scene_hash}`, measured at {self.sizes}; {self.how}."


def scene_uses(result: Result) -> tuple[SceneUse, ...]:
    """The scenes of a file's cells, in order; their reference images lie in a folder beside the file."""
    found: dict[tuple[str, str], list] = {}
    for cell in result.cells:
        found.setdefault((cell.scene, cell.scene_hash), []).append(cell)
    uses = []
    for (scene, scene_hash), cells in found.items():
        sizes = tuple(dict.fromkeys(cell.resolution_text for cell in cells))
        path, reference = None, None
        own_file = next((cell.scene_file for cell in cells if cell.scene_file), "")
        for cell in cells:
            convergence = cell.convergence
            if convergence is None or not convergence.reference_picture or convergence.reference.scene != scene:
                continue
            file = result.path.parent / convergence.reference_picture
            if os.path.lexists(file):
                path, reference = file, convergence.reference
                break
        if reference is None:
            uses.append(SceneUse(scene, scene_hash, sizes, file=own_file))
        else:
            uses.append(SceneUse(scene, scene_hash, sizes, path, reference.variant, 2 * reference.spp_per_half))
    return tuple(uses)


def scene_pictures(uses: Sequence[SceneUse], renderer: Renderer | None) -> list[ScenePicture]:
    """One picture per scene and hash, sorted by name."""
    merged: dict[tuple[str, str], list[SceneUse]] = {}
    for use in uses:
        merged.setdefault((use.scene, use.scene_hash), []).append(use)
    return [_picture(members, renderer) for _, members in sorted(merged.items())]


def _picture(uses: Sequence[SceneUse], renderer: Renderer | None) -> ScenePicture:
    use = next((use for use in uses if use.reference is not None), uses[0])
    sizes = {tuple(map(int, size.split("x"))) for one in uses for size in one.resolutions}
    measured = ", ".join(f"{width}×{height}" for width, height in sorted(sizes))
    known = ScenePicture(use.scene, use.scene_hash or "unknown", measured)
    if use.reference is not None:
        by = f"{use.reference_spp} spp by {use.reference_variant}" if use.reference_spp else "in closed form"
        try:
            return replace(known, image=_from_reference(use), how=f"the convergence study's reference, {by}")
        except InputError as error:
            return replace(known, failure=one_line(str(error)))
    if renderer is None:
        return replace(known, failure="none beside the result files; no program to render it")
    return _rendered(known, use, renderer)


def _from_reference(use: SceneUse) -> Image:
    pixels = read_pfm(use.reference)
    return _image(use, np.round(255 * displayed(pixels, exposure_of(pixels))).astype(np.uint8))


def _image(use: SceneUse, pixels: np.ndarray) -> Image:
    """An image from 8-bit pixels, given as an array with two axes if grey."""
    raster = Raster.fromarray(pixels)
    with io.BytesIO() as written:
        raster.convert("RGB").save(written, "JPEG", quality=_JPEG_QUALITY, subsampling=0, optimize=True)
        return _framed(use, written.getvalue())


def _framed(use: SceneUse, jpeg: bytes) -> Image:
    with Raster.open(io.BytesIO(jpeg)) as raster:
        width, height = raster.size
    name = safe_name(f"{use.scene}-{use.scene_hash or 'unknown'}") + ".jpg"
    return Image(name, jpeg, f"The scene {use.scene}", _SHOWN, round(_SHOWN * height / width))


def _rendered(known: ScenePicture, use: SceneUse, renderer: Renderer) -> ScenePicture:
    """A picture rendered now, or kept from an earlier report: its file name tells scene, size and quality."""
    size = _fitting(use.resolutions[0], renderer.side)
    how = f"rendered at {size[0]}×{size[1]}, {renderer.spp} spp, light sampled where that applies"
    name = f"{use.scene}-{known.scene_hash}-{size[0]}x{size[1]}-{renderer.spp}spp"
    kept = renderer.folder / (safe_name(name) + ".jpg")
    if use.scene_hash and kept.is_file():
        try:
            return replace(known, image=_framed(use, read_whole(kept, LARGEST_IMAGE)), how=how)
        except (InputError, OSError):
            pass  # a cached picture of a scene that cannot be read is rendered anew
    done = _render(use, size, renderer)
    if done.image is None:
        return replace(known, failure=f"not rendered: {textwrap.shorten(done.failure, _LONGEST_REASON)}")
    if use.scene_hash and done.scene_hash != use.scene_hash:
        found = done.scene_hash or "unknown"
        return replace(known, failure=f"the program's scene of that name is another one, of hash {found}")
    image = _image(use, np.round(255 * done.image).astype(np.uint8))
    if not done.remarks:
        write_whole(kept, lambda path: path.write_bytes(image.data) and None)
    return replace(known, image=image, how="; ".join([how, *done.remarks]))


def _render(use: SceneUse, size: tuple[int, int], renderer: Renderer) -> gallery.Rendered:
    """Renders a scene from its own file, by name, or from a file of its name with its hash; else the first failure."""
    attempts = []
    # A suite may have used a scene file whose name the program does not know.
    files = sorted(path for path in _SCENES.rglob("*.json") if path.stem == use.scene)
    own = [use.file] if use.file and os.path.isfile(use.file) else []
    for source in (*own, use.scene, *map(str, files)):
        attempts.append(_render_source(source, size, renderer))
        if attempts[-1].image is not None and use.scene_hash in ("", attempts[-1].scene_hash):
            return attempts[-1]
    return attempts[0]


def _render_source(source: str, size: tuple[int, int], renderer: Renderer) -> gallery.Rendered:
    """Renders with next-event estimation, which reduces noise at equal mean; without it where it does not apply."""
    program = renderer.binary.resolve()
    with scratch_folder(renderer.folder) as scratch:
        for axes in (_LESS_NOISE, {}):
            wanted = gallery.Picture(source, source, axes)
            done = gallery.render(program, wanted, renderer.spp, size, scratch)
            if done.image is not None:
                break
    return done


def _fitting(resolution: str, side: int) -> tuple[int, int]:
    """The measured resolution scaled to `side` pixels along the longer side."""
    width, height = (int(part) for part in resolution.split("x"))
    longest = max(width, height)
    return max(1, round(side * width / longest)), max(1, round(side * height / longest))
