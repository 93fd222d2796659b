"""`python3 -m analysis` in the repository's root, without an installation: see analysis.py."""

import runpy
from pathlib import Path

if __name__ == "__main__":
    runpy.run_path(str(Path(__file__).with_name("analysis.py")), run_name="__main__")
