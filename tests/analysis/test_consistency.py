"""Results that contradict themselves are refused, by every command that loads them; what a stopped run left is not."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from builder import Builder
from conftest import RESULTS, committed

from ptbench.errors import InputError
from ptbench.io.consistency import contradictions
from ptbench.io.line_seal import LineSeal
from ptbench.io.nodes import Node, read_json
from ptbench.io.results import load
from ptbench.io.validate import validate
from ptbench.studies.disturbed import disturbance_in

COMMITTED = sorted(RESULTS.glob("*/*.json*"))
PACKET = committed("amd-epyc-2-threads/packet.json")


def cells_of(document: dict) -> list[dict]:
    return document["ptbench"]["cells"]


def samples_of(document: dict, cell: int = 0) -> list[dict]:
    name = cells_of(document)[cell]["cell"]
    return [row for row in document["benchmarks"] if row["run_name"] == name and row["run_type"] == "iteration"]


def drop(document: dict, *rows: dict) -> None:
    document["benchmarks"] = [row for row in document["benchmarks"] if not any(row is one for one in rows)]


def add_films(document: dict) -> None:
    """What a program of today writes: the hash of each sample's film. The first is the instrumented pass's here."""
    for index, cell in enumerate(cells_of(document)):
        assert cell["instrumented"]["spp"] == cell["spp"]
        for row in samples_of(document, index):
            row["film_hash"] = cell["film_hash"] if row["pt_seed"] == 1 else f"{row['pt_seed']:016x}"


def spoil_film(document: dict) -> None:
    add_films(document)
    samples_of(document, 1)[2]["film_hash"] = "f" * 16


def retake_first(document: dict, **changed) -> None:
    """Notes in the file that its first sample was taken again; `changed` is in what the sample was before."""
    add_films(document)
    row = samples_of(document)[0]
    sample = {key: row[key] for key in row if key.startswith("pt_")} | {"film_hash": row["film_hash"]}
    for derived in ("pt_low_clock", "pt_contended"):
        sample.pop(derived)
    place = {"cell": changed.pop("cell", row["run_name"]), "repetition_index": changed.pop("repetition_index", 0)}
    document["ptbench"]["retakes"] = {"most_per_cell": 9, "samples": [{**place, "sample": {**sample, **changed}}]}


def copy_sample(document: dict, **changed) -> None:
    twin = samples_of(document)[0] | changed
    document["benchmarks"].insert(1, twin)


def median_of(document: dict) -> dict:
    name = cells_of(document)[0]["cell"]
    medians = (row for row in document["benchmarks"] if row.get("aggregate_name") == "median")
    return next(row for row in medians if row["run_name"] == name)


# What is done to a good file, and what the line has to say; CELL: the first cell's name, OTHER: the second's.
FAULTS: dict[str, tuple[Callable[[dict], object], tuple[str, ...]]] = {
    "a sample twice": (
        copy_sample,
        ("$.benchmarks[1].repetition_index: found 0, which $.benchmarks[0] has, in the cell CELL", "each sample"),
    ),
    "a sample twice under another index": (
        lambda d: copy_sample(d, repetition_index=99),
        ("$.benchmarks[1].pt_seed: found 1, which $.benchmarks[0] has, in the cell CELL",),
    ),
    "a place in time twice": (
        lambda d: copy_sample(d, repetition_index=99, pt_seed=99),
        ("$.benchmarks[1].pt_order: found", "which $.benchmarks[0] has, in the cell CELL"),
    ),
    "the last sample missing": (
        lambda d: drop(d, samples_of(d)[-1]),
        ("$.ptbench.cells[0]: found no sample 8 of the cell CELL, which is ok and has 8, allowed: samples 0 to 8",),
    ),
    "samples missing between": (
        lambda d: drop(d, *samples_of(d)[2:7]),
        ("$.ptbench.cells[0]: found no sample 2, 3, 4 and 2 more of the cell CELL",),
    ),
    "ok without samples": (
        lambda d: drop(d, *samples_of(d)),
        ("$.ptbench.cells[0]: found no sample of the cell CELL, which is ok, allowed: all of its repetitions",),
    ),
    "a gap in what a stopped run left": (
        lambda d: (
            drop(d, *samples_of(d)[2:3], *samples_of(d)[5:]),
            cells_of(d)[0].update(status="interrupted", reason="the run ended"),
            d["context"].update({"ptbench.status": "interrupted"}),
        ),
        ("$.ptbench.cells[0]: found no sample 2 of the cell CELL, which is interrupted and has 4",),
    ),
    "a cell stopped in a run that was not": (
        lambda d: (
            drop(d, *samples_of(d)[5:]),
            cells_of(d)[0].update(status="interrupted", reason="the run ended"),
        ),
        ("$.ptbench.cells[0].status: found the cell CELL interrupted, allowed: ok or failed: the run is completed",),
    ),
    "a sample taken again that is not there": (
        lambda d: retake_first(d, repetition_index=9),
        ("$.ptbench.retakes.samples[0].repetition_index: found 9 in the cell CELL", "the index of one of its samples"),
    ),
    "a sample taken again with another seed": (
        lambda d: retake_first(d, pt_seed=7),
        ("$.ptbench.retakes.samples[0].sample.pt_seed: found 7, allowed: 1, as in the sample that took its place",),
    ),
    "a sample taken again with another film": (
        lambda d: retake_first(d, film_hash="f" * 16),
        ('$.ptbench.retakes.samples[0].sample.film_hash: found "ffffffffffffffff"', "that took its place"),
    ),
    "a sample taken again without a time": (
        lambda d: retake_first(d, pt_wall_ms=0),
        ("$.ptbench.retakes.samples[0].sample.pt_wall_ms: found 0 in the cell CELL", "a time above 0"),
    ),
    "a sample too many": (
        lambda d: copy_sample(d, repetition_index=9, pt_seed=10, pt_order=999),
        ("$.ptbench.cells[0]: found sample 9 of the cell CELL, allowed: samples 0 to 8: 9 were asked for",),
    ),
    "rows that do not agree on how many": (
        lambda d: samples_of(d)[3].update(repetitions=7),
        ("$.benchmarks[3].repetitions: found 7 in the cell CELL, allowed: 9",),
    ),
    **{
        f"a time that is none, {key} {value}": (
            lambda d, key=key, value=value: samples_of(d)[3].update({key: value}),
            (f"$.benchmarks[3].{key}: found {value}",),
        )
        for key in ("real_time", "pt_wall_ms", "pt_device_ms", "pt_end_to_end_ms")
        for value in (0, -0.5)
    },
    "a time that its wall time is not": (
        lambda d: samples_of(d)[3].update(real_time=4 * samples_of(d)[3]["pt_wall_ms"]),
        ("$.benchmarks[3].real_time: found ", "in the cell CELL, allowed: ", ", its pt_wall_ms"),
    ),
    "a device that worked longer than the render took": (
        lambda d: samples_of(d)[3].update(pt_device_ms=1.01 * samples_of(d)[3]["pt_wall_ms"]),
        ("$.benchmarks[3].pt_device_ms: found ", "allowed: at most ", ", its pt_wall_ms"),
    ),
    "a render that ends before its last stage": (
        lambda d: samples_of(d)[3].update(pt_end_to_end_ms=0.99 * samples_of(d)[3]["pt_wall_ms"]),
        ("$.benchmarks[3].pt_end_to_end_ms: found ", "allowed: at least ", ", its pt_wall_ms"),
    ),
    "a median of other samples": (
        lambda d: samples_of(d)[0].update(dict.fromkeys(("real_time", "pt_wall_ms", "pt_device_ms"), 1e-3)),
        ("].real_time: found ", " in the cell CELL, allowed: ", ", the median of its 9 samples"),
    ),
    "a median of other CPU times": (
        lambda d: median_of(d).update(cpu_time=1.0),
        ("].cpu_time: found 1.0 in the cell CELL, allowed: ", ", the median of its 9 samples"),
    ),
    "a sample's film": (
        spoil_film,
        (
            '.film_hash: found "ffffffffffffffff" in the cell OTHER',
            '"0000000000000003", the film of the same seed in the cell CELL',
        ),
    ),
    "a cell's film": (
        lambda d: cells_of(d)[1].update(film_hash="f" * 16),
        ('$.ptbench.cells[1].film_hash: found "ffffffffffffffff" in the cell OTHER, allowed: "',),
    ),
    "a row of no cell": (
        lambda d: samples_of(d)[3].update(run_name="nobody"),
        ('$.benchmarks[3].run_name: found "nobody", allowed: the name of a cell in $.ptbench.cells',),
    ),
    "a cell twice": (
        lambda d: cells_of(d).append(cells_of(d)[0]),
        ("again, allowed: each name once",),
    ),
}


@pytest.fixture
def broken(tmp_path) -> Callable[[str], tuple[Path, tuple[str, ...]]]:
    """(a file with the fault of that name, what has to be said of it)."""

    def make(name: str) -> tuple[Path, tuple[str, ...]]:
        document = copy.deepcopy(PACKET)
        names = [json.dumps(cell["cell"]) for cell in cells_of(document)]
        fault, texts = FAULTS[name]
        fault(document)
        path = tmp_path / "broken.json"
        path.write_text(json.dumps(document), encoding="utf-8")
        return path, tuple(text.replace("CELL", names[0]).replace("OTHER", names[1]) for text in texts)

    return make


def test_the_faults_are_in_a_file_that_has_none(tmp_path):
    document = copy.deepcopy(PACKET)
    assert list(contradictions(Node(tmp_path, document))) == []
    add_films(document)
    assert list(contradictions(Node(tmp_path, document))) == []
    # The first two cells of the file must leave the same film.
    one, other = cells_of(document)[:2]
    assert (one["claim"], one["film_hash"]) == ("bitwise", other["film_hash"])


@pytest.mark.parametrize("name", FAULTS)
def test_loading_and_validating_refuse_it(broken, analysis, name):
    path, texts = broken(name)
    with pytest.raises(InputError) as refused:
        load(path)
    line = str(refused.value)
    assert line.startswith(f"{path}: $.")
    assert "\n" not in line
    for text in texts:
        assert text in line
    code, out, err = analysis("validate", path)
    assert (code, err, out.count("\n")) == (1, "", 1)
    assert out.startswith(f"{path}: $.")


@pytest.mark.parametrize("name", ["a sample twice", "the last sample missing", "a sample's film"])
def test_every_command_that_loads_it_refuses_it(broken, analysis, tmp_path, name):
    path, texts = broken(name)
    good = tmp_path / "good.json"
    good.write_text(json.dumps(PACKET), encoding="utf-8")
    variants = [cell["variant"] for cell in cells_of(PACKET)[:2]]
    for arguments in (
        ("plots", path, "--out", tmp_path / "out"),
        ("report", path, "--out", tmp_path / "out"),
        ("report", good, path, "--out", tmp_path / "out"),
        ("compare", good, path, "--out", tmp_path / "out"),
        ("compare", good, good, "--noise", path, "--out", tmp_path / "out"),
        ("explain", path, *variants, "--out", tmp_path / "out"),
    ):
        code, out, err = analysis(*arguments)
        assert (code, out, err.count("\n")) == (2, "", 1), arguments
        assert str(path) in err
        assert texts[0] in err
        assert not (tmp_path / "out").exists()


def test_a_file_with_hashes_of_samples_is_as_its_schema_says(tmp_path):
    document = copy.deepcopy(PACKET)
    add_films(document)
    path = tmp_path / "films.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    assert validate(path) == []
    assert load(path).cells[0].samples[2].film_hash == "0000000000000003"


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_committed_files_do_not_contradict_themselves(path):
    root = read_json(path)
    if isinstance(root.value, dict) and {"benchmarks", "ptbench"} <= root.value.keys():
        assert list(contradictions(root)) == []


def test_a_key_that_an_object_has_twice_is_refused(analysis, tmp_path):
    """Python's parser takes the last of its values without a word."""
    path = tmp_path / "twice.json"
    time = samples_of(PACKET)[0]["real_time"]
    text = json.dumps(PACKET).replace(f'"real_time": {time},', f'"real_time": {time}, "real_time": 1.0,', 1)
    path.write_text(text, encoding="utf-8")
    line = f'{path}: $.benchmarks[0]: found the key "real_time" twice, allowed: once\n'
    for command in ("validate", "plots"):
        code, out, err = analysis(command, path)
        assert (code, out) == (2, "")
        assert err.endswith(line)
        assert err.count("\n") == 1
    path.write_text('{"a": [{"b": 1}, {"c": {"d": 1, "e": 2, "d": 1}}]}', encoding="utf-8")
    with pytest.raises(InputError, match=r'twice\.json: \$\.a\[1\]\.c: found the key "d" twice, allowed: once'):
        read_json(path)


