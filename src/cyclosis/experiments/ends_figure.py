"""The figure of the experiment about the ends of cells."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray
from matplotlib.colors import ListedColormap

from ..figures import quantities
from ..figures.regime_maps import COLOURS as REGIME_COLOURS
from ..figures.story import Panel, reference, story
from ..figures.style import DOWN, INK, QUIET, UP
from . import closed_views
from .closed_cells import CAPSULE, CYLINDER, SHAPES, SPHEROID
from .ends_verdict import KINDS, NONE, differs, kinds, onset, verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = ((CAPSULE, 1.0, 0.5), (CAPSULE, 0.5, 0.025), (SPHEROID, 1.0, 0.5), (SPHEROID, 0.5, 0.025))
"""Cells that are drawn."""
COLOURS = (*(REGIME_COLOURS[name][0] for name in ("unidirectional", "cyclosis")), QUIET)
DEEP = 20
"""Stripes of a place in a map: the least common multiple of numbers of seeds."""


def draw(data: xarray.Dataset) -> Figure:
    """Draw four closed cells, the ends of every shape over both rates, and growth over ε."""
    titles = [f"{shape.split()[0]}, ({alpha_p:g}, {alpha_u:g})" for shape, alpha_p, alpha_u in SHOWN]
    shown = [
        closed_views.drawn(title, picture)
        for title, picture in zip(titles, data["picture"].values, strict=True)
    ]

    def plane(shape: str) -> Callable[[Any], None]:
        def drawn(ax: Any) -> None:
            found = kinds(data["end"].sel(shape=shape).transpose("alpha_u", "alpha_p", "seed", "number"))
            rows, columns = found.shape[:2]
            stripes = np.array([[_stripes(place) for place in row] for row in found]).reshape(rows, -1)
            ax.imshow(
                np.ma.masked_equal(stripes, NONE), cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=2.5,
                extent=(0, columns, 0, rows), origin="lower", aspect="auto", interpolation="nearest",
            )  # fmt: skip
            ax.set(xticks=np.arange(columns + 1), yticks=np.arange(rows + 1))
            ax.grid(color="white", linewidth=1.0)
            ax.tick_params(length=0, labelbottom=False, labelleft=False)
            for axis, name in ((ax.xaxis, "alpha_p"), (ax.yaxis, "alpha_u")):
                values = data[name].values
                named = [0, len(values) // 2, len(values) - 1] if len(values) > 3 else range(len(values))
                for k in named:
                    at, text = k + 0.5, f"{values[k]:g}"
                    if axis is ax.xaxis:
                        ax.text(at, -0.15, text, ha="center", va="top", fontsize=8)
                    else:
                        ax.text(-0.1, at, text, ha="right", va="center", fontsize=8)
            ax.spines[:].set_visible(False)
            if shape != CYLINDER:
                for i, j in np.argwhere(differs(data, shape)):
                    ax.plot(i + 0.5, j + 0.5, "o", color=INK, markersize=2.2)
            ax.set_title(shape.split()[0], fontsize=9.0, pad=13.0)
            if shape == CAPSULE:
                for kind, colour in zip(KINDS, COLOURS, strict=True):
                    ax.plot([], [], "s", color=colour, markersize=5.0, label=kind)
                ax.legend(
                    fontsize=8.0, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 0.98), ncols=3,
                    borderpad=0, handletextpad=0, columnspacing=0.8,
                )  # fmt: skip
            ax.set_xlabel("α$_p$", labelpad=9.0)
            ax.set_ylabel("α$_u$", labelpad=15.0)

        return drawn

    def grows(ax: Any) -> None:
        rate = data["over_epsilon"].sel(wave="displaced")
        lines = (
            ("nothing", UP, "-", "all terms"),
            ("advection", DOWN, "--", "no advection"),
            ("shear", INK, ":", "no shear"),
        )
        for name, colour, dashes, label in lines:
            values = rate.sel(without=name).isel(weak_alpha_u=0)
            ax.plot(data["epsilon"], values, color=colour, linestyle=dashes, linewidth=1.2, label=label)
        ax.axhline(0.0, color=INK, linewidth=0.5)
        if np.isfinite(at := onset(data, 0.0)):
            reference(ax, at, f"{at:.3f}", upright=True)
        ax.set_xlim(0, float(data["epsilon"][-1]))
        ax.set_xlabel("ε", labelpad=1.0)
        quantities.name(ax.yaxis, "growth, displaced sink", "rate", labelpad=1.0)
        ax.legend(fontsize=7.5, frameon=False, loc="upper left", borderpad=0, handlelength=1.6)

    panels = [*(Panel(plane(shape)) for shape in SHAPES), Panel(grows, 1.25)]
    return story(shown, panels, str(verdict(data)), width=200.0)


def _stripes(place: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return kinds of one place in order, `DEEP` of them in their shares; `NONE` where none is known."""
    known = np.sort(place[place != NONE])
    if not known.size:
        return np.full(DEEP, NONE)
    return np.asarray(known[(np.arange(DEEP) * known.size) // DEEP])
