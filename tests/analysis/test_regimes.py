import numpy as np
import pytest

import cyclosis as cy

GRID = cy.CylinderGrid(64, 32, 5.0)
PARAMS = cy.Parameters()
THETA, Z = np.meshgrid(GRID.theta, GRID.z, indexing="ij")


@pytest.mark.parametrize(
    ("name", "state"),
    [
        ("disordered", cy.initial.disordered(GRID)),
        ("disordered", np.zeros((2, 64, 32))),
        ("unidirectional", cy.initial.unidirectional(GRID, np.sqrt(0.975))),
        ("circumferential", cy.initial.circumferential(GRID)),
        ("cyclosis", cy.initial.stripes(GRID, 2)),
        ("multistripe", cy.initial.stripes(GRID, 4)),
        ("undecided", np.stack([0 * Z, 0.8 * np.sin(2 * np.pi * Z / 5)])),
        ("undecided", np.stack([0 * Z, 0.5 * (np.cos(THETA) + np.cos(2 * np.pi * Z / 5))])),
    ],
)
def test_states_are_named_for_what_they_look_like(name, state):
    found = cy.regime(PARAMS, GRID, state)
    assert found.name == name
    assert found.name in cy.REGIMES
    assert str(found).startswith(name)


@pytest.mark.parametrize("order", [0.049999, 0.05 - 1e-12, 0.0498, 0.03])
def test_an_order_below_the_bound_is_told_as_one(order):
    found = cy.regime(PARAMS, GRID, cy.initial.unidirectional(GRID, order))
    told, bound = map(float, found.reason.removeprefix("order ").split(" is below "))
    assert told < bound == cy.zones.DISORDER
    assert told == pytest.approx(order, rel=0.02)


def test_a_rigidly_moving_state_is_travelling():
    """A term -c·∇P makes any pattern drift at c; the regime recovers c."""
    import jax.numpy as jnp

    c = (0.03, -0.02)

    def drift(t, P, u, params, grid):
        spectrum = jnp.fft.fft2(P)
        slope = c[0] * 1j * grid.m[:, None] + c[1] * 1j * grid.q[None, :]
        return -jnp.fft.ifft2(slope * spectrum).real

    state = 0.7 * np.stack([np.cos(THETA + 2 * np.pi * Z / 5), np.sin(THETA)])
    found = cy.regime(PARAMS, GRID, state, terms=[drift])
    assert found.name == "travelling"
    assert found.drift == pytest.approx(c, rel=1e-9)
    assert not found.settled


def test_steady_cyclosis_is_settled_and_reports_its_numbers():
    run = cy.simulate(PARAMS, GRID, cy.initial.stripes(GRID), t_end=60, save_every=60)
    found = cy.regime(PARAMS, GRID, run.final_state)
    assert found.name == "cyclosis"
    assert found.settled
    assert found.zones == pytest.approx([0, np.pi], abs=1e-6) or found.zones == pytest.approx(
        [np.pi, 2 * np.pi], abs=1e-6
    )
    assert found.widths == pytest.approx([0.5, 0.5])
    assert found.mean_P == pytest.approx([0, 0], abs=1e-9)
    assert np.hypot(*found.drift) < 1e-6


def test_an_undecided_state_is_told_why():
    grid = cy.CylinderGrid(32, 32)
    P = np.zeros((2, *grid.shape))
    P[1] = 0.5 * np.cos(2 * np.pi * grid.z / grid.length)
    assert "along the axis, not around it" in cy.regime(cy.Parameters(), grid, P).reason
    P[1] = 0.3 * np.cos(grid.theta)[:, None]
    P[0] = 0.25
    found = cy.regime(cy.Parameters(), grid, P)
    assert (found.name, found.reason[-34:]) == ("undecided", "% of the order runs around the axis"[-34:])
