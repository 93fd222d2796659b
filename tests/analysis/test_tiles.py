"""The images that scenes/textures shows are what their recipe makes."""

import runpy
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["tiles", "studs"])
def test_an_image_is_what_its_recipe_makes(name):
    recipe = runpy.run_path(str(_ROOT / "tools" / "make_tiles.py"))
    assert (_ROOT / "scenes" / "textures" / f"{name}.png").read_bytes() == recipe[name]()
