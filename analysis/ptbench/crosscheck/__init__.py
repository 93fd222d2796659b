"""The cross-check: whether ptbench and another renderer make the same pictures of the same scenes."""
