"""The command line options of `fleet`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "results", type=Path, nargs="+", metavar="RESULT.json", help="a file a GPU; the first: whose counters are known"
    )
    parser.add_argument(
        "--inspect", type=Path, nargs="+", action="extend", default=[], metavar="FILE",
        help="of `ptbench inspect --counters` on the first file's GPU, or of `inspect --arch` for any",
    )  # fmt: skip
    parser.add_argument(
        "--gpu", action="append", default=[], metavar="MODEL",
        help="also predict a GPU that was not measured, from its data sheet (repeatable)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", help="fleet.md and the figures")


_HELP = "a suite on several models of GPU: ratios, rankings that change, and what data sheets predict"
COMMANDS = (Command("fleet", _HELP, _add_arguments, "fleet_command"),)
