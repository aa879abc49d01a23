"""Runs against the stored reference fields."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

import cyclosis as cy
import oracle

from . import Row

FOLDER = Path(__file__).parent.parent / "reference"
TIMES = (5, 10, 20)
OWN_GRID = {"paper": (1e-5, 2e-5, 4e-5), "general": (5e-8, 1e-7, 3e-6)}
FINE = 1e-7


def load(name):
    """Return parameters, grid, initial state and the fields P and u by time."""
    with np.load(FOLDER / f"{name}.npz") as stored:
        given = json.loads(str(stored["parameters"]))
        length, (d_theta, d_z) = given.pop("length"), given.pop("dhat")
        params = cy.Parameters(**given, repulsion_angle=float(np.arctan2(d_z, d_theta)))
        P0 = stored["P0"]
        fields = {t: (stored[f"P_{t}"], stored[f"u_{t}"]) for t in TIMES}
    return params, cy.CylinderGrid(*P0.shape[1:], length), P0, fields


def errors(name, refine=1, **settings):
    """Return max errors (of P, of u) at each time, sampled from a `refine` times finer grid, and the run."""
    params, grid, P0, fields = load(name)
    finer = grid.resized(grid.n_theta * refine, grid.n_z * refine)
    run = cy.simulate(params, finer, cy.interpolate(P0, finer.shape), t_end=20.0, save_at=TIMES, **settings)
    assert run.ok, run.message
    found = []
    for t, P in zip(TIMES, run.frames, strict=True):
        u = cy.flow(params, finer, P)
        exact_P, exact_u = fields[t]
        found.append(
            [float(np.abs(a[:, ::refine, ::refine] - b).max()) for a, b in ((P, exact_P), (u, exact_u))]
        )
    return found, run


def own_grid(name):
    """ETDRK4 at dt 0.05 without dealiasing on the file's grid: what is left is the grid's own error.

    Part of it: the stored fields, sampled from twice the grid, have Nyquist modes that the run drops.
    """
    found, run = errors(name, stepper="etdrk4", dt=0.05, dealias="none")
    law, fields = f"reference {name}, own grid, etdrk4 dt 0.05", load(name)[3]
    rows = []
    for t, bound, (error_P, error_u), P in zip(TIMES, OWN_GRID[name], found, run.frames, strict=True):
        kept = np.stack([oracle.resampled(c, c.shape) for c in fields[t][0]])
        rows += [
            Row(law, f"max |P - P_ref|, t = {t}", error_P, bound),
            Row(law, f"the same without P_ref's Nyquist modes, t = {t}", float(np.abs(P - kept).max())),
            Row(law, f"max |u - u_ref|, t = {t}", error_u),
        ]
    return rows


def twice_the_grid(name):
    """Twice the grid: what is left at dt 0.05 is the time error, since half the step removes 15/16 of it."""
    coarse, _ = errors(name, 2, stepper="etdrk4", dt=0.05, dealias="none")
    fine, _ = errors(name, 2, stepper="etdrk4", dt=0.025, dealias="none")
    rows = []
    for t, (a, _), (b, _) in zip(TIMES, coarse, fine, strict=True):
        law = f"reference {name}, twice the grid, t = {t}"
        rows += [
            Row(law, "max |P - P_ref|, etdrk4 dt 0.05", a, FINE if name == "general" else None),
            Row(law, "max |P - P_ref|, etdrk4 dt 0.025", b, FINE),
            Row(law, "order in time of that error", float(np.log2(a / b)), 4.3, 3.7),
        ]
    return rows


def default_stepper(name):
    """The default stepper on the file's grid, for the report."""
    found, run = errors(name)
    law = f"reference {name}, own grid, default stepper ({run.effort.evaluations} right-hand sides)"
    return [Row(law, f"max |P - P_ref|, t = {t}", e) for t, (e, _) in zip(TIMES, found, strict=True)]


def rows():
    """Return every row of this comparison."""
    return [row for name in OWN_GRID for f in (own_grid, twice_the_grid, default_stepper) for row in f(name)]
