"""Makes text safe for a terminal: control characters from file names and values are escaped."""

import os
import re
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout

# Control characters, marks that change the direction of text or begin a line, and surrogates: Python decodes a byte
# 0xNN of a file name that is not UTF-8 as the surrogate U+DCNN.
_UNSAFE = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def visible(text: str, keep: str = "") -> str:
    """`text` in one line with unsafe characters escaped: \\x1b, \\xff, \\u202e. Those of `keep` stay."""
    return _UNSAFE.sub(lambda found: found[0] if found[0] in keep else _escaped(ord(found[0])), text)


def _escaped(code: int) -> str:
    if 0xDC80 <= code <= 0xDCFF:
        code -= 0xDC00
    return f"\\x{code:02x}" if code <= 0xFF else f"\\u{code:04x}"


def say(text: object) -> None:
    """Prints one line with unsafe characters escaped."""
    print(visible(str(text)))


# Exit code that a shell reports for a program ended by SIGPIPE.
READER_LEFT = 128 + signal.SIGPIPE


class OutputError(Exception):
    """Raised if standard output is closed, or its disk is full: exit code 3."""


class _Visible:
    """A text stream that escapes unsafe characters before another stream.

    A reader may close the stream early, as `head` does: that ends the program with READER_LEFT and no message. Other
    write errors raise OutputError, or are ignored if `may_be_lost`. `stream` is None where it is closed.
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
            # After a failed write, further output goes to /dev/null, so that flushing the stream at exit cannot fail.
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
    """A context in which all printed text is escaped except for line ends."""
    with redirect_stdout(_Visible(sys.stdout)), redirect_stderr(_Visible(sys.stderr, may_be_lost=True)):
        yield
        sys.stdout.flush()
