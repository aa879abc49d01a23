"""Roses of filament angles: the density at points around a cell as it orders, and across a zone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt
import xarray
from matplotlib.figure import Figure

from ..analysis.zones import zones_of
from ..model.doors import door
from ..model.errors import InputError
from ..model.grid import Array
from ..models.kinetic.angular import density
from . import frames
from .looks import setting
from .style import INK, QUIET, TYPE, WIDTH, blank, place, polarity_rgb

__all__ = [
    "ACROSS",
    "ANGLES",
    "roses",
]


def __dir__() -> list[str]:
    return sorted(__all__)


COLUMNS, ROWS = 8, 4
"""Points around the cell, and times at which they are shown."""
ACROSS = 0.6
"""Angle on either side of a zone, in radians, up to which roses are drawn."""
ANGLES = 256
_REACH = 0.47
"""Radius of the largest rose; the next is at a distance of 1."""
# Places in millimetres.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP = 16.0, 2.0, 10.0, 3.0, 9.0


@door
def roses(dataset: xarray.Dataset, times: npt.ArrayLike | None = None, width: float = WIDTH) -> Figure:
    """Draw the density of filament angles Ψ(φ) at eight points around a cell, and across a zone.

    `dataset` is that of a run of the kinetic model. Each rose has the radius √Ψ in the direction φ, so that
    its area is the concentration: upward is e_z, to the right e_theta. Colours are those of P_z, a line is P.
    One row for each of `times`, by default four that show how the cell orders; all at half the length of the
    cell. The last row is a closer look across the first zone of the last of the times, if it has one. `width`
    is in millimetres. Raises `InputError` for the dataset of another model, and for times that it does not
    have.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.figures.roses import roses
        >>> grid = cy.CylinderGrid(16, 1)
        >>> state = cy.kinetic.dressed(cy.initial.stripes(grid, magnitude=0.5), modes=12)
        >>> run = cy.simulate(cy.Parameters(d_r=0.1), grid, state, t_end=3.0, model=cy.models.kinetic)
        >>> len(roses(run.to_dataset()).axes)  # four times, and a zone
        5
    """
    frames.grid_of(dataset)
    if "moments" not in dataset:
        rule = "that of a run of the kinetic model, with moments"
        raise InputError("dataset", "one without moments", rule, "run with --model kinetic")
    chosen = frames.story(dataset, ROWS) if times is None else frames.indices_at(dataset, times)
    half = dataset.sizes["z"] // 2
    rings = [_ring(dataset, index, half) for index in chosen]
    even: Array = 2 * np.pi / COLUMNS * np.arange(COLUMNS, dtype=np.float64)
    rows = [
        (f"$t$ = {float(dataset['time'][index]):g}", ring, even)
        for index, ring in zip(chosen, rings, strict=True)
    ]
    zones = zones_of(np.stack([rings[-1][1].real, rings[-1][1].imag])[:, :, None])
    if zones.size:
        rows.append(("a zone", rings[-1], zones[0] + ACROSS * np.linspace(-1.0, 1.0, COLUMNS + 1)))
    with setting(TYPE):
        return _drawn(rows, width)


def _ring(dataset: xarray.Dataset, index: int, z: int) -> npt.NDArray[Any]:
    """Return the moments (N + 1, n_theta) of a frame around the cell at one z."""
    real, imaginary = np.asarray(dataset["moments"].isel(time=index, z=z).values, dtype=np.float64)
    return np.asarray(real + 1j * imaginary)


def _at(ring: npt.NDArray[Any], angles: Array) -> npt.NDArray[Any]:
    """Return the moments (N + 1, points) at angles around the cell, by trigonometric interpolation."""
    n = ring.shape[1]
    waves = np.fft.fft(ring, axis=1) / n
    m = np.rint(n * np.fft.fftfreq(n))
    waves[:, np.abs(m) >= n / 2] = 0.0
    return np.asarray(waves @ np.exp(1j * np.outer(m, angles)))


def _drawn(rows: Sequence[tuple[str, npt.NDArray[Any], Array]], width: float) -> Figure:
    densities = [_densities(_at(ring, angles)) for _, ring, angles in rows]
    largest = max(float(psi.max()) for psi in densities)
    step = (width - _LEFT - _RIGHT) / max(len(angles) for _, _, angles in rows)
    closer = rows[-1][0] == "a zone"
    height = _BELOW + _ABOVE + len(rows) * step + (_GAP if closer else 0.0)
    figure = blank(width, height)
    for k, ((label, ring, angles), around) in enumerate(zip(rows, densities, strict=True)):
        last = closer and k == len(rows) - 1
        bottom = _BELOW if last else height - _ABOVE - (k + 1) * step
        ax = place(figure, _LEFT, bottom, step * len(angles), step)
        ax.set_xlim(-0.5, len(angles) - 0.5)
        ax.set_ylim(-0.5, 0.5)
        ax.set_frame_on(False)
        ax.set_yticks([0.0], [label])
        ax.tick_params(length=0)
        ends = last or k == len(rows) - (2 if closer else 1)
        ax.set_xticks(range(len(angles)) if ends else [], _names(angles, last) if ends else [])
        P = _at(ring, angles)[1]
        for place_at, (psi, p) in enumerate(zip(around, P, strict=True)):
            _rose(ax, float(place_at), psi / largest, complex(p))
        if ends:
            ax.set_xlabel(r"$\theta$ from the zone" if last else r"$\theta$", labelpad=1.0)
    return figure


def _names(angles: Array, closer: bool) -> list[str]:
    if closer:
        middle = angles[len(angles) // 2]
        return [f"{angle - middle:+.2f}".replace("-", "−").replace("+0.00", "0") for angle in angles]
    return [rf"${angle / np.pi:.3g}\,\pi$".replace("$1\\,", "$") if angle else "$0$" for angle in angles]


def _densities(m: npt.NDArray[Any]) -> Array:
    """Return Ψ (points, angles) of moments (N + 1, points), without what is below 0."""
    return np.maximum(density(m[:, :, None], max(ANGLES, 2 * len(m)))[:, 0], 0.0)


def _rose(ax: Any, x: float, psi: Array, p: complex) -> None:
    phi = 2 * np.pi / psi.size * np.arange(psi.size)
    radius = _REACH * np.sqrt(psi)
    colour = polarity_rgb(np.array([p.imag]))[0]
    ax.add_patch(matplotlib.patches.Circle((x, 0.0), _REACH, fill=False, edgecolor=QUIET, linewidth=0.4))
    ax.fill(x + radius * np.cos(phi), radius * np.sin(phi), facecolor=colour, edgecolor=INK, linewidth=0.6)
    if abs(p) > 0.02:
        ax.plot(
            [x, x + _REACH * p.real], [0.0, _REACH * p.imag], color=INK, linewidth=1.1, solid_capstyle="round"
        )
