"""How fast a wall takes up what is dissolved in the vacuole, against the Péclet number."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import number
from ..vacuole import uptake
from ..vacuole.flow import VacuoleFlow
from .looks import setting
from .style import INK, QUIET, TYPE, UP, blank, place
from .vacuole_bands import compared, legend_of, peclet_numbers, wound

__all__ = [
    "vacuole_uptake",
]


def __dir__() -> list[str]:
    return sorted(__all__)


# Places in millimetres.
_LEFT, _BELOW, _HIGH, _ABOVE, _RIGHT = 15.0, 11.0, 56.0, 4.0, 4.0


@door
def vacuole_uptake(
    flow: VacuoleFlow, pitch: float | None = None, peclets: npt.ArrayLike | None = None, width: float = 100.0
) -> Figure:
    """Return the figure of the Sherwood number of an absorbing wall against the Péclet number Pe = UR/D.

    The bands are those of the flow on average (`flow` at one time of a run), straight, and wound with `pitch`
    in R: by default their own, or one turn in the length of the cell if they are straight. The Sherwood
    number is the rate at which the mean decays, in D/R²; that of diffusion alone is dashed. Pe is from 1 to
    10 000, or `peclets`. Dimensionless; `width` is in millimetres. Raises `InputError` for a flow without
    bands and for values out of range.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.vacuole_uptake import vacuole_uptake
        >>> grid = cy.CylinderGrid(16, 16)
        >>> flow = cy.vacuole.flow_of_state(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> figure = vacuole_uptake(flow, peclets=[10.0, 100.0])
        >>> [line.get_label() for line in figure.axes[0].get_lines()]
        ['diffusion', 'straight', 'pitch 5 $R$']
    """
    profile, turn = compared(flow, pitch)
    numbers = peclet_numbers(peclets)
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        ax = place(figure, _LEFT, _BELOW, width - _LEFT - _RIGHT, _HIGH)
        diffusion = uptake(wound(0 * profile, np.inf), 1.0)
        ax.axhline(diffusion, color=QUIET, linewidth=1.1, dashes=(4, 2), zorder=3, label="diffusion")
        for winding, colour in ((np.inf, INK), (turn, UP)):
            bands = wound(profile, winding)
            rates = [uptake(bands, pe) for pe in numbers]
            ax.plot(
                numbers, rates, "o-", color=colour, linewidth=1.4, markersize=3.2, label=legend_of(winding)
            )
        ax.set(xscale="log", xlim=(numbers[0], numbers[-1]), ylim=(0, None))
        ax.set(xlabel="Pe = $UR/D$", ylabel="Sherwood number")
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(loc="upper left", frameon=False, fontsize=9.0, handlelength=1.8)
        return figure
