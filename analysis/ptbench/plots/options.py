"""The command line of `plots`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("result", type=Path, metavar="RESULT.json", help="or a folder of files of `ptbench rays`")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: figures/SUITE beside the result file")


def _load():
    from ptbench.plots.command import plots

    return lambda options: plots(options.result, options.out)


COMMANDS = (Command("plots", "every study's figure and summary.md, from a result file alone", _add_arguments, _load),)
