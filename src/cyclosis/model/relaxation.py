"""The fast part of the drive that is local in space, for steppers that treat it implicitly.

At a place with the flow held fixed the torques turn and stretch P at a rate g(P), whose Jacobian D is a real
2 x 2 matrix there. On packed fields it acts as D[v] = c v + m v*. Its eigenvalue along P is about
-2 (α_p + α_u u·P), -3 at the parameters of Figure 4, on ordered stripes; it is positive in the zones between
them, where order grows.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from . import filaments
from .filaments import Term
from .moment import Moment
from .spectral import Space, dot


def jacobian(now: Moment, terms: tuple[Term, ...]) -> tuple[jax.Array, jax.Array]:
    """Return c and m of the Jacobian of all torques but the shear, at fixed flow; each of the shape of p."""
    torques = [term for term in terms if term.kind == "torque" and term.name != "shear"]

    def rate(p: jax.Array) -> jax.Array:
        return filaments.turned_by(now.beside(p), torques)

    one = jnp.ones_like(now.p)
    along_theta, along_z = (jax.jvp(rate, (now.p,), (way * one,))[1] for way in (1, 1j))
    return 0.5 * (along_theta - 1j * along_z), 0.5 * (along_theta + 1j * along_z)


def decaying(c: jax.Array, m: jax.Array) -> jax.Array:
    """Return c and m, stacked, of D without growth: eigenvalues of its symmetric part clipped to <= 0.

    These are Re c ± |m|. What is left has no growth at all, so that 1 - τ D can be inverted for all τ >= 0.
    """
    size = jnp.abs(m)
    upper, lower = jnp.minimum(c.real + size, 0.0), jnp.minimum(c.real - size, 0.0)
    stretch = 0.5 * (upper - lower) / jnp.where(size > 0, size, 1.0)
    return jnp.stack([0.5 * (upper + lower) + 1j * c.imag, stretch * m])


def relaxed(
    space: Space, linear: jax.Array, local: jax.Array, spectrum: jax.Array, tau: jax.Array
) -> jax.Array:
    """Return (1 - τ L)⁻¹ (1 - τ D)⁻¹ of a packed spectrum, for the symbol L and the c and m of `decaying`.

    Two transforms. Nyquist modes, which only an intervention leaves in a state, are left to L alone.
    """
    field = space.to_physical(spectrum)
    first, second = 1.0 - tau * local[0], tau * local[1]
    # Products with reciprocals: a complex array divided by a real one takes several times longer.
    scale = 1.0 / (dot(first, first) - dot(second, second))
    inverse = scale * (jnp.conj(first) * field + second * jnp.conj(field))
    return (1.0 / (1.0 - tau * linear)) * (spectrum + space.keep * space.to_spectrum(inverse - field))
