"""Reads regular files of limited size, and writes regular files atomically.

A file is written under a temporary name in the same folder, and then renamed.
"""

import errno
import gzip
import io
import os
import re
import stat
import tempfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

from ptbench.errors import InputError, MachineError, bad_value

# Largest files that are read, as in the ptbench program: the largest committed result has 20 MB, and a parsed result
# takes about ten times its file size in memory.
LARGEST_RESULT = 1 << 30
LARGEST_INPUT = 64 << 20
# Largest image file in bytes: 9459x9459 pixels of three floats.
LARGEST_IMAGE = 1 << 30

_NO_REGULAR_FILE = "no regular file (a device, a pipe or a socket)"
_A_NEW_FILE = "a file, new or regular"
_IN_WORDS = {
    errno.ENOENT: "no such file",
    errno.ENOTDIR: "a path through a file that is no folder",
    errno.EACCES: "no permission",
    errno.EPERM: "no permission",
    errno.ELOOP: "a link that leads to itself",
}


# Error codes of a full or failing disk or machine, for which another file name would not help.
_OF_THE_MACHINE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.ENOMEM, errno.EMFILE, errno.ENFILE)


def _write_failure(target: Path, place: str, error: OSError, allowed: str) -> InputError | MachineError:
    """The exception for a failed write: InputError if the call is to blame, MachineError for the machine."""
    reason = _reason(target, error)
    if error.errno in _OF_THE_MACHINE:
        return MachineError(f"{target}: cannot be written: {reason}")
    return bad_value(target, place, reason, allowed)


def package_file(*parts: str) -> Path:
    """A file or folder of the package, in a checkout or an installation."""
    return Path(str(resources.files("ptbench").joinpath(*parts)))


def read_whole(path: Path, largest: int = LARGEST_INPUT) -> bytes:
    """The contents of the regular file that `path` names or links to; raises InputError."""
    try:
        # The file type is checked before opening, because opening a device may have side effects.
        _check_kind(path, os.stat(path), largest)
        # O_NONBLOCK avoids waiting for a writer if a pipe has replaced the file since its type was checked.
        with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
            status = os.fstat(file.fileno())
            _check_kind(path, status, largest)
            # One byte more than the file's size is read to detect its end; a file that has grown is read on in pieces.
            data = file.read(status.st_size + 1)
            while len(data) > status.st_size and len(data) <= largest and (more := file.read(1 << 16)):
                data += more
    except OSError as error:
        raise _unreadable(path, _reason(path, error), largest) from error
    except ValueError as error:  # the file name contains a null character
        raise _unreadable(path, "a name that no file can have", largest) from error
    if len(data) > largest:
        raise _unreadable(path, "more bytes than when it was opened, too large", largest)
    return data


def stored_file(path: Path) -> Path:
    """The path of FILE.json, or of FILE.json.gz where only that exists."""
    packed = path if path.suffix == ".gz" else Path(f"{path}.gz")
    return path if os.path.lexists(path) or not os.path.isfile(packed) else packed


