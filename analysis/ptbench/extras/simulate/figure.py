"""Parallel efficiency over the number of GPUs: one panel per number of samples per pixel, one line per partition."""

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from ptbench.extras.simulate.model import PARTITIONS
from ptbench.extras.simulate.study import Study
from ptbench.extras.simulate.text import assumptions
from ptbench.figures import style


def draw(study: Study) -> Figure:
    """Draws the page of the simulation, whose caption lists the assumptions."""
    ranks, spps = study.parts.definition["ranks"], study.parts.definition["spp"]
    caption = (
        f"Simulated, {study.side}×{study.side} pixels, over {study.far.name}. Bands: the middle 90 % of trials. "
        + " ".join(assumptions(study))
        + " Nobody has run this on more GPUs than the page names."
    )
    looks = {partition: style.look(index) for index, partition in enumerate(PARTITIONS)}
    page, panels = style.panel_grid(
        "One render on many GPUs: what is left of their speed",
        caption,
        [f"{spp} samples a pixel" for spp in spps],
        [list(PARTITIONS) for _ in spps],
        label_width=max(style.text_width(name, style.LABEL_SIZE) for name in PARTITIONS),
        left=0.95,
        gap=0.35,
        plot_widths=(4.6, 2.9),
        least_height=2.3,
        y_label="Efficiency",
    )
    for axes, spp in zip(panels, spps, strict=True):
        axes.set_xscale("log", base=2)
        axes.set_xlim(ranks[0], ranks[-1])
        axes.set_ylim(0, 1.02)
        style.ticks(axes.xaxis, FixedLocator(ranks[::2]))
        axes.set_xlabel("GPUs")
        axes.grid(axis="y")
        ends = []
        for partition in PARTITIONS:
            spreads = [study.efficiencies[partition, spp, count] for count in ranks]
            look = looks[partition]
            values = [spread.value for spread in spreads]
            axes.plot(ranks, values, color=look.colour, linestyle=look.line, marker=look.marker, markersize=4)
            axes.fill_between(
                ranks, [one.low for one in spreads], [one.high for one in spreads], color=look.colour, alpha=0.15, lw=0
            )
            ends.append((ranks[-1], values[-1]))
        style.label_lines(page, axes, ends, list(PARTITIONS), list(looks.values()), above=0.0)
    return page.figure
