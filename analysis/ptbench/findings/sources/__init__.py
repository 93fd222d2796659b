"""The kinds of sources that a page may use, one module per kind of file, discovered by findings/source.py."""
