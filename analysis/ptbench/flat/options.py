"""The command line options of `flat`."""

import argparse
from pathlib import Path

from ptbench.command import Command
from ptbench.tidy.columns import GROUPS


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", type=Path, nargs="+", metavar="RESULT", help="a result file, or a folder of some")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=".csv, or .parquet where pyarrow is")
    parser.add_argument(
        "--table", choices=GROUPS, default="", metavar="NAME",
        help=f"one of {', '.join(GROUPS)} (default: samples; of files of stability and rays theirs)",
    )  # fmt: skip


_HELP = "rows of result files as one CSV or Parquet table (docs/columns.md)"
COMMANDS = (Command("flat", _HELP, _add_arguments),)
