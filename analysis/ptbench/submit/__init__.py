"""Runs a suite as a Slurm job array of shards: submission, continuation, and collection by machine."""
