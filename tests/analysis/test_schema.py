"""The JSON Schemas: they hold for every committed file and for fresh ones, and refuse what is wrong."""

from __future__ import annotations

import copy
import json
import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from builder import rates_named, small
from conftest import RESULTS, ROOT, committed, stored_text
from jsonschema import Draft202012Validator

from ptbench.io.cells import CELL_STATUSES, CLAIMS, RUN_STATUSES, STUDY_TYPES
from ptbench.io.fields import tables
from ptbench.io.files import read_stored
from ptbench.io.line_seal import NO_CHECKSUM, OTHER_TEXT, LineSeal
from ptbench.io.validate import KINDS, SCHEMAS, complaints, kind_of, registry, schema, validate, validator

BY_HAND = ("many_lights_profile", "nee_bound", "rays_cpu", "rays_first")  # records that no command of ptbench wrote
COMMITTED = sorted(path for path in RESULTS.glob("*/*.json*") if path.name.partition(".")[0] not in BY_HAND)
BINARY = ROOT / "build" / "ptbench"
CELL = (
    "wavefront.none.none.material.off.off.off.pcg4d.aos.features.stream.exact.float.robust"
    "/scene:edge/backend:cpu/resolution:8x8/depth:2/spp:1"
)
_LISTS_OF_MANY = ("benchmarks", "rows", "cells", "not_applicable", "cases", "pt_checkpoints")


def shape(value: object) -> object:
    """The keys, statuses and JSON types of a value, without its numbers and texts."""
    if isinstance(value, dict):
        kept = {"status", "run_type", "kind", "backend", "claim"}
        return tuple((key, inner if key in kept else shape(inner)) for key, inner in value.items())
    if isinstance(value, list):
        return tuple(sorted({repr(shape(item)) for item in value}))
    return type(value).__name__


def thinned(value: object, key: str = "") -> object:
    """`value` with one of each shape in its long lists."""
    if isinstance(value, dict):
        return {name: thinned(inner, name) for name, inner in value.items()}
    if isinstance(value, list) and key in _LISTS_OF_MANY:
        return [thinned(item) for item in {shape(item): item for item in value}.values()]
    return value


def nodes(node: object, place: str) -> Iterator[tuple[str, dict]]:
    """Every object within a schema, with where it stands."""
    if isinstance(node, dict):
        yield place, node
    for key, inner in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
        yield from nodes(inner, f"{place}/{key}")


@pytest.mark.parametrize("name", [*KINDS, "common"])
def test_a_schema_describes_every_field_and_allows_no_other(name):
    own = schema(name)
    Draft202012Validator.check_schema(own)
    for place, node in nodes(own, name):
        for key, field in node.get("properties", {}).items() if node.get("type") == "object" else ():
            assert "description" in field or "$ref" in field, f"{place}: {key}"
        # A row is closed, and what it may be is not; a sample is closed in a row and in a journal's line.
        parts = ("cell_facts", "sample", "sample_row", "aggregate_row", "failed_row")
        open_on_purpose = place in (*(f"result/$defs/{part}" for part in parts), "common/$defs/machine", "journal")
        if node.get("type") == "object" and not open_on_purpose:
            assert "additionalProperties" in node or node.get("unevaluatedProperties") is False, place


def test_the_documented_tables_are_those_of_the_schemas():
    written = (ROOT / "docs" / "result-fields.md").read_text(encoding="utf-8")
    assert written == tables(), "python3 -m ptbench.io.fields > docs/result-fields.md"
    assert (ROOT / "docs" / "schema").resolve() == SCHEMAS.resolve()


def test_the_names_that_are_read_are_those_of_the_schema():
    own = schema("result")["$defs"]
    assert own["cell_facts"]["properties"]["status"]["enum"] == list(CELL_STATUSES)
    assert own["cell"]["properties"]["claim"]["enum"] == list(CLAIMS)
    assert own["study"]["properties"]["type"]["enum"] == list(STUDY_TYPES)
    assert schema("common")["$defs"]["run_status"]["enum"] == list(RUN_STATUSES)


