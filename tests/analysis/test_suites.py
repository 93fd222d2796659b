"""Suites that study materials: no path of theirs walks through a body, unless the scene says that it is about that."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import ROOT

SUITES = sorted([*(ROOT / "scenes/suites").glob("*.json"), *(ROOT / "claims/suites").glob("*.json")])
# What puts paths in order by material, or into the places of others.
_ORDERS = ("sorting", "sort_key", "compaction")
_REGROUPS = ("regroup", "wavefront_materials", "wavefront_refill")


def document(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def orders_paths(study: dict) -> bool:
    """Whether the study compares ways to order paths or to put others in their places."""
    parts = [study, *study.get("variants", ())]
    axes = [part.get("axes", {}) for part in parts]
    choices = {axis: {choice for part in axes for choice in part.get(axis, ())} for axis in (*_ORDERS, "integrator")}
    return any(len(choices[axis]) > 1 for axis in _ORDERS) or bool(choices["integrator"] & set(_REGROUPS))


def about_walks(scene: dict) -> bool:
    return "walk" in scene["description"]


def has_walks(scene: dict) -> bool:
    return any(material["type"] == "subsurface" for material in scene["materials"].values())


@pytest.mark.parametrize("path", SUITES, ids=lambda path: "/".join(path.parts[-3:]))
def test_studies_of_materials_have_no_walks_that_the_scene_does_not_say(path):
    hidden = [
        f"{study['name']}: {name}"
        for study in document(path)["studies"]
        if orders_paths(study)
        for name in study["scenes"]
        if has_walks(scene := document(ROOT / "scenes" / f"{name}.json")) and not about_walks(scene)
    ]
    assert hidden == []


@pytest.mark.parametrize("box", ["open", "closed"])
def test_the_boxes_of_many_kinds_differ_from_those_of_walks_by_one_ball(box):
    kinds, walks = (document(ROOT / f"scenes/materials/cornell_{box}_{name}.json") for name in ("kinds", "walks"))
    assert (has_walks(kinds), has_walks(walks), about_walks(walks)) == (False, True, True)
    types = {material["type"] for material in kinds["materials"].values()}
    assert types == {
        "emitter", "diffuse", "mirror", "mix", "dielectric", "rough_conductor", "rough_dielectric", "principled",
    }  # fmt: skip
    assert [one for one in kinds["objects"] if one not in walks["objects"]] == [
        {**one, "material": "frosted"} for one in walks["objects"] if one not in kinds["objects"]
    ]
    boxes = [material for material in kinds["materials"] if material not in walks["materials"]]
    assert (kinds["camera"], boxes) == (walks["camera"], ["frosted"])
