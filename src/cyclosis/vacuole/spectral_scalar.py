"""A scalar in the whole vacuole, in modes: waves around and along, eigenfunctions of diffusion in the radius.

    c = Σ y_kmq f_mk(r) exp(i m θ + i q z),    dy/dt = -(λ_mk + q²) y / Pe + <∇f* · v c> + forcing

The diagonal part is exact in the exponential steppers of `cyclosis.dynamics`; advection is in weak divergence
form: the rate of the mean is 0 to the last digit where the wall is sealed. Products are made on the points
of `RadialBasis` and on 3/2 times as many points as waves around and along, without aliasing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..model.grid import Array, CylinderGrid
from .radial import RadialBasis, radial_basis

Modes = npt.NDArray[np.complex128]


class Tables(NamedTuple):
    """What the compiled functions need: real arrays for every m in transform order."""

    value: Any
    slope: Any
    weights: Any
    r: Any
    m: Any
    q: Any


@dataclass(frozen=True, eq=False)
class Space:
    """The modes and the points of a scalar.

    Values are on `functions.r` x `grid.theta` x `grid.z`, shape (n_r, n_theta, n_z), modes complex of shape
    (k, 2 m_max + 1, q_max + 1): those with negative q follow from c being real.
    """

    grid: CylinderGrid
    functions: RadialBasis
    m_max: int
    q_max: int

    @cached_property
    def m(self) -> npt.NDArray[np.int64]:
        """Waves around the axis, in transform order."""
        return np.concatenate([np.arange(self.m_max + 1), np.arange(-self.m_max, 0)])

    @cached_property
    def q(self) -> Array:
        """Axial wavenumbers, from 0 up."""
        return 2 * np.pi / self.grid.length * np.arange(self.q_max + 1, dtype=np.float64)

    @cached_property
    def rates(self) -> Array:
        """λ + q² of every mode, (k, m, q); 0 for modes that do not exist."""
        own = self.functions.rates[np.abs(self.m)].T[:, :, None] + self.q**2
        return np.where(self.present[:, :, None], own, 0.0)

    @cached_property
    def present(self) -> npt.NDArray[np.bool_]:
        """Which modes (k, m) exist."""
        count = np.array(self.functions.count)[np.abs(self.m)]
        return np.asarray(np.arange(self.functions.rates.shape[1])[:, None] < count)

    @cached_property
    def twice(self) -> Array:
        """How often a mode with this q counts in sums over all modes: 1 for q = 0, else 2, shape (q,)."""
        return np.where(np.arange(self.q_max + 1) == 0, 1.0, 2.0)

    @cached_property
    def tables(self) -> Tables:
        """The arrays of the compiled functions."""
        f, m = self.functions, np.abs(self.m)
        return Tables(f.value[m], f.slope[m], f.weights, f.r, self.m.astype(float), self.q)

    def analyse(self, values: Array) -> Modes:
        """Return the modes of values (n_r, n_theta, n_z): the projection <f* c>."""
        return np.asarray(_analyse(self.tables, values))

    def synthesise(self, modes: npt.NDArray[Any]) -> Array:
        """Return the values (n_r, n_theta, n_z) of modes."""
        return np.asarray(_synthesise(self.tables, modes, self.grid.shape))

    def spectrum(self, pattern: Array) -> Modes:
        """Return the waves (m, q) of a pattern (n_theta, n_z) on the wall."""
        return np.asarray(_cut(self.tables, jnp.asarray(np.fft.rfft2(pattern, norm="forward"))))

    def harmonic(self, pattern: Array) -> Array:
        """Return the harmonic function at the points, (n_r, n_theta, n_z), with this pattern on the wall."""
        waves = self.spectrum(pattern)
        n, r = np.abs(self.m)[:, None], self.functions.r[:, None, None]
        out = np.zeros((r.size, *waves.shape), complex)
        out[:, :, :1] = waves[:, :1] * r**n
        x = self.q[1:]
        out[:, :, 1:] = waves[:, 1:] * growth(n, x, r)[0]
        return np.asarray(_to_points(self.tables, jnp.asarray(out), self.grid.shape))

    def harmonic_slope(self, pattern: Array) -> Modes:
        """Return the waves (m, q) of the radial derivative at the wall of that harmonic function."""
        waves = self.spectrum(pattern)
        n = np.abs(self.m)[:, None]
        slope = np.broadcast_to(n, waves.shape).astype(float).copy()
        slope[:, 1:] = growth(n, self.q[1:], np.ones(1))[1]
        return waves * slope

    def on_wall(self, waves: npt.NDArray[Any]) -> Array:
        """Return the values (n_theta, n_z) on the wall of waves (m, q)."""
        return np.asarray(_to_points(self.tables, jnp.asarray(waves), self.grid.shape))

    def value_at_wall(self, modes: npt.NDArray[Any]) -> Array:
        """Return the values (n_theta, n_z) at r = 1 of modes."""
        edge = self.functions.at_wall[np.abs(self.m)]
        return self.on_wall(np.einsum("mk,kmq->mq", edge, modes))

    def slope_at_wall(self, modes: npt.NDArray[Any]) -> Array:
        """Return the radial derivatives (n_theta, n_z) at r = 1 of modes."""
        edge = self.functions.wall_slope[np.abs(self.m)]
        return self.on_wall(np.einsum("mk,kmq->mq", edge, modes))


def growth(n: Any, q: Any, r: Any) -> tuple[Any, Any]:
    """Return I_n(q r)/I_n(q), and its derivative at r = 1, for q > 0 and orders up to some hundred."""
    from scipy.special import ive  # slow to load

    below = ive(n, q)
    # Where the order is so high that both vanish in double precision the function is r^n.
    tiny = below < 1e-280
    safe = np.where(tiny, 1.0, below)
    inside = np.where(tiny, r**n * 1.0, ive(n, q * r) / safe * np.exp(q * (r - 1)))
    return inside, np.where(tiny, n * 1.0, n + q * ive(n + 1, q) / safe)


def space(grid: CylinderGrid, n_r: int, biot: float) -> Space:
    """Return the space of a grid around and along and `n_r` points along the radius, for one wall.

    Two thirds of the waves that the points could show are kept, so that products are free of aliasing.
    """
    m_max, q_max = (grid.n_theta - 1) // 3, (grid.n_z - 1) // 3
    degree = 4 * n_r // 3
    return Space(grid, radial_basis(min(m_max, degree), degree, n_r, biot), min(m_max, degree), q_max)


class ScalarSystem(NamedTuple):
    """The equation as the steppers of `cyclosis.dynamics` take it: a pytree of arrays.

    `velocity` (frames, 3, n_r, n_theta, n_z) at the times `times` (frames,), one frame for a steady flow, and
    `lift` (n_r, n_theta, n_z), a harmonic function that carries the pattern of the wall (or 0).
    """

    tables: Tables
    rates: Any
    forcing: Any
    lift: Any
    velocity: Any
    times: Any

    def linear(self) -> jax.Array:
        """Return the diagonal of diffusion."""
        return -self.rates

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> Any:
        """Return the modes and the time: all that the rest follows from."""
        return spectrum, time

    def nonlinear(self, now: Any) -> jax.Array:
        """Return the rate of the modes by advection, and what comes in through the wall."""
        modes, time = now
        shape = self.velocity.shape[-2:]
        c = _synthesise(self.tables, modes, shape) + self.lift
        return weak(self.tables, at_time(self.velocity, self.times, time) * c) + self.forcing

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return the norm of the modes."""
        return jnp.sqrt(jnp.sum(jnp.abs(spectrum) ** 2))

    def peak(self, now: Any) -> jax.Array:
        """Return a bound of nothing: a scalar cannot diverge by itself."""
        return jnp.zeros(())


