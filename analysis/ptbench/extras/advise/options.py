"""The command line options of `advise`."""

import argparse
from pathlib import Path

from ptbench.command import Command, add_root, positive, resolution


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", metavar="SCENE", nargs="?", default="", help="a scene's file, or its name in scenes/")
    parser.add_argument("--try", dest="tried", type=positive, metavar="N", help="instead: try it on N made scenes")
    parser.add_argument("--seed", type=positive, default=1, metavar="N", help="of those scenes (default: 1)")
    parser.add_argument("--loaded", action="store_true", help="try it although other processes use the machine")
    parser.add_argument("--out", type=Path, metavar="FILE", help="of --try (default: results/MACHINE/advice.json)")
    parser.add_argument("--resume", action="store_true", help="of --try: keep the decided scenes of FILE's same try")
    machine = parser.add_mutually_exclusive_group()
    machine.add_argument("--gpu", metavar="MODEL", help="a GPU of results/, such as h200 (default: this machine)")
    machine.add_argument("--cpu", action="store_true", help="ask what was measured on CPUs")
    parser.add_argument("--depth", type=positive, metavar="N", help="default: the scene's")
    parser.add_argument("--resolution", type=resolution, metavar="WxH", help="default: the scene's")
    parser.add_argument("--measure", action="store_true", help="run the advised choices and the next ones here")
    parser.add_argument("--spp", type=positive, default=4, metavar="N", help="of --measure, a sample (default: 4)")
    parser.add_argument("--results", type=Path, metavar="DIR", help="ask these instead (default: the checkout's)")
    parser.add_argument("--binary", type=Path, metavar="PTBENCH", help="default: build/ptbench")
    add_root(parser)


def _fault(options: argparse.Namespace) -> str:
    if bool(options.scene) != (options.tried is not None):
        return ""
    return f"found {'both' if options.scene else 'neither'}, allowed: SCENE or --try N"


_HELP = "which choices to take for a scene, what each is expected to bring, and from which measurements"
COMMANDS = (Command("advise", _HELP, _add_arguments, fault=_fault),)
