"""The right-hand side of the polar model with a concentration c of filaments.

    dc/dt = -ε ∇·(u c) + d⁽ˢ⁾ ∇²c
    dP/dt = ... + 2 d⁽ˢ⁾ (∇ ln c · ∇)P
    F = c |P|ⁿ P, or |cP|ⁿ cP

The dots are the right-hand side without concentration, in any closure: torques turn filaments in the same way
however many there are. The new term is [d⁽ˢ⁾ ∇²(cP) - P d⁽ˢ⁾ ∇²c]/c less d⁽ˢ⁾ ∇²P: more filaments arrive from
where there are more. Modes have shape (2, n_theta, n_z): P packed, and c.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp

from ...model import hydrodynamics
from ...model.moment import Moment, Values
from ...model.spectral import reverse
from ...model.system import System
from ..on_polar import OnPolar


class UnevenMoment(Moment):
    """What follows from P and c at an instant; `power` says that the force is |cP|ⁿ cP."""

    def __init__(self, time: Any, modes: jax.Array, base: System, power: bool) -> None:
        values, operator = base.couplings(time)
        super().__init__(
            time, modes[0], values, base.space, operator, base.cubic, base.grid, closure=base.closure
        )
        self.modes, self.power = modes, power

    @cached_property
    def c(self) -> jax.Array:
        """The concentration."""
        return self.space.to_physical(self.modes[1]).real

    @cached_property
    def force(self) -> jax.Array:
        """F_theta + i F_z."""
        if self.power:
            return hydrodynamics.force(self.c * self.p, self.values.force_exponent, self.cubic)
        return self.c * hydrodynamics.force(self.p, self.values.force_exponent, self.cubic)

    @cached_property
    def crowding(self) -> jax.Array:
        """2 d⁽ˢ⁾ (∇ ln c · ∇)P, packed."""
        slope = self.space.to_physical(1j * self.space.K * self.modes[1])
        along_theta, along_z = self.p_gradient
        return 2.0 * self.values.d_s / self.c * (slope.real * along_theta + slope.imag * along_z)


@dataclass(frozen=True)
class UnevenSystem(OnPolar):
    """The right-hand side of one cell; `base` is that without concentration."""

    base: System
    power: bool

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> UnevenMoment:
        """Return the moment of modes."""
        return UnevenMoment(time, spectrum, self.base, self.power)

    def linear(self) -> jax.Array:
        """Return the symbols of the linear terms of P and c; zero if not split."""
        spread = self._spread(self.base.strongest())
        return jnp.stack([self.base.linear(), spread if self.base.split else jnp.zeros_like(spread)])

    def _spread(self, values: Values) -> jax.Array:
        """Return the symbol of the diffusion of c."""
        return -values.d_s * self.space.k2 * ("diffusion" in self.names)

    def nonlinear(self, now: UnevenMoment) -> jax.Array:
        """Return the modes of the rest of dP/dt and dc/dt."""
        space = self.space
        rate, change = self.base.nonlinear(now), jnp.zeros_like(now.modes[1])
        if "diffusion" in self.names:
            rate += space.keep * space.to_spectrum(now.crowding)
        if "advection" in self.names:
            # A flux: the mean of c is then kept exactly.
            outflow = 1j * jnp.conj(space.K) * space.to_spectrum(now.u * now.c)
            change -= 0.5 * now.values.epsilon * space.keep * (outflow + reverse(outflow))
        if not self.base.split or self.base.ramp is not None:
            change += (self._spread(now.values) - self.linear()[1]) * now.modes[1]
        return jnp.stack([rate, change])

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return <|P|² + c²>^½, without the mean of c, which never changes."""
        square = (jnp.abs(spectrum) ** 2).at[1, 0, 0].set(0.0)
        return jnp.sqrt(jnp.sum(square, dtype=jnp.float64)) / spectrum[0].size


jax.tree_util.register_dataclass(UnevenSystem, data_fields=["base"], meta_fields=["power"])
