"""What a state on a closed surface is, by measurable criteria."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...analysis.zones import DISORDER, DOMINANT
from ...closed.defects import Defect, defects
from ...closed.grid import Array, ClosedGrid
from ...closed.shapes import Sphere
from ...model.grid import sign_changes
from ...model.wording import beside

REGIMES = (
    "disordered",
    "source-to-sink",
    "cyclosis",
    "circulation",
    "multistripe",
    "swirl",
    "travelling",
    "undecided",
)
SETTLED = 1e-3
"""Relative rate <|dP/dt|²>^½ / <|P|²>^½ below which a state counts as settled."""
TURNING = 0.9
"""Share of |dP/dt|² that a rotation about the axis must explain for a state to count as travelling, and share
of <|u|²> that a rigid rotation must explain for a droplet to count as circulating."""
STRAIGHT = 0.5
"""The circles on which streams are counted have at least this radius: those near the poles are left out,
because streams turn over there."""


@dataclass(frozen=True, eq=False)
class ClosedRegime:
    """What a state on a closed surface is, and the numbers that show it (all dimensionless).

    `name` is one of `REGIMES`; `reason` a short sentence. `defects` are those of P, with indices that sum to
    2. `order` is <|P|²>^½, `circulation` the vector (3,) 3/2 <x × u>, `drift` the angular velocity about the
    axis that best explains dP/dt, `rate` the relative rate of change, `settled` whether that is below 10⁻³.

    The first criterion that holds gives the name:

    * `disordered`: <|P|²>^½ < 0.05.
    * `travelling`: not settled, and a rotation about the axis explains 90 % of |dP/dt|².
    * `circulation`, on a sphere only: a rigid rotation explains 90 % of <|u|²>.
    * `swirl`: 80 % of <|P|²> is in P_theta; filaments run around the axis.
    * `source-to-sink`: P_s has one sign on all circles of radius 0.5 or more, and holds at least half of
      <|P|²>: filaments run from pole to pole. There is no flow if nothing depends on theta.
    * `cyclosis`: every such circle is crossed by exactly two indifferent zones: two counter-streaming
      stripes, joined over the poles.
    * `multistripe`: the same with four or more.
    * `undecided`: none of these (yet).
    """

    name: str
    reason: str
    defects: list[Defect]
    order: float
    circulation: Array
    drift: float
    rate: float
    settled: bool

    def __str__(self) -> str:
        return f"{self.name} ({self.reason})"

    @property
    def details(self) -> dict[str, str]:
        """The defects and the circulation in words, by what they are."""
        counts = {index: [found.index for found in self.defects].count(index) for index in (1, -1)}
        listed = ", ".join(f"{count} of {index:+d}" for index, count in counts.items() if count)
        x, y, z = self.circulation
        return {"defects of P": listed or "none", "circulation": f"({x:.4f}, {y:.4f}, {z:.4f})"}


def judged(grid: ClosedGrid, P: Array, u: Array, change: Array, turning: Array) -> ClosedRegime:
    """Return the regime of a state P, its flow u, its rate of change, and its derivative by theta.

    All are vector fields (2, n_theta, n_s).
    """
    order = float(np.sqrt(grid.mean(np.sum(P**2, axis=0))))
    speed2 = float(grid.mean(np.sum(u**2, axis=0)))
    rate2, turn2 = (float(grid.mean(np.sum(field**2, axis=0))) for field in (change, turning))
    rate = np.sqrt(rate2) / max(order, 1e-300)
    along = float(grid.mean(np.sum(change * turning, axis=0)))
    drift = -along / turn2 if turn2 > 1e-12 * order**2 else 0.0
    explained = drift**2 * turn2 / rate2 if rate2 > 0 else 0.0
    in_space = grid.e_theta * u[0] + grid.e_s * u[1]
    circulation = 1.5 * grid.mean(np.cross(grid.xyz, in_space, axis=0))
    rigid = 2 / 3 * float(circulation @ circulation) / speed2 if speed2 > 0 else 0.0
    name, reason = _name(grid, P, order, rate, drift, explained, rigid)
    found = defects(grid, P) if order >= DISORDER else []
    return ClosedRegime(name, reason, found, order, circulation, drift, float(rate), bool(rate < SETTLED))


def _name(
    grid: ClosedGrid, P: Array, order: float, rate: float, drift: float, explained: float, rigid: float
) -> tuple[str, str]:
    if order < DISORDER:
        return "disordered", f"order {beside(order, DISORDER, 2)} is below {DISORDER}"
    if rate >= SETTLED and explained >= TURNING:
        return "travelling", f"rotates about the axis at {drift:.3g}"
    if isinstance(grid.surface, Sphere):
        if rigid >= TURNING:
            return "circulation", "the flow circulates about one axis"
        return "undecided", f"a rotation explains {100 * rigid:.0f} % of the flow"
    around = float(grid.mean(P[0] ** 2)) / order**2
    if around >= DOMINANT:
        return "swirl", f"{100 * around:.0f} % of the order runs around the axis"
    straight = P[1][:, grid.r >= STRAIGHT]
    up, crossed = straight > 0, sign_changes(straight)
    low, high = int(crossed.min()), int(crossed.max())
    if low != high:
        return "undecided", f"{low} to {high} indifferent zones along the cell"
    if around > 0.5:
        return "undecided", f"{100 * around:.0f} % of the order runs around the axis"
    if high == 0 and up.any() and not up.all():
        return "undecided", "the polarity changes along the cell, not around it"
    if high == 0:
        return "source-to-sink", "one polarity, from one end to the other"
    if high == 2:
        return "cyclosis", "two stripes along the whole cell, joined over its ends"
    return "multistripe", f"{high} stripes along the whole cell"
