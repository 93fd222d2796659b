"""How a command declares itself: `COMMANDS` in the `options.py` of its folder, which loads nothing that takes a moment.

`cli/main.py` collects them and runs the one that is called.
"""

import argparse
import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TypeVar

Of = TypeVar("Of")


def _nothing_wrong(options: argparse.Namespace) -> str:
    return ""


@dataclass(frozen=True)
class Command:
    """A word of the command line, what follows it and what it does."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    # Imports the command's modules and returns what runs it, which returns the exit code. Apart from running, so that
    # a package that is not installed is told as that. The options hold `program`, too: what complaints call it.
    load: Callable[[], Callable[[argparse.Namespace], int]]
    # What options that are each allowed are wrong in together; empty: nothing.
    fault: Callable[[argparse.Namespace], str] = _nothing_wrong


def call_of(kind: type[Of], options: argparse.Namespace) -> Of:
    """The dataclass `kind` made of the options by the names of its fields, each of which is an option."""
    return kind(**{field.name: getattr(options, field.name) for field in fields(kind)})


def resolution(text: str) -> tuple[int, int]:
    """A type of argparse's: WIDTHxHEIGHT, each from 1 to 99999 pixels."""
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not match:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: WIDTHxHEIGHT such as 200x200')
    return int(match[1]), int(match[2])


def positive(text: str) -> int:
    """A type of argparse's: an integer from 1 to 999999999."""
    if not re.fullmatch(r"[1-9]\d{0,8}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: an integer of at least 1')
    return int(text)


def add_root(parser: argparse.ArgumentParser) -> None:
    """`--root`, of commands that read a checkout."""
    parser.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")


def add_ledger(parser: argparse.ArgumentParser, what: str, pages: str) -> None:
    """`--results`, `--binary`, `--write`, `--check` and `--root`, of commands that keep pages of what was measured.

    `what` is written with --write, and `pages` is the folder of its pages.
    """
    parser.add_argument("--results", type=Path, metavar="DIR", help="look up there instead (default: the checkout's)")
    parser.add_argument("--binary", type=Path, metavar="PTBENCH", help="of --run (default: build/ptbench)")
    parser.add_argument("--write", action="store_true", help=f"write {what}")
    parser.add_argument("--check", action="store_true", help=f"exit code 1 where a page of {pages} does not match")
    add_root(parser)
