"""A travelling state of the kinetic model: order, flow and the density of filament angles."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..model.doors import door
from ..model.errors import number
from ..stability.kinetic.travelling import TravellingState
from . import quantities
from .looks import setting
from .style import DOWN, INK, LEGEND, QUIET, TYPE, UP, WIDTH, blank, place

__all__ = [
    "ACROSS",
    "travelling",
]


def __dir__() -> list[str]:
    return sorted(__all__)


ACROSS = 400
"""Angles around the cell that are drawn."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _HIGH, _KEY = 15.0, 14.0, 10.0, 9.0, 18.0, 52.0, 3.0
_TURN = ["0", "π/2", "π", "3π/2", "2π"]


@door
def travelling(found: TravellingState, width: float = WIDTH) -> Figure:
    """Return the figure of a `TravellingState`, seen as it travels; dimensionless.

    Left, P_theta, P_z, |P| and the axial flow u_z over the angle θ around the cell; right, the density
    Ψ(θ, φ) of filaments at the angle φ to the circumference, π/2 along the cell. `width` in millimetres.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures import kinetic
        >>> params = cy.Parameters(kappa=0.1, d_r=0.1, d_s=0.05)
        >>> figure = kinetic.travelling(cy.kinetic.travelling_state(params, n_theta=16, modes=12))
        >>> len(figure.axes)
        3
    """
    width = number("width", width, 60.0, 1000.0, "choose a width in millimetres")
    theta = np.linspace(0, 2 * np.pi, ACROSS)
    P, u = found.at(theta)
    with setting(TYPE):
        figure = blank(width, _BELOW + _HIGH + _ABOVE)
        across = (width - _LEFT - _RIGHT - _GAP) / 2
        left = place(figure, _LEFT, _BELOW, across, _HIGH)
        left.axhline(0.0, color=QUIET, linewidth=0.6)
        curves = (
            (np.hypot(*P), INK, ":", "$|P|$"),
            (P[1], UP, "-", "$P_z$"),
            (P[0], DOWN, "-", r"$P_\theta$"),
            (u[1], INK, "-", "$u_z$"),
        )
        for values, colour, line, label in curves:
            left.plot(theta, values, color=colour, linestyle=line, linewidth=1.2, label=label)
        left.set_ylim(-1.05, 1.05)
        left.spines[["top", "right"]].set_visible(False)
        left.legend(**LEGEND | {"bbox_to_anchor": (-0.03, 1.0), "ncols": 4})
        right = place(figure, _LEFT + across + _GAP, _BELOW, across, _HIGH)
        drift = quantities.words(found.drift, "speed", ".6g")
        right.set_title(f"density of angles; drift {drift}", loc="left", fontsize=9.0, pad=3.0)
        image = right.pcolormesh(
            *_density(found), cmap="Purples", vmin=0.0, shading="gouraud", rasterized=True
        )
        right.set_ylabel("φ", labelpad=1.0)
        right.set_yticks(np.arange(-2, 3) * np.pi / 2, ["-π", "-π/2", "0", "π/2", "π"])
        for ax in (left, right):
            ax.set_xlim(0, 2 * np.pi)
            ax.set_xticks(np.arange(5) * np.pi / 2, _TURN)
            ax.set_xlabel("θ", labelpad=1.0)
        key = place(figure, width - _RIGHT + 2.0, _BELOW, _KEY, _HIGH)
        figure.colorbar(image, cax=key)
    return figure


def _density(found: TravellingState) -> tuple[object, object, object]:
    """Return θ from 0 to 2π, φ from -π to π, and Ψ (φ, θ), both ends included."""
    psi = found.density(4 * len(found.moments))
    psi = np.pad(np.fft.fftshift(psi, axes=1), ((0, 1), (0, 1)), mode="wrap")
    theta = np.linspace(0, 2 * np.pi, len(psi))
    return theta, np.linspace(-np.pi, np.pi, psi.shape[1]), psi.T
