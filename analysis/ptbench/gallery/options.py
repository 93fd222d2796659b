"""The command line options of `gallery`."""

import argparse
from pathlib import Path

from ptbench.command import Command, positive, resolution
from ptbench.io.files import package_file


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--binary", type=Path, required=True, metavar="PTBENCH")
    parser.add_argument("--spec", type=Path, default=package_file("gallery.json"), metavar="GALLERY.json")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--spp", type=positive, default=64, metavar="N", help="samples per pixel (default: 64)")
    parser.add_argument(
        "--resolution", type=resolution, default=(200, 200), metavar="WxH", help="pixels a picture (default: 200x200)"
    )


_HELP = "render the picture pairs of a gallery file into one labelled sheet"
COMMANDS = (Command("gallery", _HELP, _add_arguments),)
