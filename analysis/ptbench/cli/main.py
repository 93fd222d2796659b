"""The command line `python3 -m ptbench COMMAND ...`, whose commands are declared in the package's folders.

Exit codes: 0 success, 1 a check failed, 2 wrong input or a wrong call, 3 the machine failed.
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
# Folders of the package whose options.py declares commands, in the order of --help.
FOLDERS = (
    "plots", "report", "compare", "extras.fleet", "crosscheck", "extras.peers", "extras.explain", "findings", "claims",
    "extras.maps", "extras.advise", "gallery", "flat", "validate", "submit", "extras.simulate", "extras.passport",
)  # fmt: skip


@cache
def commands() -> dict[str, tuple[str, Command]]:
    """All commands by name, each with the folder that declares it, in the order of --help."""
    found = ((folder, one) for folder in FOLDERS for one in import_module(f"ptbench.{folder}.options").COMMANDS)
    return {command.name: (folder, command) for folder, command in found}


def _program() -> str:
    """The name by which the process was started: the installed command's, or the module's."""
    return _PROGRAM if Path(sys.argv[0]).stem == _PROGRAM else _MODULE


def parser_of(program: str = _MODULE) -> argparse.ArgumentParser:
    """Makes the parser of the whole command line; `program` is the name in usage and error messages."""
    parser = Parser(prog=program, description="Draws what ptbench measured.")
    parser.add_argument("--version", action="version", version=f"{_PROGRAM} {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="|".join(commands()))
    for _, command in commands().values():
        command.add_arguments(subparsers.add_parser(command.name, help=command.help))
    parser.set_defaults(program=program)
    return parser


def main(arguments: list[str] | None = None, program: str = "") -> int:
    """Runs one command and returns its exit code; a wrong call ends with SystemExit(2), --help with SystemExit(0).

    `program` is the name in usage and error messages; by default the one that the process was started by.
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
    """Sets MPLBACKEND to agg for the import of matplotlib, as notebooks export a backend that only they have."""
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
    """Imports the module with a command's functions; a missing Python package becomes a one-line InputError."""
    try:
        return import_module(f"ptbench.{folder}.command")
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] == "ptbench":
            raise
        raise InputError(f"{name} needs the Python package {error.name} (analysis/requirements.txt)") from error
