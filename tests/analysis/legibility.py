"""Whether a drawn page can be read: no text is cut off, no two texts overlap."""

from __future__ import annotations

from itertools import combinations

from matplotlib.figure import Figure
from matplotlib.text import Text

from ptbench.figures import style


def texts_of(figure: Figure) -> list[Text]:
    """All that is written on the page."""
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    # Tick objects outside the limits exist but are not drawn.
    for axes in figure.axes:
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            for tick in axis.get_major_ticks() + axis.get_minor_ticks():
                if not low <= tick.get_loc() <= high or not tick.label1.get_visible():
                    texts = [text for text in texts if text is not tick.label1]
                texts = [text for text in texts if text is not tick.label2]
    return texts


def check_legible(figure: Figure, name: str) -> None:
    with style.applied():
        figure.draw_without_rendering()
        renderer = figure.canvas.get_renderer()
        boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in texts_of(figure)]
    assert len(boxes) > 5
    for text, box in boxes:
        inside = box.x0 >= 0 and box.y0 >= 0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1
        assert inside, f"{name}: {text!r} is cut off"
    for (one, a), (two, b) in combinations(boxes, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        along = min(a.y1, b.y1) - max(a.y0, b.y0)
        # A pixel of a hundred to the inch: boxes hold some air above and below their letters.
        assert across <= 1 or along <= 2, f"{name}: {one!r} and {two!r} overlap"
