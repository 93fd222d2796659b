"""`python3 -m ptbench`: runs the command line of `ptbench.cli`."""

import sys

from ptbench.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
