"""A result of `ptbench run` as a page asks it, by what is asked."""
