"""`ptbench.load`: result files as rows, arrays and pandas tables that say the same as the package's own tables."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from builder import Builder, small
from conftest import PACKAGE, RESULTS
from stability_builder import StabilityBuilder

import ptbench
from ptbench import frames
from ptbench.errors import InputError
from ptbench.io.results import load
from ptbench.studies.rows import measure
from ptbench.tidy.rows import TABLES

FIRST_BOUNCE = RESULTS / "nvidia-h200" / "first_bounce.json"


def failing(tmp_path):
    builder = Builder().study("compaction")
    builder.cell("compaction", ms_per_spp=2.0)
    builder.cell("compaction", axes={"compaction": "gap_fill"}, error="out of memory")
    return builder.write(tmp_path / "failing.json")


def test_verdicts_are_those_of_the_studies():
    result = load(FIRST_BOUNCE)
    expected = [(study.name, row) for study in result.studies for row in measure(result, study)]
    rows = ptbench.load(FIRST_BOUNCE).rows("verdicts")
    assert len(rows) == len(expected) > 0
    for told, (study, row) in zip(rows, expected, strict=True):
        assert (told["study"], told["label"], told["cell"]) == (study, row.label, row.cell.name)
        assert told.get("ms_per_spp") == (row.estimate and row.estimate.value)
        for name, value in (("ratio", "value"), ("ratio_low", "low"), ("ratio_high", "high")):
            assert told.get(name) == (row.ratio and getattr(row.ratio, value))
        assert told.get("verdict") == (row.verdict and row.verdict.word)
    assert {"FASTER", "SLOWER"} & {told.get("verdict") for told in rows}


def test_rows_arrays_and_frames_say_the_same(tmp_path):
    loaded = ptbench.load([small().write(tmp_path / "a.json"), failing(tmp_path)])
    for table in set(TABLES) - {"stability", "rays"}:
        rows, columns, frame = loaded.rows(table), loaded.columns(table), loaded.frame(table)
        assert list(columns) == list(frame.columns)
        assert {len(column) for column in columns.values()} == {len(rows)} == {len(frame)}
        assert frame.equals(getattr(frames, table)([file.path for file in loaded.files]))
        for name, column in columns.items():
            known = [value for value, is_missing in zip(column, frame[name].isna(), strict=True) if not is_missing]
            assert known == frame[name].dropna().tolist()
            assert known == [row[name] for row in rows if row.get(name) is not None]


def test_arrays_have_types_and_say_what_is_missing(tmp_path):
    columns = ptbench.load(failing(tmp_path)).columns("cells")
    assert (columns["depth"].dtype, columns["failed_samples"].dtype) == (np.int64, np.int64)
    assert columns["median_ms_per_spp"].dtype == float
    assert list(np.isnan(columns["median_ms_per_spp"])) == [False, True]
    assert (columns["is_convergence"].dtype, columns["commit_dirty"].dtype) == (bool, bool)
    assert np.isnan(columns["device_bytes"]).all()  # a count that no cell has
    assert list(columns["compaction"]) == ["none", "gap_fill"]
    assert list(columns["status"]) == ["ok", "failed"]


def test_the_first_table_is_that_of_the_kind_of_file(tmp_path):
    stability = StabilityBuilder().case().row({}, 1e-7).write(tmp_path / "stability.json")
    assert "relation" in ptbench.load(stability).columns()
    assert "wall_ms" in ptbench.load(str(failing(tmp_path))).columns()


def test_what_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.json: the file: found no such file"):
        ptbench.load(tmp_path / "nothing.json")
    loaded = ptbench.load(failing(tmp_path))
    with pytest.raises(InputError, match='found the table "times", allowed: samples, cells'):
        loaded.rows("times")
    with pytest.raises(InputError, match=r"failing\.json: \$\.schema: found nothing"):
        loaded.rows("stability")


def test_rows_and_arrays_do_without_pandas_and_importing_waits_for_nothing(tmp_path):
    code = (
        "import sys; sys.modules['pandas'] = None; import ptbench; "
        "assert 'numpy' not in sys.modules and 'matplotlib' not in sys.modules; "
        f"loaded = ptbench.load({str(failing(tmp_path))!r}); print(len(loaded.rows('cells')), len(loaded.columns()))\n"
        "try: loaded.frame()\nexcept ImportError as error: print(error)"
    )
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={"PYTHONPATH": str(PACKAGE.parent)})
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.splitlines()
    assert first.startswith("2 ")
    assert second.startswith("ptbench.frames needs pandas")
