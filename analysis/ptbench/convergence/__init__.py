"""Convergence of the error with time: fits, bias and variance, efficiency."""
