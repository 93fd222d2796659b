"""Limits of the command line of `crosscheck` that its code needs as well."""

SIDE = 8  # pixels along a side of the blocks whose means are compared
ALL = "all"  # word that stands for every shipped scene in place of scenes' names
MOST_SPP = 100_000_000  # largest number of samples per pixel of one image in a cross-check
