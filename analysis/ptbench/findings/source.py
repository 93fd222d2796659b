"""What a page has of a file by a name of its own, and how the kind of a file is found.

Each kind is a class in a module of findings/sources, or in the source.py of a folder of extras, and says by
`form` which files are its own. The modules are found where they lie: one more kind is one more file.
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

# Forms of files that have no schema's name.
SEVERAL, TEXT, FOLDER, LIST, SUITE, OTHER = "several files", "text", "a folder", "a list", "ptbench run", "other JSON"
# Form of the files of `ptbench stability`, whose schema has this name.
STABILITY = "ptbench-stability-1"
_MODULES = ("findings/sources/*.py", "extras/*/source.py")
_NO_PART_OF_IT = ("kernels_behind", "optional")


class Source:
    """A file of results/; every public method and property of a kind may stand in a page."""

    commit = ""  # of the program that wrote it; empty: such a file does not say, or needs none
    _kinds: ClassVar[dict[str, type[Source]]] = {}

    def __init_subclass__(cls, form: str = "", **others: object) -> None:
        """`form`: a schema's name, or one of the forms above; a class without one is a part of others."""
        super().__init_subclass__(**others)
        if form and Source._kinds.setdefault(form, cls) is not cls:
            raise TypeError(f"two kinds of source for {form}: {Source._kinds[form].__name__} and {cls.__name__}")

    def __init__(self, results: Path, file: str) -> None:
        self._results, self._shown = results, file

    @classmethod
    def of(cls, results: Path, about: Mapping) -> Source:
        """Made of a page's entry in "sources"."""
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
        """A line of a list: the file and what it is."""
        raise FindingError(f"{self._shown}: such a file has no line in a list of sources")


@cache
def kinds() -> Mapping[str, type[Source]]:
    """Every kind of source by its form."""
    modules(*_MODULES)
    return Source._kinds


def form_of(results: Path, about: Mapping) -> str:
    """By which its kind is found."""
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
    """What a source of a page's head stands for, by what its file holds; None for one that may be missing and is."""
    file = results / about["file"]
    if about.get("optional") and not file.exists() and not Path(f"{file}.gz").exists():
        return None
    # One file is a source of several pages, whatever age each of them allows.
    return _opened(results, json.dumps({key: value for key, value in about.items() if key not in _NO_PART_OF_IT}))
