"""The kinds of sources that a page may use, one module per kind of file; modules are discovered (findings/source.py).
"""
