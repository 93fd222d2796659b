"""`python3 -m ptbench validate`: checks files against their schemas."""

import sys
from collections.abc import Iterable
from pathlib import Path

from ptbench.errors import InputError
from ptbench.io.validate import validate
from ptbench.terminal import say


def validate_command(paths: Iterable[Path], program: str) -> int:
    """Prints for each file one line: valid, or where it is not. Returns the exit code: 0, 1 or 2."""
    code = 0
    for path in paths:
        try:
            found = validate(path)
        except InputError as error:
            print(f"{program}: {error}", file=sys.stderr)
            code = 2
            continue
        others = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
        say(f"{path}: {found[0]}{others}" if found else f"{path}: good")
        code = max(code, 1 if found else 0)
    return code
