"""One instant of a cell: the state and every field that follows from it, each computed once."""

from __future__ import annotations

import copy
from functools import cached_property
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from . import hydrodynamics
from .closures import PAPER
from .grid import CylinderGrid
from .hydrodynamics import FlowOperator
from .spectral import Space


class Values(NamedTuple):
    """The values of `Parameters` by name as arrays: numbers of shape (), fields on the product grid.

    `kappa_mirror` is κ e^{2iφ}, the packed form of the repulsion's second part.
    """

    alpha_p: Any
    alpha_u: Any
    epsilon: Any
    d_s: Any
    d_r: Any
    kappa: Any
    mu: Any
    repulsion_angle: Any
    zero_theta_flux: Any
    force_exponent: Any
    kappa_mirror: Any


class Moment:
    """The state `spectrum` at `time`, and lazily the packed fields p, u, force, strain, and further ones.

    `closure` names what stands for the higher moments of the filaments' angles.
    """

    closure: str = PAPER
    fuses = True
    """Whether advection and shear together have a shorter form here, see `filaments.nonlinear`."""

    def __init__(
        self,
        time: Any,
        spectrum: jax.Array,
        values: Values,
        space: Space,
        operator: FlowOperator,
        cubic: bool,
        grid: CylinderGrid | None = None,
        closure: str = PAPER,
    ) -> None:
        self.time, self.spectrum, self.values = time, spectrum, values
        self.space, self.operator, self.cubic, self.grid = space, operator, cubic, grid
        self.closure = closure

    def beside(self, p: jax.Array) -> Moment:
        """Return the same instant with another P at every place, in the flow of this one."""
        other = copy.copy(self)
        other.__dict__ |= {"u": self.u, "p": p}
        return other

    def of(self, spectrum: jax.Array) -> Moment:
        """Return another state at the same instant, of which nothing has been computed."""
        others = self.values, self.space, self.operator, self.cubic, self.grid, self.closure
        return Moment(self.time, spectrum, *others)

    @cached_property
    def p(self) -> jax.Array:
        """P_theta + i P_z."""
        return self.space.to_physical(self.spectrum)

    @cached_property
    def force(self) -> jax.Array:
        """F_theta + i F_z."""
        return hydrodynamics.force(self.p, self.values.force_exponent, self.cubic)

    @cached_property
    def force_spectrum(self) -> jax.Array:
        """The spectrum of the force."""
        return self.space.to_spectrum(self.force)

    @cached_property
    def flow_spectrum(self) -> jax.Array:
        """The spectrum of the flow."""
        return hydrodynamics.flow_spectrum(self.operator, self.force_spectrum)

    @cached_property
    def u(self) -> jax.Array:
        """u_theta + i u_z."""
        return self.space.to_physical(self.flow_spectrum)

    @cached_property
    def strain(self) -> jax.Array:
        """E_tt + i E_tz, with E the symmetric gradient of u and E_zz = -E_tt."""
        return self.space.to_physical(0.5j * (self.space.K * self.flow_spectrum))

    @cached_property
    def vorticity(self) -> jax.Array:
        """d_theta u_z - d_z u_theta."""
        return self.space.to_physical(1j * (jnp.conj(self.space.K) * self.flow_spectrum)).imag

    @cached_property
    def divergence(self) -> jax.Array:
        """∇·P (the imaginary part of the same transform is the curl of P)."""
        return self.space.to_physical(1j * (jnp.conj(self.space.K) * self.spectrum)).real

    @property
    def p_gradient(self) -> tuple[jax.Array, jax.Array]:
        """The derivatives of P in the directions theta and z."""
        return self._gradient(self.spectrum)

    @property
    def u_gradient(self) -> tuple[jax.Array, jax.Array]:
        """The derivatives of u in the directions theta and z."""
        return self._gradient(self.flow_spectrum)

    def _gradient(self, spectrum: jax.Array) -> tuple[jax.Array, jax.Array]:
        m, q = self.space.m, self.space.q
        return self.space.to_physical(1j * (m * spectrum)), self.space.to_physical(1j * (q * spectrum))
