"""Figures, one module each: what a figure shows of a result, how it is drawn, and its name for `registry`."""
