"""Modules that are found where they lie, so that whoever asks for a kind of them names none."""

from functools import cache
from importlib import import_module
from types import ModuleType

from ptbench.io.files import package_file


@cache
def modules(*patterns: str) -> tuple[ModuleType, ...]:
    """The package's modules whose files match, "extras/*/plots.py"; each pattern's by name."""
    package = package_file()
    found = [path for pattern in patterns for path in sorted(package.glob(pattern)) if path.stem != "__init__"]
    names = [path.relative_to(package).with_suffix("").parts for path in found]
    return tuple(import_module(".".join(("ptbench", *parts))) for parts in names)
