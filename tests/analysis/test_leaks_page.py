"""A page's view of rays that leave closed meshes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import RESULTS

from ptbench.errors import FindingError
from ptbench.findings.source import source_of
from ptbench.findings.sources.leaks import LeaksSource


def written(folder: Path, *ways: tuple[int, int]) -> LeaksSource:
    kernels = [{"kernel": "plain", "rays": rays, "leaks": leaks} for rays, leaks in ways]
    trees = [{"accelerator": "bvh2", "builder": "sah_binned", "kernels": kernels}]
    value = {"schema": "ptbench-leaks-1", "context": {}, "meshes": [{"mesh": "menger:3", "trees": trees}]}
    (folder / "leaks.json").write_text(json.dumps(value), encoding="utf-8")
    source = source_of(folder, {"file": "leaks.json"})
    assert isinstance(source, LeaksSource)
    return source


def test_rays_and_leaks_are_counted(tmp_path):
    source = written(tmp_path, (4_000_000_000, 2), (2_500_000_000, 1))
    assert (source.meshes, source.ways, source.leaks, source.least_rays) == (["menger:3"], 2, 3, "2.50")


@pytest.mark.parametrize("ways", [[(1000, 0), (1000, 1)], [(0, 0)], []])
def test_a_mesh_is_closed_only_where_rays_were_traced_and_none_left(tmp_path, ways):
    with pytest.raises(FindingError, match="the page says: none"):
        written(tmp_path, *ways).must_be_closed("none")


def test_the_committed_search_had_a_thousand_million_rays_each_way():
    source = source_of(RESULTS, {"file": "nvidia-h200/leaks.json"})
    assert source.must_be_closed("none") == "none"
    assert float(source.least_rays) >= 1
    assert "commit" in source.provenance
