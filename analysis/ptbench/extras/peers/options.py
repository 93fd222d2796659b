"""The command line options of `python3 -m ptbench peers`."""

import argparse
import re
import shlex
import sys
from pathlib import Path

from ptbench.command import Command
from ptbench.crosscheck.options import blocks, percent, whole
from ptbench.extras.peers.wanted import CHANCE, EVALUATED, LIGHTS, MEGAKERNEL, OF_MITSUBA
from ptbench.io.axes import DIRECT_LIGHT

_NAME = re.compile(r"[A-Za-z][\w.+ -]{0,59}")
_AXIS = re.compile(r"\w+=\w+")


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenes", nargs="+", metavar="SCENE", help="by name or .json file")
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"), metavar="PTBENCH")
    parser.add_argument(
        "--python", type=Path, default=Path(sys.executable), metavar="PYTHON", help="one that has Mitsuba's wheel"
    )
    parser.add_argument("--backend", default="cpu", choices=("cpu", "cuda"), help="where all run (default: cpu)")
    parser.add_argument(
        "--variant", type=_variant, action="append", default=[], metavar="NAME:AXIS=CHOICE,..",
        help="of ptbench, repeatable; pictures and efficiencies are held against the first (default: the fastest "
        f"known with {DIRECT_LIGHT}=nee_mis and off, and Embree's trees)",
    )  # fmt: skip
    parser.add_argument(
        "--mitsuba", type=_mitsuba_text, action="append", default=[], metavar="VARIANT[:path|bsdf[:evaluated]]",
        help='repeatable, or "none" (default: path and bsdf as megakernels, path in evaluated loops)',
    )  # fmt: skip
    parser.add_argument(
        "--program", type=_program, action="append", default=[], metavar="NAME[:off|nee_mis]=COMMAND",
        help="any other renderer that answers as docs/other_renderers.md says, repeatable",
    )  # fmt: skip
    parser.add_argument("--rounds", type=whole(2, 1000), default=9, metavar="N", help="of all peers (default: 9)")
    parser.add_argument(
        "--repetitions", type=whole(1, 1000), default=1, metavar="N", help="timed renders of a round (default: 1)"
    )
    parser.add_argument(
        "--render-ms", type=whole(1, 100_000), default=250, metavar="N",
        help="what a timed render should take: its samples a pixel are chosen so (default: 250)",
    )  # fmt: skip
    parser.add_argument("--seeds", type=whole(2, 1000), default=8, metavar="N", help="pictures of each (default: 8)")
    parser.add_argument(
        "--spp", type=whole(1, 1_000_000), default=128, metavar="N", help="samples a pixel of a picture (default: 128)"
    )
    parser.add_argument(
        "--resolution", type=blocks, default=(200, 200), metavar="WxH", help="multiples of 8 (default: 200x200)"
    )
    parser.add_argument("--depth", type=whole(1, 1_000_000), metavar="N", help="default: the scene's")
    parser.add_argument(
        "--scale", type=float, default=16.0, metavar="K",
        help="every length of Mitsuba's scene times a power of two, so that its offsets do not show (default: 16)",
    )  # fmt: skip
    parser.add_argument(
        "--aim", type=percent, default=0.005, metavar="PERCENT",
        help="the bias of an image's mean that must be seen before there is a ratio (default: 0.5)",
    )  # fmt: skip
    parser.add_argument(
        "--allow", type=percent, default=0.001, metavar="PERCENT", help="a bias that is no difference (default: 0.1)"
    )
    parser.add_argument(
        "--seconds", type=whole(1, 100_000), default=600, metavar="N", help="the most for one answer (default: 600)"
    )
    parser.add_argument("--out", type=Path, metavar="PEERS.json", help="default: results/MACHINE/peers.json")
    parser.add_argument("--resume", action="store_true", help="go on with an unfinished file")
    parser.add_argument("--overwrite", action="store_true", help="begin anew where there is one")


def _variant(text: str) -> str:
    name, _, axes = text.partition(":")
    if not _NAME.fullmatch(name) or not all(_AXIS.fullmatch(axis) for axis in axes.split(",")):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: NAME:AXIS=CHOICE,AXIS=CHOICE,..')
    return text


def _mitsuba_text(text: str) -> str:
    variant, estimator, mode = (*text.split(":"), *["", ""])[:3]
    good = re.fullmatch(r"\w+", variant) and estimator in ("", *OF_MITSUBA) and mode in ("", MEGAKERNEL, EVALUATED)
    if not good or text.count(":") > 2:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: VARIANT, VARIANT:path|bsdf, or with :evaluated')
    return text


def _program(text: str) -> str:
    named, _, command = text.partition("=")
    name, _, estimator = named.partition(":")
    try:
        words = shlex.split(command)
    except ValueError:
        words = []
    if not _NAME.fullmatch(name) or estimator not in ("", LIGHTS, CHANCE) or not words:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: NAME=COMMAND or NAME:{LIGHTS}=COMMAND')
    return text


_HELP = "time, variance and efficiency of ptbench and other renderers, side by side on this machine"
COMMANDS = (Command("peers", _HELP, _add_arguments, "peers_command"),)
