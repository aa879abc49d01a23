"""What an ensemble measures of a member every few steps: a few numbers, and means along each axis."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..model.spectral import dot
from ..model.system import System
from .diagnostics import tail


class Signs(NamedTuple):
    """A few numbers of a state, and its means along each axis as packed spectra.

    `largest` is max |P|, `order` <|P|²>^½, `around` <P_theta²>^½, `unevenness` <|P - <P>|²>^½; `vary_theta`
    and `vary_z` are the root mean squares of the part that varies along each axis; `tail` is the spectral
    tail; `low` and `high` are the fewest and the most sign changes of P_z around a circle z = const.
    """

    largest: Any
    order: Any
    around: Any
    unevenness: Any
    vary_theta: Any
    vary_z: Any
    tail: Any
    low: Any
    high: Any
    mean_along_z: Any
    mean_along_theta: Any


def signs(system: System, spectrum: jax.Array) -> Signs:
    """Return the signs of a packed spectrum (traceable)."""
    energy = (spectrum.real**2 + spectrum.imag**2) / spectrum.size**2
    p = jnp.fft.ifft2(spectrum)
    up = p.imag > 0
    changes = jnp.sum(up != jnp.roll(up, 1, axis=0), axis=0)

    def root(values: Any) -> Any:
        return jnp.sqrt(jnp.sum(values, dtype=jnp.float64))

    return Signs(
        largest=jnp.sqrt(jnp.max(dot(p, p))),
        order=root(energy),
        around=jnp.sqrt(jnp.mean(p.real**2, dtype=jnp.float64)),
        unevenness=root(energy.at[0, 0].set(0.0)),
        vary_theta=root(energy[1:]),
        vary_z=root(energy[:, 1:]),
        tail=tail(system, energy),
        low=jnp.min(changes),
        high=jnp.max(changes),
        mean_along_z=spectrum[:, 0] / spectrum.shape[1],
        mean_along_theta=spectrum[0] / spectrum.shape[0],
    )
