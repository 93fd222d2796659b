"""The command line options of `submit` and `collect`."""

import argparse
import re
from pathlib import Path

from ptbench.command import Command


def _word(text: str) -> str:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: a GPU model as Slurm names it, such as h100')
    return text


def _time(text: str) -> str:
    if not re.fullmatch(r"(\d+-)?\d+(:\d\d){0,2}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: Slurm\'s [DAYS-]HOURS:MINUTES:SECONDS or MINUTES')
    return text


def _shards(text: str) -> int:
    if not re.fullmatch(r"[1-9]\d{0,3}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: an integer of at least 1')
    return int(text)


def _add_submit(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--suite", required=True, metavar="S", help="by name or .json file")
    parser.add_argument("--slurm", action="store_true", required=True, help="by sbatch files, which may be changed")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="a folder that every node sees")
    parser.add_argument("--shards", type=_shards, default=4, metavar="N", help="tasks of the array (default: 4)")
    parser.add_argument("--backend", choices=("cuda", "cpu"), default="cuda", help="default: cuda, one GPU a task")
    parser.add_argument(
        "--gpu", type=_word, action="append", default=[], metavar="MODEL",
        help="one array for each of these GPU models (repeatable; default: one, of any GPU)",
    )  # fmt: skip
    parser.add_argument("--time", type=_time, default="01:00:00", metavar="LIMIT", help="of a task (default: 01:00:00)")
    parser.add_argument(
        "--sbatch", action="append", default=[], metavar="OPTION", help='a line of its own: "--partition=gpu"'
    )
    parser.add_argument(
        "--run", action="append", default=[], metavar="OPTION", help='for `ptbench run`: "--repetitions=5"'
    )
    parser.add_argument("--binary", type=Path, default=Path("build/ptbench"), metavar="PTBENCH")
    parser.add_argument("--dry-run", action="store_true", help="write the files, submit nothing")


def _add_collect(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="the --out of `submit`")


COMMANDS = (
    Command("submit", "run a suite on a cluster: a Slurm job array of shards", _add_submit, "submit_command"),
    Command("collect", "merge what came back of `submit`, and say what is missing", _add_collect, "collect_command"),
)
