"""Text that is safe on a terminal: what file names and values bring along is shown, and never obeyed."""

from __future__ import annotations

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


# As a shell reports a program that the signal ended.
READER_LEFT = 128 + signal.SIGPIPE


class _Visible:
    """A stream of text in front of another one, which gets only what it can show.

    Whoever reads it may leave early, as `head` does: that ends the program with READER_LEFT and no complaint.
    """

    def __init__(self, stream):
        self._stream = stream

    def write(self, text: str) -> int:
        encoding = getattr(self._stream, "encoding", None) or "utf-8"
        safe = visible(text, keep="\n\t").encode(encoding, "backslashreplace").decode(encoding)
        with self._reader_may_leave():
            self._stream.write(safe)
        return len(text)

    def flush(self) -> None:
        with self._reader_may_leave():
            self._stream.flush()

    @contextmanager
    def _reader_may_leave(self) -> Iterator[None]:
        try:
            yield
        except BrokenPipeError:
            # What is still in the stream must go somewhere when the interpreter ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
            raise SystemExit(READER_LEFT) from None

    def __getattr__(self, name: str):
        return getattr(self._stream, name)


@contextmanager
def visible_output() -> Iterator[None]:
    """Within it all that is printed is escaped but for the ends of lines."""
    with redirect_stdout(_Visible(sys.stdout)), redirect_stderr(_Visible(sys.stderr)):
        yield
        sys.stdout.flush()
