"""Medians, ratios, their intervals, and what they allow to say."""
