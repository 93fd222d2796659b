"""Writes scenes/environments/sky.hdr: a clear sky over grey ground, with a hazy sun of one texel.

With a sun a hundred times as bright, so few of `ptbench verify`'s default paths would hit it that the mean of
direct_light=off would appear known, without the sun.
"""

import math
import sys
from pathlib import Path

WIDTH, HEIGHT = 64, 32
SUN = (8, 13)  # row and column of the sun's texel: 42 degrees up, between -z and +x
Colour = tuple[float, float, float]


def _between(low: Colour, high: Colour, share: float) -> Colour:
    return tuple(a + (b - a) * share for a, b in zip(low, high, strict=True))


def _radiance(row: int, column: int) -> Colour:
    if (row, column) == SUN:
        return (60.0, 54.0, 45.0)
    height = math.cos(math.pi * (row + 0.5) / HEIGHT)
    if height < 0:
        return (0.25, 0.23, 0.2)
    return _between((0.9, 0.95, 1.0), (0.2, 0.4, 0.9), math.sqrt(height))


def _rgbe(colour: Colour) -> tuple[int, int, int, int]:
    mantissa, exponent = math.frexp(max(colour))
    scale = mantissa * 256 / max(colour)
    return (*(int(channel * scale) for channel in colour), exponent + 128)


def _runs(values: list[int]) -> bytes:
    """A row of texels encoded as runs of equal values, and the rest one by one."""
    coded = bytearray()
    start = 0
    while start < len(values):
        end = start + 1
        while end < len(values) and values[end] == values[start] and end - start < 127:
            end += 1
        coded += bytes([128 + end - start, values[start]])
        start = end
    return bytes(coded)


def sky() -> bytes:
    coded = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode()
    for row in range(HEIGHT):
        texels = [_rgbe(_radiance(row, column)) for column in range(WIDTH)]
        coded += bytes([2, 2, WIDTH >> 8, WIDTH & 255])
        for channel in range(4):
            coded += _runs([texel[channel] for texel in texels])
    return coded


if __name__ == "__main__":
    Path(sys.argv[1] if len(sys.argv) > 1 else "scenes/environments/sky.hdr").write_bytes(sky())
