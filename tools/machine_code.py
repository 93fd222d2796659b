"""Hashes the machine code that a build of ptbench makes of its CUDA kernels, to compare two builds.

    python3 tools/machine_code.py build/ptbench --out after.json [--scene all] [--arch sm_90] [--pairs]
    python3 tools/machine_code.py --compare before.json after.json

The first compiles, scene by scene, what `ptbench verify --quick` would run (every choice of every axis once; with
--pairs what `verify` would, every two choices together) into an empty cache, without a GPU. It writes the SHA-256 of
each program's instructions, and that of each object which nvcc made in the program's folder. The second exits with 1
and says how many programs of a scene are in one file alone, and which objects differ: their code changed. Objects of
builds in folders of other names always differ, in the names of symbols with internal linkage.
"""

import argparse
import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path


def programs_of(binary: Path, scene: str, architecture: str, *, pairs: bool) -> list[str]:
    """SHA-256 of the machine code of each program that the scene's variants need, sorted."""
    with tempfile.TemporaryDirectory() as cache:
        call = [binary, "verify", *([] if pairs else ["--quick"]), "--compile", "--arch", architecture]
        call += ["--scene", scene, "--quiet"]
        subprocess.run(call, check=True, env={**os.environ, "XDG_CACHE_HOME": cache}, stdout=sys.stderr)
        return sorted(hash_of_code(file.read_bytes()) for file in Path(cache).rglob("*.cubin"))


def hash_of_code(cubin: bytes) -> str:
    """SHA-256 of the kernels' instructions in a cubin, an ELF file: of its sections `.text.KERNEL` and their names.

    Symbols and constants are left out, since a constant that no kernel reads is in them too.
    """
    (start,) = struct.unpack_from("<Q", cubin, 40)
    size, count, names_index = struct.unpack_from("<3H", cubin, 58)
    headers = [struct.unpack_from("<IIQQQQ", cubin, start + index * size) for index in range(count)]
    names = headers[names_index][4]
    code = {}
    for name_at, _, _, _, offset, length in headers:
        name = cubin[names + name_at : cubin.index(b"\0", names + name_at)]
        if name.startswith(b".text."):
            code[name] = cubin[offset : offset + length]
    return hashlib.sha256(b"".join(name + text for name, text in sorted(code.items()))).hexdigest()


def objects_of(build: Path) -> dict[str, str]:
    """SHA-256 of the device code in each object that nvcc made for the program, by the object's path in the build."""
    found = {}
    for file in sorted(build.glob("CMakeFiles/ptbench_nvcc.dir/**/*.cu.o")):
        with tempfile.NamedTemporaryFile() as section:
            call = ["objcopy", "-O", "binary", "--only-section=.nv_fatbin", "--set-section-flags=.nv_fatbin=alloc"]
            subprocess.run([*call, file, section.name], check=True)
            found[str(file.relative_to(build))] = hashlib.sha256(Path(section.name).read_bytes()).hexdigest()
    return found


def compare(before: dict, after: dict) -> list[str]:
    """A line for each scene whose programs differ, and for each object that does."""
    lines = []
    for scene in sorted(before["scenes"].keys() | after["scenes"].keys()):
        one, other = (Counter(side["scenes"].get(scene, [])) for side in (before, after))
        gone, new = (one - other).total(), (other - one).total()
        if gone or new:
            lines.append(f"{scene}: of {one.total()} programs {gone} are gone, of {other.total()} {new} are new")
    objects = before["objects"].keys() | after["objects"].keys()
    return lines + [
        f"{name}: another machine code"
        for name in sorted(objects)
        if before["objects"].get(name) != after["objects"].get(name)
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("binary", type=Path, nargs="?")
    parser.add_argument("--scene", default="cornell_open", help="names, comma-separated, or all")
    parser.add_argument("--arch", default="sm_90")
    parser.add_argument("--pairs", action="store_true")
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
    names = arguments.scene.split(",")
    if names == ["all"]:
        call = [arguments.binary, "list", "--names", "scenes"]
        names = subprocess.run(call, check=True, capture_output=True, text=True).stdout.split()
    scenes = {name: programs_of(arguments.binary, name, arguments.arch, pairs=arguments.pairs) for name in names}
    objects = objects_of(arguments.binary.parent)
    document = {"version": version, "architecture": arguments.arch, "scenes": scenes, "objects": objects}
    arguments.out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
