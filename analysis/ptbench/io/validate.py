"""Validates files that ptbench writes against their JSON Schemas (draft 2020-12) in the folder schema.

In results and journals that are valid, samples and films are also checked against each other.

`docs/results.md` is the guide to these files.
"""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError
from referencing import Registry, Resource

from ptbench.errors import InputError, bad_value
from ptbench.io.consistency import JournalBook, contradictions
from ptbench.io.files import LARGEST_RESULT, one_line, package_file, read_whole
from ptbench.io.line_seal import LineSeal
from ptbench.io.nodes import Node, parse, read_json, shown
from ptbench.terminal import visible

SCHEMAS = package_file("schema")
KINDS = (
    "result",
    "stability",
    "rays",
    "leaks",
    "crosscheck",
    "peers",
    "imports",
    "advice",
    "inspect",
    "tuning",
    "journal",
    "gpu-tests",
    "passport",
)
# Kinds of files that people write, such as claims: they are validated, but not described among ptbench's outputs.
WRITTEN_BY_HAND = ("claim", "map")
_BY_SCHEMA = {
    "ptbench-crosscheck-1": "crosscheck",
    "ptbench-peers-1": "peers",
    "ptbench-imports-1": "imports",
    "ptbench-advice-1": "advice",
    "ptbench-map-1": "map",
    "ptbench-gpu-tests-1": "gpu-tests",
    "ptbench-passport-1": "passport",
}
_WRITTEN_BY_US = (
    "a file of ptbench run, merge, stability, rays, inspect, autotune, crosscheck, peers or passport, of a package's "
    "gpu_tests, a run's .journal.jsonl, a claim, a map"
)


@cache
def schema(name: str) -> dict:
    """The JSON schema of a kind of file, or the `common` one that they share."""
    return json.loads((SCHEMAS / f"ptbench-{name}.schema.json").read_text(encoding="utf-8"))


@cache
def registry() -> Registry:
    """All schemas by file name: references between them are relative to one folder."""
    names = (*KINDS, *WRITTEN_BY_HAND, "common")
    return Registry().with_resources(
        (f"ptbench-{name}.schema.json", Resource.from_contents(schema(name))) for name in names
    )


@cache
def validator(kind: str) -> Draft202012Validator:
    """A validator for a kind of file."""
    # The JSON schema is referenced by its file's name, so that references within it are resolved in that file.
    return Draft202012Validator({"$ref": f"ptbench-{kind}.schema.json"}, registry=registry())


def kind_of(path: Path, value: object) -> str:
    """The kind of a parsed file, one of KINDS, by keys that only that kind has. Raises InputError for anything else."""
    if isinstance(value, list):
        return "inspect"
    if isinstance(value, dict):
        if {"schema", "claim"} <= value.keys():
            return "claim"
        if {"schema", "meshes"} <= value.keys():
            return "leaks" if value["schema"] == "ptbench-leaks-1" else "rays"
        if value.get("schema") in _BY_SCHEMA:
            return _BY_SCHEMA[value["schema"]]
        for kind, keys in (("result", {"benchmarks", "ptbench"}), ("stability", {"schema", "rows"})):
            if keys & value.keys():
                return kind
        if {"machine", "entries"} <= value.keys():
            return "tuning"
    raise bad_value(path, "$", shown(value), _WRITTEN_BY_US)


def complaints(value: object, kind: str, place: str = "$") -> Iterator[str]:
    """What is wrong with a value of a kind of file, one line each: "PLACE: found .., allowed: .."."""
    errors = validator(kind).iter_errors(value)
    # Duplicate complaints are dropped, since two rules may require the same.
    yield from dict.fromkeys(line for error in errors for line in _lines(error, place))


