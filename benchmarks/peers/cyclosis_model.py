"""The model in cyclosis, as in the README's start, behind the interface of the others."""

from functools import partial

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, follow


def prepare(params, n, length, step, stepper="adaptive"):
    """Return a function that takes a state P to time t; `step` is `rtol`, or `dt` of a fixed stepper."""
    grid = cy.CylinderGrid(n_theta=n, n_z=n, length=length)
    how = {"stepper": stepper, "dt" if stepper == "etdrk4" else "rtol": step}

    def advance(state, t_end):
        return cy.simulate(params, grid, state, t_end=t_end, save_at=[t_end], **how).final_state

    return advance


def ensemble(params, n, length, step):
    """Return a function that takes many states to time t, as a worker of a sweep does."""
    grid = cy.CylinderGrid(n_theta=n, n_z=n, length=length)

    def advance_all(states, t_end):
        how = EnsembleSettings(t_end=t_end, finish="t_end", rtol=step)
        members = [Member(params, grid, partial(lambda state: state, state)) for state in states]
        return [outcome.state for outcome in follow(members, how)]

    return advance_all
