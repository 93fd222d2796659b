"""`python3 -m analysis`, as the command line was called before: it says so, and does what `python3 -m ptbench` does."""

import sys
from pathlib import Path

_HERE = Path(__file__).resolve().parent
if (_HERE / "ptbench").is_dir():
    # A checkout: its own package, whatever is installed.
    sys.path.insert(0, str(_HERE))

from ptbench.cli.main import main  # noqa: E402 (it is found where the lines above look for it)

if __name__ == "__main__":
    print("python3 -m analysis: the package is called ptbench now, python3 -m ptbench; this name goes with release 2",
          file=sys.stderr)  # fmt: skip
    sys.exit(main(program="python3 -m analysis"))
