"""Loading: what a good file gives, and what is said of a bad one."""

from __future__ import annotations

import gzip
import json
from dataclasses import replace

import pytest
from builder import OPEN, Builder, small

from ptbench.errors import InputError
from ptbench.io.cells import NotApplicable
from ptbench.io.results import load, load_kept


def load_changed(tmp_path, change):
    """The error text for a good document after `change(document)`."""
    document = small().document()
    change(document)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError) as caught:
        load(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_good_file(tmp_path):
    result = load(small().write(tmp_path / "quick.json"))
    assert result.suite == "quick"
    assert not result.interrupted
    assert result.git == "0123abcd4567"
    assert [study.name for study in result.studies] == [
        "remaining_paths",
        "sorting_by_depth",
        "first_bounce_by_depth",
        "compaction",
        "integrator",
    ]
    cell = result.cells[0]
    assert (cell.scene, cell.depth, cell.spp, cell.resolution) == ("cornell_open", 8, 4, (200, 200))
    assert cell.axes["compaction"] == "scan"
    assert cell.instrumented.live_paths == tuple(OPEN)
    assert len(cell.samples) == 9
    assert cell.measured
    assert len(result.cells_of(result.studies[3])) == 8


def test_a_sample_is_its_wall_time_over_its_spp(tmp_path):
    builder = Builder()
    builder.cell(None, ms_per_spp=2.5, spp=8, noise=0.0, n=1)
    sample = load(builder.write(tmp_path / "one.json")).cells[0].samples[0]
    assert sample.wall_ms == pytest.approx(20.0)
    assert sample.device_ms == pytest.approx(18.0)
    assert sample.ms_per_spp == pytest.approx(2.5)
    # 4 rays a path, 200 x 200 pixels: 160000 rays in 2.5 ms.
    assert sample.mega_rays_per_second == pytest.approx(64.0)
    assert sample.mega_cycles_per_spp == pytest.approx(2.5 * 3.69)


def test_samples_come_in_order_of_repetition(tmp_path):
    builder = Builder()
    builder.cell(None, n=5)
    builder.rows.reverse()
    cell = load(builder.write(tmp_path / "shuffled.json")).cells[0]
    assert [sample.repetition for sample in cell.samples] == [0, 1, 2, 3, 4]


def test_google_benchmarks_own_suffixes_of_a_name_are_understood(tmp_path):
    builder = Builder()
    builder.cell(None, n=3)
    for row in builder.rows:
        row["run_name"] += "/iterations:1/repeats:3/manual_time"
    assert len(load(builder.write(tmp_path / "suffix.json")).cells[0].samples) == 3


def test_error_rows_make_a_cell_failed_even_if_it_calls_itself_ok(tmp_path):
    builder = Builder()
    builder.cell(None, n=2, error="out of memory", status="ok")
    cell = load(builder.write(tmp_path / "failed.json")).cells[0]
    assert cell.failed
    assert not cell.measured
    assert cell.failure == "out of memory"
    assert cell.samples == ()


def test_a_dirty_tree_shows(tmp_path):
    builder = Builder()
    builder.context["ptbench.git_dirty"] = "true"
    assert load(builder.write(tmp_path / "dirty.json")).git == "0123abcd4567 (dirty)"


def test_an_interrupted_cell_without_samples_or_counts(tmp_path):
    builder = Builder()
    builder.cell(None, n=0, status="interrupted", reason="signal 2")
    builder.context["ptbench.status"] = "interrupted"
    result = load(builder.write(tmp_path / "interrupted.json"))
    assert result.interrupted
    assert not result.cells[0].measured
    assert not result.cells[0].failed
    assert result.cells[0].instrumented is None


def set_in(*place):
    """A change of one value: set_in("ptbench", "cells", 0, "depth", "8")."""
    *keys, last, value = place

    def change(document):
        for key in keys:
            document = document[key]
        if value is KeyError:
            del document[last]
        else:
            document[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (set_in("context", KeyError), "$.context: found nothing, allowed: this key is required"),
        (set_in("ptbench", KeyError), "$.ptbench: found nothing, allowed: this key is required"),
        (set_in("benchmarks", {}), "$.benchmarks: found {}, allowed: an array"),
        (set_in("ptbench", []), "$.ptbench: found [], allowed: an object"),
        (
            set_in("context", "ptbench.schema_version", "2"),
            '$.context.ptbench.schema_version: found "2", allowed: "1"',
        ),
        (
            set_in("context", "ptbench.status", "done"),
            '$.context.ptbench.status: found "done", allowed: "completed" or "interrupted"',
        ),
        (set_in("ptbench", "cells", 0, "depth", "8"), '$.ptbench.cells[0].depth: found "8", allowed: an integer'),
        (
            set_in("ptbench", "cells", 0, "depth", 0),
            "$.ptbench.cells[0].depth: found 0, allowed: an integer of at least 1",
        ),
        (
            set_in("ptbench", "cells", 0, "spp", 2.5),
            "$.ptbench.cells[0].spp: found 2.5, allowed: an integer of at least 1",
        ),
        (set_in("ptbench", "cells", 0, "spp", True), "$.ptbench.cells[0].spp: found true, allowed: an integer"),
        (set_in("ptbench", "cells", 0, "spp", 10**400), "allowed: an integer of at least 1"),
        (set_in("ptbench", "cells", 0, "scene", ""), '.scene: found "", allowed: a string that is not empty'),
        (
            set_in("ptbench", "cells", 1, "resolution", [200]),
            "cells[1].resolution: found [200], allowed: [width, height]",
        ),
        (set_in("ptbench", "cells", 1, "axes", "sorting", 3), "cells[1].axes.sorting: found 3, allowed: a string"),
        (
            set_in("ptbench", "cells", 2, "status", "fine"),
            'cells[2].status: found "fine", allowed: "ok" or "failed" or "interrupted"',
        ),
        (set_in("ptbench", "cells", 2, "claim", "exact"), 'cells[2].claim: found "exact", allowed: "bitwise" or'),
        (set_in("ptbench", "cells", 0, "studies", ["other"]), 'studies[0]: found "other", allowed: "remaining_paths"'),
        (
            set_in("ptbench", "cells", 0, "instrumented", "live_paths", [3, -1]),
            "cells[0].instrumented.live_paths[1]: found -1, allowed: an integer of at least 0",
        ),
        (set_in("ptbench", "studies", 1, "name", "remaining_paths"), 'studies[1].name: found "remaining_paths" again'),
        (set_in("ptbench", "not_applicable", [{"variant": "a"}]), "not_applicable[0].reason: found nothing"),
        (
            set_in("benchmarks", 0, "run_name", "other"),
            '$.benchmarks[0].run_name: found "other", allowed: the name of a cell',
        ),
        (set_in("benchmarks", 0, "run_type", "x"), '$.benchmarks[0].run_type: found "x", allowed: "iteration" or'),
        (
            set_in("benchmarks", 0, "pt_wall_ms", 0),
            '$.benchmarks[0].pt_wall_ms: found 0 in the cell "wavefront.scan.',
        ),
        (set_in("benchmarks", 0, "pt_wall_ms", -1.5), 'depth:8/spp:4", allowed: a time above 0'),
        (set_in("benchmarks", 0, "pt_wall_ms", "12"), '[0].pt_wall_ms: found "12", allowed: a finite number above 0'),
        (set_in("benchmarks", 0, "pt_spp", KeyError), "[0].pt_spp: found nothing, allowed: this key is required"),
        (set_in("benchmarks", 0, "pt_wall_ms", float("nan")), "a value: found NaN, allowed: finite numbers only"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(tmp_path, change, message):
    text = load_changed(tmp_path, change)
    assert text.startswith(str(tmp_path / "bad.json"))
    assert message in text


def test_a_cell_listed_twice(tmp_path):
    def twice(document):
        document["ptbench"]["cells"].append(document["ptbench"]["cells"][0])

    assert "again, allowed: each name once" in load_changed(tmp_path, twice)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "line 1 column 1: found no valid JSON"),
        (b'{"context": {},\n "benchmarks": [', "line 2 column 17: found no valid JSON"),
        (b"[]", "$: found [], allowed: an object"),
        (b'{"context": "\xff"}', "byte 13: found bytes that are not UTF-8"),
        (b"[" * 100_000, "the file: found JSON nested too deeply"),
    ],
    ids=["empty", "cut off", "array", "latin-1", "nested"],
)
def test_files_that_are_no_json(tmp_path, content, message):
    path = tmp_path / "broken.json"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        load(path)
    assert f"{path}: {message}" in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match=r"none\.json: the file: found no such file, allowed: a regular file of at"):
        load(tmp_path / "none.json")


