"""The bound under which disorder is certain: its inequalities hold, and what it certifies decays."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.disorder import Disorder

GRID = cy.CylinderGrid(24, 20, 5.0)


def random_state(seed, size):
    """A smooth random state with max |P| = size and a mean of any size."""
    rng = np.random.default_rng(seed)
    noise = cy.interpolate(rng.normal(size=(2, 8, 8)), GRID.shape) + rng.normal(size=(2, 1, 1)) * 2
    return noise * size / np.sqrt(np.max(np.sum(noise**2, axis=0)))


def measures(P):
    uneven = P - P.mean(axis=(1, 2), keepdims=True)
    return (
        float(np.sqrt(np.max(np.sum(P**2, axis=0)))),
        float(np.sqrt(np.mean(np.sum(uneven**2, axis=0)))),
        float(np.sqrt(np.mean(P[0] ** 2))),
    )


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("angle", [0.0, np.pi / 2])
def test_every_inequality_holds_at_random_states(seed, angle):
    size = 0.05 + 0.06 * seed
    params = cy.Parameters(alpha_p=0.02, alpha_u=0.8, epsilon=0.4, repulsion_angle=angle)
    bound = Disorder(params, GRID)
    P = random_state(seed, size)
    M, e, s = measures(P)
    change = cy.rate_of_change(params, GRID, P, dealias="full")
    uneven = P - P.mean(axis=(1, 2), keepdims=True)
    # The same formulas as in the module's text, written out again.
    a, c = params.d_r - params.alpha_p, bound.steepest
    decay = a + params.d_s * bound.k1_squared - 3 * params.kappa * M**2
    decay -= params.alpha_u * (3 * M**2 + 5 * M**4) + 3 * params.epsilon * c * M**3
    assert np.mean(np.sum(uneven * change, axis=0)) / e <= -decay * e + 1e-12
    held = params.kappa * (1 - M**2) if angle == 0 else -params.kappa * M**2
    beta = 3 * params.alpha_u * (M**2 + M**4) + 3 * params.epsilon * c * M**3
    around = a + held - params.alpha_u * (M**2 + M**4)
    assert np.mean(P[0] * change[0]) / s <= -around * s + beta * e + 1e-12
    u = cy.flow(params, GRID, P, dealias="full")
    mean = u.mean(axis=(1, 2), keepdims=True)
    assert np.max(np.hypot(*(u - mean))) <= 3 * bound.C0 * M**2 * e
    assert np.abs(mean).max() <= M**2 * s + 1e-14


@pytest.mark.slow
def test_what_is_certified_decays_and_keeps_within_its_bound():
    params = cy.Parameters(alpha_p=0.025, alpha_u=1.0)
    P = random_state(5, 0.02)
    assert Disorder(params, GRID).decays(*measures(P))
    run = cy.simulate(params, GRID, P, 400.0, 20.0)
    size = [measures(frame) for frame in run.frames]
    assert max(M for M, _, _ in size) <= 4 * size[0][0]
    assert size[-1][1] < 1e-2 * size[0][1]
    assert np.all(np.diff(run.records["order"]) < 0)


def test_certain_for_the_noise_of_a_thousand_filaments_soon_after_the_start():
    grid = cy.CylinderGrid(48, 48, 5.0)
    params = cy.Parameters(alpha_p=0.025, alpha_u=1.0)
    run = cy.simulate(params, grid, cy.initial.disordered(grid), 10.0, 10.0)
    assert not Disorder(params, grid).decays(*measures(cy.initial.disordered(grid)))
    assert Disorder(params, grid).decays(*measures(run.final_state))


def test_never_where_disorder_can_grow():
    weak = (1e-6, 1e-7, 1e-7)
    assert Disorder(cy.Parameters(alpha_p=0.025), GRID).decays(*weak)
    assert not Disorder(cy.Parameters(alpha_p=0.0250001), GRID).decays(*weak)
    # Without repulsion a uniform P_theta drives itself as soon as alpha_u > alpha_p.
    assert not Disorder(cy.Parameters(alpha_p=0.025, kappa=0.0), GRID).decays(*weak)
    assert not Disorder(cy.Parameters(alpha_p=0.01, repulsion_angle=0.5), GRID).decays(*weak)
    # Full stripes at alpha_p = 0 keep themselves: a large state is never certified.
    assert not Disorder(cy.Parameters(alpha_p=0.0, alpha_u=0.5), GRID).decays(0.9, 0.8, 0.0)
