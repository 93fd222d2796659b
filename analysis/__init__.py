"""For `python3 -m analysis` in the repository's root; the package is `ptbench`, in this folder."""
