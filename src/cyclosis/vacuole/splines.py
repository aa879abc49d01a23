"""The velocity anywhere in the vacuole, by B-splines on a grid that has neither a pole nor a wall.

With r = cos s over the whole diameter (r < 0 is the opposite θ) the Cartesian components are smooth and
periodic in s, θ and z, even about s = 0. Points s_i = (i + 1/2) π/n_s therefore need no condition on the axis
or the wall. The coefficients are found once, by the filters of SciPy; values follow in JAX, which has splines
of order 1 only.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..model.grid import Array
from .flow import VacuoleFlow, cartesian

FRONT, BACK = 3, 4
"""Points that are repeated before and after each direction, so that no index has to be wrapped."""


class Lattice(NamedTuple):
    """The points of a table: `n_s` over the diameter and `n_theta`, both even, `n_z`, and the period."""

    n_s: int
    n_theta: int
    n_z: int
    length: float
    order: int

    @property
    def stored(self) -> tuple[int, int, int]:
        """The shape of a table: half of the diameter, and repeated points in every direction."""
        margin = FRONT + BACK
        return self.n_s // 2 + margin, self.n_theta + margin, self.n_z + margin


def coefficients(flow: VacuoleFlow, lattice: Lattice) -> Array:
    """Return the table (3, n, n, n) of the spline through the velocity at the points of a lattice."""
    from scipy.ndimage import spline_filter1d

    half, shape = lattice.n_s // 2, (lattice.n_theta, lattice.n_z)
    s = (np.arange(half) + 0.5) * np.pi / lattice.n_s
    angles = 2 * np.pi / shape[0] * np.arange(shape[0], dtype=np.float64)
    near = cartesian(flow.volume(np.cos(s), shape), angles[:, None])
    far = np.roll(near, shape[0] // 2, axis=2)[:, ::-1]
    whole = np.concatenate([near, far], axis=1)
    for axis, mode in ((1, "reflect"), (2, "grid-wrap"), (3, "grid-wrap")):
        whole = spline_filter1d(whole, lattice.order, axis=axis, mode=mode)
    along = np.arange(-FRONT, half + BACK)
    rows = np.where(along < 0, -1 - along, along)  # even about s = 0
    columns, layers = (np.arange(-FRONT, n + BACK) % n for n in shape)
    return np.ascontiguousarray(whole[:, rows][:, :, columns][:, :, :, layers])


def lattice_of(flow: Any, order: int, refine: int, n_s: int) -> Lattice:
    """Return the lattice of a flow: `refine` times as fine as its grid, and even around the axis."""
    around = refine * flow.grid.n_theta
    return Lattice(n_s, around + around % 2, refine * flow.grid.n_z, float(flow.grid.length), order)


def velocity(table: Any, xyz: Any, lattice: Lattice) -> Any:
    """Return the velocity (3, n), Cartesian, at points (3, n) of x, y, z; beyond the wall that at it."""
    radius = jnp.minimum(jnp.hypot(xyz[0], xyz[1]), 1.0)
    angle = jnp.arctan2(xyz[1], xyz[0])
    places = (
        jnp.arccos(radius) * (lattice.n_s / jnp.pi) - 0.5,
        (angle * (lattice.n_theta / (2 * jnp.pi))) % lattice.n_theta,
        (xyz[2] * (lattice.n_z / lattice.length)) % lattice.n_z,
    )
    flat, (_, n1, n2) = table.reshape(3, -1), lattice.stored
    start: Any = 0
    weights = []
    for place, size in zip(places, (1, n1, n2), strict=True):
        whole = jnp.floor(place)
        weights.append(b_spline((place - whole).astype(table.dtype), lattice.order))
        start = start * size + whole.astype(jnp.int32) + FRONT - (lattice.order - 1) // 2
    taps = range(lattice.order + 1)

    def plane(first: Any, weight: Any) -> Any:
        out = [jnp.zeros_like(weight)] * 3
        for b in taps:
            both = weight * weights[1][b]
            for c in taps:
                at, last = first + (b * n2 + c), both * weights[2][c]
                for k in range(3):
                    out[k] = out[k] + last * flat[k].at[at].get(mode="promise_in_bounds")
        return jnp.stack(out)

    if lattice.order == 3:
        total = sum(plane(start + a * n1 * n2, weights[0][a]) for a in taps)
    else:  # written out in full it would take half a minute to compile
        across = jnp.stack(weights[0])
        first = jnp.zeros((3, xyz.shape[1]), table.dtype)
        total = jax.lax.fori_loop(
            0, lattice.order + 1, lambda a, sum_: sum_ + plane(start + a * (n1 * n2), across[a]), first
        )
    return total.astype(xyz.dtype)


def b_spline(t: Any, order: int) -> list[Any]:
    """Return the order + 1 values, at 0 <= t <= 1 past a knot, of the B-splines of odd order there."""
    values = [jnp.ones_like(t)]
    for p in range(1, order + 1):  # Cox and de Boor, on knots at whole numbers
        higher = [jnp.zeros_like(t)] * (p + 1)
        for k, value in enumerate(values):
            higher[k] = higher[k] + value * (k + 1 - t) / p
            higher[k + 1] = higher[k + 1] + value * (t + p - 1 - k) / p
        values = higher
    return values


@lru_cache(maxsize=16)
def compiled_velocity(lattice: Lattice) -> Any:
    """Return `velocity` for one lattice, compiled."""
    return jax.jit(lambda table, xyz: velocity(table, xyz, lattice))
