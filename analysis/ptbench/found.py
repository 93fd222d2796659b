"""Discovers modules by file patterns, so that the code that uses a kind of module names none of them."""

from functools import cache
from importlib import import_module
from types import ModuleType

from ptbench.io.files import package_file


@cache
def modules(*patterns: str) -> tuple[ModuleType, ...]:
    """The package's modules whose files match patterns such as "extras/*/plots.py", in the order of their names."""
    package = package_file()
    found = [path for pattern in patterns for path in sorted(package.glob(pattern)) if path.stem != "__init__"]
    names = [path.relative_to(package).with_suffix("").parts for path in found]
    return tuple(import_module(".".join(("ptbench", *parts))) for parts in names)
