"""From a state to its regime, by measurable criteria."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..display.shown import shown
from ..model.closures import PAPER
from ..model.doors import door
from ..model.filaments import TermLike
from ..model.grid import Array, CylinderGrid, resolved
from ..model.parameters import Parameters
from ..model.system import rate_of_change
from ..model.wording import beside
from .zones import DISORDER as DISORDER
from .zones import DOMINANT as DOMINANT
from .zones import crossings, stripe_widths, zones_of

REGIMES = (
    "disordered",
    "unidirectional",
    "cyclosis",
    "multistripe",
    "circumferential",
    "travelling",
    "undecided",
)

SETTLED = 1e-3
"""Relative rate <|dP/dt|²>^½ / <|P|²>^½ below which a state counts as settled."""
TRANSLATION = 0.9
"""Share of |dP/dt|² that a rigid drift must explain for a state to count as travelling."""


@shown
@dataclass(frozen=True, eq=False)
class Regime:
    """What a state is, and the numbers that show it (all dimensionless).

    `name` is one of `REGIMES`; `reason` a short sentence. `zones` are the angles (radians) at which the
    axial mean of P_z changes sign, `widths` the stripes between them as fractions of the circumference
    (both empty if there are none), `mean_P` the mean order vector (2,), `order` <|P|²>^½, `drift` the
    rigid velocity (theta, z) that best explains dP/dt, `rate` the relative rate of change
    <|dP/dt|²>^½ / <|P|²>^½, `settled` whether that is below 10⁻³.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> found = cy.regime(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> found.name, found.reason, found.widths.round(4)
        ('cyclosis', 'two stripes along the whole cell', array([0.5, 0.5]))
        >>> round(found.order, 4), found.settled, found.zones.shape, found.drift.shape
        (0.6364, False, (2,), (2,))
        >>> found.details["stripe widths"]
        '0.5000 : 0.5000'
    """

    name: str
    reason: str
    zones: Array
    widths: Array
    mean_P: Array
    order: float
    drift: Array
    rate: float
    settled: bool

    def __str__(self) -> str:
        return f"{self.name} ({self.reason})"

    @property
    def details(self) -> dict[str, str]:
        """The zones and the widths of the stripes in words, by what they are."""
        angles = ", ".join(f"{np.degrees(angle):.1f}°" for angle in self.zones)
        return {
            "indifferent zones": f"{self.zones.size}, at {angles}" if self.zones.size else "none",
            "stripe widths": " : ".join(f"{width:.4f}" for width in self.widths) or "none",
        }


@door
def regime(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    terms: Iterable[TermLike] | None = None,
    time: float = 0.0,
    dealias: str = "none",
    closure: str = PAPER,
) -> Regime:
    """Return the `Regime` of a state (2, n_theta, n_z), dimensionless.

    The first criterion that holds gives the name:

    * `disordered`: <|P|²>^½ < 0.05.
    * `travelling`: never steady, but drifting or rotating as a whole. The relative rate of change is at
      least 10⁻³ and a rigid drift explains 90 % of |dP/dt|²: dP/dt = -c·∇P.
    * `circumferential`: 80 % of <|P|²> is in P_theta; filaments run around the axis.
    * `unidirectional`: P_z has one sign everywhere, and holds at least half of <|P|²>.
    * `cyclosis`: every circle z = const is crossed by exactly two indifferent zones, that is two
      counter-streaming stripes; at least half of <|P|²> is in P_z.
    * `multistripe`: the same with four or more.
    * `undecided`: none of these (yet).

    The name describes the state, not whether it lasts: see `rate` and `settled`. The state is taken
    without its Nyquist modes, as in the right-hand side. Raises `InputError` if state or parameter fields do
    not match the grid.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> print(cy.regime(params, grid, cy.initial.stripes(grid)))
        cyclosis (two stripes along the whole cell)
        >>> cy.regime(params, grid, cy.initial.disordered(grid)).name
        'disordered'
    """
    P = resolved(grid.check_state(state))
    return judged(grid, P, rate_of_change(params, grid, P, time, terms, dealias, closure))


def judged(grid: CylinderGrid, P: Array, change: Array) -> Regime:
    """Return the `Regime` of a state P (2, n_theta, n_z) without Nyquist modes that changes at a rate."""
    order = float(np.sqrt(np.mean(np.sum(P**2, axis=0))))
    rate = float(np.sqrt(np.mean(np.sum(change**2, axis=0)))) / max(order, 1e-300)
    drift, explained = _drift(grid, P, change)
    name, reason = _name(P, order, rate, drift, explained)
    zones = zones_of(P)
    return Regime(
        name, reason, zones, stripe_widths(zones), P.mean(axis=(1, 2)), order, drift, rate, rate < SETTLED
    )


def _name(P: Array, order: float, rate: float, drift: Array, explained: float) -> tuple[str, str]:
    if order < DISORDER:
        return "disordered", f"order {beside(order, DISORDER, 2)} is below {DISORDER}"
    if rate >= SETTLED and explained >= TRANSLATION:
        return "travelling", f"drifts at {drift[0]:.3g} around and {drift[1]:.3g} along the axis"
    around = float(np.mean(P[0] ** 2)) / order**2
    if around >= DOMINANT:
        return "circumferential", f"{100 * around:.0f} % of the order runs around the axis"
    up = P[1] > 0
    crossed = crossings(P)
    low, high = int(crossed.min()), int(crossed.max())
    one_sign = bool(up.all() or not up.any())
    if low != high:
        return "undecided", f"{low} to {high} indifferent zones along the axis"
    if around > 0.5:
        return "undecided", f"{100 * around:.0f} % of the order runs around the axis"
    if high == 0 and not one_sign:
        return "undecided", "the polarity changes along the axis, not around it"
    if high == 0:
        return "unidirectional", "one polarity, no indifferent zone"
    if high == 2:
        return "cyclosis", "two stripes along the whole cell"
    return "multistripe", f"{high} stripes along the whole cell"


def _drift(grid: CylinderGrid, P: Array, change: Array) -> tuple[Array, float]:
    """Fit dP/dt = -c·∇P; return c and the share of |dP/dt|² that it explains."""
    spectrum = np.fft.fft2(P)
    m, q = 1j * grid.m[:, None], 1j * grid.q[None, :]
    gradients = np.stack([np.fft.ifft2(k * spectrum).real.ravel() for k in (m, q)])
    target = change.ravel()
    size = float(target @ target)
    if size == 0.0 or not np.isfinite(size):
        return np.zeros(2), 0.0
    # A drift is not defined along a direction in which the state hardly varies: leave it at zero.
    scale = np.sqrt(np.sum(gradients**2, axis=1))
    usable = scale > 1e-6 * np.sqrt(np.sum(P**2))
    drift = np.zeros(2)
    if usable.any():
        drift[usable] = -np.linalg.lstsq(gradients[usable].T, target, rcond=1e-10)[0]
    remainder = target + drift @ gradients
    return drift, 1.0 - float(remainder @ remainder) / size