def read_stored(path: Path, largest: int = LARGEST_INPUT) -> tuple[Path, bytes]:
    """The contents of FILE.json, or of FILE.json.gz where only that exists, and the name without `.gz`.

    Large results are committed compressed, and may be named either way. Raises InputError.
    """
    packed = stored_file(path)
    if packed.suffix != ".gz":
        return path, read_whole(path, largest)
    try:
        with gzip.open(io.BytesIO(read_whole(packed, largest))) as file:
            data = file.read(largest + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise _unreadable(packed, f"no whole gzip file ({error})", largest) from error
    if len(data) > largest:
        raise _unreadable(packed, "more bytes when unpacked, too large", largest)
    return packed.with_suffix(""), data


def _reason(path: Path, error: OSError) -> str:
    if error.errno == errno.ENOENT and os.path.islink(path):
        return "a link to nothing"
    return _IN_WORDS.get(error.errno, error.strerror or str(error))


def _check_kind(path: Path, status: os.stat_result, largest: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise _unreadable(path, "a folder", largest)
    if not stat.S_ISREG(status.st_mode):
        raise _unreadable(path, _NO_REGULAR_FILE, largest)
    if status.st_size > largest:
        raise _unreadable(path, f"{status.st_size} bytes, too large", largest)


def _unreadable(path: Path, found: str, largest: int) -> InputError:
    return bad_value(path, "the file", found, f"a regular file of at most {largest >> 20} MiB that can be read")


def named_files(folder: Path, names: Iterable[str], what: str) -> list[Path]:
    """Every JSON file of a folder, or those named; raises InputError for a missing one."""
    files = {path.stem: path for path in sorted(folder.glob("*.json"))}
    if not files:
        raise bad_value(folder, "folder", f"no {what}", "the root of a checkout as --root")
    if unknown := [name for name in names if name not in files]:
        raise bad_value(folder, what, ", ".join(unknown), ", ".join(files))
    return [files[name] for name in (dict.fromkeys(names) if names else files)]


def make_folder(folder: Path) -> None:
    """Makes a folder with its parents; raises InputError."""
    check_output_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _write_failure(folder, "output folder", error, "a folder that can be made") from error


def check_output_folder(folder: Path) -> None:
    """Raises InputError if the output folder's name is taken by something else."""
    if os.path.lexists(folder) and not os.path.isdir(folder):
        found = "a link to nothing" if not os.path.exists(folder) else "a file, which is no folder"
        raise bad_value(folder, "output folder", found, "a folder that can be made")


def check_output_file(target: Path, sources: Iterable[Path | str] = ()) -> None:
    """Raises InputError if the output file's name is taken by something that is no regular file, or by an input."""
    try:
        mode = os.stat(target).st_mode
    except OSError as error:
        if error.errno == errno.ENOENT and not os.path.islink(target):
            return
        raise bad_value(target, "output file", _reason(target, error), _A_NEW_FILE) from error
    if not stat.S_ISREG(mode):
        raise bad_value(target, "output file", "a folder" if stat.S_ISDIR(mode) else _NO_REGULAR_FILE, _A_NEW_FILE)
    if any(os.path.exists(source) and os.path.samefile(source, target) for source in sources):
        raise bad_value(target, "output file", "a file that this call reads", "another file")


def write_whole(target: Path, write: Callable[[Path], None]) -> Path:
    """Lets `write` fill a temporary file that becomes `target` only when complete.

    If `target` is a link, the file that it points to is replaced and the link stays.
    """
    check_output_file(target)
    final = _behind_links(target)
    try:
        descriptor, name = tempfile.mkstemp(dir=final.parent, prefix=f".{final.stem}-", suffix=final.suffix)
    except OSError as error:
        raise _write_failure(final.parent, "output folder", error, "a folder that can be written") from error
    os.close(descriptor)
    temporary = Path(name)
    try:
        write(temporary)
        # A file of mkstemp is private; figures and results get the permissions that the umask gives any new file.
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        os.replace(temporary, final)
    except OSError as error:
        raise _write_failure(target, "output file", error, "a name that can be written") from error
    finally:
        temporary.unlink(missing_ok=True)
    return target


def move_whole(source: Path, target: Path) -> None:
    """Renames a finished file to its final name, following links as `write_whole` does."""
    check_output_file(target)
    try:
        os.replace(source, _behind_links(target))
    except OSError as error:
        raise _write_failure(target, "output file", error, "a name that can be written") from error


def _behind_links(target: Path) -> Path:
    return Path(os.path.realpath(target)) if target.is_symlink() else target


@contextmanager
def scratch_folder(folder: Path) -> Iterator[Path]:
    """A temporary folder inside `folder` for unfinished files, removed on exit."""
    try:
        made = tempfile.TemporaryDirectory(dir=folder, prefix=".render-")
    except OSError as error:
        raise _write_failure(folder, "output folder", error, "a folder that can be written") from error
    with made as name:
        yield Path(name)


def write_text(target: Path, text: str) -> Path:
    """Writes a UTF-8 text file atomically, and returns its path; raises InputError."""
    # File names from the command line need not be valid UTF-8.
    data = text.encode("utf-8", "backslashreplace")
    return write_whole(target, lambda temporary: temporary.write_bytes(data) and None)


def safe_name(text: str) -> str:
    """The text as a safe file name, so that a study or suite name cannot reach another folder."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", text).strip(".") or "unnamed"


def one_line(text: str) -> str:
    """The text with each run of white space replaced by one space."""
    return " ".join(text.split())


def picked(value: object, names: str) -> dict:
    """The named attributes of an object for JSON, with tuples as lists."""
    found = {name: getattr(value, name) for name in names.split()}
    return {name: list(one) if isinstance(one, tuple) else one for name, one in found.items()}
