"""The kinetic model as one value; its equation is in `cyclosis.models.kinetic.system`.

Source: the Smoluchowski equation from which Woodhouse & Goldstein, PNAS 110 (2013) 14132, derive that of the
order vector by a moment closure. With torques "literal" the rates are those of every term of that derivation,
(a_p, a_u) = (α_p, α_u): exact where filaments are fully aligned. With "rate" these two are doubled, so that
without repulsion weak order grows at α_p - d_r as the paper's words say.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from ...analysis.regimes import Regime, judged
from ...contract.model import Model, Problem, Times
from ...model.errors import InputError, choice, whole
from ...model.grid import CylinderGrid, resolved
from ..on_polar import flow, member_row, rate_modes
from ..polar_cylinder import polar
from . import quantities, stored
from .actions import act
from .angular import MODES, MOST_MODES, Moments, order
from .starts import kinetic_state, seeded
from .system import KineticSystem, kinetic_system

TORQUES = {"literal": 1.0, "rate": 2.0}
"""Factor by which bundling and flow alignment turn filaments, by the name of the convention."""


def _modes_of(problem: Problem) -> int:
    return MODES if problem.shape is None else problem.shape[0] - 1


def _scaled(problem: Problem) -> Problem:
    """Return the problem with the rates a_p and a_u in place of α_p and α_u."""
    factor, params = TORQUES[problem.model.options["torques"]], problem.params
    if factor == 1:
        return problem
    return problem.at(params.replace(alpha_p=factor * params.alpha_p, alpha_u=factor * params.alpha_u))


def _system(problem: Problem, split: bool) -> KineticSystem:
    base: Any = polar.system(_scaled(problem), split)
    return kinetic_system(base, _modes_of(problem))


def _ramped(first: Problem, last: Problem, times: Times, split: bool) -> KineticSystem:
    base: Any = polar.ramped(_scaled(first), _scaled(last), times, split)
    return kinetic_system(base, _modes_of(first))


def _whole_modes(system: KineticSystem, m: Moments) -> Any:
    return np.fft.fft2(m).astype(system.space.packed)


def _modes(system: KineticSystem, m: Moments) -> Any:
    return _whole_modes(system, m) * np.asarray(system.space.keep)


def _state(grid: CylinderGrid, spectrum: Any) -> Moments:
    return np.fft.ifft2(np.asarray(spectrum, dtype=np.complex128))


def _check_state(grid: CylinderGrid, state: Any, name: str) -> Moments:
    given = np.asarray(state)
    rule = f"moments (N + 1, {grid.n_theta}, {grid.n_z}), complex, with N from 2 to {MOST_MODES}"
    fits = given.ndim == 3 and given.shape[1:] == grid.shape and 3 <= len(given) <= MOST_MODES + 1
    if not fits or not np.iscomplexobj(given):
        remedy = "make them with cyclosis.kinetic: kinetic.dressed(P) of an order vector, say"
        raise InputError(name, given, rule, remedy)
    m = given.astype(np.complex128)
    if not np.all(np.isfinite(m)):
        raise InputError(name, m, "finite everywhere", "remove its NaN or infinite entries")
    if np.abs(m[0].imag).max() > 1e-12 or m[0].real.min() <= 0:
        raise InputError(f"m_0 of {name}", m[0], "a concentration, real and positive", "divide by it")
    largest = _largest(m)
    if largest > 1 + 1e-12:
        remedy = "scale the moments down, or raise filaments_per_square if it is noise"
        raise InputError(
            f"max |P| of {name}", largest, "at most 1, because P is a mean of unit vectors", remedy
        )
    return m


def _largest(m: Moments) -> float:
    return float(np.hypot(*resolved(order(m))).max())


def _regime(problem: Problem, m: Moments) -> Regime:
    change = _state(problem.grid, rate_modes(problem, m)[1]) / m[0].real
    return judged(problem.grid, resolved(order(m)), np.stack([change.real, change.imag]))


def kinetic_model(modes: int = MODES, torques: str = "literal") -> Model:
    """Return the kinetic model whose configurations have so many angular modes, and these torques.

    A state given to `simulate` brings its own number of modes. Raises `InputError` for values out of range.

    Example:
        >>> import cyclosis as cy
        >>> cy.kinetic.kinetic_model(torques="rate")
        cyclosis.models.kinetic
    """
    modes = whole("modes", modes, 2, MOST_MODES, f"the default is {MODES}")
    choice("torques", torques, tuple(TORQUES))
    return _made(modes, torques)


@cache
def _made(modes: int, torques: str) -> Model:
    assert polar.starts is not None
    starts = replace(polar.starts, make=partial(kinetic_state, modes), seeded=partial(seeded, modes))
    return replace(_KINETIC, options={"modes": modes, "torques": torques}, starts=starts)


# Parameters, grid, bounds and regimes are those of the polar model: the cell is the same.
_KINETIC = replace(
    polar,
    name="kinetic",
    title="Self-organised cytoplasmic streaming on a cylinder, by the density of filament angles",
    source="Kinetic model of Woodhouse & Goldstein, PNAS 110 (2013), doi 10.1073/pnas.1302736110",
    system=_system,
    ramped=_ramped,
    modes=_modes,
    whole_modes=_whole_modes,
    state=_state,
    check_state=_check_state,
    act=act,
    largest=_largest,
    stiffness=lambda system: float(
        np.max(system.space.k2) * system.values.d_s
        + system.n.max() ** 2 * system.values.d_r
        + system.n.max() * np.max(system.values.alpha_p + system.values.alpha_u + system.values.kappa)
    ),
    quantities=quantities.QUANTITIES,
    measure=quantities.measure,
    tails=polar.tails
    | {"angular_tail": quantities.ANGULAR_TAIL, "negative_density": quantities.LEAST_DENSITY},
    decay_time=lambda system: polar.decay_time(system.base),
    remedies=dict.fromkeys(("angular_tail", "negative_density"), "use more angular modes"),
    stored=stored.STORED,
    coordinates=stored.coordinates,
    derive=stored.derive,
    regime=_regime,
    lanes=None,
    member_row=member_row(order),
    flow=flow,
    picture=lambda grid, m: polar.picture(grid, order(m)),
)

kinetic = kinetic_model()
"""The kinetic model with literal torques."""
