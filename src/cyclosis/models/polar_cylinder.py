"""The polar model: the order vector P of filaments on a periodic cylinder, and the flow they drive.

    dP/dt = -ε (u·∇)P + (I - PP)·[ε (P·∇)u + α_p P + α_u u - κ (P·d) d] + d⁽ˢ⁾ ∇²P - d⁽ʳ⁾ P
    -μ ∇²u + u + Π₀ e_z + ∇Π' = |P|ⁿ P,   ∇·u = 0,   <u_z> = 0

Source: Woodhouse & Goldstein, PNAS 110 (2013) 14132. The equation is in `cyclosis.model`, the meaning of its
states in `cyclosis.analysis`; here the two are combined in one value.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from ..analysis import resolution
from ..analysis.appearance import Look
from ..analysis.axial_points import axial_tails, fewer_points, usable
from ..analysis.diagnostics import QUANTITIES, measure
from ..analysis.regimes import REGIMES, Regime, regime
from ..analysis.signs import signs
from ..contract.members import AxialPoints, Inquiry, Lanes, Starts
from ..contract.model import Model, Problem, Times
from ..display.notebook import map_of
from ..model import swept_starts
from ..model.actions import act
from ..model.closures import PAPER
from ..model.definitions import GRID, SURFACE
from ..model.errors import InputError
from ..model.filaments import select_terms
from ..model.grid import Array, CylinderGrid, resolved
from ..model.parameters import Parameters
from ..model.spectral import on_axial_points, pack
from ..model.starts import initial_state
from ..model.system import System, flow_spectrum, ramped, state_of
from ..model.system import system as system_of
from . import polar_stored


def _system(problem: Problem, split: bool, cubic: bool | None = None) -> System:
    settings = (problem.terms, problem.dealias, problem.precision, split)
    return system_of(problem.params, problem.grid, *settings, cubic=cubic, closure=_closure(problem))


def _closure(problem: Problem) -> str:
    return str(problem.model.options.get("closure", PAPER))


def stays_cubic(first: Parameters, last: Parameters) -> bool:
    """Return whether the force is cubic all the way from one set of parameters to another."""
    return {first.force_exponent, last.force_exponent} == {2.0}


def _ramped(first: Problem, last: Problem, times: Times, split: bool) -> System:
    cubic = stays_cubic(first.params, last.params)
    return ramped(_system(first, split, cubic), _system(last, split, cubic), times)


def _whole_modes(system: System, state: Array) -> npt.NDArray[Any]:
    # Nyquist modes are kept here: without them the whole surface would change. They diffuse away.
    return np.fft.fft2(pack(state)).astype(system.space.packed)


def _measure(system: System, spectrum: Any, time: Any) -> dict[str, Any]:
    return measure(system, system.reported(spectrum), time)


def _regime(problem: Problem, state: Array) -> Regime:
    params, grid, closure = problem.params, problem.grid, _closure(problem)
    return regime(params, grid, state, problem.terms, dealias=problem.dealias, closure=closure)


def _shared(params: Parameters, grid: CylinderGrid) -> Any:
    """Return what must be equal for members that share lanes."""
    built_in = (params.d_s, params.d_r, params.mu, params.zero_theta_flux, params.force_exponent == 2)
    fields = tuple(name for name, value in params.items() if isinstance(value, np.ndarray))
    # Fields are too large to be copied for every lane: only members with equal fields share lanes.
    return (grid, built_in, tuple((name, getattr(params, name).tobytes()) for name in fields))


def _certain(problem: Problem) -> Callable[[], Inquiry]:
    # Imported late: the theory of steady states is built on the dynamics, which import this model.
    from ..ensemble.certainty import Certainty

    certainty = Certainty(
        problem.params,
        problem.grid,
        terms=tuple(term.name for term in problem.terms),
        dealias=problem.dealias,
    )
    return certainty.inquiry


def grid_of(**table: Any) -> CylinderGrid:
    """Return the grid of a [grid] table. Raises `InputError` for a setting that only closed cells have."""
    for item in SURFACE:
        if table.get(item.name) is not None:
            rule = "used only where [model] kind is closed"
            raise InputError(item.name, table[item.name], rule, "remove it, or choose that model")
    own = {item.name for item in GRID}
    return CylinderGrid(**{name: value for name, value in table.items() if name in own})


def _flow(system: System, spectrum: Any, time: Any) -> Array:
    return system.state(flow_spectrum(system, system.reported(spectrum), time))


polar = Model(
    name="polar",
    title="Self-organised cytoplasmic streaming on a cylinder",
    source="Model of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110",
    parameters=Parameters,
    grid=CylinderGrid,
    grid_of=grid_of,
    terms=select_terms,
    system=_system,
    ramped=_ramped,
    modes=System.spectrum,
    whole_modes=_whole_modes,
    state=lambda grid, spectrum: state_of(spectrum),
    check_state=lambda grid, state, name: grid.check_state(state, name, bounded=True),
    act=act,
    largest=lambda state: float(np.hypot(*resolved(state)).max()),
    bound=1.01,
    sharp_bound=1.25,
    stiffness=resolution.stiffness,
    quantities=QUANTITIES,
    measure=_measure,
    tails={"spectral_tail": resolution.UNDERRESOLVED_TAIL},
    peak="max_P",
    decay_time=resolution.decay_time,
    finer=resolution.finer,
    stored=polar_stored.STORED,
    coordinates=polar_stored.coordinates,
    derive=polar_stored.derive,
    regimes=REGIMES,
    regime=_regime,
    lanes=Lanes(
        signs=signs,
        look=Look.of_signs,
        look_of_state=Look.of_state,
        shared=_shared,
        values=lambda system: system.varying,
        with_values=System.with_varying,
        certain=_certain,
        axial=AxialPoints(fewer_points, usable, System.in_batches, on_axial_points, axial_tails),
    ),
    starts=Starts(
        make=initial_state,
        filled=swept_starts.filled,
        noisy=swept_starts.noisy,
        refuse_impossible=swept_starts.refuse_impossible,
        seeded=swept_starts.seeded,
    ),
    member_variables=polar_stored.MEMBER_VARIABLES,
    member_row=polar_stored.member_row,
    flow=_flow,
    attributes=lambda grid: {"length": grid.length},
    caption=lambda grid: f"{grid.n_theta} x {grid.n_z}, length {grid.length:g}",
    picture=lambda grid, state: map_of(state, grid.length),
)
"""The polar model."""
