"""The polar model with the drag of the vacuole: its flow is resisted by the fluid inside the cell.

    (1 + μ k² + β Z(m, q)) u_k = (I - kk/k²)·F_k

Z is the drag of the Stokes flow in the vacuole on a wave of its wall (`cyclosis.vacuole.drag`), and β =
η/(νR) the viscosity of the vacuole over the friction of the layer and the radius. Everything else is that of
the polar model. The theory of `cyclosis.stability` is that of β = 0, so that no regime of this model is
certified.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp

from ..analysis import diagnostics
from ..analysis.regimes import Regime, judged
from ..contract.model import Model, Problem, Quantity, Times
from ..model.errors import number
from ..model.grid import Array, resolved
from ..model.parameters import Parameters
from ..model.system import System, ramped, state_of
from ..model.system import system as system_of
from . import polar_stored
from .on_polar import rate_modes
from .polar_cylinder import polar, stays_cubic

USUAL = 0.007
"""β of a layer of thickness R/50 without slip at its outer wall, as viscous as the vacuole."""


def _system(problem: Problem, split: bool, cubic: bool | None = None) -> System:
    settings = (problem.terms, problem.dealias, problem.precision, split)
    drag = problem.model.options["vacuole_drag"]
    return system_of(problem.params, problem.grid, *settings, cubic=cubic, vacuole_drag=drag)


def _ramped(first: Problem, last: Problem, times: Times, split: bool) -> System:
    cubic = stays_cubic(first.params, last.params)
    return ramped(_system(first, split, cubic), _system(last, split, cubic), times)


def _dissipated(system: System, now: Any) -> Any:
    energy = (now.flow_spectrum.real**2 + now.flow_spectrum.imag**2) / now.flow_spectrum.size**2
    return jnp.zeros(()) if system.drag is None else jnp.sum(system.drag * energy)


IN_VACUOLE = Quantity(
    "vacuole_dissipation", "β <u·Zu>", (), "1", "power dissipated in the vacuole", _dissipated
)


@jax.jit
def _dissipation(system: System, spectrum: Any, time: Any) -> Any:
    return IN_VACUOLE.compute(system, system.at(spectrum, time))


def _measure(system: System, spectrum: Any, time: Any) -> dict[str, Any]:
    reported = system.reported(spectrum)
    more = {IN_VACUOLE.name: _dissipation(system, reported, time)}
    return diagnostics.measure(system, reported, time) | more


def _regime(problem: Problem, state: Array) -> Regime:
    return judged(problem.grid, resolved(state), state_of(rate_modes(problem, state)))


def _derive(problem: Problem) -> Callable[[Parameters, Array], dict[str, Any]]:
    return polar_stored.derived(lambda params: _system(problem.at(params), True))


def coupled_model(vacuole_drag: float = USUAL) -> Model:
    """Return the polar model with the drag β of the vacuole, dimensionless: `model=` of `simulate` takes it.

    β = η/(νR) = η h/(3 η_c R) for a layer of thickness h and viscosity η_c without slip at its outer wall.
    Runs also record `vacuole_dissipation`, which completes the budget: power_input = viscous_dissipation +
    friction_dissipation + vacuole_dissipation. β = 0 gives the numbers of the polar model. Raises
    `InputError` for β outside 0 to 100.

    Example:
        >>> import cyclosis as cy
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> start = cy.initial.stripes(grid, magnitude=0.5)
        >>> run = cy.simulate(params, grid, start, t_end=1.0, model=cy.models.coupled_model(0.1))
        >>> names = ("viscous", "friction", "vacuole")
        >>> spent = sum(run.records[f"{name}_dissipation"][-1] for name in names)
        >>> abs(float(spent / run.records["power_input"][-1]) - 1) < 1e-12
        True
    """
    return _made(number("vacuole_drag", vacuole_drag, 0.0, 100.0, f"the usual value is {USUAL}"))


@cache
def _made(vacuole_drag: float) -> Model:
    return replace(_COUPLED, options={"vacuole_drag": vacuole_drag})


def _with_vacuole() -> tuple[Quantity, ...]:
    """Return the quantities of the polar model, and the vacuole's dissipation after that of the friction."""
    names = [item.name for item in polar.quantities]
    place = names.index("friction_dissipation") + 1
    return (*polar.quantities[:place], IN_VACUOLE, *polar.quantities[place:])


_COUPLED = replace(
    polar,
    name="coupled",
    title="Self-organised cytoplasmic streaming on a cylinder, with the drag of the vacuole",
    system=_system,
    ramped=_ramped,
    quantities=_with_vacuole(),
    measure=_measure,
    derive=_derive,
    regime=_regime,
    lanes=None,
)

coupled = coupled_model()
"""The polar model with the usual drag of the vacuole."""
