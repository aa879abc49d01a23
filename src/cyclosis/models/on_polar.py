"""What models share whose state has more than P, with the grid, couplings and flow of the polar one."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import jax
import numpy as np
import numpy.typing as npt

from ..contract.model import Problem
from ..model.grid import Array
from ..model.moment import Values
from ..model.precision import double
from ..model.spectral import Space
from ..model.system import System, flow_spectrum
from . import polar_stored


class OnPolar:
    """The part of a system that follows from `base`, a polar one; the rest is that of the model."""

    base: System

    @property
    def space(self) -> Space:
        """Wavenumbers and transforms."""
        return self.base.space

    @property
    def values(self) -> Values:
        """The couplings."""
        return self.base.values

    @property
    def terms(self) -> Any:
        """The terms that act."""
        return self.base.terms

    @cached_property
    def names(self) -> set[str]:
        """The names of the terms that act."""
        return {term.name for term in self.base.terms}

    def peak(self, now: Any) -> jax.Array:
        """Return max |P|²."""
        return self.base.peak(now)

    def rate(self, now: Any) -> jax.Array:
        """Return the modes of the rate of change."""
        own: Any = self
        rate: jax.Array = own.linear() * now.modes + own.nonlinear(now)
        return rate


def rate_modes(problem: Problem, state: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the modes of the rate at which a state of a problem's model changes, at time 0."""
    made: Any = problem.model.system(problem, True)
    with double():
        return np.asarray(made.rate(made.at(problem.model.modes(made, state))))


def flow(system: Any, spectrum: Any, time: Any) -> Array:
    """Return the flow (2, n_theta, n_z) that modes drive at a time."""
    found: Array = system.base.state(flow_spectrum(system, spectrum * system.space.keep, time))
    return found


def flow_of_states(problem: Problem) -> Callable[[Any, Any], Array]:
    """Return a function of parameters and a state that gives the flow (2, n_theta, n_z), without any ramp."""
    made = polar_stored.last_made(lambda params: problem.model.system(problem.at(params), True))

    def of_state(params: Any, state: Any) -> Array:
        with double():
            system, placed = made(params)
            spectrum = flow_spectrum(placed, problem.model.modes(system, state), np.float64(0.0))
        found: Array = system.base.state(spectrum)
        return found

    return of_state


def member_row(order: Callable[[Any], Array]) -> Callable[[Any, Any], dict[str, Any]]:
    """Return the function that gives what a sweep stores of a member and its outcome, without the quantities.

    `order` gives P (2, n_theta, n_z) of a state.
    """

    def row(member: Any, outcome: Any) -> dict[str, Any]:
        P, start = order(outcome.state), order(member.state())[1].mean(axis=1)
        return {
            **polar_stored.zones(P),
            "profile": P.mean(axis=2),
            "initial_k0": start.mean(),
            "initial_m1": polar_stored.amplitude(start),
        }

    return row
