"""The files that a report covers: those named, and all results in named folders."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.cells import Result
from ptbench.io.nodes import Node, read_json
from ptbench.io.results import result_of
from ptbench.io.stability import Stability, is_stability, stability_of
from ptbench.terminal import visible

# Schemas of cross-checks, peer comparisons and leak searches: their files lie beside results, and no report shows them.
_NO_RESULTS = ("ptbench-crosscheck-", "ptbench-peers-", "ptbench-leaks-")


@dataclass(frozen=True)
class Sources:
    """The files of a report; `titles` are their shortest distinct names, `passed_over` files that are no results."""

    paths: tuple[Path, ...]
    titles: tuple[str, ...]
    passed_over: tuple[Path, ...]


def load(path: Path) -> Result | Stability:
    """Reads and checks a result of `ptbench run` or `ptbench stability`; raises InputError."""
    root = read_json(path)
    return stability_of(root) if is_stability(root) else result_of(root)


def find_sources(named: Sequence[Path]) -> Sources:
    """The result files that the names stand for; raises InputError for a name without a result."""
    paths: list[Path] = []
    passed_over: list[Path] = []
    for path in named:
        if not os.path.isdir(path):
            paths.append(path)
            continue
        inside = sorted({*path.glob("*.json"), *path.glob("*.json.gz")})
        results = [file for file in inside if _is_result(read_json(file))]
        if not results:
            raise bad_value(path, "the folder", f"{len(inside)} JSON files, none a result", "at least one result file")
        paths += results
        passed_over += [file for file in inside if file not in results]
    once = {os.path.realpath(path): path for path in reversed(paths)}
    kept = tuple(path for path in dict.fromkeys(paths) if once[os.path.realpath(path)] is path)
    return Sources(kept, tuple(_titles(kept)), tuple(dict.fromkeys(passed_over)))


def _is_result(root: Node) -> bool:
    """Whether a JSON file has the keys of a result; others in a folder are skipped, but broken results are errors."""
    value = root.value
    if not isinstance(value, dict):
        return False
    if str(value.get("schema", "")).startswith(_NO_RESULTS):
        return False
    return "schema" in value or {"benchmarks", "ptbench"} <= value.keys()


def _titles(paths: Sequence[Path]) -> list[str]:
    """Titles for files, such as "compaction", or "nvidia-h200/compaction" where two files share a name."""
    names = [
        [*Path(os.path.realpath(path)).parent.parts, visible(path.name.removesuffix(".gz").removesuffix(".json"))]
        for path in paths
    ]
    titles = []
    for name in names:
        length = 1
        while length < len(name) and sum(other[-length:] == name[-length:] for other in names) > 1:
            length += 1
        titles.append("/".join(name[-length:]))
    return titles
