"""Comparison of result files of two commits, two machines or many GPUs: each file against the first."""
