"""From a state to numbers: one table of quantities, and the functions that evaluate it.

`QUANTITIES` feeds recorded scalars, dataset attributes, figure labels and the documentation. Angle
brackets are means over the cylinder's surface; everything is dimensionless (unit "1"): P is a mean of
unit vectors, speeds are in U = Φ/ν, times in R/U, powers per area in Φ U.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt

from ..contract.model import Quantity as Quantity
from ..model import filaments
from ..model.closures import PAPER
from ..model.doors import door
from ..model.errors import number
from ..model.filaments import TermLike
from ..model.grid import Array, CylinderGrid, resolved
from ..model.moment import Moment
from ..model.parameters import Parameters
from ..model.precision import double
from ..model.spectral import dot, unpack
from ..model.system import System
from ..model.system import system as system_of
from .plain import plain as _plain

__all__ = [
    "QUANTITIES",
    "TAIL_FRACTION",
    "Quantity",
    "diagnose",
    "measure",
    "spectra",
    "system_of",
    "tail",
]


def __dir__() -> list[str]:
    return sorted(__all__)


TAIL_FRACTION = 2.0 / 3.0
"""The spectral tail is beyond this fraction of the resolved wavenumbers, in either direction."""


def _energy(spectrum: jax.Array) -> jax.Array:
    """Share of each mode in <|v|²> of a packed field (Parseval)."""
    return (spectrum.real**2 + spectrum.imag**2) / spectrum.size**2


def _mean_P(system: System, now: Moment) -> Any:
    return unpack(now.spectrum[0, 0] / now.spectrum.size)


def _order(system: System, now: Moment) -> Any:
    return jnp.sqrt(jnp.sum(_energy(now.spectrum)))


def _dissipated(system: System, now: Moment) -> Any:
    return now.values.mu * jnp.sum(system.space.k2 * _energy(now.flow_spectrum))


def tail(system: System, energy: jax.Array) -> Any:
    """Return the amplitude in the spectral tail over that of all modes, dimensionless (traceable).

    (Σ beyond / Σ all)^½ of `energy` (n_theta, n_z), the share of each mode in a mean square; beyond are
    those with |m| or |q| above `TAIL_FRACTION` of the largest.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> from cyclosis.model.system import system as system_of
        >>> grid = cy.CylinderGrid(16, 16)
        >>> system = system_of(cy.Parameters(), grid)
        >>> energy = np.zeros(grid.shape)
        >>> energy[1, 0], energy[6, 0] = 3.0, 1.0  # of m = 7 at most
        >>> float(cy.diagnostics.tail(system, energy))  # (1/4)^½
        0.5
    """
    m = jnp.abs(system.space.m) / jnp.max(system.space.m)
    # A grid of one axial point has no waves along z.
    q = jnp.abs(system.space.q) / jnp.maximum(jnp.max(system.space.q), float(np.finfo(energy.dtype).tiny))
    beyond = jnp.sum(jnp.where(jnp.maximum(m, q) > TAIL_FRACTION, energy, 0.0))
    return jnp.sqrt(beyond / jnp.maximum(jnp.sum(energy), float(np.finfo(energy.dtype).tiny)))


def _spectral_tail(system: System, now: Moment) -> Any:
    return tail(system, _energy(now.spectrum))


def _budget(system: System, now: Moment) -> Any:
    each = filaments.rates(now, system.terms)
    return jnp.stack([jnp.mean(dot(now.p, rate)) for rate in each.values()])


QUANTITIES = (
    Quantity("mean_P", "<P>", ("component",), "1", "mean of the order vector", _mean_P),
    Quantity("order", "<|P|²>^½", (), "1", "root mean square of the order vector", _order),
    Quantity(
        "max_P",
        "max |P|",
        (),
        "1",
        "largest magnitude of the order vector",
        lambda system, now: jnp.sqrt(jnp.max(dot(now.p, now.p))),
    ),
    Quantity(
        "peak_speed",
        "max |u|",
        (),
        "1",
        "largest flow speed",
        lambda system, now: jnp.sqrt(jnp.max(dot(now.u, now.u))),
    ),
    Quantity(
        "rms_speed",
        "<|u|²>^½",
        (),
        "1",
        "root mean square flow speed",
        lambda system, now: jnp.sqrt(jnp.sum(_energy(now.flow_spectrum))),
    ),
    Quantity(
        "net_flux",
        "<u_z>",
        (),
        "1",
        "mean axial flow, held at zero by the end caps",
        lambda system, now: jnp.mean(now.u.imag),
    ),
    Quantity(
        "pressure_gradient",
        "Π₀",
        (),
        "1",
        "axial pressure gradient that holds the net flux at zero",
        lambda system, now: jnp.mean(now.force.imag),
    ),
    Quantity(
        "power_input",
        "<F·u>",
        (),
        "1",
        "power that the filaments' force puts into the flow",
        lambda system, now: jnp.mean(dot(now.force, now.u)),
    ),
    Quantity("viscous_dissipation", "μ <|∇u|²>", (), "1", "power dissipated by viscosity", _dissipated),
    Quantity(
        "friction_dissipation",
        "<|u|²>",
        (),
        "1",
        "power dissipated by friction with the wall",
        lambda system, now: jnp.sum(_energy(now.flow_spectrum)),
    ),
    Quantity(
        "rate_of_change",
        "<|dP/dt|²>^½",
        (),
        "1",
        "root mean square rate of change of the order vector",
        lambda system, now: jnp.sqrt(jnp.sum(_energy(system.rate(now)))),
    ),
    Quantity(
        "spectral_tail",
        "-",
        (),
        "1",
        "amplitude beyond two thirds of the resolved wavenumbers over that of all",
        _spectral_tail,
    ),
    Quantity("budget", "<P·term>", ("term",), "1", "what each term adds to d/dt <|P|²>/2", _budget),
)


@jax.jit
def measure(system: System, spectrum: Any, time: Any) -> dict[str, Any]:
    """Return every quantity of a packed spectrum (n_theta, n_z), by name, dimensionless (traceable).

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.model.precision import double
        >>> from cyclosis.model.system import system as system_of
        >>> grid = cy.CylinderGrid(16, 16)
        >>> system = system_of(cy.Parameters(), grid)
        >>> with double():
        ...     now = cy.diagnostics.measure(system, system.spectrum(cy.initial.stripes(grid)), 0.0)
        >>> round(float(now["max_P"]), 6)
        0.9
    """
    now = system.at(spectrum, time)
    return {item.name: item.compute(system, now) for item in QUANTITIES}


@door
def diagnose(
    params: Parameters,
    grid: CylinderGrid,
    state: npt.ArrayLike,
    time: float = 0.0,
    terms: Iterable[TermLike] | None = None,
    dealias: str = "none",
    closure: str = PAPER,
) -> dict[str, Any]:
    """Return every quantity of `QUANTITIES` for a state (2, n_theta, n_z), dimensionless.

    Scalars are floats; `mean_P` is an array (2,), `budget` a dictionary by term. They equal what a run
    with the same `terms`, `dealias` and `closure` records: the state is taken without its Nyquist modes, and
    the largest |P| and |u| are those on the points on which products are formed. Raises `InputError` if state
    or parameter fields do not match the grid.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> now = cy.diagnose(cy.Parameters(), grid, cy.initial.stripes(grid))
        >>> dissipated = now["viscous_dissipation"] + now["friction_dissipation"]
        >>> abs(now["power_input"] - dissipated) < 1e-12, abs(now["net_flux"]) < 1e-12
        (True, True)
        >>> round(now["order"], 4), now["mean_P"].shape, sorted(now["budget"])[:2]  # 0.9/2^½
        (0.6364, (2,), ['advection', 'bundling'])
    """
    P = grid.check_state(state)
    system = system_of(params, grid, terms, dealias, closure=closure)
    now = number("time", time, -1e12, 1e12, "the default is 0")
    with double():
        values = measure(system, system.spectrum(P), now)
    return _plain(system, values)


@door
def spectra(grid: CylinderGrid, state: npt.ArrayLike) -> dict[str, Array]:
    """Return how <|P|²> is spread over wavenumbers.

    `m` and `azimuthal` (mode numbers 0, 1, ... and the energy in them, summed over q), `q` and `axial`
    likewise; each energy array sums to <|P|²> of the state without its
    Nyquist modes. Dimensionless. Raises `InputError` for a state that does not match the grid.

    Example:
        >>> import cyclosis as cy
        >>> grid = cy.CylinderGrid(16, 16)
        >>> found = cy.spectra(grid, cy.initial.stripes(grid, count=4, magnitude=1.0))
        >>> found["m"][:4], found["azimuthal"][:4].round(6)  # all in m = 2, and <|P|²> = 1/2
        (array([0., 1., 2., 3.]), array([0. , 0. , 0.5, 0. ]))
        >>> found["q"].shape, round(float(found["axial"].sum()), 6)
        ((9,), 0.5)
    """
    P = resolved(grid.check_state(state))
    energy = np.sum(np.abs(np.fft.fft2(P, norm="forward")) ** 2, axis=0)
    m = np.abs(np.rint(grid.m)).astype(int)
    j = np.abs(np.rint(grid.q * grid.length / (2 * np.pi))).astype(int)
    axial = np.bincount(j, energy.sum(axis=0))
    return {
        "m": np.arange(m.max() + 1.0),
        "azimuthal": np.bincount(m, energy.sum(axis=1)),
        "q": 2 * np.pi / grid.length * np.arange(j.max() + 1.0),
        "axial": axial,
    }
