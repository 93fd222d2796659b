"""Explains where the time of two variants differs, and which other differences accompany that."""
