"""The quantities of a state on a closed surface; angle brackets are means over its area."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ...analysis import diagnostics
from ...analysis.diagnostics import TAIL_FRACTION
from ...closed.system import ClosedSystem
from ...contract.model import Quantity
from ...model import filaments
from ...model.moment import Moment
from ...model.spectral import dot


def energy(system: ClosedSystem, modes: jax.Array) -> jax.Array:
    """Return the share of each harmonic in <|P|²>."""
    return 2 * np.pi / system.space.area * (modes.real**2 + modes.imag**2)


def _flow_energy(system: ClosedSystem, flow: jax.Array) -> jax.Array:
    """Return the share of each flow mode in <|u|²>: both of ±m count, except for m = 0."""
    twice = jnp.where(jnp.arange(flow.shape[0]) > 0, 2.0, 1.0)[:, None]
    return 2 * np.pi / system.space.area * twice * (flow.real**2 + flow.imag**2)


def tail(system: ClosedSystem, share: jax.Array) -> Any:
    """Return the amplitude beyond `TAIL_FRACTION` of k_max over that of all, of shares in <|P|²>."""
    k2 = system.space.k2
    beyond = jnp.sum(jnp.where(k2 > TAIL_FRACTION**2 * jnp.max(k2), share, 0.0))
    return jnp.sqrt(beyond / jnp.maximum(jnp.sum(share), float(np.finfo(share.dtype).tiny)))


def _in_space(system: ClosedSystem, field: jax.Array) -> jax.Array:
    """Return a packed field as vectors in space (3, n_theta, n_s)."""
    return system.space.e_theta * field.real + system.space.e_s * field.imag


def _circulation(system: ClosedSystem, now: Moment) -> Any:
    moment = jnp.cross(system.space.xyz, _in_space(system, now.u), axis=0)
    return 1.5 * system.space.mean(moment)


def _budget(system: ClosedSystem, now: Moment) -> Any:
    each = filaments.rates(now, system.terms)
    return jnp.stack([system.space.mean(dot(now.p, rate)) for rate in each.values()])


QUANTITIES = (
    Quantity(
        "mean_vector",
        "<P>",
        ("axis",),
        "1",
        "mean of the order vector as a vector in space",
        lambda system, now: system.space.mean(_in_space(system, now.p)),
    ),
    Quantity(
        "order",
        "<|P|²>^½",
        (),
        "1",
        "root mean square of the order vector",
        lambda system, now: jnp.sqrt(jnp.sum(energy(system, now.spectrum))),
    ),
    *(item for item in diagnostics.QUANTITIES if item.name in ("max_P", "peak_speed")),
    Quantity(
        "rms_speed",
        "<|u|²>^½",
        (),
        "1",
        "root mean square flow speed",
        lambda system, now: jnp.sqrt(jnp.sum(_flow_energy(system, now.flow_spectrum))),
    ),
    Quantity(
        "circulation",
        "3/2 <x × u>",
        ("axis",),
        "1",
        "circulation as a vector in space: the angular velocity, if a unit sphere rotates rigidly",
        _circulation,
    ),
    Quantity(
        "power_input",
        "<F·u>",
        (),
        "1",
        "power that the filaments' force puts into the flow",
        lambda system, now: system.space.mean(dot(now.force, now.u)),
    ),
    Quantity(
        "viscous_dissipation",
        "2 μ <|D|²>",
        (),
        "1",
        "power dissipated by viscosity",
        lambda system, now: (
            now.values.mu * jnp.sum(system.space.viscous * _flow_energy(system, now.flow_spectrum))
        ),
    ),
    Quantity(
        "friction_dissipation",
        "<|u|²>",
        (),
        "1",
        "power dissipated by friction with the wall",
        lambda system, now: jnp.sum(_flow_energy(system, now.flow_spectrum)),
    ),
    Quantity(
        "rate_of_change",
        "<|dP/dt|²>^½",
        (),
        "1",
        "root mean square rate of change of the order vector",
        lambda system, now: jnp.sqrt(jnp.sum(energy(system, system.rate(now)))),
    ),
    Quantity(
        "spectral_tail",
        "-",
        (),
        "1",
        "amplitude beyond two thirds of k_max over that of all harmonics",
        lambda system, now: tail(system, energy(system, now.spectrum)),
    ),
    Quantity("budget", "<P·term>", ("term",), "1", "what each term adds to d/dt <|P|²>/2", _budget),
)


@jax.jit
def measure(system: ClosedSystem, modes: Any, time: Any) -> dict[str, Any]:
    """Return every quantity of modes (2, M + 1, J), by name, dimensionless (traceable)."""
    now = system.at(modes, time)
    return {item.name: item.compute(system, now) for item in QUANTITIES}
