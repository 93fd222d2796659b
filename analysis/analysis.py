"""The name under which the command line was run before: `python3 -m analysis` does what `python3 -m ptbench` does.

The old name works for one more release, and prints a notice that it goes.
"""

import sys
from pathlib import Path

if __name__ == "__main__":
    # The package ptbench lies in this file's own folder, in a checkout as well as in an installation by pip.
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    from ptbench.cli.main import main

    notice = "the package is called ptbench now, python3 -m ptbench; this name goes after the next release"
    print(f"python3 -m analysis: {notice}", file=sys.stderr)
    sys.exit(main(program="python3 -m analysis"))
