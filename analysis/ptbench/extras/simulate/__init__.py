"""Simulates one render on a thousand GPUs from parts that were measured on a few."""