def journal_complaints(path: Path) -> Iterator[str]:
    """Complaints about a journal by line; an incomplete last line, cut off by a kill, is ignored."""
    whole, _, _ = read_whole(path, LARGEST_RESULT).rpartition(b"\n")
    lines = whole.split(b"\n") if whole else []
    book, seal, is_whole = JournalBook(), LineSeal(), True
    if not lines:
        yield "line 1: found nothing, allowed: a line of type run"
    for number, line in enumerate(lines, start=1):
        place = f"line {number}"
        if damage := seal.fault(line):
            is_whole = False  # after a damaged line, contradictions would be reported at wrong lines
            yield f"{place}: found {damage}, allowed: lines as ptbench wrote them"
            continue
        try:
            value, key_twice = parse(line.decode("utf-8"), _refuse)
        except (ValueError, RecursionError):
            yield f"{place}: found no valid JSON, allowed: one JSON object a line"
            continue
        if key_twice is not None:
            where, twice, allowed = key_twice
            yield f"{place} {where}: found {twice}, allowed: {allowed}"
            continue
        found = list(complaints(value, "journal", f"{place} $"))
        yield from found
        if number == 1 and isinstance(value, dict) and value.get("type") != "run":
            yield f'{place} $.type: found {shown(value.get("type"))}, allowed: "run" in the first line'
        if not found and is_whole:
            yield from map(str, book.enter(Node(path, value, f"{place} $")))


def validate(path: Path) -> list[str]:
    """All complaints about a file, in order; empty: the file is valid.

    Raises InputError for a file that cannot be read, is no JSON, or is of no kind that ptbench writes.
    """
    if path.suffix == ".jsonl":
        return list(journal_complaints(path))
    root = read_json(path)
    kind = kind_of(path, root.value)
    found = list(complaints(root.value, kind))
    results = {"result": lambda: [root], "passport": lambda: root.need("runs").items()}.get(kind, list)
    return found or [line for result in results() for line in _contradictions(result)]


def _contradictions(root: Node) -> Iterator[str]:
    try:
        yield from map(str, contradictions(root))
    except InputError as error:  # the error for a row of the result file that belongs to no cell of it
        yield str(error).removeprefix(visible(f"{root.file}: "))


def _refuse(constant: str) -> None:
    raise ValueError(constant)


def _place(error: ValidationError, start: str) -> str:
    keys = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in error.absolute_path)
    return start + "".join(keys)


def _lines(error: ValidationError, start: str) -> Iterator[str]:
    place = _place(error, start)
    if error.validator in ("required", "dependentRequired"):
        for key in _missing(error):
            yield f"{place}.{key}: found nothing, allowed: this key is required"
    elif error.validator in ("additionalProperties", "unevaluatedProperties") and error.validator_value is False:
        for key in _unknown(error):
            yield f"{place}: found the key {shown(key)}, allowed: the keys that the schema has"
    else:
        yield f"{place}: found {shown(error.instance)}, allowed: {_allowed(error)}"


def _missing(error: ValidationError) -> list[str]:
    # jsonschema reports each missing key separately, and names it only in the message.
    if error.validator == "required":
        wanted = error.validator_value
    else:
        wanted = [key for have, keys in error.validator_value.items() if have in error.instance for key in keys]
    return [key for key in wanted if key not in error.instance and error.message.startswith(repr(key))]


def _unknown(error: ValidationError) -> list[str]:
    return [key for key in error.instance if repr(key) in error.message]


def _allowed(error: ValidationError) -> str:
    """What a schema keyword allows, in words; jsonschema's message for keywords that are not listed."""
    value = error.validator_value
    names = {"object": "an object", "array": "an array", "string": "a string", "number": "a finite number"}
    names |= {"integer": "an integer", "boolean": "true or false", "null": "null"}
    texts = {
        "type": lambda: " or ".join(names[name] for name in ([value] if isinstance(value, str) else value)),
        "enum": lambda: " or ".join(json.dumps(choice) for choice in value),
        "const": lambda: json.dumps(value),
        "pattern": lambda: f"a string like {value}",
        "minimum": lambda: f"at least {value}",
        "maximum": lambda: f"at most {value}",
        "exclusiveMinimum": lambda: f"above {value}",
        "minLength": lambda: "a string that is not empty",
        "minItems": lambda: f"{value} or more",
        "maxItems": lambda: f"at most {value}",
        "uniqueItems": lambda: "each once",
        # The schema keyword `not` is used for keys that are excluded by other keys of the object.
        "not": lambda: f"none with {' and '.join(value['required'])}" if "required" in value else "no such key here",
        "anyOf": lambda: " or ".join(_allowed(inner) for inner in error.context),
        "oneOf": lambda: " or ".join(_allowed(inner) for inner in error.context),
    }
    return texts[error.validator]() if error.validator in texts else one_line(error.message)
