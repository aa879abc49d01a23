"""The closed cell as one value; its equation is in `cyclosis.closed.system`.

Source: the filament equation and the flow of Woodhouse & Goldstein, PNAS 110 (2013) 14132, in covariant
derivatives on a closed surface. The paper stands in for the ends of a cell by zero net flux; here they are
part of the surface, and the flux through every circle around the cell vanishes by itself.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import jax
import numpy as np

from ...analysis import resolution
from ...analysis.diagnostics import TAIL_FRACTION
from ...closed.grid import Array, ClosedGrid
from ...closed.space import closed_space
from ...closed.system import PRINCIPAL, REPULSIONS, ClosedSystem, closed_system, flow_vector, vector
from ...contract.members import Starts
from ...contract.model import Model, Problem, Times
from ...display.notebook import closed_map_of
from ...model.errors import InputError, choice
from ...model.parameters import Parameters
from ...model.precision import double
from ...model.system import ramped
from ..polar_cylinder import polar, stays_cubic
from . import quantities, starts, states, stored
from .actions import act
from .lanes import LANES
from .shape_table import grid_of, table_of


def _system(problem: Problem, split: bool, cubic: bool | None = None) -> ClosedSystem:
    options = problem.model.options
    if problem.dealias != "none":
        rule = "none on a closed surface, where n_theta and n_s set how far products are padded"
        raise InputError("dealias", problem.dealias, rule, "leave it out")
    return closed_system(
        problem.params,
        problem.grid,
        problem.terms,
        problem.precision,
        split,
        cubic=cubic,
        repulsion=str(options.get("repulsion", PRINCIPAL)),
    )


def _ramped(first: Problem, last: Problem, times: Times, split: bool) -> Any:
    cubic = stays_cubic(first.params, last.params)
    return ramped(_system(first, split, cubic), _system(last, split, cubic), times)


def _decay_time(system: ClosedSystem) -> float:
    return resolution.damped_after(system, TAIL_FRACTION * float(np.sqrt(np.max(system.space.k2))))


def _finer(params: Parameters, grid: ClosedGrid) -> str:
    largest = resolution.largest_wavenumber(params)
    if largest is None:
        return "use a larger k_max"
    return f"use a larger k_max: {int(np.ceil(max(largest, 1.25 * grid.k_max)))} should do"


@jax.jit
def _moment_fields(system: ClosedSystem, modes: Any) -> tuple[Any, Any]:
    now = system.at(modes)
    return now.flow_spectrum, system.rate(now)


def _regime(problem: Problem, state: Array) -> states.ClosedRegime:
    made = _system(problem, True)
    with double():
        modes = made.spectrum(state)
        amplitudes, rate = _moment_fields(made, modes)
    m = np.arange(modes.shape[1])[:, None] * np.array([1, -1])[:, None, None]
    u, change, turning = flow_vector(made.space, amplitudes), made.state(rate), made.state(1j * m * modes)
    return states.judged(problem.grid, made.state(modes), u, change, turning)


def _caption(grid: ClosedGrid) -> str:
    settings = ", ".join(f"{key} {value:g}" for key, value in grid.surface.table.items() if key != "kind")
    name = grid.surface.kind + (f" ({settings})" if settings else "")
    return f"{name}, k_max {grid.k_max:g}, {grid.n_theta} x {grid.n_s}"


def closed_model(repulsion: str = PRINCIPAL) -> Model:
    """Return the model of a closed cell: `model=` of `simulate` takes it.

    `repulsion` names how the repulsive direction follows from the curvatures k_1, k_2, |k_1| >= |k_2|, of the
    surface, in units of 1/R: -κ M P stands for -κ (P·d) d, with

    * "principal": M = (k_1² - k_2²) d d, d the direction of k_1
    * "polynomial": M = B² - K I, B the shape operator, K = k_1 k_2
    * "bounded": M = (k_1² - k_2²)/(k_1² + k_2²) d d

    All are the paper's on a cylinder of radius R, and vanish where no direction is more curved than another.
    Raises `InputError` for another name.

    Example:
        >>> import cyclosis as cy
        >>> cy.models.closed_model("bounded").wording
        'closed with repulsion = bounded'
    """
    choice("repulsion", repulsion, tuple(REPULSIONS))
    return _made(repulsion)


@cache
def _made(repulsion: str) -> Model:
    return _CLOSED if repulsion == PRINCIPAL else replace(_CLOSED, options={"repulsion": repulsion})


_CLOSED = Model(
    name="closed",
    title="Self-organised cytoplasmic streaming on a closed surface",
    source="Model of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110, on closed cells",
    parameters=Parameters,
    grid=ClosedGrid,
    grid_of=grid_of,
    table_of=table_of,
    terms=polar.terms,
    system=_system,
    ramped=_ramped,
    modes=ClosedSystem.spectrum,
    whole_modes=ClosedSystem.spectrum,
    state=lambda grid, modes: vector(closed_space(grid), modes),
    check_state=lambda grid, state, name: grid.check_state(state, name, bounded=True),
    act=act,
    largest=lambda state: float(np.hypot(*state).max()),
    bound=polar.bound,
    sharp_bound=polar.sharp_bound,
    stiffness=polar.stiffness,
    quantities=quantities.QUANTITIES,
    measure=quantities.measure,
    tails=polar.tails,
    peak="max_P",
    decay_time=_decay_time,
    finer=_finer,
    stored=stored.STORED,
    coordinates=stored.coordinates,
    derive=stored.derive,
    regimes=states.REGIMES,
    regime=_regime,
    lanes=LANES,
    starts=Starts(
        make=starts.closed_state,
        filled=starts.filled,
        noisy=polar.starts.noisy,  # type: ignore[union-attr]
        refuse_impossible=starts.refuse_impossible,
        seeded=starts.seeded,
    ),
    member_variables=stored.MEMBER_VARIABLES,
    flow=stored.flow,
    attributes=lambda grid: {"surface": grid.surface.kind, "area": grid.area},
    geometry=stored.geometry,
    caption=_caption,
    picture=lambda grid, state: closed_map_of(state, grid.s, grid.r),
)

closed = closed_model()
"""The closed cell with the principal repulsion."""
