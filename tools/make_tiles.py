"""Writes scenes/textures/tiles.png: tiles with dark joints, the lower left one red and the upper right one blue.

The bytes are the same everywhere: the data is stored, not deflated.
"""

import struct
import sys
import zlib
from pathlib import Path

SIDE, TILE = 32, 4
Colour = tuple[int, int, int]


def _colour(column: int, row: int) -> Colour:
    """`row`: from the bottom, as texture coordinates go."""
    if column % TILE == 0 or row % TILE == 0:
        return (90, 80, 70)
    tile = (column // TILE, row // TILE)
    if tile == (0, 0):
        return (200, 40, 30)
    if tile == (SIDE // TILE - 1, SIDE // TILE - 1):
        return (40, 60, 200)
    shade = (37 * tile[0] + 61 * tile[1]) % 8 * 6
    return (230 - shade, 210 - shade, 180 - shade)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _stored(data: bytes) -> bytes:
    """A zlib stream of one block that is not compressed (RFC 1950, RFC 1951)."""
    return (
        b"\x78\x01\x01"
        + struct.pack("<HH", len(data), len(data) ^ 0xFFFF)
        + data
        + struct.pack(">I", zlib.adler32(data))
    )


def tiles() -> bytes:
    rows = b"".join(
        b"\0" + b"".join(bytes(_colour(column, row)) for column in range(SIDE)) for row in reversed(range(SIDE))
    )
    header = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"sRGB", b"\0"), (b"IDAT", _stored(rows)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


if __name__ == "__main__":
    Path(sys.argv[1] if len(sys.argv) > 1 else "scenes/textures/tiles.png").write_bytes(tiles())
