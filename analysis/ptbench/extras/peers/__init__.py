"""Compares how fast ptbench and other renderers make the same pictures, in one run on one machine."""
