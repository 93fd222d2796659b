"""The tiles that scenes/textures shows are what their recipe makes."""

import runpy
from pathlib import Path

_ROOT = Path(__file__).parents[2]


def test_the_tiles_are_what_their_recipe_makes():
    recipe = runpy.run_path(str(_ROOT / "tools" / "make_tiles.py"))
    assert (_ROOT / "scenes" / "textures" / "tiles.png").read_bytes() == recipe["tiles"]()
