#!/usr/bin/env python3
"""Imports and renders every scene in a folder of course scenes by other authors, and counts the outcomes.

FOLDER/AUTHOR/.. has scenes in the text or JSON format of CIS 565 with the mesh files that they name, in the places that
they have in their repositories. Files of equal content count once, and only the first MOST by name of each author. The
output has only counts: no names of authors or files, and no text of theirs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

SCHEMA = "ptbench-imports-1"
MOST = 20  # largest number of scene files of one author that the survey counts
RENDER_SECONDS = 120
SIDE = 16  # width and height of a render in pixels

IMPORTED, REFUSED, NO_RENDER, BROKEN = "imported and rendered", "refused", "imported, not rendered", "crashed"

# Features that a scene needs, by patterns in the scene's text, independent of what the importer reports.
TEXT_NEEDS = {
    # A material of index -1 is the one in a mesh's own file, so that the scene needs meshes.
    "mesh": r"^\s*(mesh|obj|custom_obj|GLTF)\b|\.(obj|gltf|glb)\s*$|^\s*ma\w*rial\s+-1\b",
    "texture": r"^\s*(TEXTURE|NORMAL_?MAP|NORMAL|ENV|BUMP)[ \t]+(?!NULL\b|0\b|[-.\d])\S|^\s*TEXTURE[ \t]+[1-9]"
    r"|\.(png|jpe?g|hdr|exr)\s*$",
    "procedural": r"^\s*(implicit|csg|tanglecube)\b|^\s*(PROTEX|usingProcTex)[ \t]+[1-9]|^TYPE[ \t]+\w*noise",
}
JSON_NEEDS = {
    "mesh": r'"TYPE"\s*:\s*"(mesh\w*|gltf|obj\w*|model|custom\w*)"|"(GLTF|Gltf|Meshes|VERTICES)"\s*:',
    "texture": r'"(TEXTURE|NORMAL|NORMALMAP|DIFFUSE|DIFFUSE_MAP|D_PATH|N_PATH|BUMP|ENVMAP|Environment\w*|EnvMap|'
    r'Background|METALLIC_ROUGHNESS)"\s*:|\.(png|jpe?g|hdr|exr)"',
    "procedural": r'"TYPE"\s*:\s*"(Procedural|Marble|Wood)"',
}

MISSING_MESH = "mesh file that is not in the repository"

# Reasons for a failed import by pattern; a problem gets the first that matches.
REASONS = (
    # "TEXTURE 3" selects a procedural pattern by its number.
    ("procedural shape or pattern", r"TEXTURE \d+\", allowed: an image"),
    ("texture, bump or environment map", r"no texture, bump or environment map|no image here"),
    ("image that is not in the repository", r"an image \.\w+ or \.\w+ that is there"),
    ("library of materials that is not in the repository", r"a library of materials that is there"),
    ("procedural shape or pattern", r"no procedural shape or pattern"),
    ("subsurface scattering without coefficients", r"scattering below a surface|subsurface body with SIGMA_S"),
    (MISSING_MESH, r"a mesh file that is there|with the file of its mesh"),
    (MISSING_MESH, r"File not found : |File read error : "),
    ("mesh file that cannot be read", r"a mesh that can be read"),
    ("glass on an open mesh", r"which is not closed"),
    (
        "mesh with the materials of its own file",
        r"only the materials of \.obj are read|mtl line \d+: |\.obj: (faces|usemtl|mtllib) ",
    ),
    ("lights and meshes in a list of their own", r"lights and meshes among the objects"),
    ("a shape that turns or grows while the shutter is open", r"a motion along a line"),
    ("no name for the scene", r"or import with --name"),
    ("a material's TYPE that is not known", r"\.TYPE|\"TYPE "),
    ("a shape that is not known", r"without a shape|allowed: cube, sphere, rect"),
    ("a word that is not known", r"allowed: in (MATERIAL|CAMERA|OBJECT|SETTINGS):|allowed: MATERIAL n|CAMERA and OBJ"),
    ("sections that are not numbered from 0", r"they count up from 0"),
    ("a line that is missing", r"without|found no "),
    ("a value out of the range of scene files", r"which makes"),
    ("a line that cannot be read", r""),
)


@dataclass
class Scene:
    """A scene of the survey: its file, the features it needs, and its outcome."""

    author: str
    path: Path
    dialect: str
    needs: list[str]
    outcome: str = ""
    reasons: set[str] = field(default_factory=set)
    warnings: int = 0
    said: str = ""

    @property
    def group(self) -> str:
        """The group of a scene, by the features that an importer must support."""
        if not self.needs:
            return "plain"
        return "mesh" if self.needs == ["mesh"] else "texture or procedural"

    @property
    def lacks_a_mesh(self) -> bool:
        """Whether the scene names a mesh file that is missing, so that no importer could read it."""
        return MISSING_MESH in self.reasons

    @property
    def lacks_a_file(self) -> bool:
        """Whether any file that the scene names is missing."""
        return any(reason.endswith("that is not in the repository") for reason in self.reasons)


def needs_of(text: str, dialect: str) -> list[str]:
    """The features that a scene needs beyond boxes, spheres and plain materials."""
    needs = TEXT_NEEDS if dialect == "text" else JSON_NEEDS
    code = re.sub(r"//.*", "", text) if dialect == "text" else text
    return [name for name, pattern in needs.items() if re.search(pattern, code, re.MULTILINE)]


def is_scene(text: str, dialect: str) -> bool:
    """Whether a file is a scene of the course, rather than other text."""
    if dialect == "text":
        return bool(
            re.search(r"^\s*(MATERIAL|OBJECT)\s+\w", text, re.MULTILINE) and re.search(r"^\s*CAMERA", text, re.M)
        )
    return '"Materials"' in text and '"Camera"' in text


def scenes_in(folder: Path) -> tuple[list[Scene], Counter]:
    """The scenes to try, and the number of files left out by reason."""
    seen: set[str] = set()
    left_out: Counter = Counter()
    scenes: list[Scene] = []
    for author in sorted(path for path in folder.iterdir() if path.is_dir()):
        kept = 0
        for path in sorted(author.rglob("*")):
            dialect = {".txt": "text", ".json": "json"}.get(path.suffix.lower())
            if dialect is None or not path.is_file():
                continue
            content = path.read_bytes()
            text = content.decode("utf-8", "replace")
            if not is_scene(text, dialect):
                continue
            digest = hashlib.sha256(content).hexdigest()
            if digest in seen:
                left_out["same content as another"] += 1
            elif kept == MOST:
                left_out[f"beyond {MOST} of one author"] += 1
            else:
                seen.add(digest)
                kept += 1
                scenes.append(Scene(author.name, path, dialect, needs_of(text, dialect)))
    return scenes, left_out


def run(command: list[str], seconds: int) -> tuple[int, str]:
    """Runs a program; returns its exit code and the text of both output streams."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return 124, "timed out"
    return done.returncode, (done.stderr + done.stdout).decode("utf-8", "replace")


