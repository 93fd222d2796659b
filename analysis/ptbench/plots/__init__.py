"""The command `plots`: every study's figure and summary.md, from a result file alone."""
