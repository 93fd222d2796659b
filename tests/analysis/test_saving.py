"""What is written of a page: small, but as it was drawn."""

from __future__ import annotations

import io
import re
import xml.etree.ElementTree as ElementTree
from itertools import pairwise

import numpy as np
import pytest
from builder import crossing
from matplotlib.figure import Figure
from PIL import Image

from ptbench.figures import style
from ptbench.figures.registry import collect_study, draw
from ptbench.figures.saving import DPI, save_figure, save_pictures
from ptbench.io.results import load

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """(PNG, SVG, the PNG as matplotlib writes it) of one figure with lines, labels and a caption."""
    folder = tmp_path_factory.mktemp("saved")
    result = load(crossing().write(folder / "result.json"))
    page = draw(collect_study(result, result.studies[0]))
    with style.applied():
        png, svg = save_figure(page, folder, "page")
        drawn = io.BytesIO()
        page.savefig(drawn, format="png", dpi=DPI)
    return png, svg, drawn.getvalue()


def test_a_png_has_few_colours_and_none_is_far_from_the_one_drawn(saved):
    png, _, drawn = saved
    written, before = Image.open(png), Image.open(io.BytesIO(drawn)).convert("RGB")
    assert written.mode == "P"
    assert written.size == before.size
    assert png.stat().st_size < len(drawn) / 2.5
    apart = np.abs(np.asarray(written.convert("RGB"), int) - np.asarray(before, int))
    assert 0 < apart.max() <= 12
    assert apart.mean() < 0.5


def test_the_series_colours_and_the_paper_are_exact(saved):
    colours = {colour for _, colour in Image.open(saved[0]).convert("RGB").getcolors()}
    assert (255, 255, 255) in colours
    for colour in style.COLOURS[:4]:
        assert tuple(bytes.fromhex(colour[1:])) in colours


def test_more_colours_than_a_palette_holds_come_closer_together(tmp_path):
    page = Figure(figsize=(1, 1))
    axes = page.add_axes((0, 0, 1, 1))
    steps = np.linspace(0, 1, 100)
    red, green = np.meshgrid(steps, steps)
    axes.imshow(np.stack([red, green, 1 - red], axis=2), interpolation="nearest")
    with style.applied():
        png, _ = save_figure(page, tmp_path, "many")
    written = Image.open(png)
    assert written.mode == "P"
    assert 100 < len(written.convert("RGB").getcolors(1 << 20)) <= 256


def test_pictures_keep_all_their_colours(tmp_path):
    page = Figure(figsize=(1, 1))
    noise = np.random.default_rng(1).random((100, 100, 3))
    page.add_axes((0, 0, 1, 1)).imshow(noise, interpolation="nearest")
    written = Image.open(save_pictures(page, tmp_path / "sheet.png", 100))
    assert (written.mode, written.size) == ("RGB", (100, 100))
    assert len(written.getcolors(1 << 20)) > 5000


def test_the_text_of_an_svg_is_text_in_fonts_that_fit(saved):
    _, svg, drawn = saved
    assert svg.stat().st_size < len(drawn) / 4
    texts = ElementTree.parse(svg).getroot().findall(f".//{SVG}text")
    assert {"none", "bucket", "late", "always"} <= {text.text for text in texts}
    assert any(text.text.startswith("Points: median render wall time") for text in texts)
    for text in texts:
        assert "'DejaVu Sans', Verdana, sans-serif" in text.get("style")


def test_an_svg_has_no_finer_step_than_a_hundredth(saved):
    tags = re.findall(r"<[^<>]*>", saved[1].read_text())
    assert not [tag for tag in tags if re.search(r"\d\.\d{3}", tag)]
    assert not [tag for tag in tags if "rotate(-0 " in tag]


def test_what_a_page_says_is_not_rounded(tmp_path):
    page = Figure(figsize=(3, 1))
    said = "0.123456 of <scene> 'DejaVu Sans' rotate(-0 1)"
    page.text(0.1, 0.5, said)
    with style.applied():
        _, svg = save_figure(page, tmp_path, "said")
    assert [text.text for text in ElementTree.parse(svg).getroot().findall(f".//{SVG}text")] == [said]


@pytest.mark.parametrize("width", [0.3, 1.1, 2.0, 6.0])
def test_lines_are_as_full_as_they_can_be(width):
    """Measuring only where a line may be full must not change where it ends."""
    text = "fi AVAVAV ,,,,.... WWWW iiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiii wavefront.thrust_remove_if.none.off.packed/" * 2
    size = style.CAPTION_SIZE
    lines = style.wrapped(text, size, width)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    for line, following in pairwise(lines):
        assert style.text_width(line, size) <= width
        # A word that is too long for a line is broken before it: then the next character must not fit.
        first = following.split()[0]
        more = f"{line} {first}" if f"{line} {first}" in text else line + following[0]
        assert style.text_width(more, size) > width
