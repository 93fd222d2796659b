"""Programs that act as ptbench and as a Python with Mitsuba's wheel: noise and times of known ratios."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from ptbench.cli.main import main

_COMMON = '''#!PYTHON -SE
import array, json, os, random, signal, sys

MEAN = 0.5

def write_pfm(path, spp, seed, brighter, spread):
    """16x16 pixels whose samples have the variance spread^2, of one generator a seed."""
    draw = random.Random(seed)
    values = array.array("f", (MEAN * brighter + spread * draw.gauss(0, 1) / spp**0.5 for _ in range(16 * 16 * 3)))
    with open(path, "wb") as file:
        file.write(b"PF\\n16 16\\n-1.0\\n")
        values.tofile(file)
'''
_PTBENCH = """
def option(name, standard=""):
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else standard

if sys.argv[1] in ("--version", "machine"):
    print("ptbench 1.0.0 (commit 0123456789abcdef0123456789abcdef01234567)" if sys.argv[1] == "--version" else "fake")
elif sys.argv[1] == "export":
    if sys.argv[2] == "fog":
        print("ptbench: fog: $.materials.wax: found subsurface, allowed: another material", file=sys.stderr)
        sys.exit(2)
    with open(option("--out"), "w") as file:
        file.write("<scene/>")
else:
    if "accelerator=absent" in sys.argv:
        print("ptbench: n/a: accelerator=absent", file=sys.stderr)
        sys.exit(2)
    spp, seed = int(option("--spp")), int(option("--seed"))
    lights = "direct_light=nee_mis" in sys.argv
    write_pfm(option("--out"), spp, seed, 1.0, 0.1 if lights else 0.4)
    ms = spp * (2.0 if lights else 0.5)
    times = {"render_seconds": 1e-3 * ms, "device_seconds": 1e-3 * ms, "foreign_cpu_seconds": 0.0}
    summary = {"scene_hash": "0123456789abcdef", "variant": "packet", "variant_id": "0123456789abcdef"}
    summary |= {"backend": "cpu", "depth": 8, "compile_seconds": 0.0, "render_seconds": 1e-3 * ms}
    print(json.dumps(summary | {"repetitions": [times] * int(option("--repetitions", "0"))}))
"""
# As the worker answers; its own script is the first word of the call.
_MITSUBA = """
_, _, variant, estimator, mode = sys.argv
with open(sys.argv[0] + ".started", "a") as file:
    file.write(variant + "\\n")
for line in sys.stdin:
    request = json.loads(line)
    said = {}
    if request["do"] == "about":
        said = {"version": "3.9.1", "variant": variant}
    elif request["do"] == "load":
        said = {"load_ms": 12.5}
    elif variant == "dying_rgb":
        print("LLVM ERROR: Cannot select: fminimum", file=sys.stderr, flush=True)
        os.kill(os.getpid(), signal.SIGABRT)
    elif request["do"] == "image":
        brighter = {"wrong_rgb": 1.2, "faulty_rgb": float("nan")}.get(variant, 1.0)
        spread = 40.0 if variant == "noisy_rgb" else 0.2
        write_pfm(request["file"], request["spp"], 1000 + request["seed"], brighter, spread)
        said = {"ms": 8.0 * request["spp"], "wall_ms": 100.0 * request["spp"], "compile_ms": 0.0}
    elif variant == "late_rgb":
        said = {"error": "CUDA_ERROR_OUT_OF_MEMORY"}
    else:
        one = {"ms": 8.0 * request["spp"], "wall_ms": 100.0 * request["spp"], "compile_ms": 0.5}
        said = {"renders": [one] * request["repetitions"]}
    print(json.dumps(said), flush=True)
"""


class Fakes:
    """Both programs in a folder, and calls with them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ptbench = self._program("ptbench", _PTBENCH)
        self.python = self._program("python", _MITSUBA)
        self.out = folder / "peers.json"

    def _program(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(_COMMON.replace("PYTHON", sys.executable, 1) + text, encoding="utf-8")
        path.chmod(0o755)
        return path

    def call(self, *arguments: str, scene: str = "box") -> int:
        """`peers` with few rounds; the exit code."""
        words = ["peers", scene, "--binary", str(self.ptbench), "--python", str(self.python), "--out", str(self.out)]
        words += ["--variant", "lights:integrator=packet,direct_light=nee_mis", "--variant", "chance:direct_light=off"]
        words += ["--rounds", "3", "--seeds", "4", "--spp", "16", "--resolution", "16x16", "--aim", "20"]
        try:
            return main([*words, *arguments], "ptbench")
        except SystemExit as error:
            return int(error.code)

    @property
    def document(self) -> dict:
        """The file that was written."""
        return json.loads(self.out.read_text(encoding="utf-8"))
