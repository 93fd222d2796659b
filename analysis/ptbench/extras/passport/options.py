"""The command line options of `passport`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("passports", nargs="+", type=Path, metavar="PASSPORT.json", help="of ptbench passport")
    parser.add_argument("--out", type=Path, metavar="FILE.md", help="also write the page as Markdown")


_HELP = "what a machine answers to the seven questions, beside other machines"
COMMANDS = (Command("passport", _HELP, _add_arguments, "passport_command"),)
