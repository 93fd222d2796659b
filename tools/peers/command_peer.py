#!/usr/bin/env python3
"""Makes any program that renders one picture per call, such as a course project, a peer of `python3 -m ptbench peers`.

`command_peer.py [--ms REGEX] -- PROGRAM ARGUMENT..` fills in the arguments {scene} {xml} {width} {height} {depth} {spp}
{seed} {out}, and the program writes the picture to {out}, a PFM of linear radiance. REGEX matches the milliseconds of
the render in the program's output; without it the whole process is timed, including start and loading.
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
    """Raised if the program fails to render a picture."""


class Peer:
    """The program as a peer, with the scene that it is to render."""

    def __init__(self, call):
        self.call = call
        self.place = {}

    def about(self, _):
        """The program's name and how it is timed, for the result file."""
        return {"program": Path(self.call.program[0]).name, "clock": self.call.ms or "the whole process"}

    def load(self, request):
        """Remembers the scene; the program reads it at each render."""
        width, height = request["resolution"]
        depth = "" if request["depth"] is None else request["depth"]
        self.place = {"scene": request["scene"], "xml": request["xml"], "width": width, "height": height}
        self.place["depth"] = depth
        return {}

    def image(self, request):
        """Renders a seed's picture to the requested file."""
        with tempfile.TemporaryDirectory(prefix="command-peer-") as folder:
            out = Path(folder) / "picture.pfm"
            said = self._rendered(request, out)
            if not out.is_file():
                raise Failed(f"{self.call.program[0]} wrote no {out.name}")
            shutil.move(out, request["file"])
        return said

    def times(self, request):
        """Render times of one seed, after a warm-up render that is not counted."""
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
    """Parses the command line of command_peer.py."""
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
