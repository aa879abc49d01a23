"""The velocity anywhere in the vacuole, by B-splines on a grid that has neither a pole nor a wall.

With r = cos s over the whole diameter (r < 0 is the opposite θ) the Cartesian components are smooth and
periodic in s, θ and z, even about s = 0. Points s_i = (i + 1/2) π/n_s therefore need no condition on the axis
or the wall. The coefficients are found once, by the filters of SciPy; values follow in JAX, which has splines
of order 1 only.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import factorial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..model.grid import Array
from .flow import VacuoleFlow, cartesian

USUAL = 128
"""Points around and along from which on order 3 leaves an error below that of the usual step."""
KNOTS = {3: (1, 4, 1), 5: (1, 26, 66, 26, 1)}
"""Values of the B-splines at their inner knots, up to a factor."""
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
    # Along z the filter divides each wave by what the spline would make of it.
    turn = 2 * np.pi / shape[1] * np.arange(flow.q.size)
    inner = np.array(KNOTS[lattice.order]) / sum(KNOTS[lattice.order])
    response = inner @ np.cos(np.outer(np.arange(inner.size) - lattice.order // 2, turn))
    near = cartesian(replace(flow, modes=flow.modes / response).volume(np.cos(s), shape), angles[:, None])
    near = spline_filter1d(near, lattice.order, axis=2, mode="grid-wrap")
    far = np.roll(near, shape[0] // 2, axis=2)[:, ::-1]
    whole = spline_filter1d(np.concatenate([near, far], axis=1), lattice.order, axis=1, mode="reflect")
    along = np.arange(-FRONT, half + BACK)
    rows = np.where(along < 0, -1 - along, along)  # even about s = 0
    columns, layers = (np.arange(-FRONT, n + BACK) % n for n in shape)
    return np.ascontiguousarray(whole[:, rows][:, :, columns][:, :, :, layers])


def lattice_of(flow: Any, order: int, refine: int | None, n_s: int) -> Lattice:
    """Return the lattice of a flow, even around the axis: `refine` times as fine as its grid.

    Without `refine` it has `USUAL` points around and along, or twice those of the grid if they are more.
    """
    around, along = (max(USUAL, 2 * n) if refine is None else refine * n for n in flow.grid.shape)
    return Lattice(n_s, around + around % 2, along, float(flow.grid.length), order)


def velocity(parts: Any, xyz: Any, lattice: Lattice) -> Any:
    """Return the velocity (3, n), Cartesian, at points (3, n) of x, y, z; beyond the wall that at it.

    `parts` are the three components of a table, each in one row: slices of a table would be copied at every
    step of a loop.
    """
    start, weights = _places(xyz, lattice, parts[0].dtype)
    return _summed(parts, start, weights, lattice).astype(xyz.dtype)


def velocity_between(frames: Any, factors: Any, xyz: Any, lattice: Lattice) -> Any:
    """Return the velocity (3, n) that is the sum of frames times factors (frames,), at points (3, n).

    `frames` are the three components of tables, each (frames, points). Whole tables are summed for many
    points, and the velocities that they give for few, whichever has fewer numbers to read.
    """
    count, rows = frames[0].shape
    factors = factors.astype(frames[0].dtype)
    if xyz.shape[1] * (lattice.order + 1) ** 3 > rows:
        return velocity([jnp.tensordot(factors, part, axes=1) for part in frames], xyz, lattice)
    flat = [part.reshape(-1) for part in frames]
    start, weights = _places(xyz, lattice, flat[0].dtype)

    def add(k: Any, total: Any) -> Any:
        return total + factors[k] * _summed(flat, start + k * rows, weights, lattice)

    none = jnp.zeros(xyz.shape, flat[0].dtype)
    return jax.lax.fori_loop(0, count, add, none).astype(xyz.dtype)


def _places(xyz: Any, lattice: Lattice, dtype: Any) -> tuple[Any, list[Any]]:
    """Return where the points of the splines at points (3, n) begin in a row, and their weights."""
    start: Any = 0
    weights = []
    for place, size in zip(_steps(xyz, lattice), (1, *lattice.stored[1:]), strict=True):
        whole = jnp.floor(place)
        weights.append(b_spline((place - whole).astype(dtype), lattice.order))
        start = start * size + whole.astype(jnp.int32) + FRONT - (lattice.order - 1) // 2
    return start, weights


def _steps(xyz: Any, lattice: Lattice) -> tuple[Any, Any, Any]:
    """Return s, θ and z of points (3, n) in steps of a lattice."""
    radius = jnp.minimum(jnp.sqrt(xyz[0] ** 2 + xyz[1] ** 2), 1.0)
    angle = jnp.arctan2(xyz[1], xyz[0])
    return (
        jnp.arccos(radius) * (lattice.n_s / jnp.pi) - 0.5,
        lattice.n_theta * _fraction(angle / (2 * jnp.pi)),
        lattice.n_z * _fraction(xyz[2] / lattice.length),
    )


def _fraction(turns: Any) -> Any:
    """Return turns from 0 to 1; the remainder of division takes far longer for those beyond."""
    return turns - jnp.floor(turns)


def _summed(parts: Any, start: Any, weights: list[Any], lattice: Lattice) -> Any:
    _, n1, n2 = lattice.stored
    taps = range(lattice.order + 1)

    def plane(first: Any) -> Any:
        out = [jnp.zeros_like(weights[0][0])] * 3
        for b in taps:
            row = [jnp.zeros_like(out[0])] * 3
            for c in taps:
                at = first + (b * n2 + c)
                for k in range(3):
                    row[k] = row[k] + weights[2][c] * parts[k].at[at].get(mode="promise_in_bounds")
            for k in range(3):
                out[k] = out[k] + weights[1][b] * row[k]
        return jnp.stack(out)

    if lattice.order == 3:
        return sum(weights[0][a] * plane(start + a * n1 * n2) for a in taps)
    # Written out in full, or with its weights computed where they are used, it would take minutes to compile.
    barrier: Any = jax.lax.optimization_barrier
    start, weights = barrier((start, weights))
    across = jnp.stack(weights[0])
    none = jnp.zeros((3, start.size), parts[0].dtype)
    return jax.lax.fori_loop(
        0, lattice.order + 1, lambda a, total: total + across[a] * plane(start + a * (n1 * n2)), none
    )


def cells(xyz: Array, lattice: Lattice) -> Array:
    """Return the place (n,) in a row of a table at which the splines at points (3, n) begin."""
    return np.asarray(_places_of(lattice)(xyz))


def b_spline(t: Any, order: int) -> list[Any]:
    """Return the order + 1 values, at 0 <= t <= 1 past a knot, of the B-splines of odd order there."""
    values = [jnp.ones_like(t)]
    for p in range(1, order + 1):  # Cox and de Boor, on knots at whole numbers
        higher = [jnp.zeros_like(t)] * (p + 1)
        for k, value in enumerate(values):
            higher[k] = higher[k] + value * (k + 1 - t)
            higher[k + 1] = higher[k + 1] + value * (t + p - 1 - k)
        values = higher
    scale = 1 / factorial(order)  # once, because divisions are slow
    return [value * scale for value in values]


@lru_cache(maxsize=16)
def compiled_velocity(lattice: Lattice) -> Any:
    """Return `velocity` for one lattice, compiled."""
    return jax.jit(lambda table, xyz: velocity(table.reshape(3, -1), xyz, lattice))


@lru_cache(maxsize=16)
def _places_of(lattice: Lattice) -> Any:
    return jax.jit(lambda xyz: _places(xyz, lattice, xyz.dtype)[0])
