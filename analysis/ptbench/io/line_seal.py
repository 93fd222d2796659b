"""Lines of JSON with a chained checksum, as harness/bench/line_seal.h writes them.

A line's last member, "check", is the FNV-1a hash of the line's text without it, seeded with the previous line's
checksum, so that a changed, lost, moved or duplicated line is detected.
"""

import re

_ENDING = re.compile(rb',"check":"([0-9a-f]{16})"\}\Z')
NO_CHECKSUM = "no checksum at its end: it was changed, or an older ptbench wrote it"
OTHER_TEXT = "another text than its checksum's: it was changed, or a line before it was lost, moved or doubled"


def fnv1a(data: bytes, start: int = 0xCBF29CE484222325) -> int:
    """The 64-bit FNV-1a hash of bytes."""
    value = start
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


class LineSeal:
    """The checksum of the last line, which seeds that of the next line."""

    def __init__(self) -> None:
        self._before = fnv1a(b"")

    def seal(self, text: bytes) -> bytes:
        """Appends the checksum to a line, the text of a JSON object with at least one member."""
        self._before = fnv1a(text, self._before)
        return text[:-1] + b',"check":"%016x"}' % self._before

    def fault(self, line: bytes) -> str:
        """What is wrong with `line` as the next one of a journal, in words, or "".

        Lines after a changed one are checked against its own checksum, so that one change is reported once.
        """
        ending = _ENDING.search(line)
        if ending is None:
            return NO_CHECKSUM
        found = fnv1a(line[: ending.start()] + b"}", self._before)
        self._before = int(ending[1], 16)
        return "" if found == self._before else OTHER_TEXT
