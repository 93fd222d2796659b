"""Writes the schemas as tables of fields: `python3 -m ptbench.io.fields > docs/result-fields.md`."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from ptbench.io.validate import KINDS, schema

_HEAD = """# Every field of the files that ptbench writes

Written by `python3 -m ptbench.io.fields` from the schemas in [schema](schema).
[results.md](results.md) is the guide.
A field that is not required is there where its meaning says so. "Since commit": files of earlier programs lack it.
`[]` is each item of an array, `NAME` each key of an object whose keys are names.
"""
_MOST_SHOWN = 9  # largest number of values up to which a schema table lists an enumeration's values
_LIMITS = {"minimum": "from", "exclusiveMinimum": "above", "maximum": "to"}


def tables() -> str:
    """All schemas as Markdown: one section per file, one table per object."""
    return _HEAD + "".join(_Schema(name).section() for name in (*KINDS, "common"))


@dataclass(frozen=True)
class Field:
    """A row of a table of schema fields."""

    path: str
    kind: str
    required: bool
    meaning: str

    def line(self) -> str:
        """The schema field as a row of Markdown."""
        cells = (f"`{self.path}`", self.kind, "yes" if self.required else "", self.meaning)
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"


@dataclass(frozen=True)
class _Schema:
    """One schema, to which references without a file name refer."""

    name: str

    def section(self) -> str:
        root = schema(self.name)
        parts = [f"\n## {self.name}\n\n{root['title']}. {root['description']}\n"]
        if "properties" in root:
            parts.append(self._table("", root))
        for key, node in root.get("$defs", {}).items():
            if node.get("deprecated"):  # a deprecated definition of the schema gets no table of its fields
                continue
            if "properties" in node:
                parts.append(self._table(key, node))
            elif len(node.get("enum", ())) > _MOST_SHOWN:
                values = ", ".join(f"`{value}`" for value in node["enum"])
                parts.append(f"\n### {self.name}: {key}\n\n{node['description']} One of {values}.\n")
        return "".join(parts)

    def _table(self, title: str, node: dict) -> str:
        also = f" With the fields of {self._link(node['$ref'])}." if "$ref" in node else ""
        about = f"### {self.name}: {title}\n\n{node['description']}{also}\n\n" if title else ""
        lines = "".join(field.line() for field in self._fields(node, ""))
        return f"\n{about}| field | type | required | meaning |\n|---|---|---|---|\n{lines}"

    def _fields(self, node: dict, prefix: str) -> Iterator[Field]:
        """The fields of an object, and of nested objects that have no table of their own."""
        for key, child in node.get("properties", {}).items():
            path = f"{prefix}{key}"
            required = key in node.get("required", ())
            yield Field(path, self._kind(child), required, self._meaning(child))
            yield from self._within(child, path)

    def _within(self, node: dict, path: str) -> Iterator[Field]:
        if isinstance(node.get("items"), dict):
            yield from self._within(node["items"], f"{path}[]")
        values = node.get("additionalProperties")
        if isinstance(values, dict):
            yield Field(f"{path}.NAME", self._kind(values), False, self._meaning(values))
            yield from self._within(values, f"{path}.NAME")
        yield from self._fields(node, f"{path}.")

    def _target(self, reference: str) -> tuple[_Schema, dict]:
        file, _, pointer = reference.partition("#/$defs/")
        name = re.fullmatch(r"ptbench-(\w+)\.schema\.json", file)[1] if file else self.name
        if not pointer:  # a schema reference without pointer means the whole file
            return _Schema(name), schema(name)
        found = schema(name)["$defs"]
        for step in pointer.split("/"):
            found = found[step]
        return _Schema(name), found

    def _link(self, reference: str) -> str:
        owner, target = self._target(reference)
        if target is schema(owner.name):
            return f"[{owner.name}](#{owner.name})"
        title = f"{owner.name}: {reference.rpartition('/')[2]}"
        return f"[{title}](#{title.replace(': ', '-')})"

    def _meaning(self, node: dict) -> str:
        if "description" in node:
            return node["description"]
        owner, target = self._target(node["$ref"])
        return owner._meaning(target)

    def _kind(self, node: dict) -> str:
        if "$ref" in node:
            owner, target = self._target(node["$ref"])
            has_table = "properties" in target or len(target.get("enum", ())) > _MOST_SHOWN
            return self._link(node["$ref"]) if has_table else owner._kind(target)
        if "const" in node:
            return f"`{json.dumps(node['const'])}`"
        if "enum" in node:
            return ", ".join(f"`{json.dumps(value)}`" for value in node["enum"])
        for word in ("anyOf", "oneOf"):
            if word in node:
                return " or ".join(self._kind(each) for each in node[word])
        if node["type"] == "array":
            items = node["items"] or node["prefixItems"][0]
            return f"array of {self._kind(items)}"
        text = " or ".join([node["type"]] if isinstance(node["type"], str) else node["type"])
        return " ".join([text, *(f"{word} {node[key]}" for key, word in _LIMITS.items() if key in node)])


if __name__ == "__main__":
    sys.stdout.write(tables())
