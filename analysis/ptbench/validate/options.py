"""The command line of `validate`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "files", type=Path, nargs="+", metavar="FILE", help="of run, merge, stability, inspect, autotune, or a journal"
    )


def _load():
    from ptbench.io.validate import validate_command

    return lambda options: validate_command(options.files, options.program)


_HELP = "hold files that ptbench wrote against their JSON Schemas, and samples against each other"
COMMANDS = (Command("validate", _HELP, _add_arguments, _load),)