def at_time(frames: Any, times: Any, time: Any) -> Any:
    """Return frames (frames, ...) at a time: cubic between the nearest four, the ends beyond the ends."""
    if frames.shape[0] == 1:
        return frames[0]
    first, factors = factors_at(times, time)
    near = jax.lax.dynamic_slice_in_dim(frames, first, factors.size)
    return jnp.tensordot(factors.astype(near.dtype), near, axes=1)


def factors_at(times: Any, time: Any) -> tuple[Any, Any]:
    """Return the first of the nearest four times (frames,), and the factors of the cubic through them."""
    count = times.shape[0]
    time = jnp.clip(time, times[0], times[-1])
    used = min(count, 4)
    first = jnp.clip(jnp.searchsorted(times, time, side="right") - used // 2, 0, count - used)
    local = jax.lax.dynamic_slice_in_dim(times, first, used)
    gaps = local[:, None] - local + jnp.eye(used)
    return first, jnp.prod(jnp.where(jnp.eye(used, dtype=bool), 1.0, (time - local) / gaps), axis=1)


def weak(tables: Tables, flux: Any) -> jax.Array:
    """Return <∇f* · F> of a flux F (3, n_r, n_theta, n_z), shape (k, m, q)."""
    waves = _cut(tables, jnp.fft.rfft2(flux, norm="forward"))
    r = tables.r[:, None, None]
    along = -1j * (tables.m[:, None] * waves[1] / r + tables.q * waves[2])
    return _contract(tables.slope, tables.weights, waves[0]) + _contract(tables.value, tables.weights, along)


def _cut(tables: Tables, waves: Any) -> Any:
    m, q = (tables.m.shape[0] - 1) // 2, tables.q.shape[0]
    return jnp.concatenate([waves[..., : m + 1, :q], waves[..., waves.shape[-2] - m :, :q]], axis=-2)


def _contract(table: Any, weights: Any, waves: Any) -> jax.Array:
    """Return Σ_r weights table(m, r, k) waves(r, m, q); real tables times both parts at once."""
    both = jnp.concatenate([waves.real, waves.imag], axis=-1) * weights[:, None, None]
    found = jnp.einsum("mrk,rmq->kmq", table, both)
    half = waves.shape[-1]
    return jax.lax.complex(found[..., :half], found[..., half:])


def _to_points(tables: Tables, waves: Any, shape: tuple[int, int]) -> jax.Array:
    m, q = (tables.m.shape[0] - 1) // 2, tables.q.shape[0]
    gap = jnp.zeros((*waves.shape[:-2], shape[0] - 2 * m - 1, q), waves.dtype)
    full = jnp.concatenate([waves[..., : m + 1, :], gap, waves[..., m + 1 :, :]], axis=-2)
    return jnp.fft.irfft2(full, s=shape, norm="forward")


@partial(jax.jit, static_argnums=2)
def _synthesise(tables: Tables, modes: Any, shape: tuple[int, int]) -> jax.Array:
    both = jnp.concatenate([modes.real, modes.imag], axis=-1)
    found = jnp.einsum("mrk,kmq->rmq", tables.value, both)
    half = modes.shape[-1]
    return _to_points(tables, jax.lax.complex(found[..., :half], found[..., half:]), shape)


@jax.jit
def _analyse(tables: Tables, values: Any) -> jax.Array:
    return _contract(tables.value, tables.weights, _cut(tables, jnp.fft.rfft2(values, norm="forward")))
