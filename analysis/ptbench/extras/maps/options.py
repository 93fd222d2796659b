"""The command line options of `map`."""

import argparse

from ptbench.command import Command, add_ledger, positive


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="NAME", help="default: all maps")
    parser.add_argument("--run", action="store_true", help="measure on this machine, or go on with it")
    parser.add_argument(
        "--budget", dest="budget_s", type=positive, metavar="S", help="seconds a map, with --run (default: the map's)"
    )
    add_ledger(parser, "docs/maps", "docs/maps")


COMMANDS = (Command("map", "where the better of two choices changes, over two axes", _add_arguments, "maps"),)
