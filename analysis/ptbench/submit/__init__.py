"""A suite as a Slurm job array of shards: submitted, gone on with, collected by machine."""
