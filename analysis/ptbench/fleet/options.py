"""The command line of `fleet`, apart from what it does, which takes a moment to load."""

from __future__ import annotations

from pathlib import Path


def add_fleet(commands) -> None:
    """The subcommand's options."""
    parser = commands.add_parser(
        "fleet", help="a suite on several models of GPU: ratios, rankings that change, and what data sheets predict"
    )
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