def test_lists_are_thinned_to_one_of_each_shape():
    rows = [{"a": 1}, {"a": 2}, {"a": 1.5}, {"a": 1, "b": []}]
    assert thinned({"rows": rows, "options": [1, 1]}) == {"rows": [{"a": 2}, {"a": 1.5}, rows[3]], "options": [1, 1]}


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_committed_files_are_valid(path):
    name, data = read_stored(path, 1 << 30)
    value = thinned(json.loads(data))
    assert list(complaints(value, kind_of(name, value))) == []


@pytest.fixture(scope="module")
def ptbench(tmp_path_factory):
    """Runs the built program on the CPU: (exit code, the file that it wrote)."""
    if not BINARY.is_file():
        pytest.skip("build/ptbench is not there")
    folder = tmp_path_factory.mktemp("fresh")

    def run(name: str, *arguments: str) -> Path:
        environment = {**os.environ, "PTBENCH_HOME": str(ROOT), "XDG_CACHE_HOME": str(folder / "cache")}
        command = [BINARY, *arguments, "--backend", "cpu", "--out", folder / name]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return folder / name

    return run


@pytest.fixture(scope="module")
def fresh(ptbench) -> dict:
    """A result with one cell and something that does not apply."""
    size = ("--resolution", "8x8", "--depth", "2", "--spp", "1", "--repetitions", "2")
    path = ptbench("run.json", "run", "--scene", "cornell_open", "--axis", "first_bounce=off,cached", *size)
    assert validate(path) == []
    return json.loads(path.read_text(encoding="utf-8"))


def test_a_fresh_run_is_valid(fresh):
    assert {row["run_type"] for row in fresh["benchmarks"]} == {"iteration", "aggregate"}
    assert fresh["ptbench"]["cells"]
    assert fresh["ptbench"]["not_applicable"]


def test_a_fresh_study_of_errors_is_valid(ptbench, tmp_path):
    study = {"name": "errors", "title": "Errors", "type": "convergence", "figure": "convergence", "scenes": ["edge"]}
    study |= {"axes": {"sampler": ["pcg4d", "sobol_owen"]}, "resolution": [8, 8], "depth": 1, "spp": 4, "images": True}
    study["reference"] = {"variance": 1, "most_spp": 64}
    suite = tmp_path / "tiny.json"
    suite.write_text(json.dumps({"name": "tiny", "description": "", "repetitions": 8, "studies": [study]}))
    path = ptbench("errors.json", "run", "--suite", str(suite))
    assert validate(path) == []
    assert '"pt_checkpoints"' in path.read_text(encoding="utf-8")


def test_a_fresh_stability_file_is_valid(ptbench):
    path = ptbench("stability.json", "stability", "--case", "lamp", "--quick", "--paths", "1024", "--quiet")
    assert validate(path) == []
    assert any("health" in row for row in json.loads(path.read_text(encoding="utf-8"))["rows"])


def _first(value: dict, kind: str) -> dict:
    return next(row for row in value["benchmarks"] if row["run_type"] == kind)


def _committed(name: str) -> dict:
    return thinned(committed(name))


@pytest.fixture(scope="module")
def errors_file() -> dict:
    return thinned(json.loads(stored_text(Path(__file__).parent / "parts_of_results" / "failed_cells.json")))


