"""A renderer as a persistent process that answers requests, a line of JSON each; and CPU times of processes."""

import contextlib
import json
import os
import subprocess
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path

from ptbench.errors import InputError
from ptbench.io.files import one_line


class PeerFailed(Exception):
    """Raised by a peer that cannot do what it is asked to; the other peers continue."""


class Talker:
    """A persistent renderer process that answers requests in JSON."""

    def __init__(self, command: Sequence[str], seconds: float) -> None:
        self._seconds = seconds
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
        try:
            self._process = subprocess.Popen(
                list(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said, text=True
            )
        except OSError as error:
            self._said.close()
            raise InputError(f"{command[0]}: {error.strerror or error}") from error

    @property
    def pid(self) -> int:
        """The process id of the renderer."""
        return self._process.pid

    def ask(self, **request: object) -> dict:
        """Sends a request and returns its answer; raises PeerFailed."""
        # The timer kills a hanging renderer, which also ends the wait for its answer.
        timer = threading.Timer(self._seconds, self._process.kill)
        timer.start()
        try:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.write(json.dumps(request) + "\n")
                self._process.stdin.flush()
            line = self._process.stdout.readline()
        finally:
            timer.cancel()
        if not line:
            raise PeerFailed(self._last_words())
        try:
            said = json.loads(line)
        except ValueError:
            said = None
        if not isinstance(said, dict):
            raise PeerFailed(f"answered {one_line(line)[:100]!r}, which is no JSON object")
        if "error" in said:
            raise PeerFailed(one_line(str(said["error"])))
        return said

    def close(self) -> int:
        """Ends the renderer's process, and returns its exit code."""
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        try:
            code = self._process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self._process.kill()
            code = self._process.wait()
        self._process.stdout.close()
        self._said.close()
        return code

    def _last_words(self) -> str:
        code = self._process.wait()
        self._said.seek(0)
        lines = self._said.read().decode("utf-8", "replace").split("\n")
        first = next((one_line(line) for line in lines if line.strip()), "nothing on standard error")
        return f"ended with exit code {code}: {first[:300]}"


def busy_ms() -> float | None:
    """CPU time of all processes since the machine started, ms; None where it is unknown."""
    try:
        head, *fields = Path("/proc/stat").read_text(encoding="ascii").split("\n", 1)[0].split()
    except OSError:
        return None
    user, nice, system, _, _, irq, soft, *_ = map(int, fields)
    return _ticks_to_ms(user + nice + system + irq + soft) if head == "cpu" else None


def process_ms(pid: int) -> float | None:
    """CPU time of one process, ms; None where it is unknown."""
    try:
        # In /proc/PID/stat the process name stands in brackets and may contain anything.
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
    except OSError:
        return None
    return _ticks_to_ms(int(fields[11]) + int(fields[12]))


def _ticks_to_ms(ticks: int) -> float:
    return 1e3 * ticks / os.sysconf("SC_CLK_TCK")
