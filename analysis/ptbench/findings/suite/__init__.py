"""A result of `ptbench run` as a source for a page, in parts by what a page asks for."""
