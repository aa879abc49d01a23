"""From the filaments' force to the flow of the cytoplasm.

Stokes flow with friction in a thin periodic layer (Woodhouse & Goldstein 2013):

    -μ ∇²u + u + Π₀ e_z + ∇Π' = F,   ∇·u = 0,   <u_z> = 0,   F = |P|ⁿ P

In Fourier space u_k = (I - kk/k²)·F_k / (1 + μ k²) for k ≠ 0; packed (see `spectral`) this is
U_k = [F_k - (K²/|K|²) conj(F_{-k})] / (2 (1 + μ k²)). At k = 0, u_z vanishes by the axial pressure
gradient Π₀ = <F_z>, and u_theta = <F_theta> unless `zero_theta_flux` holds it at zero too.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from .spectral import Space, dot, reverse


class FlowOperator(NamedTuple):
    """The linear map from force to flow: U_k = direct F_k + mirror conj(F_{-k})."""

    direct: Any
    mirror: Any


def flow_operator(space: Space, mu: Any, zero_theta_flux: Any, drag: Any = None) -> FlowOperator:
    """Return the `FlowOperator` of a space; plain arithmetic, for both NumPy and traced values.

    `drag` (n_theta, n_z) is a further resistance β Z to each wave, beside 1 + μ k²; None means 0.
    """
    zero = 1.0 * (space.k2 == 0)
    green = 0.5 * space.keep / (1.0 + mu * space.k2) * (1.0 - zero)
    if drag is not None:
        green = green / (1.0 + drag / (1.0 + mu * space.k2))
    unit = (space.m + 1j * space.q) ** 2 / (space.k2 + zero)
    # At k = 0 the two halves add up to Re F: only the mean of F_theta, if that is free.
    mean = 0.5 * (1.0 - zero_theta_flux) * zero
    return FlowOperator((green + mean).astype(space.k2.dtype), (mean - green * unit).astype(space.packed))


def force(p: jax.Array, exponent: Any, cubic: bool) -> jax.Array:
    """Return the packed force |P|ⁿ P; `cubic` says that n is 2, which avoids the power."""
    square = dot(p, p)
    if cubic:
        return square * p
    # At P = 0 the power itself would give 0⁰, or an infinite slope, although the force is finite.
    positive = jnp.where(square > 0, square, 1.0)
    return jnp.where(square > 0, positive ** (0.5 * exponent), jnp.where(exponent > 0, 0.0, 1.0)) * p


def flow_spectrum(operator: FlowOperator, force_spectrum: jax.Array) -> jax.Array:
    """Return the spectrum of the flow that a force drives."""
    return operator.direct * force_spectrum + operator.mirror * reverse(force_spectrum)
