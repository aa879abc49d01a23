"""Runs against stored ones of an earlier, independent program: see tests/reference/README.md."""

import json
from pathlib import Path

import numpy as np
import pytest

import cyclosis as cy

REFERENCE = Path(__file__).parent.parent / "reference"
SURFACES = {"sphere": cy.Sphere(), "spheroid": cy.Spheroid(2.0), "capsule": cy.Capsule(5.0, 0.4)}


def first(grid, size):
    """The initial state: the tangent part of a field in space, written out in `meta`."""
    x, y, z = grid.xyz
    field = np.stack(
        [np.sin(1 + 2 * y) + z**2 * x / (1 + z**2), np.cos(2 * x - z) + y, x * y - y * np.sin(2 * z)]
    )
    return cy.closed.from_vectors(grid, size * field)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "k_max", "bound"), [("sphere", 26, 5e-6), ("spheroid", 24, 3e-5), ("capsule", 24, 6e-5)]
)
def test_runs_are_the_stored_ones(name, k_max, bound):
    with np.load(REFERENCE / f"closed_{name}.npz") as stored:
        meta = json.loads(str(stored["meta"]))
        data = {key: stored[key] for key in ("x", "P", "u", "scalars", "rate0")}
    given = meta["parameters"]
    params = cy.Parameters(**{"epsilon" if key == "eps" else key: value for key, value in given.items()})
    grid, times = cy.ClosedGrid(SURFACES[name], k_max=k_max), meta["times"]
    P0 = first(grid, meta["amp"])
    run = cy.simulate(params, grid, P0, t_end=times[-1], save_at=times, stepper="etdrk4", dt=0.1)
    assert run.times.tolist() == times
    for index, P in enumerate(run.frames):
        u = cy.flow(params, grid, P)
        assert np.abs(grid.cartesian(P, data["x"]) - data["P"][index]).max() < bound
        assert np.abs(grid.cartesian(u, data["x"]) - data["u"][index]).max() < bound
        force = np.sum(P**2, axis=0) * P
        means = [grid.mean(np.sum(a * b, axis=0)) for a, b in ((P, P), (u, u), (force, u))]
        assert np.abs(means - data["scalars"][index]).max() < bound
    rate = grid.cartesian(cy.rate_of_change(params, grid, P0), data["x"]) - data["rate0"]
    # The file's own error of rate0 is the largest on the pointed spheroid, 2e-4.
    assert np.abs(rate).max() < 3 * meta["error_estimates"]["rate0"] + 1e-8
