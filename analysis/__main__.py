"""The command line: `python3 -m analysis plots|report|compare|gallery ...`.

Exit codes: 0 good, 1 a check failed, 2 the input or the call is wrong.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from analysis.compare_options import add_compare
from analysis.errors import InputError


class _Parser(argparse.ArgumentParser):
    """argparse with complaints of one line, as all of ptbench's are."""

    def error(self, message: str):
        self.exit(2, f"{self.prog}: {message}; see --help\n")


def _resolution(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not match:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: WIDTHxHEIGHT such as 200x200')
    return int(match[1]), int(match[2])


def _positive(text: str) -> int:
    if not re.fullmatch(r"[1-9]\d{0,8}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: an integer of at least 1')
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python3 -m analysis", description="Draws what ptbench measured.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="plots|report|compare|gallery")
    plots = commands.add_parser("plots", help="every study's figure and summary.md, from a result file alone")
    plots.add_argument("result", type=Path, metavar="RESULT.json")
    plots.add_argument("--out", type=Path, metavar="DIR", help="default: figures/SUITE beside the result file")
    add_compare(commands)
    gallery = commands.add_parser("gallery", help="render the picture pairs of a gallery file into one labelled sheet")
    gallery.add_argument("--binary", type=Path, required=True, metavar="PTBENCH")
    gallery.add_argument("--spec", type=Path, default=Path(__file__).with_name("gallery.json"), metavar="GALLERY.json")
    gallery.add_argument("--out", type=Path, required=True, metavar="DIR")
    gallery.add_argument("--spp", type=_positive, default=64, metavar="N", help="samples per pixel (default: 64)")
    gallery.add_argument(
        "--resolution", type=_resolution, default=(200, 200), metavar="WxH", help="pixels a picture (default: 200x200)"
    )
    report = commands.add_parser("report", help="one page of one or more result files: report.html and report.md")
    report.add_argument("results", type=Path, nargs="+", metavar="RESULT", help="a result file, or a folder of some")
    report.add_argument("--out", type=Path, required=True, metavar="DIR")
    report.add_argument(
        "--binary", type=Path, metavar="PTBENCH", help="renders the scenes' pictures (default: no rendering)"
    )
    report.add_argument("--spp", type=_positive, default=16, metavar="N", help="of those pictures (default: 16)")
    report.add_argument(
        "--side", type=_positive, default=160, metavar="N", help="pixels of their longer side (default: 160)"
    )
    return parser


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    # Drawing libraries take a moment to load; a wrong call should not wait for them.
    from analysis.compare import compare_command
    from analysis.gallery import gallery
    from analysis.plots import plots
    from analysis.report.command import report

    try:
        if options.command == "report":
            return report(options.results, options.out, options.binary, options.spp, options.side)
        if options.command == "plots":
            return plots(options.result, options.out)
        if options.command == "compare":
            return compare_command(options)
        return gallery(options.binary, options.spec, options.out, options.spp, options.resolution)
    except InputError as error:
        print(f"python3 -m analysis: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
