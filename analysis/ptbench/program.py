"""Calls of the program ptbench, for commands that measure: what a scene has, and small suites written as files."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import InputError, bad_value
from ptbench.io.cells import Result
from ptbench.io.results import load


@dataclass(frozen=True)
class Program:
    """The program at a path."""

    binary: Path

    def output(self, *arguments: object) -> str:
        """What a call writes; raises InputError with the program's own line where it fails."""
        done = self._called(arguments)
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if line.strip()] or [f"exit code {done.returncode}"]
            raise InputError(lines[-1].removeprefix("ptbench: "))
        return done.stdout

    def machine(self) -> str:
        """What the folder of this machine's results is called."""
        return self.output("machine").strip()

    def scene(self, scene: str) -> dict:
        """What `list --scene` says of one scene."""
        (found,) = json.loads(self.output("list", "--scene", scene, "--json"))["scenes"]
        return found

    def measure(self, suite: Mapping, folder: Path, backend: str, *, shown: bool = False) -> Result:
        """Runs a suite that is written into the folder; raises InputError where the program refuses or fails."""
        file, out = folder / f"{suite['name']}.json", folder / f"{suite['name']}_result.json"
        file.write_text(json.dumps(suite, indent=1), encoding="utf-8")
        call = ("run", "--suite", file, "--backend", backend, "--untuned", "--overwrite", "--out", out)
        if not shown:
            self.output(*call, "--quiet")
        elif (code := self._shown(call)) != 0:
            raise InputError(f"{self.binary} {' '.join(map(str, call))}: exit code {code}")
        return load(out)

    def _called(self, arguments: Sequence[object]) -> subprocess.CompletedProcess:
        self._check()
        command = [str(self.binary), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)

    def _shown(self, arguments: Sequence[object]) -> int:
        self._check()
        command = [str(self.binary), *map(str, arguments)]
        return subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode

    def _check(self) -> None:
        if not self.binary.is_file() or not os.access(self.binary, os.X_OK):
            found = "a file that cannot be run" if self.binary.is_file() else "no such file"
            raise bad_value(self.binary, "--binary", found, "the ptbench program")
