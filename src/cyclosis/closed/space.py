"""Transforms between the harmonics of a closed surface and its points (traceable).

Modes are an array (2, M + 1, J): [0, m] are the coefficients of e^{imθ} and [1, m] those of e^{-imθ}, the
latter 0 for m = 0. A transform is a product with one real table for each m, and a Fourier transform around
the cell. Derivatives are taken in between, where each m is a function of the latitude:

    D_θ p = (i/r)(m - r') p,   D_s p = p'          (covariant, of p = p_θ + i p_s)
    div p + i curl p = D_θ p - i D_s p,    E_θθ + i E_θs = (D_θ u + i D_s u)/2  where div u = 0

The derivative along the meridian is that of the interpolating polynomial in x = cos τ, times sin τ where m is
even.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..model.precision import dtypes
from .grid import Array, ClosedGrid


@dataclass(frozen=True)
class ClosedSpace:
    """The tables of a grid in arrays (a traceable value).

    `vector` (M + 1, n_s, J) and `flow` (M + 1, n_s, K) are values on the points, `to_vector` (M + 1, J, n_s)
    and `to_flow` (M + 1, K, n_s) the projections, with the areas of the points. `along` (2, n_s, n_s) is d/ds
    for even and odd m, `around` (2 M + 1, n_s) is (m - r')/r in the order of transforms. `k2` (2, M + 1, J)
    are the eigenvalues λ, `keep` those entries that are modes, `parity` (M + 1, K) that of `Tables`, and
    `weights` (n_theta, n_s) the shares of the points in the `area`.
    """

    vector: Any
    to_vector: Any
    flow: Any
    to_flow: Any
    viscous: Any
    parity: Any
    along: Any
    around: Any
    k2: Any
    keep: Any
    weights: Any
    area: Any
    xyz: Any
    e_theta: Any
    e_s: Any
    shape: tuple[int, int]

    @property
    def packed(self) -> Any:
        """The complex type of packed fields."""
        return np.complex64 if self.k2.dtype == np.float32 else np.complex128

    def to_latitudes(self, modes: jax.Array) -> jax.Array:
        """Return the functions of the latitude of every m, shape (2 M + 1, n_s), of a state's modes."""
        return _spread(self.vector, modes)

    def flow_to_latitudes(self, flow: jax.Array) -> jax.Array:
        """Return the functions of the latitude (2 M + 1, n_s) of a flow's amplitudes (M + 1, K)."""
        return _spread(self.flow, jnp.stack([flow, -self.parity * jnp.conj(flow)]))

    def to_points(self, latitudes: jax.Array) -> jax.Array:
        """Return the packed field (n_theta, n_s) of functions of the latitude (2 M + 1, n_s)."""
        most, n = latitudes.shape[-2] // 2, self.shape[0]
        gap = jnp.zeros((*latitudes.shape[:-2], n - 2 * most - 1, self.shape[1]), latitudes.dtype)
        parts = [latitudes[..., : most + 1, :], gap, latitudes[..., most + 1 :, :]]
        return jnp.fft.ifft(jnp.concatenate(parts, -2), axis=-2, norm="forward")

    def to_physical(self, modes: jax.Array) -> jax.Array:
        """Return the packed field (n_theta, n_s) of a state's modes."""
        return self.to_points(self.to_latitudes(modes))

    def from_points(self, field: jax.Array) -> jax.Array:
        """Return the functions of the latitude (2 M + 1, n_s) of a packed or real field."""
        most = self.around.shape[0] // 2
        spectrum = jnp.fft.fft(field.astype(self.packed), axis=-2, norm="forward")
        return jnp.concatenate([spectrum[..., : most + 1, :], spectrum[..., -most:, :]], -2)

    def to_spectrum(self, field: jax.Array) -> jax.Array:
        """Return the modes (2, M + 1, J) of a packed field, by projection."""
        return self.keep * _gather(self.to_vector, self.from_points(field))

    def derivatives(self, latitudes: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Return the covariant derivatives D_θ and D_s, packed and on the points."""
        along_theta = self.to_points(1j * self.around * latitudes)
        return along_theta, self.to_points(self.along_meridian(latitudes))

    def along_meridian(self, latitudes: jax.Array) -> jax.Array:
        """Return d/ds of functions of the latitude (2 M + 1, n_s)."""
        most = latitudes.shape[-2] // 2
        orders = np.concatenate([np.arange(most + 1), np.arange(most, 0, -1)]) % 2
        out = jnp.zeros_like(latitudes)
        for odd in (0, 1):
            chosen = np.flatnonzero(orders == odd)
            columns = _columns(latitudes[..., chosen, :])
            slopes = jnp.einsum("st,...mtc->...msc", self.along[odd], columns)
            out = out.at[..., chosen, :].set(_complex(slopes))
        return out

    def flow_amplitudes(self, force: jax.Array) -> jax.Array:
        """Return ∫ v·F (M + 1, K) for every flow mode v, of a packed force on the points."""
        both = _gather(self.to_flow, self.from_points(force))
        return 0.5 * (both[..., 0, :, :] - self.parity * jnp.conj(both[..., 1, :, :]))

    def mean(self, field: jax.Array) -> jax.Array:
        """Return the mean over the surface of a real field (n_theta, n_s)."""
        return jnp.sum(field * self.weights, (-2, -1))


jax.tree_util.register_dataclass(
    ClosedSpace,
    data_fields=[
        "vector",
        "to_vector",
        "flow",
        "to_flow",
        "viscous",
        "parity",
        "along",
        "around",
        "k2",
        "keep",
        "weights",
        "area",
        "xyz",
        "e_theta",
        "e_s",
    ],
    meta_fields=["shape"],
)


@lru_cache(maxsize=4)
def closed_space(grid: ClosedGrid, precision: str = "float64") -> ClosedSpace:
    """Return the `ClosedSpace` of a grid, in NumPy arrays of the given precision."""
    real, _ = dtypes(precision)
    made, at, area = grid.tables, grid.meridian, grid.points.area
    most = len(made.modes) - 1
    m = np.concatenate([np.arange(most + 1), np.arange(-most, 0)])[:, None]
    held = np.arange(made.vector.shape[2]) < made.modes[:, None]
    keep = np.stack([held, held & (np.arange(most + 1) > 0)[:, None]])
    return ClosedSpace(
        vector=made.vector.astype(real),
        to_vector=(area[:, None] * made.vector).transpose(0, 2, 1).astype(real),
        flow=made.flow.astype(real),
        to_flow=(area[:, None] * made.flow).transpose(0, 2, 1).astype(real),
        viscous=made.viscous.astype(real),
        parity=made.parity.astype(real),
        along=_along(grid).astype(real),
        around=((m - at.slope) / at.r).astype(real),
        k2=(np.stack([made.rate, made.rate]) * keep).astype(real),
        keep=keep.astype(real),
        weights=(grid.weights / grid.area).astype(real),
        area=np.asarray(grid.area, real),
        xyz=grid.xyz.astype(real),
        e_theta=grid.e_theta.astype(real),
        e_s=grid.e_s.astype(real),
        shape=grid.shape,
    )


def _along(grid: ClosedGrid) -> Array:
    """Return the matrices of d/ds for even and odd m, (2, n_s, n_s): barycentric differentiation in x."""
    points = grid.points
    x, sin = points.x, np.sqrt((1 - points.x) * (1 + points.x))
    barycentric = points.barycentric
    apart = x[:, None] - x[None, :] + np.eye(len(x))
    D = barycentric[None, :] / barycentric[:, None] / apart
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    scale = -(sin / points.meridian.speed)[:, None]
    even = scale * (sin[:, None] * D / sin[None, :] - np.diag(x / sin**2))
    return np.stack([even, scale * D])


def _columns(values: jax.Array) -> jax.Array:
    return jnp.stack([values.real, values.imag], -1)


def _complex(columns: jax.Array) -> jax.Array:
    return jax.lax.complex(columns[..., 0], columns[..., 1])


def _spread(table: jax.Array, pairs: jax.Array) -> jax.Array:
    """Return functions (2 M + 1, n_s) of coefficients (2, M + 1, J) of a table (M + 1, n_s, J).

    Those of -m are mirrored along the meridian.
    """
    made = _complex(jnp.einsum("msj,...hmjc->...hmsc", table, _columns(pairs)))
    return jnp.concatenate([made[..., 0, :, :], made[..., 1, :0:-1, ::-1]], -2)


def _gather(table: jax.Array, latitudes: jax.Array) -> jax.Array:
    """Return the products (2, M + 1, J) of functions (2 M + 1, n_s) with a table (M + 1, J, n_s)."""
    most = latitudes.shape[-2] // 2
    positive = latitudes[..., : most + 1, :]
    zero = latitudes[..., :1, :]
    negative = jnp.concatenate([zero, latitudes[..., :most:-1, :]], -2)[..., ::-1]
    pairs = jnp.stack([positive, negative], -3)
    return _complex(jnp.einsum("mjs,...hmsc->...hmjc", table, _columns(pairs)))
