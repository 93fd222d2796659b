"""How a command declares itself: `COMMANDS` in the `options.py` of its folder, which imports nothing slow.

`cli/main.py` collects the commands and runs the one that is called.
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
    """A command of the command line: its name, its arguments and the function that runs it."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    # Name of the function in the command's module `command` that runs it; empty: the function has the command's name.
    function: str = ""
    # Checks a command's parsed options together and returns what is wrong with their combination; empty: nothing.
    fault: Callable[[argparse.Namespace], str] = _nothing_wrong


def called(function: Callable[..., int], options: argparse.Namespace) -> int:
    """Calls a command's function with the options by its parameters' names and returns its exit code.

    A parameter named `options` gets all options and `program` the program's name for error messages; a parameter that
    is a dataclass is built from the options named as its fields.
    """

    def given(parameter: Parameter) -> object:
        if is_dataclass(parameter.annotation):
            names = (field.name for field in fields(parameter.annotation))
            return parameter.annotation(**{name: getattr(options, name) for name in names})
        return options if parameter.name == "options" else getattr(options, parameter.name)

    return function(**{name: given(parameter) for name, parameter in signature(function).parameters.items()})


def resolution(text: str) -> tuple[int, int]:
    """An argparse type: WIDTHxHEIGHT, each from 1 to 99999 pixels."""
    match = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if not match:
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: WIDTHxHEIGHT such as 200x200')
    return int(match[1]), int(match[2])


def positive(text: str) -> int:
    """An argparse type: an integer from 1 to 999999999."""
    if not re.fullmatch(r"[1-9]\d{0,8}", text):
        raise argparse.ArgumentTypeError(f'found "{text}", allowed: an integer of at least 1')
    return int(text)


def add_root(parser: argparse.ArgumentParser) -> None:
    """Adds `--root` to the parser of a command that reads a checkout."""
    parser.add_argument("--root", type=Path, default=Path(), metavar="DIR", help="the checkout (default: here)")


def add_ledger(parser: argparse.ArgumentParser, what: str, pages: str) -> None:
    """Adds `--results`, `--binary`, `--write`, `--check` and `--root` to a command that keeps pages of measurements.

    `what` names the files that --write writes, and `pages` the folder of the pages.
    """
    parser.add_argument("--results", type=Path, metavar="DIR", help="look up there instead (default: the checkout's)")
    parser.add_argument("--binary", type=Path, metavar="PTBENCH", help="of --run (default: build/ptbench)")
    parser.add_argument("--write", action="store_true", help=f"write {what}")
    parser.add_argument("--check", action="store_true", help=f"exit code 1 where a page of {pages} does not match")
    add_root(parser)
