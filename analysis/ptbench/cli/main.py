"""The command line: `python3 -m ptbench COMMAND ...`, one command or more a folder.

Exit codes: 0 good, 1 a check failed, 2 the input or the call is wrong, 3 the machine failed.
"""

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from ptbench import __version__
from ptbench.cli.parser import Parser
from ptbench.command import Command, called
from ptbench.errors import FindingError, InputError, MachineError
from ptbench.terminal import OutputError, visible, visible_output

_PROGRAM = "ptbench-analysis"
_MODULE = "python3 -m ptbench"
# Whose options.py has COMMANDS, in the order of --help.
FOLDERS = (
    "plots", "report", "compare", "extras.fleet", "crosscheck", "extras.peers", "extras.explain", "findings", "claims",
    "extras.maps", "extras.advise", "gallery", "flat", "validate", "submit", "extras.simulate",
)  # fmt: skip


@cache
def commands() -> dict[str, tuple[str, Command]]:
    """All commands by name, each with its folder, in the order of --help."""
    found = ((folder, one) for folder in FOLDERS for one in import_module(f"ptbench.{folder}.options").COMMANDS)
    return {command.name: (folder, command) for folder, command in found}


def _program() -> str:
    """How it was called: as the installed command, or as a module."""
    return _PROGRAM if Path(sys.argv[0]).stem == _PROGRAM else _MODULE


def parser_of(program: str = _MODULE) -> argparse.ArgumentParser:
    """The whole command line; `program` is what usage and complaints call it."""
    parser = Parser(prog=program, description="Draws what ptbench measured.")
    parser.add_argument("--version", action="version", version=f"{_PROGRAM} {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="|".join(commands()))
    for _, command in commands().values():
        command.add_arguments(subparsers.add_parser(command.name, help=command.help))
    parser.set_defaults(program=program)
    return parser


def main(arguments: list[str] | None = None, program: str = "") -> int:
    """Runs one command and returns its exit code; a wrong call ends with SystemExit(2), --help with SystemExit(0).

    `program` is what usage and complaints call it; left out, it is what the process was started as.
    """
    program = program or _program()
    with visible_output():
        try:
            with _drawing_to_files():
                code = _main(sys.argv[1:] if arguments is None else arguments, program)
            sys.stdout.flush()
        except OutputError as error:
            print(f"{program}: {error}", file=sys.stderr)
            return 3
        return code


@contextmanager
def _drawing_to_files() -> Iterator[None]:
    """matplotlib reads MPLBACKEND as soon as it is imported, and notebooks export one that only they have."""
    kept = os.environ.get("MPLBACKEND")
    os.environ["MPLBACKEND"] = "agg"
    try:
        yield
    finally:
        if kept is None:
            del os.environ["MPLBACKEND"]
        else:
            os.environ["MPLBACKEND"] = kept


def _main(arguments: list[str], program: str) -> int:
    options = parser_of(program).parse_args(arguments)
    folder, command = commands()[options.command]
    if fault := command.fault(options):
        print(f"{program} {command.name}: {visible(fault)}; see --help", file=sys.stderr)
        return 2
    try:
        return called(getattr(_functions(folder, command.name), command.function or command.name), options)
    except (InputError, FindingError) as error:
        print(f"{program}: {visible(str(error))}", file=sys.stderr)
        return 2
    except MachineError as error:
        print(f"{program}: {visible(str(error))}", file=sys.stderr)
        return 3


def _functions(folder: str, name: str) -> ModuleType:
    """The command's functions; a package that is not installed is named in one line, as an InputError."""
    try:
        return import_module(f"ptbench.{folder}.command")
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] == "ptbench":
            raise
        raise InputError(f"{name} needs the Python package {error.name} (analysis/requirements.txt)") from error
