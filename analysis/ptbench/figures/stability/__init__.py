"""The figures of a stability file."""
