"""The sky that scenes/environments shows is what its recipe makes."""

import runpy
from pathlib import Path

_ROOT = Path(__file__).parents[2]


def test_the_sky_is_what_its_recipe_makes():
    recipe = runpy.run_path(str(_ROOT / "tools" / "make_sky.py"))
    assert (_ROOT / "scenes" / "environments" / "sky.hdr").read_bytes() == recipe["sky"]()
