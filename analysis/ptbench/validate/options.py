"""The command line options of `validate`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths", type=Path, nargs="+", metavar="FILE", help="of run, merge, stability, inspect, autotune, or a journal"
    )


_HELP = "hold files that ptbench wrote against their JSON Schemas, and samples against each other"
COMMANDS = (Command("validate", _HELP, _add_arguments, "validate_command"),)
