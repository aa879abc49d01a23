"""How a flow in the vacuole spreads what is dissolved there along the cell, against the Péclet number."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import number
from ..vacuole import dispersion
from ..vacuole.flow import VacuoleFlow
from .looks import setting
from .style import INK, QUIET, TYPE, UP, blank, place
from .vacuole_bands import compared, legend_of, peclet_numbers, wound

__all__ = [
    "vacuole_dispersion",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Places in millimetres.
_LEFT, _BELOW, _HIGH, _ABOVE, _RIGHT = 17.0, 11.0, 56.0, 4.0, 4.0


@door
def vacuole_dispersion(
    flow: VacuoleFlow, pitch: float | None = None, peclets: npt.ArrayLike | None = None, width: float = 100.0
) -> Figure:
    """Return the figure of Taylor dispersion along a sealed cell, D_eff/D, against the Péclet number UR/D.

    The bands are those of the flow on average (`flow` at one time of a run), straight, and wound with `pitch`
    in R: by default their own, or one turn in the length of the cell if they are straight. Straight bands
    have D_eff/D = 1 + c Pe²; c is in the legend. Pe is from 1 to 10 000, or `peclets`. Dimensionless; `width`
    is in millimetres. Raises `InputError` for a flow without bands and for values out of range.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.vacuole_dispersion import vacuole_dispersion
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> straight, twisted = vacuole_dispersion(flow, peclets=[10.0, 100.0]).axes[0].get_lines()[1:]
        >>> bool(straight.get_ydata()[1] > twisted.get_ydata()[1])  # the twist lowers it
        True
    """
    profile, turn = compared(flow, pitch)
    numbers = peclet_numbers(peclets)
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        ax = place(figure, _LEFT, _BELOW, width - _LEFT - _RIGHT, _HIGH)
        ax.axhline(1.0, color=QUIET, linewidth=1.1, dashes=(4, 2), label="diffusion")
        straight, twisted = wound(profile, np.inf), wound(profile, turn)
        c = dispersion(straight).coefficient
        names = (f"{legend_of(np.inf)}: 1 + {c:.4g} Pe$^2$", legend_of(turn))
        for bands, colour, name in zip((straight, twisted), (INK, UP), names, strict=True):
            ratios = [dispersion(bands, pe).ratio for pe in numbers]
            ax.plot(numbers, ratios, "o-", color=colour, linewidth=1.4, markersize=3.2, label=name)
        ax.set(xscale="log", yscale="log", xlim=(numbers[0], numbers[-1]), ylim=(0.7, None))
        ax.set(xlabel="Pe = $UR/D$", ylabel=r"$D_\mathrm{eff}/D$")
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(loc="upper left", frameon=False, fontsize=9.0, handlelength=1.8)
        return figure
