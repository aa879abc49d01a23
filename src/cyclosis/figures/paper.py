"""A figure of matplotlib that notebooks show, and what its files say of its origin."""

from __future__ import annotations

import io
from typing import Any

from matplotlib import figure

from ..version import __version__
from .looks import setting

DPI = 144
"""Dots per inch of a figure that a notebook shows."""


class Figure(figure.Figure):
    """A figure that a notebook shows even where pyplot, which tells notebooks of figures, is not in use."""

    def _repr_png_(self) -> bytes:
        """Return the picture, as notebooks ask for it."""
        from .style import TYPE  # which makes such figures

        file = io.BytesIO()
        with setting(TYPE):
            self.savefig(file, format="png", dpi=DPI, metadata=metadata(self, "png"))
        return file.getvalue()


def metadata(drawn: figure.Figure, kind: str) -> dict[str, Any]:
    """Return what a saved figure says of its origin, in the words that its format has."""
    maker, about = f"cyclosis {__version__}", str(drawn.get_label())
    if kind == "png":
        return {"Software": maker, "Description": about}
    if kind == "pdf":
        return {"Creator": maker, "Keywords": about}
    if kind == "svg":
        return {"Creator": maker, "Description": about, "Date": None}
    return {"Creator": f"{maker} {about}".strip()}
