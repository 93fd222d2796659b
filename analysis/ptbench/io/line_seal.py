"""Lines of JSON that carry a checksum, as harness/bench/line_seal.h writes them.

The last member of a line, "check", is the FNV-1a of the line's text without it, begun with the checksum of the line
before: a line that was changed, lost, moved or doubled is found.
"""

import re

_ENDING = re.compile(rb',"check":"([0-9a-f]{16})"\}\Z')
NO_CHECKSUM = "no checksum at its end: it was changed, or an older ptbench wrote it"
OTHER_TEXT = "another text than its checksum's: it was changed, or a line before it was lost, moved or doubled"


def fnv1a(data: bytes, start: int = 0xCBF29CE484222325) -> int:
    """FNV-1a, 64 bit, of bytes."""
    value = start
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


class LineSeal:
    """The checksum of the last line, with which the next one's begins."""

    def __init__(self) -> None:
        self._before = fnv1a(b"")

    def seal(self, text: bytes) -> bytes:
        """The next line of a journal, made of the text of an object that has a member."""
        self._before = fnv1a(text, self._before)
        return text[:-1] + b',"check":"%016x"}' % self._before

    def fault(self, line: bytes) -> str:
        """The fault of `line` as the next one of a journal, in words, or "".

        Lines after a changed one are good if they follow on what it says of itself, so that one change is told once.
        """
        ending = _ENDING.search(line)
        if ending is None:
            return NO_CHECKSUM
        found = fnv1a(line[: ending.start()] + b"}", self._before)
        self._before = int(ending[1], 16)
        return "" if found == self._before else OTHER_TEXT
