"""Texts of a figure that lie on one another or are cut off at its edge, as they are drawn."""

import itertools

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

TOUCHING = 0.02
"""Inches by which the boxes of two texts may overlap: they have some air around the letters."""


def overlaps(figure):
    """Return pairs of texts that overlap, and texts with None that leave the figure."""
    canvas = FigureCanvasAgg(figure)
    drawn, draw = {}, Text.draw

    def noted(text, renderer, *args, **kwargs):
        if text.get_visible() and text.get_text().strip():
            drawn[id(text)] = text.get_text(), text.get_window_extent(renderer)
        return draw(text, renderer, *args, **kwargs)

    Text.draw = noted  # only what is drawn counts: ticks beyond the ends of an axis are not
    try:
        canvas.draw()
    finally:
        Text.draw = draw
    room, found = TOUCHING * figure.dpi, []
    for (text, box), (other, its) in itertools.combinations(drawn.values(), 2):
        across, up = (
            min(getattr(box, end), getattr(its, end)) - max(getattr(box, start), getattr(its, start))
            for start, end in (("x0", "x1"), ("y0", "y1"))
        )
        if min(across, up) > room:
            found.append((text, other))
    for text, box in drawn.values():
        beyond = box.x1 - figure.bbox.width, box.y1 - figure.bbox.height
        if max(-box.x0, -box.y0, *beyond) > room:
            found.append((text, None))
    return found
