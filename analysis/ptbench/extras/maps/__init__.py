"""Crossover maps: two axes, two choices, and the line where their ratio is 1."""
