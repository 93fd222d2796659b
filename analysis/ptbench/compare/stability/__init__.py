"""Comparison of files of `ptbench stability` with the first of them."""
