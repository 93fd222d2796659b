"""The options of `python3 -m ptbench crosscheck`."""

import argparse
import sys
from pathlib import Path

from ptbench.command import Command
from ptbench.crosscheck.limits import ALL, MOST_SPP, SIDE
from ptbench.io.axes import DIRECT_LIGHT


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help=f'by name or .json file; "{ALL}": every shipped one')
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"), metavar="PTBENCH")
    parser.add_argument(
        "--python", type=Path, default=Path(sys.executable), metavar="PYTHON", help="one that has Mitsuba's wheel"
    )
    parser.add_argument(
        "--variant", default="auto", help="Mitsuba's (default: cuda_ad_rgb where there is a GPU, else scalar_rgb)"
    )
    parser.add_argument("--backend", default="", choices=("", "cpu", "cuda"), help="ptbench's (default: its own)")
    parser.add_argument(
        "--axis",
        action="append",
        default=[],
        metavar="AXIS=CHOICE",
        help=f"(default: {DIRECT_LIGHT}=nee_mis, and trees for meshes)",
    )
    parser.add_argument("--seeds", type=whole(2, 1000), default=8, metavar="N", help="images of each (default: 8)")
    parser.add_argument(
        "--first-seed", type=whole(1, 1_000_000), default=1, metavar="N",
        help="of both (default: 1); what is to be taken together with another call's needs other seeds than that",
    )  # fmt: skip
    parser.add_argument(
        "--spp", type=whole(1, MOST_SPP), default=128, metavar="N", help="samples a pixel and seed (default: 128)"
    )
    parser.add_argument(
        "--spp-here", type=whole(1, MOST_SPP), metavar="N",
        help="of ptbench's images, where they need other numbers for as little noise (default: as --spp)",
    )  # fmt: skip
    parser.add_argument(
        "--most-spp", type=whole(1, MOST_SPP), default=1, metavar="N",
        help="a scene that is too weak is rendered again, with as many as the aim needs, up to N (default: not)",
    )  # fmt: skip
    parser.add_argument(
        "--resolution", type=blocks, default=(64, 64), metavar="WxH", help=f"multiples of {SIDE} (default: 64x64)"
    )
    parser.add_argument("--depth", type=whole(1, 1_000_000), metavar="N", help="default: the scene's")
    parser.add_argument(
        "--scale", type=float, default=1.0, metavar="K", help="every length of Mitsuba's scene times a power of two"
    )
    parser.add_argument(
        "--aim", type=percent, default=0.005, metavar="PERCENT",
        help="the bias of an image's mean that must be seen (default: 0.5)",
    )  # fmt: skip
    parser.add_argument(
        "--allow", type=percent, default=0.0, metavar="PERCENT", help="a bias that is no difference (default: 0)"
    )
    parser.add_argument(
        "--jobs", type=whole(1, 256), default=1, metavar="N",
        help="scenes at a time (default: 1); nothing that is timed here is compared",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="REPORT.json")
    parser.add_argument("--resume", action="store_true", help="keep the scenes that REPORT.json has from the same call")


def whole(low: int, high: int):
    """An argparse type: whole numbers from `low` to `high`."""

    def read(text: str) -> int:
        if not text.isascii() or not text.isdigit() or not low <= int(text) <= high:
            raise argparse.ArgumentTypeError(f'found "{text}", allowed: a whole number from {low} to {high}')
        return int(text)

    return read


def percent(text: str) -> float:
    """An argparse type: a fraction, given in per cent."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 100:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: a percentage from 0 to 100')
    return value / 100


def blocks(text: str) -> tuple[int, int]:
    """An argparse type: WIDTHxHEIGHT of images that are compared by blocks, so that both are multiples of the block."""
    sides = text.split("x")
    if len(sides) != 2 or not all(
        side.isascii() and side.isdigit() and int(side) % SIDE == 0 and 0 < int(side) <= 4096 for side in sides
    ):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: WxH, multiples of {SIDE} up to 4096')
    return int(sides[0]), int(sides[1])


_HELP = "render scenes here and in Mitsuba 3, and hold them to one mean"
COMMANDS = (Command("crosscheck", _HELP, _add_arguments, "crosscheck_command"),)
