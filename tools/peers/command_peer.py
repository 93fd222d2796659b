#!/usr/bin/env python3
"""Makes a peer of `python3 -m ptbench peers` of any program that renders one picture a call, such as a course project.

`command_peer.py [--ms REGEX] -- PROGRAM ARGUMENT..`: in the arguments {scene} {xml} {width} {height} {depth} {spp}
{seed} {out} are filled in, and the program writes the picture to {out}, a PFM of linear radiance. REGEX finds in what
it prints the milliseconds that its render took; without it the whole process is timed, start and scene included.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path


class Failed(Exception):
    """The failure of a program that was asked for a picture."""


class Peer:
    """The program, and the scene that it is asked to render."""

    def __init__(self, call):
        self.call = call
        self.place = {}

    def about(self, _):
        """Which program this is."""
        return {"program": Path(self.call.program[0]).name, "clock": self.call.ms or "the whole process"}

    def load(self, request):
        """Takes the scene, which is not read before it is rendered."""
        width, height = request["resolution"]
        depth = "" if request["depth"] is None else request["depth"]
        self.place = {"scene": request["scene"], "xml": request["xml"], "width": width, "height": height}
        self.place["depth"] = depth
        return {}

    def image(self, request):
        """The picture of a seed."""
        with tempfile.TemporaryDirectory(prefix="command-peer-") as folder:
            out = Path(folder) / "picture.pfm"
            said = self._rendered(request, out)
            if not out.is_file():
                raise Failed(f"{self.call.program[0]} wrote no {out.name}")
            shutil.move(out, request["file"])
        return said

    def times(self, request):
        """The times of a seed's renders: one warms up, and then come those that count."""
        with tempfile.TemporaryDirectory(prefix="command-peer-") as folder:
            out = Path(folder) / "picture.pfm"
            return {"renders": [self._rendered(request, out) for _ in range(request["repetitions"] + 1)][1:]}

    def _rendered(self, request, out):
        words = {**self.place, "spp": request["spp"], "seed": request["seed"], "out": out}
        command = [_filled(argument, words) for argument in self.call.program]
        begun = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        wall_ms = 1e3 * (time.perf_counter() - begun)
        if done.returncode != 0:
            raise Failed(f"{command[0]} ended with exit code {done.returncode}: {' '.join(done.stderr.split())[:200]}")
        found = re.search(self.call.ms, done.stdout + done.stderr) if self.call.ms else None
        if self.call.ms and not found:
            raise Failed(f"{command[0]} printed nothing like {self.call.ms}")
        return {"ms": float(found[1]) if found else wall_ms, "wall_ms": wall_ms, "compile_ms": 0.0}


def _filled(argument, words):
    return re.sub(r"\{(\w+)\}", lambda name: str(words.get(name[1], name[0])), argument)


def arguments():
    """Reads the arguments of the call."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ms", default="", metavar="REGEX", help="with one group: the milliseconds of the render")
    parser.add_argument("program", nargs="+", help="and its arguments, after --")
    call = parser.parse_args()
    try:
        if call.ms and re.compile(call.ms).groups != 1:
            parser.error(f'--ms: found "{call.ms}", allowed: a regular expression with one group')
    except re.error as error:
        parser.error(f'--ms: found "{call.ms}", allowed: a regular expression ({error})')
    return call


def main():
    """Answers requests until there are no more."""
    peer = Peer(arguments())
    for line in sys.stdin:
        try:
            request = json.loads(line)
            said = getattr(peer, request["do"])(request)
        except (Failed, OSError, ValueError) as error:
            said = {"error": str(error)}
        print(json.dumps(said), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
