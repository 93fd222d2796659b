#!/usr/bin/env python3
"""Runs many calls on the GPUs of one host at once, one per GPU, each with its own CPU cores.

    tools/fleet/side_by_side.py calls.txt --out DIR [--until 3600] [--gpus N]

calls.txt has one line per call, `NAME | SECONDS | COMMAND`, in order of weight; empty lines and those that begin with #
count for nothing:

    !devices | 60  | build/ptbench run --suite devices --untuned --out $OUT/devices.json
    refill   | 100 | build/ptbench run --suite refill --untuned --out $OUT/refill.json

SECONDS is about what the call takes. One with ! before its name has all GPUs and cores to itself, before the others
begin. A call that no longer fits into --until is left out; one that takes longer than twice its seconds and half a
minute is interrupted as by ctrl-C, which `ptbench run` resumes. What a call says goes to DIR/NAME.log; $OUT is DIR.
The exit code is 1 where a call failed, was interrupted or was left out, and 2 for bad input.

Renders on two GPUs of a host do not slow each other (docs/findings/devices.md), but what waits for the host does feel
its other work: verdicts on such cells may be UNSURE. Needs the standard library and Linux's taskset, timeout and
nvidia-smi.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

GRACE = 30.0  # seconds that a call may take beyond twice its expected time


@dataclass(frozen=True)
class Call:
    """A call of the list, with its name, expected seconds and command."""

    name: str
    seconds: float
    command: str
    is_alone: bool


def calls_in(text: str, file: str) -> list[Call]:
    """The calls in a list, in order; exits with 2 for a malformed line."""
    calls: list[Call] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        found = re.fullmatch(r"\s*(!?)([A-Za-z0-9_.-]+)\s*\|\s*(\d+(?:\.\d+)?)\s*\|\s*(\S.*)", line)
        if found is None:
            _bad(f"{file}:{number}: found {line!r}, allowed: NAME | SECONDS | COMMAND")
        alone, name, seconds, command = found.groups()
        if any(call.name == name for call in calls):
            _bad(f"{file}:{number}: found {name} twice, allowed: names that differ, for their logs")
        calls.append(Call(name, float(seconds), command.strip(), bool(alone)))
    if not calls:
        _bad(f"{file}: found no call, allowed: NAME | SECONDS | COMMAND")
    return calls


class Host:
    """A host with its GPUs and cores, and the time left for calls."""

    def __init__(self, gpus: int, out: Path, until: float) -> None:
        self._gpus, self._out, self._until = gpus, out, until
        self._begun = time.monotonic()
        self._lock = threading.Lock()
        self.faults = 0

    def run_all(self, calls: list[Call]) -> None:
        """Runs the calls that need the whole host first, then each of the others on the first free GPU."""
        for call in (call for call in calls if call.is_alone):
            if call.seconds <= self._left():
                self._run(call, None)
            else:
                self._leave_out(call)
        waiting = [call for call in calls if not call.is_alone]
        workers = [threading.Thread(target=self._work, args=(gpu, waiting)) for gpu in range(self._gpus)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for call in waiting:
            self._leave_out(call)

    def _work(self, gpu: int, waiting: list[Call]) -> None:
        while True:
            with self._lock:
                call = next((call for call in waiting if call.seconds <= self._left()), None)
                if call is None:
                    return
                waiting.remove(call)
            self._run(call, gpu)

    def _run(self, call: Call, gpu: int | None) -> None:
        limit = min(2 * call.seconds + GRACE, max(1.0, self._left()))
        command = ["timeout", "--signal=INT", "--kill-after=10", f"{limit:.1f}", "bash", "-c", call.command]
        environment = {**os.environ, "OUT": str(self._out)}
        if gpu is not None:
            cores = sorted(os.sched_getaffinity(0))
            share = max(1, len(cores) // self._gpus)
            own = [cores[index % len(cores)] for index in range(gpu * share, (gpu + 1) * share)]
            command = ["taskset", "--cpu-list", ",".join(map(str, own)), *command]
            environment["CUDA_VISIBLE_DEVICES"] = str(gpu)
        begun = time.monotonic()
        with (self._out / f"{call.name}.log").open("w", encoding="utf-8") as log:
            code = subprocess.run(
                command, env=environment, stdout=log, stderr=subprocess.STDOUT, check=False
            ).returncode
        word = "ended" if code == 0 else "was interrupted" if code in (124, 137) else f"failed with exit code {code}"
        where = "all GPUs" if gpu is None else f"GPU {gpu}"
        self._say(f"{call.name}: {word} after {time.monotonic() - begun:.0f} s, {where}", is_fault=code != 0)

    def _leave_out(self, call: Call) -> None:
        self._say(f"{call.name}: left out: {call.seconds:g} s, {max(0.0, self._left()):.0f} s left", is_fault=True)

    def _left(self) -> float:
        return self._until - (time.monotonic() - self._begun)

    def _say(self, line: str, *, is_fault: bool) -> None:
        with self._lock:
            self.faults += is_fault
            print(line, flush=True)


def _gpus() -> int:
    try:
        listed = subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        _bad("nvidia-smi: found none that lists GPUs, allowed: a host with GPUs, or --gpus N")
    return len(listed.splitlines())


def _bad(line: str) -> None:
    print(line, file=sys.stderr)
    raise SystemExit(2)


def main() -> int:
    """Runs the calls that a list file names and returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("calls", type=Path, help="a line a call: NAME | SECONDS | COMMAND")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="for logs and, as $OUT, results")
    parser.add_argument("--until", type=float, default=3600, metavar="S", help="seconds for all (default: an hour)")
    parser.add_argument("--gpus", type=int, help="workers (default: the GPUs of the host)")
    options = parser.parse_args()
    if not options.calls.is_file():
        _bad(f"{options.calls}: found no file, allowed: a list of calls")
    if options.gpus is not None and options.gpus < 1:
        _bad(f"--gpus: found {options.gpus}, allowed: an integer of at least 1")
    calls = calls_in(options.calls.read_text(encoding="utf-8"), str(options.calls))
    options.out.mkdir(parents=True, exist_ok=True)
    host = Host(options.gpus or _gpus(), options.out.resolve(), options.until)
    host.run_all(calls)
    return 1 if host.faults else 0


if __name__ == "__main__":
    sys.exit(main())
