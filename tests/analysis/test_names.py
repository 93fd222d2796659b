"""Names of variants, from files of every age, and what all rows of a table share."""

import re

import pytest
from conftest import RESULTS

from ptbench.io.names import axes_spelled_out, shown_name, tuned_in, with_shown_names
from ptbench.io.results import load_kept
from ptbench.studies.variants import table_names

BASELINES = {"integrator": "wavefront", "compaction": "none", "layout": "aos", "arithmetic": "precise"}


@pytest.mark.parametrize(
    ("axes", "tuned", "name"),
    [
        ({}, {}, "?"),
        ({"integrator": "wavefront", "compaction": "none"}, {}, "wavefront"),
        ({"integrator": "megakernel", "layout": "aos"}, {"block": "64"}, "megakernel block=64"),
        (
            {"integrator": "wavefront", "compaction": "thrust_remove_if", "layout": "soa"},
            {},
            "wavefront compaction=thrust_remove_if layout=soa",
        ),
        # No baseline is known of this axis: what was before it was there is not told.
        ({"integrator": "wavefront", "robustness": "robust"}, {}, "wavefront"),
        ({"integrator": "wavefront", "robustness": "naive"}, {}, "wavefront robustness=naive"),
    ],
)
def test_a_name_says_what_differs(axes, tuned, name):
    assert shown_name(axes, tuned, BASELINES) == name


def test_tunables_are_found_in_names_of_every_age():
    axes = {"integrator": "wavefront", "layout": "soa"}
    assert tuned_in("wavefront layout=soa jitters=4 block=64", axes) == {"jitters": "4", "block": "64"}
    assert tuned_in("wavefront.none.soa+jitters=4+block=64", axes) == {"jitters": "4", "block": "64"}
    assert tuned_in("wavefront+jitters=4", axes) == {"jitters": "4"}
    assert tuned_in("wavefront", axes) == {}


def test_an_older_name_is_its_choices_in_the_order_of_the_files_axes():
    assert axes_spelled_out("a.b", ("integrator", "layout")) == {"integrator": "a", "layout": "b"}
    assert axes_spelled_out("a.b+jitters=1", ("integrator", "layout")) == {"integrator": "a", "layout": "b"}
    assert axes_spelled_out("wavefront layout=soa", ("integrator", "layout")) == {}


def test_every_committed_cell_has_one_name_and_the_name_its_cells():
    """Names of cells are one to one with the older names: no cell has two, and no two cells share one."""
    for file in sorted(RESULTS.glob("*/*.json*")):
        if file.stem.partition(".")[0] not in ("compaction", "scaling", "seeds", "convergence", "schedulers", "packet"):
            continue
        result = load_kept(file)
        pairs = {(cell.variant, cell.variant_in_file) for cell in result.cells}
        assert len({shown for shown, _ in pairs}) == len({spelled for _, spelled in pairs}) == len(pairs), file


def test_what_all_rows_share_stands_above():
    result = load_kept(next((RESULTS / "nvidia-h200").glob("compaction.json*")))
    named = table_names(result, result.cells)
    assert named.shared == "arithmetic=exact"
    assert named.above() == ["All rows: arithmetic=exact.", ""]
    assert "wavefront" in named.names.values()
    assert not any("arithmetic" in name for name in named.names.values())
    one = table_names(result, result.cells[:1])
    assert (one.shared, *one.names.values()) == ("", "wavefront arithmetic=exact")


def test_a_message_of_an_older_file_names_variants_as_they_are_shown():
    order = ("integrator", "compaction", "layout", "arithmetic")
    text = "film bits equal to megakernel.none.soa.precise+block=64 and to the CPU's; see a.b.c.d.e and kernels.cu"
    assert with_shown_names(text, order, BASELINES) == (
        "film bits equal to megakernel layout=soa block=64 and to the CPU's; see a.b.c.d.e and kernels.cu"
    )
    new = "film bits equal to megakernel layout=soa block=64"
    assert with_shown_names(new, order, BASELINES) == new


@pytest.mark.parametrize("file", ["compaction.json", "convergence.json"])
def test_a_cells_shown_name_is_the_promised_one(file):
    cells = load_kept(RESULTS / "nvidia-h200" / file).cells
    names = [cell.shown for cell in cells]
    form = re.compile(r"\w+(?:/\w+:\w+)*/scene:\w+/backend:cuda/\d+x\d+/depth:\d+/spp:\d+(?:/checkpoints:octaves)?")
    assert [name for name in names if not form.fullmatch(name)] == []
    assert len(set(names)) == len(names)


def test_no_committed_summary_has_a_name_of_an_older_file():
    spelled = re.compile(r"\b\w+(?:\.[a-z0-9_]+){6,}")
    for page in sorted(RESULTS.glob("*/figures/*/summary.md")):
        assert spelled.findall(page.read_text(encoding="utf-8")) == [], f"{page}: run python3 -m ptbench plots"
