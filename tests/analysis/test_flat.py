"""`python3 -m ptbench flat`: one table of result files, which reads back as what the files say."""

from __future__ import annotations

import builtins
import csv
import math

import pandas as pd
import pytest
from builder import Builder
from conftest import RESULTS, ROOT
from stability_builder import StabilityBuilder

from ptbench import frames
from ptbench.cli.main import main
from ptbench.tidy import rows
from ptbench.tidy.columns import COLUMNS, FROM_FILES, GROUPS
from ptbench.tidy.descriptions import page

SORTING = RESULTS / "nvidia-h200" / "sorting.json"


def flat(*arguments) -> int:
    return main(["flat", *(str(argument) for argument in arguments)])


def read_csv(path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def small_result(path):
    builder = Builder().study("compaction")
    builder.cell("compaction", n=3)
    builder.cell("compaction", n=2, error='gone, "for good"\nreally', axes={"compaction": "scan"})
    return builder.write(path)


def test_a_committed_file_reads_back_as_it_is(tmp_path, capsys):
    out = tmp_path / "sorting.csv"
    assert flat(SORTING, "--out", out) == 0
    expected = rows.samples(SORTING)
    read = read_csv(out)
    assert capsys.readouterr().out == f"{out}: {len(expected.rows)} rows, {len(expected.types)} columns\n"
    assert list(read[0]) == list(expected.types)
    assert len(read) == len(expected.rows)
    for row, told in zip(read, expected.rows, strict=True):
        for name, kind in expected.types.items():
            value = told.get(name)
            if value is None:
                assert row[name] == "", name
            elif kind == "float64":
                assert float(row[name]) == value, name
            else:
                assert row[name] == (str(value).lower() if kind == "boolean" else str(value)), name


def test_every_axis_of_every_cell_is_a_column(tmp_path):
    assert flat(SORTING, "--table", "cells", "--out", tmp_path / "cells.csv") == 0
    read = {row["cell"]: row for row in read_csv(tmp_path / "cells.csv")}
    cells = frames.cells(SORTING)
    assert len(read) == len(cells)
    for axis in ("integrator", "compaction", "sorting", "sort_key", "layout", "launch", "arithmetic"):
        assert [read[cell][axis] for cell in cells["cell"]] == list(cells[axis])


def test_several_files_and_a_folder_are_one_table(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    one, two = small_result(folder / "one.json"), small_result(folder / "two.json")
    assert flat(one, two, "--out", tmp_path / "named.csv") == 0
    assert flat(folder, "--out", tmp_path / "folder.csv") == 0
    read = read_csv(tmp_path / "named.csv")
    assert [row["file"] for row in read] == [str(one)] * 5 + [str(two)] * 5
    assert [row["status"] for row in read] == (["ok"] * 3 + ["failed"] * 2) * 2
    assert read[3]["wall_ms"] == ""
    assert read[3]["reason"] == 'gone, "for good"\nreally'
    assert (tmp_path / "folder.csv").read_bytes() == (tmp_path / "named.csv").read_bytes()


def test_files_of_stability_give_their_checks(tmp_path):
    builder = StabilityBuilder().case().row({}, 0, a=0.01).row({}, 0.5).row({}, math.inf).none({}, reason="no lamp")
    file = builder.write(tmp_path / "stability.json")
    assert flat(file, "--out", tmp_path / "checks.csv") == 0
    read = read_csv(tmp_path / "checks.csv")
    assert [row["status"] for row in read] == ["passed", "failed", "failed", "n/a"]
    assert [row["parameter_a"] for row in read] == ["0.01", "0.1", "0.1", "0.1"]
    assert [row["error"] for row in read] == ["0.0", "0.5", "inf", ""]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--out", "rows.txt"], 'rows.txt: --out: found the ending ".txt", allowed: .csv or .parquet'),
        (["--out", "rows"], 'rows: --out: found the ending "", allowed: .csv or .parquet'),
        (["--table", "stability", "--out", "rows.csv"], "$.schema: found nothing, allowed:"),
    ],
)
def test_a_wrong_call_is_one_line_and_writes_nothing(tmp_path, capsys, monkeypatch, arguments, said):
    file = small_result(tmp_path / "one.json")
    monkeypatch.chdir(tmp_path)
    assert flat(file, *arguments) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.json"]


def test_a_table_that_there_is_not(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        flat(SORTING, "--table", "sample", "--out", tmp_path / "rows.csv")
    assert ended.value.code == 2
    assert 'found the word "sample" (did you mean "samples"?), allowed: samples, cells,' in capsys.readouterr().err


def test_without_pyarrow_parquet_is_refused_before_anything_is_read(tmp_path, capsys, monkeypatch):
    there_is = builtins.__import__

    def without_pyarrow(name, *arguments, **named):
        if name.partition(".")[0] == "pyarrow":
            raise ModuleNotFoundError(name=name)
        return there_is(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", without_pyarrow)
    assert flat(tmp_path / "no such file.json", "--out", tmp_path / "rows.parquet") == 2
    err = capsys.readouterr().err
    assert "found no Python package pyarrow, allowed: a .csv, or Parquet where there is pyarrow (pip install" in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_parquet_reads_back_with_types_and_meanings(tmp_path):
    pq = pytest.importorskip("pyarrow.parquet", reason="no pyarrow")
    out = tmp_path / "samples.parquet"
    file = small_result(tmp_path / "one.json")
    assert flat(file, "--out", out) == 0
    table = pq.read_table(out)
    expected = rows.samples(file)
    assert table.column_names == list(expected.types)
    for name in expected.types:
        assert table.column(name).to_pylist() == [row.get(name) for row in expected.rows], name
    for name, kind in (("seed", "int64"), ("wall_ms", "double"), ("low_clock", "bool"), ("reason", "string")):
        assert str(table.schema.field(name).type) == kind
    assert table.schema.field("wall_ms").metadata[b"description"].decode() == COLUMNS["wall_ms"][1]
    assert isinstance(pd.read_parquet(out)["compaction"].dtype, pd.CategoricalDtype)


def test_parquet_has_room_for_seeds_of_64_bits(tmp_path):
    pq = pytest.importorskip("pyarrow.parquet", reason="no pyarrow")
    from ptbench.flat.command import write_parquet

    seed = (1 << 64) - 1
    values = ({"seed": seed, "wall_ms": math.inf}, {"wall_ms": 2.0})
    write_parquet(rows.Rows(values, {"seed": "Int64", "wall_ms": "float64"}), tmp_path / "seeds.parquet")
    table = pq.read_table(tmp_path / "seeds.parquet")
    assert table.column("seed").to_pylist() == [seed, None]
    assert table.column("wall_ms").to_pylist() == [math.inf, 2.0]


def test_every_column_is_described_and_the_page_is_up_to_date():
    planned = {name for groups in GROUPS.values() for group in groups for name in group}
    assert planned == COLUMNS.keys()
    assert set(FROM_FILES) < planned
    assert GROUPS.keys() == rows.TABLES.keys()
    written = (ROOT / "docs" / "columns.md").read_text(encoding="utf-8")
    assert written == page(), "python3 -m ptbench.tidy.descriptions > docs/columns.md"
