"""From P and c to numbers: those of the polar model, and those of the concentration."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from ...analysis import signs as polar_signs
from ...analysis.diagnostics import QUANTITIES as POLAR
from ...analysis.diagnostics import tail
from ...contract.model import Quantity
from ...model.spectral import dot
from .system import UnevenMoment, UnevenSystem


def _energy(modes: jax.Array) -> jax.Array:
    """Return the share of each mode in <|P|² + c²>, without the mean of c."""
    return jnp.sum(jnp.abs(modes).at[1, 0, 0].set(0.0) ** 2, axis=0) / modes[0].size ** 2


def _rate_of_change(system: UnevenSystem, now: UnevenMoment) -> Any:
    return system.base.size(system.rate(now)[0])


def _budget(system: UnevenSystem, now: UnevenMoment) -> Any:
    own = next(item for item in POLAR if item.name == "budget").compute(system, now)
    crowding = jnp.mean(dot(now.p, now.crowding))
    diffuses = jnp.asarray([term.name == "diffusion" for term in system.terms])
    return own + jnp.where(diffuses, crowding, 0.0)


_OWN = {
    "rate_of_change": _rate_of_change,
    "spectral_tail": lambda system, now: tail(system.base, _energy(now.modes)),
    "budget": _budget,
}
QUANTITIES = (
    *(Quantity(q.name, q.symbol, q.dims, q.unit, q.meaning, _OWN.get(q.name, q.compute)) for q in POLAR),
    Quantity(
        "mean_concentration",
        "<c>",
        (),
        "1",
        "mean concentration of filaments, which never changes",
        lambda system, now: now.modes[1, 0, 0].real / now.modes[1].size,
    ),
    Quantity(
        "min_concentration",
        "min c",
        (),
        "1",
        "smallest concentration of filaments",
        lambda system, now: jnp.min(now.c),
    ),
    Quantity(
        "max_concentration",
        "max c",
        (),
        "1",
        "largest concentration of filaments",
        lambda system, now: jnp.max(now.c),
    ),
)


@jax.jit
def measure(system: UnevenSystem, spectrum: Any, time: Any) -> dict[str, Any]:
    """Return every quantity of modes (2, n_theta, n_z), by name, dimensionless (traceable)."""
    now = system.at(spectrum * system.space.keep, time)
    return {item.name: item.compute(system, now) for item in QUANTITIES}


def signs(system: UnevenSystem, spectrum: jax.Array) -> polar_signs.Signs:
    """Return the signs of modes (traceable)."""
    own = polar_signs.signs(system.base, spectrum[0])
    return own._replace(tail=tail(system.base, _energy(spectrum)))
