"""The command line options of `report`."""

import argparse
from pathlib import Path

from ptbench.command import Command, positive


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("named", type=Path, nargs="+", metavar="RESULT", help="a result file, or a folder of some")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument(
        "--binary", type=Path, metavar="PTBENCH", help="renders the scenes' pictures (default: no rendering)"
    )
    parser.add_argument("--spp", type=positive, default=16, metavar="N", help="of those pictures (default: 16)")
    parser.add_argument(
        "--side", type=positive, default=160, metavar="N", help="pixels of their longer side (default: 160)"
    )


_HELP = "one page of one or more result files: report.html and report.md"
COMMANDS = (Command("report", _HELP, _add_arguments),)
