"""Builds targets of a CMake build folder (Ninja) and shows the progress.

On a terminal the progress is one line that is rewritten; elsewhere a plain line every half minute. Warnings and errors
follow on stderr, and everything is in the folder's build.log.

The script runs before the virtual environment exists, so it uses only the standard library.
"""

from __future__ import annotations

import argparse
import os
import re
import selectors
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

SECONDS_BETWEEN_LINES = 30  # seconds between progress lines in a log
STATUS = re.compile(r"\[(\d+)/(\d+)\] ")
CHATTER = re.compile(r"\[\d+/\d+\] |ninja: no work|ninja: Entering|-- ")
# g++ 12 sometimes fails to save a precompiled header, and succeeds when called again.
PASSING_FAILURE = "internal compiler error: in gt_pch_save"


def clock_text(seconds: float) -> str:
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"{hours}:{minutes:02}:{whole % 60:02}" if hours else f"{minutes}:{whole % 60:02}"


def kind_of(output: str) -> tuple[str, str]:
    """The kind of a build step, by which durations are estimated: its output's folder and file type."""
    path = Path(output)
    return str(path.parent), path.suffix


class TimeLeft:
    """Estimates the time left of a build from its steps' durations, in this build or in the folder's earlier ones.

    `outputs` are those of all steps that may have to run. Ninja tells how many do, and its log which have run.
    """

    def __init__(self, folder: Path, outputs: list[str]):
        self._log = folder / ".ninja_log"
        self._outputs = outputs
        self._before = dict(self._entries())

    def _entries(self) -> Iterator[tuple[str, tuple[int, int]]]:
        try:
            lines = self._log.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:
            return
        for line in lines:
            fields = line.split("\t")
            if len(fields) == 5:
                yield fields[3], (int(fields[0]), int(fields[1]))

    def seconds(self, elapsed: float, finished: int, total: int) -> float | None:
        """Seconds until the build ends; None while nothing is known."""
        entries = dict(self._entries())
        took = {output: (end - start) / 1000 for output, (start, end) in entries.items()}
        done = {output for output, entry in entries.items() if self._before.get(output) != entry}
        if not done or elapsed <= 0:
            return None
        by_kind: dict[tuple[str, str], list[float]] = {}
        for output, seconds in took.items():
            by_kind.setdefault(kind_of(output), []).append(seconds)
        work_done = sum(took[output] for output in done)
        mean = work_done / len(done)
        left = [output for output in self._outputs if output not in done]
        expected = [took.get(output, average(by_kind.get(kind_of(output), [mean]))) for output in left]
        work_left = (total - finished) * average(expected or [mean])
        return elapsed * work_left / work_done if work_done > 0 else None


def average(values: list[float]) -> float:
    return sum(values) / len(values)


def outputs_of(folder: Path, targets: list[str]) -> list[str]:
    """Outputs of the steps that targets depend on; empty for Ninja before 1.11, which lacks the tool `inputs`."""
    command = ["cmake", "--build", str(folder), "--target", *targets, "--", "-t", "inputs"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    made = (".o", ".gch", ".pch")
    return [line for line in done.stdout.splitlines() if line.endswith(made)] if done.returncode == 0 else []


class Progress:
    def __init__(self, time_left: TimeLeft):
        self._time_left = time_left
        self._on_terminal = sys.stdout.isatty()
        self._started = self._said = time.monotonic()
        self._finished = self._total = 0

    def note(self, line: str) -> None:
        if match := STATUS.match(line):
            self._finished, self._total = int(match[1]), int(match[2])

    def tick(self) -> None:
        now = time.monotonic()
        if self._total == 0 or now - self._said < (0.2 if self._on_terminal else SECONDS_BETWEEN_LINES):
            return
        self._said = now
        elapsed = now - self._started
        left = self._time_left.seconds(elapsed, self._finished, self._total)
        text = f"ptbench: [{self._finished}/{self._total}] {clock_text(elapsed)}"
        text += "" if left is None else f", about {clock_text(left)} left"
        print(f"\r{text}\033[K" if self._on_terminal else text, end="" if self._on_terminal else "\n", flush=True)

    def clear(self) -> None:
        if self._on_terminal:
            print("\r\033[K", end="", flush=True)


def build(folder: Path, jobs: int, targets: list[str], log: Path) -> tuple[int, str]:
    """Builds targets; returns the exit code, and the build's output without its progress lines."""
    progress = Progress(TimeLeft(folder, outputs_of(folder, targets)))
    command = ["cmake", "--build", str(folder), "-j", str(jobs), "--target", *targets]
    environment = {**os.environ, "NINJA_STATUS": "[%f/%t] "}
    said = []
    with (
        subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment
        ) as process,
        log.open("wb") as file,
        selectors.DefaultSelector() as selector,
    ):
        assert process.stdout is not None
        selector.register(process.stdout, selectors.EVENT_READ)
        rest = b""
        while True:
            if selector.select(timeout=1):
                block = os.read(process.stdout.fileno(), 1 << 16)
                if not block:
                    break
                file.write(block)
                *lines, rest = (rest + block).split(b"\n")
                for line in (line.decode(errors="replace") for line in lines):
                    progress.note(line)
                    if not CHATTER.match(line):
                        said.append(line)
            progress.tick()
    progress.clear()
    if rest:
        said.append(rest.decode(errors="replace"))
    return process.returncode, "".join(f"{line}\n" for line in said)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--jobs", type=int, required=True)
    parser.add_argument("--called-from", type=Path, default=Path.cwd(), help="the folder that messages name files from")
    parser.add_argument("targets", nargs="+")
    arguments = parser.parse_args()
    folder, jobs, targets = arguments.folder, arguments.jobs, arguments.targets
    log = folder / "build.log"
    print(f"ptbench: building with {jobs} jobs", flush=True)
    status, said = build(folder, jobs, targets, log)
    if status != 0 and PASSING_FAILURE in said:
        first = log.with_name(log.name + ".first")
        log.replace(first)
        shown = os.path.relpath(first, arguments.called_from)
        print(f"ptbench: g++ broke down saving a precompiled header (log: {shown}): building once more", flush=True)
        status, said = build(folder, jobs, targets, log)
    sys.stderr.write(said)
    return 0 if status == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