# What is done to a good file, and the line that must come of it.
RESULT_FAULTS = {
    "a cell without film_hash": (
        lambda v: v["ptbench"]["cells"][0].pop("film_hash"),
        "$.ptbench.cells[0].film_hash: found nothing, allowed: this key is required",
    ),
    "a checkpoint without film_hash": (
        lambda v: v["benchmarks"][0]["pt_checkpoints"][0].pop("film_hash"),
        "$.benchmarks[0].pt_checkpoints[0].film_hash: found nothing, allowed: this key is required",
    ),
    "a checkpoint without shared": (
        lambda v: v["benchmarks"][0]["pt_checkpoints"][0].pop("shared"),
        "$.benchmarks[0].pt_checkpoints[0].shared: found nothing, allowed: this key is required",
    ),
    "a status of its own": (
        lambda v: v["ptbench"]["cells"][0].update(status="good"),
        '$.ptbench.cells[0].status: found "good", allowed: "ok" or "failed" or "interrupted"',
    ),
    "a cell that is ok and says why not": (
        lambda v: v["ptbench"]["cells"][0].update(reason="too slow"),
        '$.ptbench.cells[0].reason: found "too slow", allowed: ""',
    ),
    "a cuda cell without its kernels": (
        lambda v: v["ptbench"]["cells"][0].pop("cuda"),
        "$.ptbench.cells[0].cuda: found nothing, allowed: this key is required",
    ),
    "an unknown key of a sample": (
        lambda v: v["benchmarks"][0].update(pt_joules=1),
        '$.benchmarks[0]: found the key "pt_joules", allowed: the keys that the schema has',
    ),
    "an unknown key of a cell": (
        lambda v: v["ptbench"]["cells"][0].update(mood="fine"),
        '$.ptbench.cells[0]: found the key "mood", allowed: the keys that the schema has',
    ),
    "an unknown key of the context": (
        lambda v: v["context"].update({"ptbench.cuda_joules": "1"}),
        '$.context: found the key "ptbench.cuda_joules", allowed: the keys that the schema has',
    ),
    "an unknown key of the file": (
        lambda v: v.update(notes=[]),
        '$: found the key "notes", allowed: the keys that the schema has',
    ),
    "a context of cuda without its device": (
        lambda v: v["context"].pop("ptbench.cuda_device"),
        "$.context.ptbench.cuda_device: found nothing, allowed: this key is required",
    ),
    "a negative time": (
        lambda v: v["benchmarks"][0].update(pt_wall_ms=-1.0),
        "$.benchmarks[0].pt_wall_ms: found -1.0, allowed: above 0",
    ),
    "a number in a string": (
        lambda v: v["benchmarks"][0].update(pt_rays="7"),
        '$.benchmarks[0].pt_rays: found "7", allowed: an integer',
    ),
    "a sample without its time": (
        lambda v: v["benchmarks"][0].pop("real_time"),
        "$.benchmarks[0].real_time: found nothing, allowed: this key is required",
    ),
    "a clock that is neither measured nor unknown": (
        lambda v: v["benchmarks"][0].pop("pt_clock_mhz_after"),
        "$.benchmarks[0].pt_clock_mhz_after: found nothing, allowed: this key is required",
    ),
    "an unknown clock with a clock": (
        lambda v: (
            v["benchmarks"][0].update(pt_clock_unknown=1, pt_clock_mhz_after=3590.0),
            v["benchmarks"][0].pop("pt_clock_mhz_before"),
        ),
        "$.benchmarks[0].pt_clock_mhz_after: found 3590.0, allowed: no such key here",
    ),
    "an aggregate of another kind": (
        lambda v: _first(v, "aggregate").update(aggregate_name="max"),
        'aggregate_name: found "max", allowed: "mean" or "median" or "stddev" or "cv"',
    ),
    "a failed row with a time": (
        lambda v: next(row for row in v["benchmarks"] if "error_occurred" in row).update(real_time=1.0),
        "real_time: found 1.0, allowed: 0",
    ),
    "a hash that is none": (
        lambda v: v["ptbench"]["cells"][0].update(scene_hash="0x12"),
        '$.ptbench.cells[0].scene_hash: found "0x12", allowed: a string like ^[0-9a-f]{16}$',
    ),
    "a rendered reference without its spp": (
        lambda v: next(
            cell["convergence"]["reference"].pop("spp_per_half")
            for cell in v["ptbench"]["cells"]
            if cell.get("convergence", {}).get("reference", {}).get("kind") == "rendered"
        ),
        "convergence.reference.spp_per_half: found nothing, allowed: this key is required",
    ),
    "a shard without its positions": (
        lambda v: v["ptbench"].update(
            run={"identity": "0" * 16, "seed": 1, "repetitions": 8, "scenes": {}, "references": "0" * 16, "cells": 1}
            | {"cells_hash": "0" * 16, "sessions": [], "shard": "1/2"}
        ),
        "$.ptbench.run.positions: found nothing, allowed: this key is required",
    ),
}


