"""Limits of the command line of `crosscheck` that its code asks for, too."""

SIDE = 8  # pixels of a block
ALL = "all"  # instead of scenes' names: every shipped scene
MOST_SPP = 100_000_000  # samples a pixel of an image
