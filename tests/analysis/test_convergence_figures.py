"""The figures and tables of a study of convergence: their numbers, that they can be read, and what they say is "
"missing."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from builder import Builder
from convergence_builder import Law, convergence_cell, convergence_study, on_gpu, without_checkpoints
from legibility import check_legible
from matplotlib.text import Text
from PIL import Image

from ptbench.errors import InputError, NotDrawable
from ptbench.figures.registry import collect_study, draw, parts_of_study
from ptbench.io.images import displayed, exposure_of, flip, read_pfm
from ptbench.io.results import load

SPPS = [1, 2, 4, 8, 16, 32, 64]
# The figures of a study, in the order in which a page shows them.
PARTS = ("", "equal_time", "time_to_error", "efficiency", "bias_variance", "checkpoint_cost")
AXES = (
    {"integrator": "megakernel"},
    {"direct_light": "nee"},
    {"direct_light": "nee_mis"},
    {"russian_roulette": "throughput"},
    {"sampler": "sobol_owen"},
    {"first_bounce": "cached"},
)


def write_pfm(path, image: np.ndarray, scale: str = "-1.0") -> None:
    height, width = image.shape[:2]
    order = "<f4" if scale.startswith("-") else ">f4"
    path.write_bytes(f"PF\n{width} {height}\n{scale}\n".encode() + image[::-1].astype(order).tobytes())


def study_of_all(scenes=("cornell_open",), extra: int = 0) -> Builder:
    """Every kind of line: shared, dependent, biased, with companions, and `extra` more choices."""
    builder = convergence_study(on_gpu(), title="Cornell boxes").study("cornell_without_checkpoints", "")
    builder.studies[-1]["figure"] = ""
    for scene in scenes:
        common = {"scene": scene, "spps": SPPS, "time_noise": 0.0}
        base = convergence_cell(builder, Law(reference_variance=1e-5), **common)
        for index, axes in enumerate((*AXES, *({"sampler": f"choice_{n}"} for n in range(extra)))):
            dependent, cached = "sobol_owen" in axes.values(), "cached" in axes.values()
            law = Law(0.25 / (index + 1), 1e-2 if cached else 0, power=1.3 if dependent else 1, reference_variance=1e-5)
            cell = convergence_cell(
                builder, law, **common, axes=axes, ms_per_spp=1 + index, independent=not dependent,
                biases=["first_bounce=cached: one sample"] if cached else None,
                shared_with=base if "megakernel" in axes.values() else None, first_seed=1 + 10 * index,
            )  # fmt: skip
            without_checkpoints(builder, cell, 1 + index, spp=SPPS[-1], scene=scene, axes=axes)
        without_checkpoints(builder, base, 2.0, spp=SPPS[-1], scene=scene)
    return builder


def with_images(builder: Builder, folder, side: int = 24) -> None:
    """Images of noise round a gradient, as the harness would leave them beside result.json."""
    images = folder / "result_images"
    images.mkdir()
    random = np.random.default_rng(4)
    y, x = np.mgrid[0:side, 0:side] / side
    reference = np.stack([x, y, 0.5 + 0 * x], axis=2)
    write_pfm(images / "reference.pfm", reference)
    for index, cell in enumerate(cell for cell in builder.cells if "convergence" in cell):
        files = {}
        for spp in SPPS[2:]:
            name = f"{index}_{spp}.pfm"
            write_pfm(images / name, reference + random.normal(0, 0.5 / spp**0.5, reference.shape))
            files[str(spp)] = f"{images.name}/{name}"
        cell["convergence"]["images"] = {"reference": f"{images.name}/reference.pfm", "by_spp": files}


def collected(builder: Builder, folder, part: str):
    result = load(builder.write(folder / "result.json"))
    return result.studies[0], collect_study(result, result.studies[0], part)


@pytest.mark.parametrize("part", [part for part in PARTS if part != "equal_time"])
@pytest.mark.parametrize(("scenes", "extra"), [(("cornell_open",), 0), (("cornell_open", "cornell_closed"), 5)])
def test_every_figure_can_be_read(tmp_path, part, scenes, extra):
    _study, data = collected(study_of_all(scenes, extra), tmp_path, part)
    check_legible(draw(data), part or "error_against_time")
    assert data.title.startswith("Cornell boxes")
    assert "NVIDIA H200" in data.caption


def test_lines_are_the_errors_and_times_of_the_file(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(0.5, noisy=False), spps=SPPS, ms_per_spp=2.0, seeds=9)
    convergence_cell(
        builder, Law(0.5, 0.01, noisy=False, reference_variance=1e-4), spps=SPPS, axes={"direct_light": "nee"}
    )
    _study, data = collected(builder, tmp_path, "")
    (panel,) = data.panels
    assert (panel.title, data.order) == ("cornell_open", ("off", "nee"))
    plain, biased = panel.lines
    assert plain.errors == pytest.approx([(0.5 / n) ** 0.5 for n in SPPS])
    assert plain.times == pytest.approx([2.0 * n for n in SPPS])
    assert (plain.plateau, panel.floor) == (None, pytest.approx(0.01))
    assert biased.plateau == pytest.approx(0.1)
    # The variance 0.5 / n comes down to the squared bias, 0.01, at 50 spp of 2 ms.
    assert biased.crossing_ms == pytest.approx(100, rel=0.02)
    axes = draw(data).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    drawn = [line for line in axes.get_lines() if len(line.get_xdata()) == len(SPPS)]
    assert [list(line.get_ydata()) for line in drawn] == [list(plain.errors), list(biased.errors)]
    slopes = [
        np.diff(np.log(line.get_ydata())) / np.diff(np.log(line.get_xdata()))
        for line in axes.get_lines() if line.get_color() == "#dadada"
    ]  # fmt: skip
    assert np.array(slopes) == pytest.approx(-0.5)
    texts = [text.get_text() for text in axes.figure.texts]
    assert "nee\nplateau 0.100" in texts
    assert "reference noise" in [text.get_text() for text in axes.texts]


def test_a_plateau_known_only_as_a_bound_is_told_of_and_not_drawn(tmp_path):
    builder = convergence_study(on_gpu(), title="Cornell boxes")
    convergence_cell(builder, Law(mean_bias=0.001))
    _study, data = collected(builder, tmp_path, "")
    (line,) = data.panels[0].lines
    assert (line.plateau_is_bound, line.has_drawn_plateau) == (True, False)
    texts = [text.get_text() for text in draw(data).findobj(Text)]
    assert any("\nplateau ≥ " in text for text in texts)
    # The axis ends with the errors, not at the bound.
    assert draw(data).axes[0].get_ylim()[0] > 10 * line.plateau


def test_bands_are_the_lowest_and_highest_seed(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(pixels=64), spps=SPPS)
    _, data = collected(builder, tmp_path, "")
    rows = [row["pt_checkpoints"] for row in builder.rows if "pt_checkpoints" in row]
    mse = np.array([[checkpoint["mse_dual"] for checkpoint in row] for row in rows])
    line = data.panels[0].lines[0]
    assert line.low**2 == pytest.approx(mse.min(axis=0))
    assert line.high**2 == pytest.approx(mse.max(axis=0))


def test_shared_curves_are_told_of(tmp_path):
    _, data = collected(study_of_all(), tmp_path, "")
    assert "Bit for bit the same images, one error curve on their own clocks: integrator=megakernel with baseline." in (
        data.caption
    )


def test_more_variants_than_a_panel_takes_are_split_and_keep_the_baseline(tmp_path):
    _, data = collected(study_of_all(extra=5), tmp_path, "")
    assert [panel.title for panel in data.panels] == ["cornell_open (1 of 2)", "cornell_open (2 of 2)"]
    assert [panel.lines[0].label for panel in data.panels] == ["baseline", "baseline"]


def test_time_bars_say_never_where_the_plateau_is_above(tmp_path):
    _, data = collected(study_of_all(), tmp_path, "time_to_error")
    (group,) = data.groups
    assert group.title == "cornell_open, to an error of 0.1"
    texts = {bar.label: bar.text for bar in group.bars}
    assert texts["first_bounce=cached"].startswith("never: plateau")
    assert all("[" in text for label, text in texts.items() if label != "first_bounce=cached")


def test_bias_against_variance_shows_limits_where_none_was_found(tmp_path):
    _, data = collected(study_of_all(), tmp_path, "bias_variance")
    points = {point.label: point for point in data.panels[0].points}
    assert [label for label, point in points.items() if point.found] == ["first_bounce=cached"]
    assert points["first_bounce=cached"].bias2.value == pytest.approx(0.01, rel=0.1)
    assert "sampler=sobol_owen" not in points
    assert "samples not being independent: sampler=sobol_owen" in data.caption


def test_what_has_no_noise_is_named_and_left_out(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(noisy=False), spps=SPPS)
    frozen = {"first_bounce": "cached_jitters"}
    convergence_cell(builder, Law(1e-15, 4e-4, noisy=False), spps=SPPS, axes=frozen, biases=["frozen"])
    _, data = collected(builder, tmp_path, "bias_variance")
    assert [point.label for point in data.panels[0].points] == ["off"]
    assert "more samples changing nothing: cached_jitters" in data.caption
    _, data = collected(builder, tmp_path, "efficiency")
    assert [bar.text for bar in data.groups[0].bars] == ["baseline", "no noise to compare, plateau 0.0200"]


def test_checkpoint_cost_needs_companions(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(noisy=False), spps=SPPS)
    with pytest.raises(NotDrawable, match="no cell was also run without checkpoints"):
        collected(builder, tmp_path, "checkpoint_cost")


def test_a_study_without_a_curve_is_not_drawn_and_says_why(tmp_path):
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(noisy=False), seeds=1)
    for part in PARTS:
        with pytest.raises(NotDrawable, match=r"no cell has a curve: .*1 complete seeds"):
            collected(builder, tmp_path, part)


# ---- Crops at equal time ----


def test_crops_are_of_equal_time_and_can_be_read(tmp_path):
    builder = study_of_all()
    with_images(builder, tmp_path)
    _study, data = collected(builder, tmp_path, "equal_time")
    (sheet,) = data.sheets
    assert [shot.label for shot in sheet.shots][:2] == ["reference", "baseline"]
    # megakernel takes 1 ms a sample, the baseline 2: the time is the one that all have an image at, 64 ms.
    assert sheet.title == "cornell_open, after 64.0 ms"
    facts = {shot.label: shot.facts for shot in sheet.shots}
    assert facts["baseline"].startswith("32 spp, 64.0 ms")
    assert facts["integrator=megakernel"].startswith("64 spp, 64.0 ms")
    assert facts["first_bounce=cached"].startswith("8 spp, 48.0 ms")
    assert "sRGB" in data.caption
    check_legible(draw(data), "equal_time")


def test_missing_images_are_told_and_the_figure_left_out(tmp_path):
    with pytest.raises(NotDrawable, match="cornell_open: no cell names an image"):
        collected(study_of_all(), tmp_path, "equal_time")
    builder = study_of_all()
    with_images(builder, tmp_path)
    # An image that is not shown need not be there.
    (tmp_path / "result_images" / "0_8.pfm").unlink()
    collected(builder, tmp_path, "equal_time")
    (tmp_path / "result_images" / "0_32.pfm").unlink()
    with pytest.raises(NotDrawable, match=r"result_images/0_32\.pfm is not there"):
        collected(builder, tmp_path, "equal_time")


def test_an_image_of_another_size_is_refused(tmp_path):
    builder = study_of_all()
    with_images(builder, tmp_path)
    for file in (tmp_path / "result_images").glob("0_*.pfm"):
        write_pfm(file, np.zeros((4, 6, 3)))
    with pytest.raises(InputError, match="the image: found 6x4, allowed: the reference's size, 24x24"):
        collected(builder, tmp_path, "equal_time")


def test_pfm_is_read_from_either_byte_order_with_its_top_first(tmp_path):
    image = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    for scale in ("-1.0", "1.0"):
        write_pfm(tmp_path / "a.pfm", image, scale)
        assert (read_pfm(tmp_path / "a.pfm") == image).all()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"P6\n1 1\n255\nabc", "the header: found 'P6"),
        (b"PF\n2 2\n-1.0\n" + b"\0" * 12, "the pixels: found 12 bytes, scale -1, allowed: 48 bytes for 2x2 pixels"),
    ],
)
def test_bad_pfm_files_are_refused_with_one_line(tmp_path, data, message):
    (tmp_path / "a.pfm").write_bytes(data)
    with pytest.raises(InputError) as error:
        read_pfm(tmp_path / "a.pfm")
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    with pytest.raises(InputError, match=r"b\.pfm: the file: found no such file"):
        read_pfm(tmp_path / "b.pfm")


def test_display_values_are_srgb_of_the_exposed_image():
    image = np.array([[[0.0, 0.25, 4.0], [1.0, 0.002, np.inf]]], dtype=np.float32)
    shown = displayed(image, 0.5)
    assert shown[0, 0] == pytest.approx([0, 1.055 * 0.125 ** (1 / 2.4) - 0.055, 1])
    assert shown[0, 1] == pytest.approx([1.055 * 0.5 ** (1 / 2.4) - 0.055, 12.92 * 0.001, 1])
    assert exposure_of(np.full((4, 4, 3), 0.25)) == 4
    assert exposure_of(np.zeros((4, 4, 3))) == 1


def test_flip_is_zero_for_equal_images_and_grows_with_the_error():
    pytest.importorskip("flip_evaluator", reason="flip-evaluator is not installed; see analysis/requirements.txt")
    random = np.random.default_rng(1)
    reference = random.random((32, 32, 3), dtype=np.float32)
    means = [flip(reference, reference * (1 + error)).mean for error in (0, 0.1, 0.3)]
    assert means[0] == 0
    assert 0.01 < means[1] < means[2] < 1
    settings = {flip(reference, image).settings for image in (reference, reference * 1.3)}
    assert len(settings) == 1
    assert "ACES at 2 exposures" in settings.pop()
    with pytest.raises(InputError, match="allowed: equal sizes"):
        flip(reference, reference[:8])
    with pytest.raises(NotDrawable, match="not finite"):
        flip(reference, np.full_like(reference, np.nan))


def test_without_the_package_flip_is_one_clear_line_and_the_crops_stay(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    builder = study_of_all()
    with_images(builder, tmp_path)
    _, data = collected(builder, tmp_path, "equal_time")
    assert "FLIP needs the Python package flip-evaluator: python3 -m pip install" in data.caption
    assert "FLIP" not in data.sheets[0].shots[1].facts
    assert [note.kind for note in data.notes if note.kind == "no FLIP"] == ["no FLIP"]


# ---- The command ----


def test_plots_writes_all_figures_and_the_tables(tmp_path, analysis):
    builder = study_of_all()
    with_images(builder, tmp_path)
    code, out, err = analysis("plots", builder.write(tmp_path / "result.json"), "--out", tmp_path / "figures")
    assert (code, err) == (0, "")
    names = sorted(path.name for path in (tmp_path / "figures").iterdir())
    drawn = [f"cornell_{part}" if part else "cornell" for part in PARTS]
    assert names == sorted(
        [f"{name}.png" for name in drawn]
        + [f"{name}.svg" for name in drawn if name != "cornell_equal_time"]
        + ["summary.md"]
    )
    assert "not drawn: cornell_without_checkpoints: the study asks for no figure" in out
    for name in drawn:
        with Image.open(tmp_path / "figures" / f"{name}.png") as image:
            assert len(image.convert("RGB").getcolors(1 << 24)) > 8, name
    summary = (tmp_path / "figures" / "summary.md").read_text()
    assert summary.count("Fit: MSE(n) = bias² + σ²/n") == 1
    (row,) = [line for line in summary.splitlines() if line.startswith("| first_bounce=cached | **plateau at 0.1")]
    assert "declared: first_bounce=cached: one sample" in row
    for said in (
        "| baseline | **converges** | 8 |", "(Holm, family-wise 1%)", "errors measured once, by wavefront/",
        "| sampler=sobol_owen |", "at least as steep as -1", "two halves of 65536 spp each by depth_first",
        "| Variant | Wall ms/spp | Device ms/spp | CPU ms/spp | σ² × ms/spp |", "ms to RMSE 0.1", "| never |",
        "Render wall time per spp with checkpoints over that without",
    ):  # fmt: skip
        assert said in summary, said


def test_one_figure_that_cannot_be_drawn_does_not_stop_the_others(tmp_path, analysis, monkeypatch):
    monkeypatch.setattr("ptbench.plots.command.save_figure", lambda figure, folder, name: [folder / f"{name}.png"])
    builder = convergence_study(on_gpu())
    convergence_cell(builder, Law(noisy=False), spps=SPPS)
    code, out, _ = analysis("plots", builder.write(tmp_path / "result.json"), "--out", tmp_path / "figures")
    assert code == 0
    assert "not drawn: cornell: equal_time: cornell_open: no cell names an image" in out
    assert "not drawn: cornell: checkpoint_cost: no cell was also run without checkpoints" in out
    assert str(tmp_path / "figures" / "cornell.png") in out.splitlines()
    summary = (tmp_path / "figures" / "summary.md").read_text()
    assert "Not drawn: equal_time: cornell_open: no cell names an image" in summary


def test_other_studies_have_one_figure():
    assert parts_of_study(load_study("compaction")) == ("",)
    assert parts_of_study(load_study("convergence")) == PARTS


def load_study(figure: str):
    from ptbench.io.cells import Study

    return Study("s", figure, "")
