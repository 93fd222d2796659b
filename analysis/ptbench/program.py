"""Runs the ptbench program and others, and measures small suites."""

import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from ptbench.errors import InputError, bad_value
from ptbench.io.cells import Result
from ptbench.io.results import load


def run_program(command: Sequence[str], text: str = "") -> subprocess.CompletedProcess:
    """Runs a program and returns its output and exit code; raises InputError if it cannot be started."""
    try:
        return subprocess.run(command, input=text, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise InputError(f"{command[0]}: {error.strerror or error}") from error


def said_by(done: subprocess.CompletedProcess) -> list[str]:
    """The lines that a program wrote to standard error, without its name and empty lines."""
    lines = [line.strip().removeprefix("ptbench: ") for line in done.stderr.splitlines() if line.strip()]
    return lines or [f"exit code {done.returncode}"]


@dataclass(frozen=True)
class Program:
    """The ptbench program at a path."""

    binary: Path

    def check(self) -> None:
        """Raises InputError if the path is no executable file."""
        if not self.binary.is_file() or not os.access(self.binary, os.X_OK):
            found = "a file that cannot be run" if self.binary.is_file() else "no such file"
            raise bad_value(self.binary, "--binary", found, "the ptbench program")

    def called(self, *arguments: object) -> subprocess.CompletedProcess:
        """Runs the program and returns its output and exit code."""
        return run_program(self._command(arguments))

    def output(self, *arguments: object) -> str:
        """The standard output of a run of the program; raises InputError with its last error line if it fails."""
        done = self.called(*arguments)
        if done.returncode != 0:
            raise InputError(said_by(done)[-1])
        return done.stdout

    def watched(self, *arguments: object, output: IO | int = subprocess.DEVNULL) -> None:
        """Runs the program with visible progress and its standard output in `output`; raises InputError if it fails."""
        code = subprocess.run(self._command(arguments), check=False, stdout=output).returncode
        if code != 0:
            raise InputError(f"{self.binary} {' '.join(map(str, arguments))}: exit code {code}")

    def machine(self) -> str:
        """The name of the folder for this machine's results."""
        return self.output("machine").strip()

    def scene(self, scene: str) -> dict:
        """The facts about a scene, from `ptbench list --scene`."""
        (found,) = json.loads(self.output("list", "--scene", scene, "--json"))["scenes"]
        return found

    def measure(self, suite: Mapping, folder: Path, backend: str, *, shown: bool = False) -> Result:
        """Runs a suite that is written into `folder`; raises InputError where the program refuses or fails."""
        file, out = folder / f"{suite['name']}.json", folder / f"{suite['name']}_result.json"
        file.write_text(json.dumps(suite, indent=1), encoding="utf-8")
        call = ("run", "--suite", file, "--backend", backend, "--untuned", "--overwrite", "--out", out)
        if shown:
            self.watched(*call)
        else:
            self.output(*call, "--quiet")
        return load(out)

    def _command(self, arguments: Sequence[object]) -> list[str]:
        self.check()
        return [str(self.binary.resolve()), *map(str, arguments)]
