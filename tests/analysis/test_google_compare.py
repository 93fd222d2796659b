"""Google Benchmark's own compare.py reads our files, and where it can say what `compare` says it says the same.

It compares rows of equal names, the medians that Google Benchmark wrote. Of names that only one file has it says
nothing but takes them into its geometric mean; ours is over what both have, so the means agree where the names do.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from compare_builder import other_program, run_again, wavefront_by_depth, without, written
from scipy import stats

from ptbench.compare.compared import compare_files

TOOL = Path(__file__).with_name("third_party") / "google_benchmark" / "compare.py"


def google(tmp_path: Path, *files: Path) -> tuple[str, dict[str, dict]]:
    """What it prints, and its rows by name with their aggregate's."""
    dump = tmp_path / "google.json"
    command = [sys.executable, str(TOOL), "--no-color", "--dump_to_json", str(dump), "benchmarks", *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout, {f"{row['name']}|{row['aggregate_name']}": row for row in json.loads(dump.read_text())}


@pytest.fixture
def files(tmp_path) -> list[Path]:
    """A real file, and another program's that was a quarter slower in one scene and an eighth faster in the other."""
    base = wavefront_by_depth()
    other = run_again(other_program(base), 5 / 4, only="cornell_open_unjittered")
    other = run_again(other, 7 / 8, only="cornell_closed_unjittered")
    return [written(base, tmp_path / "a.json"), written(other, tmp_path / "b.json")]


def test_its_numbers_are_ours(files, tmp_path):
    printed, rows = google(tmp_path, *files)
    (ours,) = compare_files(files).comparisons
    assert len(ours.rows) == 8
    for row in ours.rows:
        name = row.pair.reference.name
        (measured,) = rows[f"{name}_median|median"]["measurements"]
        # Google Benchmark's numbers went through two divisions and a subtraction of their own.
        assert 1 + measured["time"] == pytest.approx(row.ratio.value, rel=1e-13)
        spp = row.pair.reference.spp
        assert measured["real_time"] / spp == pytest.approx(sorted(row.pair.reference.ms_per_spp)[4], rel=1e-15)
        samples = rows[f"{name}|"]
        assert len(samples["measurements"]) == 9
        # Google Benchmark's U test is of the nine samples that we have.
        times = [cell.ms_per_spp for cell in (row.pair.reference, row.pair.other)]
        theirs = stats.mannwhitneyu(*times, alternative="two-sided").pvalue
        assert samples["utest"]["time_pvalue"] == pytest.approx(theirs, rel=1e-12)
        assert f"{name}_median" in printed


def test_its_geometric_mean_is_ours_where_the_cells_are(files, tmp_path):
    """Google's mean is over samples, not medians: the same ratio if all samples of a cell are scaled alike."""
    _, rows = google(tmp_path, *files)
    (ours,) = compare_files(files).comparisons
    (mean,) = rows["OVERALL_GEOMEAN|geomean"]["measurements"]
    assert 1 + mean["time"] == pytest.approx((5 / 4 * 7 / 8) ** (1 / 2), rel=1e-13)
    assert ours.time.estimate.value == pytest.approx((5 / 4 * 7 / 8) ** (1 / 2), rel=1e-13)


def test_where_the_cells_are_not_it_counts_strangers_and_we_do_not(files, tmp_path):
    less = written(without(json.loads(files[1].read_text()), "depth:8"), tmp_path / "less.json")
    _, rows = google(tmp_path, files[0], less)
    (ours,) = compare_files([files[0], less]).comparisons
    assert ours.time.used == 4
    assert ours.time.estimate.value == pytest.approx((5 / 4 * 7 / 8) ** (1 / 2), rel=1e-13)
    (mean,) = rows["OVERALL_GEOMEAN|geomean"]["measurements"]
    assert abs(1 + mean["time"] - ours.time.estimate.value) > 0.1
