"""Text that is safe on a terminal: what file names and values bring along is shown, and never obeyed."""

import os
import re
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout

# Control characters, marks that turn the direction of text or begin a line, and halves of characters: Python reads a
# byte 0xNN of a name that is no UTF-8 as the half U+DCNN.
_UNSAFE = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def visible(text: str, keep: str = "") -> str:
    """`text` in one line with such characters escaped: \\x1b, \\xff, \\u202e. Those of `keep` stay."""
    return _UNSAFE.sub(lambda found: found[0] if found[0] in keep else _escaped(ord(found[0])), text)


def _escaped(code: int) -> str:
    if 0xDC80 <= code <= 0xDCFF:
        code -= 0xDC00
    return f"\\x{code:02x}" if code <= 0xFF else f"\\u{code:04x}"


def say(text: object) -> None:
    """Prints one line, whatever a file's name has in it."""
    print(visible(str(text)))


# The exit code that a shell reports for a program that the signal ended.
READER_LEFT = 128 + signal.SIGPIPE


class OutputError(Exception):
    """Standard output is closed, or its disk is full: exit code 3."""


class _Visible:
    """A stream of text in front of another one, which gets only what it can show.

    Whoever reads it may leave early, as `head` does: that ends the program with READER_LEFT and no complaint.
    Otherwise what cannot be written raises OutputError, or is lost where `may_be_lost`. `stream` is None where it is
    closed.
    """

    def __init__(self, stream, *, may_be_lost: bool = False):
        self._stream = stream
        self._may_be_lost = may_be_lost

    def write(self, text: str) -> int:
        encoding = getattr(self._stream, "encoding", None) or "utf-8"
        safe = visible(text, keep="\n\t").encode(encoding, "backslashreplace").decode(encoding)
        if self._stream is not None:
            with self._may_fail():
                self._stream.write(safe)
        elif not self._may_be_lost:
            raise OutputError("standard output: cannot be written: it is closed")
        return len(text)

    def flush(self) -> None:
        if self._stream is not None:
            with self._may_fail():
                self._stream.flush()

    @contextmanager
    def _may_fail(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            # Output goes nowhere from here on: what is still in the stream must go somewhere when the interpreter ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
            if self._may_be_lost:
                return
            if isinstance(error, BrokenPipeError):
                raise SystemExit(READER_LEFT) from None
            raise OutputError(f"standard output: cannot be written: {error.strerror or error}") from error

    def __getattr__(self, name: str):
        return getattr(self._stream, name)


@contextmanager
def visible_output() -> Iterator[None]:
    """A context in which all that is printed is escaped but for the ends of lines."""
    with redirect_stdout(_Visible(sys.stdout)), redirect_stderr(_Visible(sys.stderr, may_be_lost=True)):
        yield
        sys.stdout.flush()
