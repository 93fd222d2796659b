"""The source of a page's numbers: a file under a name, and how the class for a file's kind is found.

Each kind is a class in a module of findings/sources, or in the source.py of a folder of extras, and declares by `form`
which files it reads. Modules are discovered, so that a new kind needs only a new file.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import ClassVar

from ptbench.errors import FindingError
from ptbench.findings.quantities import link_to
from ptbench.found import modules
from ptbench.io.nodes import Node, read_json

# Forms of source files that are recognised otherwise than by a schema's name.
SEVERAL, TEXT, FOLDER, LIST, SUITE, OTHER = "several files", "text", "a folder", "a list", "ptbench run", "other JSON"
# The schema name by which `ptbench stability` marks its result files.
STABILITY = "ptbench-stability-1"
_MODULES = ("findings/sources/*.py", "extras/*/source.py")
_NO_PART_OF_IT = ("kernels_behind", "optional")


class Source:
    """A file of results/ as a source for pages, which may use every public method and property of its class."""

    commit = ""  # commit of the program that wrote the source file; empty: unknown or irrelevant
    _kinds: ClassVar[dict[str, type[Source]]] = {}

    def __init_subclass__(cls, form: str = "", **others: object) -> None:
        """Registers a class for `form`, a schema's name or one of the constants above; without one it is a base."""
        super().__init_subclass__(**others)
        if form and Source._kinds.setdefault(form, cls) is not cls:
            raise TypeError(f"two kinds of source for {form}: {Source._kinds[form].__name__} and {cls.__name__}")

    def __init__(self, results: Path, file: str) -> None:
        self._results, self._shown = results, file

    @classmethod
    def of(cls, results: Path, about: Mapping) -> Source:
        """Makes the source for a page's entry in "sources"."""
        return cls(results, about["file"])

    @cached_property
    def _value(self) -> dict:
        """The JSON object of the file."""
        return read_json(self._results / self._shown).value

    @property
    def _link(self) -> str:
        return link_to(self._results, self._shown)

    @property
    def provenance(self) -> str:
        """A Markdown list item with the file and what it is."""
        raise FindingError(f"{self._shown}: such a file has no line in a list of sources")


@cache
def kinds() -> Mapping[str, type[Source]]:
    """Every class of source, by its form."""
    modules(*_MODULES)
    return Source._kinds


def form_of(results: Path, about: Mapping) -> str:
    """The form of a page's source, by which its class is found."""
    file: str = about["file"]
    if "against" in about:
        return SEVERAL
    if file.endswith(".txt"):
        return TEXT
    return FOLDER if (results / file).is_dir() else _form_of_json(read_json(results / file))


def _form_of_json(root: Node) -> str:
    if isinstance(root.value, list):
        return LIST
    fields = root.fields()
    if "schema" in fields:
        return str(fields["schema"]) if str(fields["schema"]) in kinds() else STABILITY
    return SUITE if "ptbench" in fields else OTHER


@cache
def _opened(results: Path, about: str) -> Source:
    entry = json.loads(about)
    return kinds()[form_of(results, entry)].of(results, entry)


def source_of(results: Path, about: Mapping) -> Source | None:
    """The source for an entry of a page's head; None for an optional file that is missing."""
    file = results / about["file"]
    if about.get("optional") and not file.exists() and not Path(f"{file}.gz").exists():
        return None
    # What a page demands of a source, such as how old it may be, is not in the cache's key: pages share the source.
    return _opened(results, json.dumps({key: value for key, value in about.items() if key not in _NO_PART_OF_IT}))
