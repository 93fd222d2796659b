"""The command line of `simulate`, apart from what it does, which takes a moment to load."""

from __future__ import annotations

from pathlib import Path


def add_simulate(commands) -> None:
    """The subcommand's options."""
    parser = commands.add_parser(
        "simulate", help="one render on a thousand GPUs, on paper: from parts that were measured on few"
    )
    parser.add_argument("--results", type=Path, default=Path("results"), metavar="DIR", help="default: results")
    parser.add_argument(
        "--definition", type=Path, metavar="FILE.json",
        help="parts, networks, sizes (default: the package's simulate/thousand.json)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", help="simulation.md and the figure")
    parser.add_argument(
        "--work", type=Path, metavar="SCENE.json", help="instead: count rays a path by block of pixels, by rendering"
    )
    parser.add_argument("--spp", type=int, default=64, metavar="N", help="of --work (default: 64)")
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"), metavar="PTBENCH", help="of --work")
