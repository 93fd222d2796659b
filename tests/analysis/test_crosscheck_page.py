"""A page's view of a cross-check's file."""

from __future__ import annotations

import json

import pytest

from ptbench.errors import FindingError
from ptbench.findings.source import source_of
from ptbench.findings.sources.crosscheck import CrosscheckSource

COMMIT = "0123456789abcdef0123456789abcdef01234567"


def scene(name: str, verdict: str, bias: float = 0.001) -> dict:
    return {
        "scene": name, "verdict": verdict, "reasons": [], "aim": 0.005, "spp": 64,
        "image": {"bias": [0.0, -bias, bias / 2], "errors": [0.0005, 0.00025, 0.0005], "sees": 0.004},
        "blocks": {"count": 192, "beyond": 1, "worst": -3.25, "limit": 6.5, "sees": 0.03},
        "pixels": {"z": 1.25},
    }  # fmt: skip


def source(tmp_path, *scenes: dict, scenes_of_call: int = 4) -> CrosscheckSource:
    context = {"date": "2026-11-23T03:00:00+0000", "ptbench.version": f"ptbench 1.0.0 (commit {COMMIT})"}
    context |= {"ptbench.machine": "m", "mitsuba.version": "3.9.1", "mitsuba.variant": "scalar_rgb"}
    settings = {"resolution": [64, 64], "seeds": 8, "power": 0.9, "family": 0.01}
    settings["family_scenes"] = scenes_of_call
    document = {"schema": "ptbench-crosscheck-1", "context": context, "settings": settings, "scenes": list(scenes)}
    name = f"{len(list(tmp_path.iterdir()))}.json"
    (tmp_path / name).write_text(json.dumps(document), encoding="utf-8")
    found = source_of(tmp_path, {"file": name})
    assert isinstance(found, CrosscheckSource)
    return found


def test_scenes_are_counted_by_their_verdicts(tmp_path):
    refused = {"scene": "fog", "verdict": "not expressible", "aim": 0.005}
    refused["reasons"] = ["$.materials.wax: found subsurface, allowed: another material: Mitsuba counts"]
    check = source(tmp_path, scene("a", "agrees"), scene("b/c.json", "too weak", 0.1), refused)
    assert (check.compared, check.agreeing, check.weak, check.differing) == (2, 1, ["b/c.json"], [])
    assert check.must_agree("It does") == "It does"
    assert check.refused() == ["`fog`: `$.materials.wax` subsurface"]
    assert check.missing == 1
    assert check.commit == COMMIT
    assert check.largest_bias == "0.10 %"
    assert (check.blocks_beyond, check.blocks) == (2, 384)
    assert check.rows[0] == "a | 64 | -0.10 % ± 0.025 % | 0.40 % | 3.2 of 6.5 | 3.0 % | +1.2 | agrees"


def test_files_share_a_probability_where_their_calls_did(tmp_path):
    refused = {"scene": "fog", "verdict": "not expressible", "aim": 0.005, "reasons": ["$.materials.wax: found wax"]}
    first, later = source(tmp_path, scene("a", "agrees"), refused), source(tmp_path, scene("fog", "agrees"))
    assert first.shared_by(later) == 4
    assert first.refused(later) == []
    with pytest.raises(FindingError, match="do not share one probability"):
        first.shared_by(source(tmp_path, scene("a", "agrees")))


def test_a_scene_that_was_rendered_again_had_another_chance(tmp_path):
    assert source(tmp_path, scene("a", "agrees")).family == "1.0 %"
    # Of the call's four scenes one was rendered three times: six chances.
    assert source(tmp_path, scene("a", "agrees") | {"first_seed": 17}).family == "1.5 %"


def test_calls_of_different_sizes_add_up_to_one_probability(tmp_path):
    once, again = {"first_seed": 1}, {"first_seed": 9}
    refused = {"scene": "fog", "verdict": "not expressible", "aim": 0.005, "reasons": []}
    first = source(tmp_path, scene("a", "agrees") | once, scene("b", "agrees") | again, refused)
    assert first.told_apart() == "0.75 %"  # three renders of a call of four scenes, of 1 %
    later = source(tmp_path, scene("c", "agrees") | once, scenes_of_call=16)
    assert first.told_apart(later) == "0.81 %"


def test_a_scene_that_differs_makes_the_sentence_false(tmp_path):
    with pytest.raises(FindingError, match="b differ; the page says: It does"):
        source(tmp_path, scene("a", "agrees"), scene("b", "differs")).must_agree("It does")
