"""Rows of result files as one table."""
