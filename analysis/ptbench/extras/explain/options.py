"""The command line options of `explain`."""

import argparse
from pathlib import Path

from ptbench.command import Command, positive, resolution
from ptbench.io.axes import LAYOUT


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("result", type=Path, metavar="RESULT.json")
    parser.add_argument("a", metavar="A", help=f'a variant\'s name, or parts that name one: "wavefront {LAYOUT}=soa"')
    parser.add_argument("b", metavar="B", help="the variant that is held against A")
    parser.add_argument("--scene", default="", help="default: every scene in which both ran")
    parser.add_argument("--depth", type=positive, metavar="N", help="default: every depth")
    parser.add_argument("--resolution", type=resolution, metavar="WxH", help="default: every resolution")
    parser.add_argument(
        "--counters", type=Path, action="append", default=[], metavar="INSPECT.json",
        help="what `ptbench inspect --counters --json` measured of the variants",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: figures/explain-... beside the result file")


_HELP = "where the time of two variants differs, and what goes with that"
COMMANDS = (Command("explain", _HELP, _add_arguments, "explain_command"),)
