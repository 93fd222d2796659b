"""A page's view of ray batches on a CPU, beside Embree."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import RESULTS

from ptbench.errors import FindingError
from ptbench.findings.source import source_of
from ptbench.findings.sources.cpu_rates import CpuRaysSource


def by(name: str, rate: float, different: int = 0) -> dict:
    return {"name": name, "mrays_per_s": rate, "other_primitive": 0, "other_bits": different}


def written(folder: Path, *classes: list[dict]) -> CpuRaysSource:
    batches = [{"class": f"class {i}", "rays": 1024, "by": one} for i, one in enumerate(classes)]
    mesh = {"mesh": "icosphere:4", "triangles": 5120, "classes": batches}
    value = {"schema": "ptbench-rays-cpu-1", "commit": "", "cpu": "a CPU", "meshes": [mesh]}
    (folder / "rays_cpu.json").write_text(json.dumps(value), encoding="utf-8")
    source = source_of(folder, {"file": "rays_cpu.json"})
    assert isinstance(source, CpuRaysSource)
    return source


def trees(bvh2: float, bvh8: float, different: int = 0) -> list[dict]:
    return [by("bvh2", bvh2), by("bvh4", 1.0), by("bvh8", bvh8, different), by("cwbvh", 0.5)]


def test_the_best_of_our_trees_is_held_against_embree(tmp_path):
    first, second = trees(2.0, 4.0), trees(3.0, 1.5)
    source = written(tmp_path, [*first, by("embree_native", 5.0, 900)], [*second, by("embree_native", 2.0, 900)])
    assert [(one.best, one.ratio) for one in source.classes] == [("bvh8", "0.800"), ("bvh2", "1.50")]
    assert source.least_over_peer == "0.800"
    assert source.must_reach(0.8, "reached") == "reached"
    with pytest.raises(FindingError, match=r"class 0: 0\.800 of embree_native; the page says: reached"):
        source.must_reach(0.81, "reached")


def test_a_tree_that_leaves_other_hits_is_refused(tmp_path):
    with pytest.raises(FindingError, match="bvh8 over icosphere:4 leaves other hits"):
        _ = written(tmp_path, [*trees(1.0, 2.0, 1), by("embree_native", 1.0)]).classes


def test_the_committed_rates_reach_the_bar():
    source = source_of(RESULTS, {"file": "amd-epyc-2-threads/rays_cpu.json"})
    assert source.must_reach(0.8, "reached") == "reached"
    assert "commit" in source.provenance
