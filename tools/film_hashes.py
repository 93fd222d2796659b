"""Hashes the films that a build of ptbench renders on a CPU, to compare two builds.

    python3 tools/film_hashes.py build/ptbench --out after.json [--scene cornell_open,scenes/meshes/teapot_room.json,..]
    python3 tools/film_hashes.py --compare before.json after.json

The first call renders every scene small (without --scene all shipped ones, including the stability suite's) in each way
listed below that applies to it, and writes the films' hashes. The second exits with 1 and names each film that the two
files do not share: both builds must leave the same bits for the same call.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
SIZE = ["--resolution", "24x24", "--spp", "3", "--untuned", "--backend", "cpu"]
# Each combination of integrator and kernel is rendered with every estimator, as a change may affect only some.
CONNECTED = [f"direct_light=nee_mis,light_sampling={choice}" for choice in ("solid_angle", "auto")]
WAYS = [
    f"integrator={integrator},specialisation={kernel},{estimator}"
    for integrator in ("depth_first", "packet", "wavefront")
    for kernel in ("features", "generic")
    for estimator in ("direct_light=off", *CONNECTED)
]


def shipped_scenes() -> list[str]:
    """Paths of all scene files in the checkout, relative to its root."""
    files = sorted((ROOT / "scenes").rglob("*.json"))
    return [str(file.relative_to(ROOT)) for file in files if "suites" not in file.parts]


def film_of(binary: Path, scene: str, way: str, image: Path) -> str | None:
    """The film's hash; None if the way of rendering does not apply to the scene. Other failures end the script."""
    axes = [word for axis in way.split(",") for word in ("--axis", axis)]
    call = [binary, "render", "--scene", scene, "--out", image, *SIZE, *axes]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return json.loads(done.stdout)["film_hash"]
    said = done.stderr.strip().splitlines()[-1]
    if "n/a: " in said:
        return None
    sys.exit(f"{scene} by {way}: {said}")


def films_of(binary: Path, scenes: list[str], image: Path) -> dict[str, str]:
    """The film hashes by scene and way of rendering."""
    films = {}
    for number, scene in enumerate(scenes, 1):
        print(f"{number} of {len(scenes)}: {scene}", file=sys.stderr)
        for way in WAYS:
            film = film_of(binary, scene, way, image)
            if film is not None:
                films[f"{scene} {way}"] = film
    return films


def compare(before: dict, after: dict) -> list[str]:
    """A line for each film that differs between two files of hashes."""
    one, other = before["films"], after["films"]
    return [
        f"{name}: {one.get(name, 'no film')} before, {other.get(name, 'no film')} after"
        for name in sorted(one.keys() | other.keys())
        if one.get(name) != other.get(name)
    ]


def main() -> int:
    """Renders scenes and writes the film hashes, or compares two files of hashes."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("binary", type=Path, nargs="?")
    parser.add_argument("--scene", default="")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--compare", type=Path, nargs=2)
    arguments = parser.parse_args()
    if arguments.compare:
        before, after = (json.loads(file.read_text(encoding="utf-8")) for file in arguments.compare)
        lines = compare(before, after)
        print("\n".join(lines) or f"the same {len(after['films'])} films")
        return 1 if lines else 0
    if arguments.binary is None or arguments.out is None:
        parser.error("needs a binary and --out, or --compare")
    version = subprocess.run([arguments.binary, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    scenes = arguments.scene.split(",") if arguments.scene else shipped_scenes()
    with tempfile.TemporaryDirectory() as folder:
        films = films_of(arguments.binary, scenes, Path(folder) / "film.pfm")
    arguments.out.write_text(json.dumps({"version": version, "films": films}, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