def reasons_of(said: str) -> set[str]:
    """The names of all problems in the importer's output."""
    found = set()
    for line in said.splitlines():
        if "no scene is written" not in line and ": note: " not in line and ": warning: " not in line:
            found.add(next(name for name, pattern in REASONS if re.search(pattern, line)))
    return found


def try_scene(scene: Scene, binary: Path) -> None:
    """Imports and renders a scene, and records the outcome."""
    with tempfile.TemporaryDirectory(prefix="ptbench-survey-") as name:
        out = Path(name) / "scene.json"
        code, scene.said = run([str(binary), "import", str(scene.path), "--out", str(out)], RENDER_SECONDS)
        scene.warnings = scene.said.count(": warning: ")
        if code == 2:
            scene.outcome, scene.reasons = REFUSED, reasons_of(scene.said)
            return
        if code != 0:
            scene.outcome = BROKEN
            return
        command = [str(binary), "render", "--scene", str(out), "--spp", "1", "--resolution", f"{SIDE}x{SIDE}"]
        command += ["--backend", "cpu", "--out", str(Path(name) / "image.pfm")]
        if '"shape": "mesh"' in out.read_text(encoding="utf-8"):
            command += ["--axis", "accelerator=bvh8", "--axis", "levels=two_level"]
        code, said = run(command, RENDER_SECONDS)
        scene.outcome = IMPORTED if code == 0 else NO_RENDER
        if code != 0:
            scene.said += said
            scene.reasons = {"the render fails"}


def share(scenes: list[Scene]) -> dict:
    """The numbers of scenes tried, imported and rendered, and imported without a warning."""
    good = sum(scene.outcome == IMPORTED for scene in scenes)
    exact = sum(scene.outcome == IMPORTED and scene.warnings == 0 for scene in scenes)
    return {"files": len(scenes), "imported_and_rendered": good, "without_a_warning": exact}


def document(scenes: list[Scene], left_out: Counter, binary: Path) -> dict:
    """The JSON document of the survey, with all counts."""
    groups = ("plain", "mesh", "texture or procedural")
    by = {
        dialect: [scene for scene in scenes if dialect in (scene.dialect, "all")] for dialect in ("all", "text", "json")
    }
    return {
        "schema": SCHEMA,
        "context": {
            "date": datetime.now().astimezone().strftime("%Y-%m-%dT%H:%M:%S%z"),
            "ptbench.version": run([str(binary), "--version"], 60)[1].strip(),
        },
        "authors": len({scene.author for scene in scenes}),
        "left_out": dict(sorted(left_out.items())),
        "dialects": {
            dialect: {
                "authors": len({scene.author for scene in some}),
                "all": share(some),
                "with_their_meshes": share([scene for scene in some if not scene.lacks_a_mesh]),
                "with_their_files": share([scene for scene in some if not scene.lacks_a_file]),
                "with_their_files_and_no_texture": share(
                    [one for one in some if not one.lacks_a_file and one.group in ("plain", "mesh")]
                ),
                "groups": {group: share([scene for scene in some if scene.group == group]) for group in groups},
                "outcomes": dict(Counter(scene.outcome for scene in some).most_common()),
                "reasons": dict(Counter(reason for scene in some for reason in sorted(scene.reasons)).most_common()),
            }
            for dialect, some in by.items()
        },
    }


def main() -> int:
    """Runs the survey and returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"))
    parser.add_argument("--out", type=Path, help="the counts, as JSON")
    parser.add_argument("--verbose", action="store_true", help="what was said of each file that did not come through")
    options = parser.parse_args()
    scenes, left_out = scenes_in(options.folder)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda scene: try_scene(scene, options.binary.resolve()), scenes))
    if options.verbose:
        for scene in scenes:
            if scene.outcome != IMPORTED:
                print(f"== {scene.author} {scene.path} [{scene.group}] {scene.outcome}: {sorted(scene.reasons)}")
                print("\n".join(line[:300] for line in scene.said.splitlines() if ": note: " not in line))
    counts = document(scenes, left_out, options.binary.resolve())
    text = json.dumps(counts, indent=1) + "\n"
    print(text, end="")
    if options.out is not None:
        options.out.write_text(text, encoding="utf-8")
    return 1 if any(scene.outcome == BROKEN for scene in scenes) else 0


if __name__ == "__main__":
    sys.exit(main())