def test_axes_that_a_file_is_too_old_to_name_are_what_they_were(tmp_path):
    builder = Builder().study("sampler")
    builder.cell("sampler", n=9)
    builder.cell("sampler", n=9, axes={"sampler": "philox"})
    old, new = load(builder.write(tmp_path / "mixed.json")).cells
    assert list(old.axes.items())[4:7] == [("direct_light", "off"), ("russian_roulette", "off"), ("sampler", "pcg4d")]
    assert (new.axes["russian_roulette"], new.axes["sampler"]) == ("off", "philox")


def test_reasons_are_told_apart_by_their_codes_or_in_older_files_by_their_texts():
    def left_out(reason, **more):
        return NotApplicable("study", "scene", "a.b", {"launch": "graph"}, reason, **more)

    elsewhere = left_out("launch=graph is not there on the backend cpu")
    assert elsewhere.elsewhere == "launch=graph"
    assert not elsewhere.has_nothing_to_tune
    reworded = left_out("graph: another backend's", reason_code="not_on_backend", reason_axis="launch")
    assert reworded.elsewhere == "launch=graph"
    assert not reworded.has_nothing_to_tune
    tuned = left_out("jitters=4 tunes none of the variant's choices")
    assert tuned.has_nothing_to_tune
    assert not tuned.elsewhere
    assert left_out("nothing to tune", reason_code="no_such_tunable").has_nothing_to_tune
    other = left_out("x=y is not there on the backend cpu", reason_code="needs_queue", reason_axis="launch")
    assert not other.elsewhere
    assert not other.has_nothing_to_tune


def test_a_kept_result_is_read_once_and_again_where_its_bytes_are_others(tmp_path):
    path = small().write(tmp_path / "a.json")
    first = load_kept(path)
    assert load_kept(path) is first
    assert first == load(path)
    copy = tmp_path / "b.json.gz"
    copy.write_bytes(gzip.compress(path.read_bytes(), mtime=0))
    assert load_kept(tmp_path / "b.json") == load(tmp_path / "b.json") == replace(first, path=tmp_path / "b.json")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('"quick"', '"quack"'), encoding="utf-8")
    assert (first.suite, load_kept(path).suite) == ("quick", "quack")
    path.write_text(text, encoding="utf-8")
    assert load_kept(path) is first
    path.write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="this key is required"):
        load_kept(path)
