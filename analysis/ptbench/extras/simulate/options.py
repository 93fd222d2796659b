"""The command line options of `simulate`."""

import argparse
from pathlib import Path

from ptbench.command import Command


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--results", type=Path, default=Path("results"), metavar="DIR", help="default: results")
    parser.add_argument(
        "--definition", type=Path, metavar="FILE.json",
        help="parts, networks, sizes (default: the package's extras/simulate/thousand.json)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", help="simulation.md and the figure")
    parser.add_argument(
        "--work", type=Path, metavar="SCENE.json", help="instead: count rays a path by block of pixels, by rendering"
    )
    parser.add_argument("--spp", type=int, default=64, metavar="N", help="of --work (default: 64)")
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"), metavar="PTBENCH", help="of --work")


_HELP = "one render on a thousand GPUs, on paper: from parts that were measured on few"
COMMANDS = (Command("simulate", _HELP, _add_arguments, "simulate_command"),)
