"""Writes the images of scenes/textures: tiles.png and the normal map studs.png.

tiles.png has tiles with dark joints, the lower left one red and the upper right one blue; studs.png has the normals of
4 x 4 domes on a plane. The bytes are the same everywhere: the data is stored, not deflated.
"""

import math
import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

SIDE, TILE = 32, 4
STUD, STUD_RADIUS, SPHERE_RADIUS = 8, 3.4, 4.2
Colour = tuple[int, int, int]


def _colour(column: int, row: int) -> Colour:
    """The colour of a texel; `row` counts from the bottom, as texture coordinates do."""
    if column % TILE == 0 or row % TILE == 0:
        return (90, 80, 70)
    tile = (column // TILE, row // TILE)
    if tile == (0, 0):
        return (200, 40, 30)
    if tile == (SIDE // TILE - 1, SIDE // TILE - 1):
        return (40, 60, 200)
    shade = (37 * tile[0] + 61 * tile[1]) % 8 * 6
    return (230 - shade, 210 - shade, 180 - shade)


def _normal(column: int, row: int) -> Colour:
    """The normal of a dome cut from a sphere, x right and y up; 128 encodes 0, as in harness/scene/texture_image.h."""
    x, y = (place % STUD + 0.5 - STUD / 2 for place in (column, row))
    if math.hypot(x, y) > STUD_RADIUS:
        return (128, 128, 255)
    z = math.sqrt(SPHERE_RADIUS**2 - x**2 - y**2)
    return tuple(128 + round(127 * part / SPHERE_RADIUS) for part in (x, y, z))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _stored(data: bytes) -> bytes:
    """A zlib stream with one uncompressed block (RFC 1950, RFC 1951)."""
    return (
        b"\x78\x01\x01"
        + struct.pack("<HH", len(data), len(data) ^ 0xFFFF)
        + data
        + struct.pack(">I", zlib.adler32(data))
    )


def _png(texel: Callable[[int, int], Colour], kind: list[tuple[bytes, bytes]]) -> bytes:
    rows = b"".join(
        b"\0" + b"".join(bytes(texel(column, row)) for column in range(SIDE)) for row in reversed(range(SIDE))
    )
    header = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), *kind, (b"IDAT", _stored(rows)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in chunks)


def tiles() -> bytes:
    return _png(_colour, [(b"sRGB", b"\0")])


def studs() -> bytes:
    return _png(_normal, [])


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "scenes/textures")
    (folder / "tiles.png").write_bytes(tiles())
    (folder / "studs.png").write_bytes(studs())
