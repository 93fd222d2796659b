"""Error against time: fits, bias and variance, efficiency."""
