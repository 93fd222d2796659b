"""The command line options of `compare`."""

import argparse
from pathlib import Path

from ptbench.command import Command
from ptbench.compare.choices import FAIL_ON


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "results", type=Path, nargs="+", metavar="RESULT.json", help="two or more; the first: reference"
    )
    parser.add_argument(
        "--noise", type=Path, nargs="+", action="extend", default=[], metavar="FILE",
        help="runs of one program on one machine (A/A), which tell its noise floor",
    )  # fmt: skip
    parser.add_argument(
        "--films-may-differ", action="store_true", help="compare also cells whose films have other bits, if rays agree"
    )
    parser.add_argument(
        "--fail-on", choices=FAIL_ON, action="append", default=[],
        help="exit code 1 if a cell is SLOWER; SLOWER or FASTER; if one of the reference has no partner (repeatable). "
        "Also 1 where the first two cannot be judged: a cell would be, but its samples were disturbed or the noise "
        "floor was refused, or all cells are UNSURE. Of stability files: different: a row has another status; failed: "
        "one that must pass fails and did not before; unmatched: as above",
    )  # fmt: skip
    parser.add_argument("--json", type=Path, metavar="FILE", help="everything, for programs")
    parser.add_argument("--out", type=Path, metavar="DIR", help="compare.md, and of result files the figures")


_HELP = "hold result, stability or rays files of commits or machines against the first one"
COMMANDS = (Command("compare", _HELP, _add_arguments, "compare_command"),)