def test_a_journals_line_with_a_key_twice_is_refused(analysis, tmp_path):
    path = tmp_path / "twice.jsonl"
    path.write_bytes(LineSeal().seal(b'{"type": "run", "identity": {"seed": 1, "seed": 2}}') + b"\n")
    code, out, err = analysis("validate", path)
    assert (code, err) == (1, "")
    assert out == f'{path}: line 1 $.identity: found the key "seed" twice, allowed: once\n'


def test_a_sample_that_was_taken_again_counts_once(tmp_path):
    document = copy.deepcopy(PACKET)
    retake_first(document, pt_foreign_cpu_ms=1e6)
    path = tmp_path / "retaken.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    result = load(path)
    assert result.retaken == 1
    assert disturbance_in(result).endswith("; 1 disturbed before was taken again")
    assert [len(cell.samples) for cell in result.cells] == [9] * len(result.cells)


def said(builder: Builder, tmp_path: Path) -> list[str]:
    return [str(found) for found in contradictions(read_json(builder.write(tmp_path / "built.json")))]


def test_what_a_stopped_run_leaves_is_good(tmp_path):
    builder = Builder().study("compaction")
    builder.context["ptbench.status"] = "interrupted"
    builder.cell("compaction", n=9)
    builder.cell("compaction", n=9, axes={"compaction": "a"}, status="interrupted", reason="the run ended")
    name = builder.cells[1]["cell"]
    late = [row for row in builder.rows if row["run_name"] == name and row.get("repetition_index", 0) > 3]
    builder.rows = [row for row in builder.rows if row not in late]
    builder.cell("compaction", n=0, axes={"compaction": "b"}, status="interrupted", reason="the run ended")
    assert said(builder, tmp_path) == []
    assert [len(cell.samples) for cell in load(tmp_path / "built.json").cells] == [9, 4, 0]


