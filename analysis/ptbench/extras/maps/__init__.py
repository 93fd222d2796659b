"""Crossover maps: the ratio of two choices over two axes, and the line where the ratio is 1."""
