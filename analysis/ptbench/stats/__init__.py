"""Medians, ratios, their confidence intervals, and verdicts."""
