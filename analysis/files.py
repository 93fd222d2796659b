"""Writes files whole or not at all: a temporary name in the same folder first, then a rename."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

from analysis.errors import InputError


def make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: output folder: found {error.strerror or error}, allowed: a folder that can be made"
        ) from error


def write_whole(target: Path, write: Callable[[Path], None]) -> Path:
    """Lets `write` fill a temporary file that becomes `target` only when it is complete."""
    try:
        descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=target.suffix)
    except OSError as error:
        raise InputError(
            f"{target.parent}: output folder: found {error.strerror or error}, allowed: a folder that can be written"
        ) from error
    os.close(descriptor)
    temporary = Path(name)
    try:
        write(temporary)
        # mkstemp makes private files; figures are meant to be shared like any other file.
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        try:
            os.replace(temporary, target)
        except OSError as error:
            raise InputError(
                f"{target}: output file: found {error.strerror or error}, allowed: a name that can be replaced"
            ) from error
    finally:
        temporary.unlink(missing_ok=True)
    return target


def write_text(target: Path, text: str) -> Path:
    return write_whole(target, lambda temporary: temporary.write_text(text, encoding="utf-8") and None)


def safe_name(text: str) -> str:
    """`text` as a file name: a study or suite name must not reach another folder."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", text).strip(".") or "unnamed"


def one_line(text: str) -> str:
    return " ".join(text.split())
