"""Where the time of two variants differs, and what goes with that."""
