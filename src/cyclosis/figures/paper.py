"""A figure of matplotlib that notebooks show."""

from __future__ import annotations

import io

from matplotlib import figure

from .looks import setting

DPI = 144
"""Dots per inch of a figure that a notebook shows."""


class Figure(figure.Figure):
    """A figure that a notebook shows even where pyplot, which tells notebooks of figures, is not in use."""

    def _repr_png_(self) -> bytes:
        """Return the picture, as notebooks ask for it."""
        from .style import TYPE, metadata  # which makes such figures

        file = io.BytesIO()
        with setting(TYPE):
            self.savefig(file, format="png", dpi=DPI, metadata=metadata(self, "png"))
        return file.getvalue()
