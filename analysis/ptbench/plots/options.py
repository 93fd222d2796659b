"""The command line options of `plots`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("path", type=Path, metavar="RESULT.json", help="or a folder of files of `ptbench rays`")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: figures/SUITE beside the result file")


COMMANDS = (Command("plots", "every study's figure and summary.md, from a result file alone", _add_arguments),)