@pytest.mark.parametrize("name", RESULT_FAULTS)
def test_a_wrong_result_is_refused(errors_file, name):
    fault, line = RESULT_FAULTS[name]
    value = copy.deepcopy(errors_file)
    fault(value)
    assert next(complaints(value, "result")).endswith(line)


def test_a_clock_that_no_core_has_is_refused(errors_file):
    """A chain of additions that the core folds said 19,108 MHz of one that ran at 3,590."""
    value = copy.deepcopy(errors_file)
    value["benchmarks"][0]["pt_clock_mhz_before"] = 19108.0
    assert list(complaints(value, "result")) == [
        "$.benchmarks[0].pt_clock_mhz_before: found 19108.0, allowed: at most 10000"
    ]


def test_what_a_run_without_a_clock_writes_is_valid(errors_file):
    value = copy.deepcopy(errors_file)
    value["context"]["ptbench.clock"] = "chains of dependent additions and multiplications"
    row = value["benchmarks"][0]
    row |= {"pt_clock_unknown": 1, "film_hash": "0123456789abcdef"}
    del row["pt_clock_mhz_before"], row["pt_clock_mhz_after"]
    known = [row for row in value["benchmarks"] if row["run_type"] == "iteration" and "error_occurred" not in row][1]
    known["pt_clock_unknown"] = 0
    assert list(complaints(value, "result")) == []


INSPECTED = [path for path in COMMITTED if path.stem.startswith("inspect_")]


@pytest.mark.parametrize("word", ["per", "a"])
@pytest.mark.parametrize("path", INSPECTED, ids=lambda path: path.stem)
def test_an_inspect_file_is_valid_by_either_word(path, word):
    value = committed(path.relative_to(RESULTS).as_posix())
    if word == "a" and "variant_id" in value[0]:
        return  # a newer key: no file of the former words has it
    value = rates_named(value, word)
    assert f"threads_{word}_block" in value[0]["kernels"][0]
    assert list(complaints(value, "inspect")) == []


def _rates() -> list[tuple[str, str]]:
    """The fields X_per_Y: (where in a report, name)."""
    own = schema("inspect")["$defs"]
    objects = {"kernels[0]": own["kernel"], "kernels[0].counters": own["counters"]}
    objects |= {"ceilings": own["ceilings"]}
    return [(place, key) for place, node in objects.items() for key in node["properties"] if "_per_" in key]


@pytest.mark.parametrize("word", ["per", "a"])
@pytest.mark.parametrize(("place", "name"), _rates())
def test_an_inspect_file_has_one_word_and_every_field(place, name, word):
    value = rates_named(_committed("nvidia-h200/inspect_cornell_open_45.json")[:2], word)
    name, other = (name.replace("_per_", f"_{each}_") for each in (word, {"per": "a", "a": "per"}[word]))
    report = value[1]
    node = {"kernels[0]": report["kernels"][0], "ceilings": report["ceilings"]}.get(place)
    node = report["kernels"][0]["counters"] if node is None else node
    number = node.pop(name)
    missing = f"$[1].{place}.{name}: found nothing, allowed: this key is required"
    assert list(complaints(value, "inspect")) == [missing]
    node[other] = number
    unknown = f'$[1].{place}: found the key "{other}", allowed: the keys that the schema has'
    assert set(complaints(value, "inspect")) == {missing, unknown}
    node[name] = number
    assert list(complaints(value, "inspect")) == [unknown]


