"""How a command declares itself: `COMMANDS` in the `options.py` of its folder, which loads nothing that takes a moment.

`cli/main.py` collects them and runs the one that is called.
"""

import argparse
import re
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from inspect import Parameter, signature
from pathlib import Path


def _nothing_wrong(options: argparse.Namespace) -> str:
    return ""


@dataclass(frozen=True)
class Command:
    """A word of the command line, what follows it and what it does."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    # What runs it and returns the exit code: a function of its folder's module `command`; empty: the one of its name.
    function: str = ""
    # What options that are each allowed are wrong in together; empty: nothing.
    fault: Callable[[argparse.Namespace], str] = _nothing_wrong


def called(function: Callable[..., int], options: argparse.Namespace) -> int:
    """The function's exit code, called with the options by the names of its parameters.

    A parameter `options` is all of them, `program` what complaints call the program, and a dataclass is made of the
    options by the names of its fields.
    """

    def given(parameter: Parameter) -> object:
        if is_dataclass(parameter.annotation):
            names = (field.name for field in fields(parameter.annotation))
            return parameter.annotation(**{name: getattr(options, name) for name in names})
        return options if parameter.name == "options" else getattr(options, parameter.name)

    return function(**{name: given(parameter) for name, parameter in signature(function).parameters.items()})


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
