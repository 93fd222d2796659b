"""The results of numerically stiff cases: layout and words for a stability file."""