@pytest.mark.parametrize("words", [("per", "a"), ("a", "per")])
def test_reports_of_one_inspect_file_have_one_word(words):
    value = _committed("nvidia-h200/inspect_cornell_open_45.json")[:2]
    found = list(complaints([rates_named(each, word) for each, word in zip(value, words, strict=True)], "inspect"))
    assert len(found) == 2 * len(_rates())
    assert all(line.startswith("$[1].") for line in found)


@pytest.mark.parametrize("word", ["per", "a"])
@pytest.mark.parametrize(
    ("fault", "line"),
    [
        (
            lambda v: v[0]["kernels"][0].update(registers=256),
            "$[0].kernels[0].registers: found 256, allowed: at most 255",
        ),
        (lambda v: v[0].update(kernels=[]), "$[0].kernels: found [], allowed: 1 or more"),
        (lambda v: v[0].pop("spp"), "$[0].spp: found nothing, allowed: this key is required"),
        (lambda v: v[0]["kernels"][0]["counters"].update(bound="l3"), '$[0].kernels[0].counters.bound: found "l3", '),
        (lambda v: v.clear(), "$: found [], allowed: 1 or more"),
    ],
    ids=["registers", "no kernels", "no spp", "bound", "empty"],
)
def test_a_wrong_inspect_file_is_refused(fault, line, word):
    value = rates_named(_committed("nvidia-h200/inspect_cornell_open_45.json")[:1], word)
    fault(value)
    assert next(complaints(value, "inspect")).startswith(line)


def test_the_schema_of_inspect_has_the_rates_that_ptbench_writes():
    sources = ("backend.cpp", "inspect.cpp", "profile.cpp")
    text = "".join((ROOT / "harness" / "cuda" / name).read_text(encoding="utf-8") for name in sources)
    written = re.findall(r'\{"(\w+_per_(?:ray|block|multiprocessor|second))",', text)
    assert sorted(written) == sorted(name for _, name in _rates())


def test_the_tables_have_each_rate_once_and_say_once_what_it_was():
    text = tables().partition("\n## inspect\n")[2].partition("\n## tuning\n")[0]
    for _, name in _rates():
        assert len(re.findall(rf"^\| `(?:ceilings\.)?{name}` \|", text, re.MULTILINE)) == 1
    assert text.count("`X_a_Y`") == 1
    assert "former_" not in text


STABILITY_FAULTS = {
    "a status of its own": (lambda row: row.update(status="skipped"), '.status: found "skipped", allowed: "passed"'),
    "a known limit without its reason": (lambda row: row.update(status="known limit"), ".reason: found nothing"),
    "a quantity without what is exact": (lambda row: row.pop("exact"), ".exact: found nothing"),
    "a word that is no number": (lambda row: row.update(measured="big"), '.measured: found "big", allowed: a finite'),
    "an unknown key": (lambda row: row.update(mood=1), ': found the key "mood"'),
}


@pytest.mark.parametrize("name", STABILITY_FAULTS)
def test_a_wrong_stability_row_is_refused(name):
    fault, text = STABILITY_FAULTS[name]
    value = _committed("nvidia-h200/stability_segments.json")
    value["rows"] = [row for row in value["rows"] if row["status"] == "passed"][:1]
    assert list(complaints(value, "stability")) == []
    fault(value["rows"][0])
    assert any(line.startswith(f"$.rows[0]{text}") for line in complaints(value, "stability"))