def test_a_failed_cells_samples_and_film_are_not_held_to_anything(tmp_path):
    """That its film differs is why it failed; its samples end where it did."""
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    builder.cell(
        "compaction", n=9, axes={"compaction": "a"}, status="failed", reason="film differs", film_hash="0" * 16
    )
    name = builder.cells[1]["cell"]
    builder.rows = [row for row in builder.rows if row["run_name"] != name or row.get("repetition_index", 0) < 2]
    assert said(builder, tmp_path) == []


@pytest.mark.parametrize(
    "apart",
    [
        {"claim": "statistical"},
        {"scene_hash": "0" * 16},
        {"depth": 4},
        {"spp": 8},
        {"resolution": [100, 100]},
    ],
    ids=lambda apart: next(iter(apart)),
)
def test_films_that_need_not_agree(tmp_path, apart):
    """Cells that claim only a mean (as arithmetic that rounds freely does), or of other work, may have other films."""
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    builder.cell("compaction", n=9, axes={"compaction": "a"}, film_hash="0" * 16, **apart)
    assert said(builder, tmp_path) == []


def test_films_of_other_backends_need_not_agree(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    builder.backend = "cuda"
    builder.cell("compaction", n=9, film_hash="0" * 16)
    assert said(builder, tmp_path) == []


def test_films_are_held_to_each_other_seed_by_seed_and_across_shards(tmp_path):
    builder = Builder().study("compaction")
    for index, choice in enumerate(("none", "a")):
        builder.cell("compaction", n=9, axes={"compaction": choice}, shard=f"{index + 1}/2")
    for row in builder.rows:
        if row["run_type"] == "iteration":
            row["film_hash"] = f"{int(row['pt_seed']):016x}"
    assert said(builder, tmp_path) == []
    last = [row for row in builder.rows if row["run_type"] == "iteration"][-1]
    last["film_hash"] = "f" * 16
    (line,) = said(builder, tmp_path)
    assert '"0000000000000009", the film of the same seed' in line


def test_a_samples_film_is_that_of_its_last_checkpoint(tmp_path):
    """Whatever the variant claims: it is one film."""
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9, claim="statistical")
    row = builder.rows[0]
    row["film_hash"] = "a" * 16
    row["pt_checkpoints"] = [{"spp": 1, "film_hash": "1" * 16}, {"spp": 4, "film_hash": "a" * 16}]
    assert said(builder, tmp_path) == []
    row["pt_checkpoints"][1]["film_hash"] = "b" * 16
    (line,) = said(builder, tmp_path)
    assert line.startswith('$.benchmarks[0].film_hash: found "aaaaaaaaaaaaaaaa" in the cell')


