"""Export of result files as one flat table."""