@pytest.fixture
def journal(errors_file, tmp_path):
    """Writes a journal of one cell with what `change` does to its lines."""
    common = {key: value for key, value in errors_file["context"].items() if key.startswith("ptbench.")}
    machine = {
        key: value for key, value in common.items() if key.rpartition(".")[2] not in ("suite", "command_line", "status")
    }
    machine.pop("ptbench.backend")
    identity = {"machine": machine, "host_name": "vm", "suite": "adhoc", "backend": "cpu", "seed": 1, "repetitions": 2}
    identity |= {"scenes": {"edge": "0" * 16}, "references": {}, "cells": [CELL]}
    row = _first(errors_file, "iteration")
    sample = {key: value for key, value in row.items() if key.startswith("pt_")} | {"pt_seed": 1}
    for derived in ("pt_low_clock", "pt_contended", "pt_checkpoints"):
        sample.pop(derived, None)
    lines = [
        {"type": "run", "identity": identity},
        {"type": "session", "facts": {"date": "2026-01-02T03:04:05+0000", "host_name": "vm", "process": 7}},
        {"type": "cell", "cell": CELL, "facts": {"status": "failed", "reason": "it threw"}},
        {"type": "sample", "cell": CELL, "sample": {**sample, "cpu_ms": 1.0, "film_hash": "0" * 16}},
    ]

    def write(change=lambda lines: None, end: bytes = b"\n", more: tuple[bytes, ...] = ()) -> Path:
        change(lines)
        path, seal = tmp_path / "result.json.journal.jsonl", LineSeal()
        texts = (*(json.dumps(line).encode() for line in lines), *more)
        path.write_bytes(b"\n".join(map(seal.seal, texts)) + end)
        return path

    return write


@pytest.fixture
def with_joules(tmp_path, monkeypatch):
    """The schemas with one more field of a sample, said where a new field is: in the result's schema, once."""
    for path in SCHEMAS.glob("*.json"):
        text = path.read_text(encoding="utf-8")
        if path.name == "ptbench-result.schema.json":
            place = '    "sample": {\n'
            head, _, rest = text.partition(place)
            field = '        "pt_joules": {"type": "number", "description": "Energy, J."},\n'
            text = head + place + rest.replace('"properties": {\n', f'"properties": {{\n{field}', 1)
        (tmp_path / path.name).write_text(text, encoding="utf-8")
    caches = (schema, registry, validator)
    monkeypatch.setattr("ptbench.io.validate.SCHEMAS", tmp_path)
    for cache in caches:
        cache.cache_clear()
    yield
    monkeypatch.undo()
    for cache in caches:
        cache.cache_clear()


def _spend(lines: list[dict]) -> None:
    """Adds energy to the samples of a journal, and a sample that is taken again."""
    lines[3]["sample"]["pt_joules"] = 1.5
    lines.append({**copy.deepcopy(lines[3]), "type": "retake"})


def _with_energy(result: dict, journal: Path) -> dict:
    """The result with energy in a row and in a sample whose place another took."""
    value = copy.deepcopy(result)
    value["benchmarks"][0]["pt_joules"] = 1.5
    sample = json.loads(journal.read_text(encoding="utf-8").splitlines()[3])["sample"]
    retaken = {"cell": value["benchmarks"][0]["run_name"], "repetition_index": 0, "sample": sample}
    value["ptbench"]["retakes"] = {"most_per_cell": 1, "samples": [retaken]}
    return value


def test_a_new_field_of_a_sample_is_known_in_rows_and_journals(errors_file, journal, with_joules):
    assert validate(journal(_spend)) == []
    assert list(complaints(_with_energy(errors_file, journal(_spend)), "result")) == []


def test_a_field_of_a_sample_that_no_schema_has_is_refused(errors_file, journal):
    unknown = 'found the key "pt_joules", allowed: the keys that the schema has'
    assert [line.partition(": ")[2] for line in validate(journal(_spend))] == [unknown] * 2
    places = {
        line.removesuffix(f": {unknown}") for line in complaints(_with_energy(errors_file, journal(_spend)), "result")
    }
    assert places == {"$.benchmarks[0]", "$.ptbench.retakes.samples[0].sample"}


