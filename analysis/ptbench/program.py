"""Calls of the program ptbench and of others: what they write, and small suites written as files."""

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
    """Runs a program; returns what it wrote, and its exit code. Raises InputError where it does not run."""
    try:
        return subprocess.run(command, input=text, capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        raise InputError(f"{command[0]}: {error.strerror or error}") from error


def said_by(done: subprocess.CompletedProcess) -> list[str]:
    """The lines that a program wrote to standard error, without its name and without empty ones."""
    lines = [line.strip().removeprefix("ptbench: ") for line in done.stderr.splitlines() if line.strip()]
    return lines or [f"exit code {done.returncode}"]


@dataclass(frozen=True)
class Program:
    """The program at a path."""

    binary: Path

    def check(self) -> None:
        """Raises InputError where the path is no program."""
        if not self.binary.is_file() or not os.access(self.binary, os.X_OK):
            found = "a file that cannot be run" if self.binary.is_file() else "no such file"
            raise bad_value(self.binary, "--binary", found, "the ptbench program")

    def called(self, *arguments: object) -> subprocess.CompletedProcess:
        """Calls the program; returns what it wrote, and its exit code."""
        return run_program(self._command(arguments))

    def output(self, *arguments: object) -> str:
        """What a call writes; raises InputError with the program's own line where it fails."""
        done = self.called(*arguments)
        if done.returncode != 0:
            raise InputError(said_by(done)[-1])
        return done.stdout

    def watched(self, *arguments: object, output: IO | int = subprocess.DEVNULL) -> None:
        """A call whose progress is seen, its standard output in `output`; raises InputError where it fails."""
        code = subprocess.run(self._command(arguments), check=False, stdout=output).returncode
        if code != 0:
            raise InputError(f"{self.binary} {' '.join(map(str, arguments))}: exit code {code}")

    def machine(self) -> str:
        """What the folder of this machine's results is called."""
        return self.output("machine").strip()

    def scene(self, scene: str) -> dict:
        """The facts of one scene, from `ptbench list --scene`."""
        (found,) = json.loads(self.output("list", "--scene", scene, "--json"))["scenes"]
        return found

    def measure(self, suite: Mapping, folder: Path, backend: str, *, shown: bool = False) -> Result:
        """Runs a suite that is written into the folder; raises InputError where the program refuses or fails."""
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
