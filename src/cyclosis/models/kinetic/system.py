"""The right-hand side of the kinetic model, in angular moments.

    dΨ/dt = -ε u·∇Ψ + d⁽ˢ⁾ ∇²Ψ + d⁽ʳ⁾ d²Ψ/dφ² - d(ωΨ)/dφ,
    ω = q·[ε (p·∇)u + a_p P + a_u u - κ (p·d) d],   p = (cos φ, sin φ), q = dp/dφ.

With E the strain and w the vorticity of u, H = a_p P + a_u u and S = ε E - (κ/2) e^{2ib} packed (see
`cyclosis.model.spectral`; b is the angle of d), ω = ε w/2 + Im(H e^{-iφ}) + Im(S e^{-2iφ}), and the moments
m_n = ∫ e^{inφ} Ψ dφ follow

    dm_n/dt = -ε u·∇m_n + (d⁽ˢ⁾ ∇² - n² d⁽ʳ⁾ + i n ε w/2) m_n
              + (n/2) [H m_{n-1} - H* m_{n+1} + S m_{n-2} - S* m_{n+2}].

The hierarchy is cut at N: m_{N+1} = m_{N+2} = 0. The flow is driven by F = c |P|² P.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ...model import hydrodynamics
from ...model.errors import InputError
from ...model.grid import CylinderGrid
from ...model.hydrodynamics import FlowOperator
from ...model.moment import Moment, Values
from ...model.spectral import Space, unpack
from ...model.system import System
from ..on_polar import OnPolar


class KineticMoment(Moment):
    """The moments `m` on the surface, and what follows from them; P and the flow as in the polar model."""

    def __init__(
        self,
        time: Any,
        modes: jax.Array,
        values: Values,
        space: Space,
        operator: FlowOperator,
        cubic: bool,
        grid: CylinderGrid | None = None,
    ) -> None:
        self.time, self.modes, self.values = time, modes, values
        self.space, self.operator, self.cubic, self.grid = space, operator, cubic, grid

    @cached_property
    def m(self) -> jax.Array:
        """m_0, ..., m_N on the points where products are formed."""
        return self.space.to_physical(self.modes)

    @cached_property
    def c(self) -> jax.Array:
        """The concentration m_0."""
        return self.m[0].real

    @cached_property
    def p(self) -> jax.Array:
        """P_theta + i P_z = m_1/c."""
        return self.m[1] / self.c

    @cached_property
    def spectrum(self) -> jax.Array:  # type: ignore[override]
        """The spectrum of P."""
        return self.space.to_spectrum(self.p)

    @cached_property
    def force(self) -> jax.Array:
        """C |P|ⁿ P, packed."""
        return self.c * hydrodynamics.force(self.p, self.values.force_exponent, self.cubic)


@dataclass(frozen=True)
class KineticSystem(OnPolar):
    """The right-hand side of one cell; `base` holds the grid, the couplings and the flow operator.

    `n` (N + 1, 1, 1) are the numbers of the moments. Modes have shape (N + 1, n_theta, n_z).
    """

    base: System
    n: Any

    def at(self, spectrum: jax.Array, time: Any = 0.0) -> KineticMoment:
        """Return the moment of modes."""
        values, operator = self.base.couplings(time)
        return KineticMoment(time, spectrum, values, self.space, operator, self.base.cubic, self.base.grid)

    def linear(self) -> jax.Array:
        """Return the symbol -d⁽ˢ⁾ k² - n² d⁽ʳ⁾, shape (N + 1, n_theta, n_z); zero if not split."""
        symbol = self._symbol(self.base.strongest())
        return symbol if self.base.split else jnp.zeros_like(symbol)

    def _symbol(self, values: Values) -> jax.Array:
        symbol = jnp.zeros_like(self.n * self.space.k2)
        if "diffusion" in self.names:
            symbol -= values.d_s * self.space.k2
        if "rotational_diffusion" in self.names:
            symbol -= values.d_r * self.n**2
        return symbol

    def nonlinear(self, now: KineticMoment) -> jax.Array:
        """Return the modes of the rest of dm/dt."""
        space, values = self.space, now.values
        rate = space.to_spectrum(sum(self._own(now), self._torque(now)))
        if "advection" in self.names:
            # The flux ∇·(u m) conserves every mean exactly, and costs no more transforms than u·∇m.
            along, across = space.to_spectrum(now.u.real * now.m), space.to_spectrum(now.u.imag * now.m)
            rate -= 1j * values.epsilon * (space.m * along + space.q * across)
        rate = space.keep * rate
        if not self.base.split or self.base.ramp is not None:
            rate += (self._symbol(values) - self.linear()) * now.modes
        return rate

    def _torque(self, now: KineticMoment) -> jax.Array:
        """Return what the torque ω does to the moments, on the surface."""
        values, m, names = now.values, now.m, self.names
        H, S, turn = jnp.zeros_like(now.p), jnp.zeros_like(now.p), None
        if "bundling" in names:
            H += values.alpha_p * now.p
        if "flow_alignment" in names:
            H += values.alpha_u * now.u
        if "shear" in names:
            S += values.epsilon * now.strain
            turn = 0.5j * values.epsilon * now.vorticity
        if "repulsion" in names:
            S -= 0.5 * values.kappa_mirror
        none = jnp.zeros_like(m[:1])
        # m_{-1} = m_1*; what multiplies m_{-1} and m_{-2} at n = 0 has the factor n.
        before, twice_before = (
            jnp.concatenate([none, m[:-1]]),
            jnp.concatenate([none, jnp.conj(m[1:2]), m[:-2]]),
        )
        after, twice_after = jnp.concatenate([m[1:], none]), jnp.concatenate([m[2:], none, none])
        rate = 0.5 * (H * before - jnp.conj(H) * after + S * twice_before - jnp.conj(S) * twice_after)
        return self.n * (rate if turn is None else rate + turn * m)

    def _own(self, now: KineticMoment) -> Iterator[jax.Array]:
        """Yield what each of the user's terms does to the moments, on the surface."""
        for term in self.base.terms:
            if term.kind == "custom":
                made = jnp.asarray(term.function(now.time, now.m, unpack(now.u), now.values, now.grid))
                if made.shape != now.m.shape:
                    rule = f"a rate of all moments, an array of shape {now.m.shape}"
                    raise InputError(f"the term {term.name}", made, rule, "return one for every m_n")
                yield made.astype(now.m.dtype)

    def size(self, spectrum: jax.Array) -> jax.Array:
        """Return the root mean square of all moments.

        The mean concentration, which never changes, is left out.
        """
        square = jnp.sum(jnp.abs(spectrum) ** 2, dtype=jnp.float64)
        square -= jnp.abs(spectrum[0, 0, 0]).astype(jnp.float64) ** 2
        return jnp.sqrt(jnp.maximum(square, 0.0)) / (spectrum.shape[1] * spectrum.shape[2])


jax.tree_util.register_dataclass(KineticSystem, data_fields=["base", "n"], meta_fields=[])


def kinetic_system(base: System, modes: int) -> KineticSystem:
    """Return the right-hand side for moments up to `modes` with the couplings of a polar system."""
    return KineticSystem(base, np.arange(modes + 1.0, dtype=base.space.k2.dtype)[:, None, None])
