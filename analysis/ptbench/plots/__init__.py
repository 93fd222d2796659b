"""Every study's figure and summary.md, from a result file alone."""