def test_a_field_of_a_sample_stands_in_one_schema():
    """Three files have a field of a sample: its struct, what measures it, and the schema of results."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in SCHEMAS.glob("*.json")}
    own = schema("result")["$defs"]
    fields = own["sample"]["properties"].keys() - own["checkpoint"]["properties"].keys()
    assert {name for name, text in texts.items() for key in fields if f'"{key}":' in text} == {
        "ptbench-result.schema.json"
    }
    assert own["sample"]["properties"].keys() & own["sample_row"]["properties"].keys() == {"pt_checkpoints"}


def _add_sample(lines: list[dict], **changed) -> None:
    lines.append(copy.deepcopy(lines[3]))
    lines[-1]["sample"] |= changed


JOURNAL_FAULTS = {
    "a sample twice": (
        _add_sample,
        f'line 5 $.sample.pt_seed: found 1, which line 4 $.sample has, in the cell "{CELL}", allowed: '
        "each sample of a cell once",
    ),
    "a sample that is missing": (
        lambda lines: _add_sample(lines, pt_seed=3),
        f'line 5 $.sample.pt_seed: found 3 in the cell "{CELL}", allowed: 2, its next sample\'s',
    ),
    "a sample too many": (
        lambda lines: (_add_sample(lines, pt_seed=2), _add_sample(lines, pt_seed=3)),
        f'line 6 $.sample: found sample 2 of the cell "{CELL}", allowed: samples 0 to 1: 2 were asked for',
    ),
    "a time that is none": (
        lambda lines: lines[3]["sample"].update(pt_wall_ms=0),
        "line 4 $.sample.pt_wall_ms: found 0, allowed: above 0",
    ),
    "a retake of no sample": (
        lambda lines: lines.append({**copy.deepcopy(lines[3]), "type": "retake"})
        or lines[4]["sample"].update(pt_seed=2),
        f'line 5 $.sample.pt_seed: found 2 in the cell "{CELL}", allowed: a seed of one of its samples',
    ),
    "a retake with another film": (
        lambda lines: lines.append({**copy.deepcopy(lines[3]), "type": "retake"})
        or lines[4]["sample"].update(film_hash="1" * 16),
        f'line 5 $.sample.film_hash: found "{"1" * 16}" in the cell "{CELL}", allowed: "{"0" * 16}", the film of the '
        "same seed before",
    ),
    "a second run": (
        lambda lines: lines.append(lines[0]),
        'line 5 $.type: found "run" again, allowed: one run a journal',
    ),
    "an unknown clock with a clock": (
        lambda lines: (
            lines[3]["sample"].update(pt_clock_unknown=1, pt_clock_mhz_before=3590.0),
            lines[3]["sample"].pop("pt_clock_mhz_after"),
        ),
        "line 4 $.sample.pt_clock_mhz_before: found 3590.0, allowed: no such key here",
    ),
    "a sample without film_hash": (
        lambda lines: lines[3]["sample"].pop("film_hash"),
        "line 4 $.sample.film_hash: found nothing, allowed: this key is required",
    ),
    "a status of its own": (
        lambda lines: lines[2]["facts"].update(status="good"),
        'line 3 $.facts.status: found "good", allowed: "ok" or "failed" or "interrupted"',
    ),
    "an unknown key": (
        lambda lines: lines[1]["facts"].update(mood=1),
        'line 2 $.facts: found the key "mood", allowed: the keys that the schema has',
    ),
    "no line of the run": (
        lambda lines: lines.pop(0),
        'line 1 $.type: found "session", allowed: "run" in the first line',
    ),
    "a line of another type": (
        lambda lines: lines[1].update(type="note"),
        'line 2 $.type: found "note", allowed: "run" or "session" or "cell" or "sample" or "retake"',
    ),
}


@pytest.mark.parametrize("name", JOURNAL_FAULTS)
def test_a_wrong_journal_is_refused(journal, name):
    fault, line = JOURNAL_FAULTS[name]
    assert validate(journal(fault)) == [line]


def test_a_journal_is_read_line_by_line(journal, tmp_path):
    assert validate(journal()) == []
    assert validate(journal(end=b'\n{"type": "sam')) == []  # cut off by a kill
    assert validate(journal(more=(b'{"type": "sam}',))) == [
        "line 5: found no valid JSON, allowed: one JSON object a line"
    ]
    assert validate(journal(lambda lines: lines.append({**copy.deepcopy(lines[3]), "type": "retake"}))) == []
    empty = tmp_path / "empty.jsonl"
    empty.touch()
    assert validate(empty) == ["line 1: found nothing, allowed: a line of type run"]


def test_a_changed_line_of_a_journal_is_named_once(journal):
    path = journal()
    whole = path.read_bytes()
    for at in range(0, len(whole) - 1, 23):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        found = validate(path)[0]
        line = 1 + whole.count(b"\n", 0, at)
        assert found.startswith(f"line {line}: found "), at
        assert found.endswith(", allowed: lines as ptbench wrote them"), at
    changed = whole.replace(b'"pt_wall_ms": ', b'"pt_wall_ms": 1')
    path.write_bytes(changed)
    assert validate(path) == [f"line 4: found {OTHER_TEXT}, allowed: lines as ptbench wrote them"]
    path.write_bytes(whole.replace(b'"process": 7', b'"process": 8'))  # told once, though lines follow
    assert validate(path) == [f"line 2: found {OTHER_TEXT}, allowed: lines as ptbench wrote them"]


def test_a_damaged_sample_is_told_once_though_others_follow(journal):
    path = journal(lambda lines: [_add_sample(lines, pt_seed=2)])
    path.write_bytes(path.read_bytes().replace(b'"pt_seed": 1', b'"pt_seed": 7'))
    assert validate(path) == [f"line 4: found {OTHER_TEXT}, allowed: lines as ptbench wrote them"]


def test_a_journals_line_that_is_lost_or_twice_is_found(journal):
    path = journal()
    lines = path.read_bytes().splitlines(keepends=True)
    for order, line in (((0, 2, 3), 2), ((0, 1, 2, 2, 3), 4), ((0, 1, 3, 2), 3)):
        path.write_bytes(b"".join(lines[index] for index in order))
        assert validate(path)[0] == f"line {line}: found {OTHER_TEXT}, allowed: lines as ptbench wrote them"
    path.write_bytes(b"".join(json.dumps({"type": "run"}).encode() + b"\n" for _ in lines))
    assert validate(path)[0] == f"line 1: found {NO_CHECKSUM}, allowed: lines as ptbench wrote them"


def test_the_command_says_one_line_a_file(analysis, tmp_path):
    packet = committed("amd-epyc-2-threads/packet.json")
    good, bad, other = (tmp_path / f"{name}.json" for name in ("good", "bad", "other"))
    good.write_text(json.dumps(packet), encoding="utf-8")
    wrong = copy.deepcopy(packet)
    wrong["benchmarks"][0] |= {"pt_wall_ms": -1, "pt_joules": 1}
    bad.write_text(json.dumps(wrong), encoding="utf-8")
    other.write_text('{"name": "quick"}', encoding="utf-8")
    assert analysis("validate", good) == (0, f"{good}: good\n", "")
    code, out, err = analysis("validate", good, bad)
    first = f"{bad}: $.benchmarks[0].pt_wall_ms: found -1, allowed: above 0 (and 1 more)"
    assert (code, out.splitlines(), err) == (1, [f"{good}: good", first], "")
    code, out, err = analysis("validate", other, tmp_path / "nothing.json", bad, good)
    assert (code, out.splitlines(), len(err.splitlines())) == (2, [first, f"{good}: good"], 2)
    assert f'{other}: $: found {{"name": "quick"}}, allowed: a file of ptbench run, merge' in err


def test_what_the_other_tests_read_is_what_ptbench_writes(tmp_path):
    """The builder of other tests leaves keys out, but writes none that ptbench does not."""
    found = validate(small().write(tmp_path / "small.json"))
    assert [line for line in found if "found the key" in line] == []