def test_the_run_says_how_many_samples_were_asked_for(tmp_path):
    """A cell without a row has no other place that does."""
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    path = builder.write(tmp_path / "run.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    document["ptbench"]["run"] = {"repetitions": 12, "seed": 1}
    (found,) = contradictions(Node(path, document))
    assert str(found).startswith("$.benchmarks[0].repetitions: found 9 in the cell")


def test_seeds_of_64_bits_are_told_apart(tmp_path):
    """Seeds that round to one double are told apart."""
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    for index, row in enumerate(builder.rows[:9]):
        row["pt_seed"] = (1 << 60) + index
    assert said(builder, tmp_path) == []
    assert load(tmp_path / "built.json").cells[0].samples[1].seed == (1 << 60) + 1


def test_a_clock_that_is_unknown_is_none(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", n=9)
    known = builder.rows[0]
    known |= {"pt_clock_unknown": 0, "pt_clock_mhz_before": 3000.0, "pt_clock_mhz_after": 4000.0}
    builder.rows[1]["pt_clock_unknown"] = 1
    del builder.rows[1]["pt_clock_mhz_before"], builder.rows[1]["pt_clock_mhz_after"]
    builder.rows[2]["pt_clock_unknown"] = 1
    (cell,) = load(builder.write(tmp_path / "clock.json")).cells
    assert [sample.clock for sample in cell.samples[:4]] == [3500.0, None, None, 3690.0]
    assert cell.samples[1].mega_cycles_per_spp is None
    assert cell.mega_cycles_per_spp is None
    assert cell.measured
