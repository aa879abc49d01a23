"""From a kinetic state to numbers: those of P and the flow, as in the polar model, and those of angles."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from ...analysis.diagnostics import QUANTITIES as POLAR
from ...analysis.diagnostics import tail
from ...contract.model import Quantity
from .system import KineticMoment, KineticSystem

LEAST_DENSITY, ANGULAR_TAIL = 1e-3, 1e-3
"""Limits of a negative density and of the last angular mode, above which a run is marked underresolved.

A tail of 7.6e-5 (40 modes, Figure 4) changes P by 2e-9; steps of the default accuracy leave about 1e-4."""
_SHARED = (
    *("mean_P", "order", "max_P", "peak_speed", "rms_speed", "net_flux", "pressure_gradient"),
    *("power_input", "viscous_dissipation", "friction_dissipation"),
)


def _rate_of_change(system: KineticSystem, now: KineticMoment) -> Any:
    return system.base.size(system.rate(now)[1])


def _nematic_order(system: KineticSystem, now: KineticMoment) -> Any:
    return jnp.sqrt(jnp.mean(jnp.abs(now.m[2] / now.c) ** 2, dtype=jnp.float64))


def _concentration(system: KineticSystem, now: KineticMoment) -> Any:
    return now.modes[0, 0, 0].real / (now.modes.shape[1] * now.modes.shape[2])


def _spectral_tail(system: KineticSystem, now: KineticMoment) -> Any:
    energy = jnp.sum(jnp.abs(now.modes[1:]) ** 2, axis=0)
    return tail(system.base, energy)


def _angular_tail(system: KineticSystem, now: KineticMoment) -> Any:
    low = jnp.maximum(jnp.max(jnp.abs(now.m[1])), jnp.max(jnp.abs(now.m[2])))
    return jnp.max(jnp.abs(now.m[-1])) / jnp.maximum(low, 1e-30)


def _negative_density(system: KineticSystem, now: KineticMoment) -> Any:
    psi = jnp.fft.irfft(jnp.conj(now.m), 2 * len(now.m), axis=0)
    return jnp.maximum(-jnp.min(psi), 0.0) / jnp.max(psi)


QUANTITIES = (
    *(item for item in POLAR if item.name in _SHARED),
    Quantity(
        "rate_of_change", "<|d(cP)/dt|²>^½", (), "1", "root mean square rate of change of cP", _rate_of_change
    ),
    Quantity(
        "nematic_order",
        "<|m_2/c|²>^½",
        (),
        "1",
        "root mean square of the nematic order of angles",
        _nematic_order,
    ),
    Quantity("concentration", "<c>", (), "1", "mean concentration of filaments", _concentration),
    Quantity(
        "spectral_tail",
        "-",
        (),
        "1",
        "amplitude beyond two thirds of the resolved wavenumbers over that of all, in all moments",
        _spectral_tail,
    ),
    Quantity("angular_tail", "-", (), "1", "largest |m_N| over the largest |m_1| or |m_2|", _angular_tail),
    Quantity(
        "negative_density",
        "-",
        (),
        "1",
        "how far the density of angles is below 0, over its largest value",
        _negative_density,
    ),
)


@jax.jit
def measure(system: KineticSystem, spectrum: Any, time: Any) -> dict[str, Any]:
    """Return every quantity of modes (N + 1, n_theta, n_z), by name, dimensionless (traceable)."""
    now = system.at(spectrum * system.space.keep, time)
    return {item.name: item.compute(system, now) for item in QUANTITIES}
