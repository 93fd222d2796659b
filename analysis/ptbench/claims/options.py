"""The command line options of `claims`."""

import argparse

from ptbench.command import Command, add_ledger


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="NAME", help="default: all claims")
    parser.add_argument("--run", action="store_true", help="measure what has no result on this machine")
    add_ledger(parser, "docs/claims and its verdicts", "docs/claims")


_HELP = "what published claims are found to be; exit code 1 where a committed verdict does not follow"
COMMANDS = (Command("claims", _HELP, _add_arguments),)
