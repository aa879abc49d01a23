"""Packed Fourier transforms on the cylinder.

A vector field (v_theta, v_z) is packed into one complex field v = v_theta + i v_z, so that one complex
transform carries both components. With K = m + i q and conj-reversal R[V]_k = conj(V_{-k}):

    gradient of a real scalar s:   i K s_k
    divergence + i curl of v:      i conj(K) V_k
    strain E_tt + i E_tz of a divergence-free u:   i K U_k / 2
    the two components apart:      (V_k + R[V]_k) / 2  and  (V_k - R[V]_k) / (2 i)
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from .grid import CylinderGrid
from .precision import dtypes

PADDING = {"none": Fraction(1), "quadratic": Fraction(3, 2), "cubic": Fraction(2), "full": Fraction(5, 2)}
"""Factor by which each direction is refined where products are formed.

A product of d band-limited factors aliases into the resolved modes unless the grid is (d + 1)/2 times
finer. The force |P|²P is cubic; the projected terms, P P (P·E·P) or a coefficient field times P P P,
are quartic: 5/2 removes all aliasing of this model.
"""


@dataclass(frozen=True)
class Space:
    """Wavenumbers of a grid and the transforms on it (a traceable value).

    `m` (n_theta, 1) and `q` (1, n_z) are the wavenumbers, 0 for the Nyquist modes; `keep_m` and `keep_q`
    are 0 there and 1 elsewhere; `k2` (n_theta, n_z) is |k|². The directions are kept
    separate because the speed of the right-hand side is limited by memory. `shape` is the grid's, `fine` the
    shape on which products are formed.
    """

    m: Any
    q: Any
    keep_m: Any
    keep_q: Any
    k2: Any
    shape: tuple[int, int]
    fine: tuple[int, int]

    @property
    def K(self) -> jax.Array:
        """The wavenumbers m + i q, shape (n_theta, n_z), each 0 on the Nyquist modes of its direction."""
        return jax.lax.complex(*jnp.broadcast_arrays(self.m, self.q))

    @property
    def keep(self) -> Any:
        """0 on the Nyquist modes, 1 elsewhere, shape (n_theta, n_z)."""
        return self.keep_m * self.keep_q

    @property
    def packed(self) -> Any:
        """The complex type of packed fields."""
        return np.complex64 if self.k2.dtype == np.float32 else np.complex128

    def to_physical(self, spectrum: jax.Array) -> jax.Array:
        """Return the packed field on the fine grid."""
        if self.fine == self.shape:
            return jnp.fft.ifft2(spectrum)
        scale = self.fine[0] * self.fine[1] / (self.shape[0] * self.shape[1])
        for axis in (-2, -1):
            spectrum = _fit(spectrum, self.shape[axis], self.fine[axis], axis)
        return jnp.fft.ifft2(spectrum * scale)

    def to_spectrum(self, field: jax.Array) -> jax.Array:
        """Return the modes that the grid has room for, of a packed (or real) field on the fine grid.

        Nyquist modes are left in: callers multiply by `keep`.
        """
        spectrum = jnp.fft.fft2(field.astype(self.packed))
        if self.fine == self.shape:
            return spectrum
        for axis in (-2, -1):
            spectrum = _fit(spectrum, self.shape[axis], self.shape[axis], axis)
        return spectrum * (self.shape[0] * self.shape[1] / (self.fine[0] * self.fine[1]))


jax.tree_util.register_dataclass(
    Space, data_fields=["m", "q", "keep_m", "keep_q", "k2"], meta_fields=["shape", "fine"]
)


def space(grid: CylinderGrid, dealias: str = "none", precision: str = "float64") -> Space:
    """Return the `Space` of a grid, in NumPy arrays of the given precision."""
    real, _ = dtypes(precision)
    keep_m, keep_q = _not_nyquist(grid.n_theta)[:, None], _not_nyquist(grid.n_z)[None, :]
    m, q = grid.m[:, None], grid.q[None, :]
    return Space(
        m=(m * keep_m).astype(real),
        q=(q * keep_q).astype(real),
        keep_m=keep_m.astype(real),
        keep_q=keep_q.astype(real),
        k2=(m**2 + q**2).astype(real),
        shape=grid.shape,
        fine=fine_shape(grid.shape, dealias),
    )


def fine_shape(shape: tuple[int, int], dealias: str) -> tuple[int, int]:
    """Return the shape on which products are formed under a dealiasing rule."""
    factor = PADDING[dealias]
    if factor == 1:
        return shape
    first, second = (2 * -(-(n * factor) // 2) for n in shape)
    return (int(first), int(second))


def reverse(spectrum: jax.Array) -> jax.Array:
    """Return conj(V_{-k}), the spectrum of the conjugate field."""
    return jnp.conj(jnp.roll(jnp.flip(spectrum, (-2, -1)), (1, 1), (-2, -1)))


def dot(a: jax.Array, b: jax.Array) -> jax.Array:
    """Return the scalar product of two packed vectors."""
    return a.real * b.real + a.imag * b.imag


def pack(vector: npt.ArrayLike) -> Any:
    """Return v_theta + i v_z from (2, n_theta, n_z), in the library that holds `vector`."""
    array = vector if isinstance(vector, jax.Array) else np.asarray(vector)
    return array[0] + 1j * array[1]


def unpack(field: jax.Array) -> jax.Array:
    """Return (2, n_theta, n_z) from v_theta + i v_z."""
    return jnp.stack([field.real, field.imag])


def on_axial_points(spectrum: jax.Array, n_z: int) -> jax.Array:
    """Return a packed spectrum (n_theta, any) of the same field on n_z points along the cell.

    Waves that both hold are kept exactly; all others, the Nyquist modes among them, are left out.
    """
    old = spectrum.shape[-1]
    if n_z == old:
        return spectrum
    return _fit(spectrum, min(old, n_z), n_z, -1) * (n_z / old)


def _not_nyquist(n: int) -> npt.NDArray[np.float64]:
    kept = np.ones(n)
    if n % 2 == 0:
        kept[n // 2] = 0.0
    return kept


def _fit(spectrum: jax.Array, resolved: int, size: int, axis: int) -> jax.Array:
    """Return a spectrum with room for `size` modes along an axis, holding the `resolved` ones."""
    low, high = (resolved + 1) // 2, (resolved - 1) // 2
    first, _, last = jnp.split(spectrum, [low, spectrum.shape[axis] - high], axis)
    gap = list(spectrum.shape)
    gap[axis] = size - low - high
    return jnp.concatenate([first, jnp.zeros(gap, spectrum.dtype), last], axis)
