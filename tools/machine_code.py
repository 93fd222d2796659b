"""Hashes the machine code that a build of ptbench makes of its CUDA kernels, to compare two builds.

    python3 tools/machine_code.py build/ptbench --out after.json [--scene cornell_open,..] [--arch sm_90]
    python3 tools/machine_code.py --compare before.json after.json

The first call compiles, scene by scene, what `ptbench verify --quick` would run (every choice of every axis once) into
an empty cache, without a GPU, and writes the SHA-256 of each program's machine code. The second exits with 1 if
programs of a scene are in only one file, and tells how many: the code of a kernel then changed.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path


def programs_of(binary: Path, scene: str, architecture: str) -> list[str]:
    """SHA-256 of the machine code of each program that a scene's variants need, sorted."""
    with tempfile.TemporaryDirectory() as cache:
        call = [binary, "verify", "--quick", "--compile", "--arch", architecture, "--scene", scene, "--quiet"]
        subprocess.run(call, check=True, env={**os.environ, "XDG_CACHE_HOME": cache}, stdout=sys.stderr)
        return sorted(hashlib.sha256(file.read_bytes()).hexdigest() for file in Path(cache).rglob("*.cubin"))


def compare(before: dict, after: dict) -> list[str]:
    """A line for each scene whose programs differ between two files of hashes."""
    lines = []
    for scene in sorted(before["scenes"].keys() | after["scenes"].keys()):
        one, other = (Counter(side["scenes"].get(scene, [])) for side in (before, after))
        gone, new = (one - other).total(), (other - one).total()
        if gone or new:
            lines.append(f"{scene}: of {one.total()} programs {gone} are gone, of {other.total()} {new} are new")
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("binary", type=Path, nargs="?")
    parser.add_argument("--scene", default="cornell_open")
    parser.add_argument("--arch", default="sm_90")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--compare", type=Path, nargs=2)
    arguments = parser.parse_args()
    if arguments.compare:
        lines = compare(*(json.loads(file.read_text(encoding="utf-8")) for file in arguments.compare))
        print("\n".join(lines) or "the same machine code")
        return 1 if lines else 0
    if arguments.binary is None or arguments.out is None:
        parser.error("needs a binary and --out, or --compare")
    version = subprocess.run([arguments.binary, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    scenes = {scene: programs_of(arguments.binary, scene, arguments.arch) for scene in arguments.scene.split(",")}
    document = {"version": version, "architecture": arguments.arch, "scenes": scenes}
    arguments.out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
