"""The command line options of `findings`."""

import argparse

from ptbench.command import Command, add_root


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="PAGE", help="default: all pages and the overview")
    parser.add_argument("--check", action="store_true", help="write nothing; exit code 1 where a page does not match")
    add_root(parser)


_HELP = "write README.md and docs/findings from docs/templates and results/ of a checkout"
COMMANDS = (Command("findings", _HELP, _add_arguments),)
