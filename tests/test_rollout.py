"""The differentiable run: equal to `simulate`, and its derivatives to central differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy

GRID = cy.CylinderGrid(16, 12, 5.0)
PARAMS = cy.Parameters()
START = cy.interpolate(cy.initial.disordered(cy.CylinderGrid(8, 8, 5.0), 20.0, 5), GRID.shape)
NAMES = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu")
TIMES = (0.0, 0.3, 1.0, 1.25)


def total(values, P0):
    P = cy.traced.rollout(PARAMS, GRID, P0, TIMES, 0.1, **dict(zip(NAMES, values, strict=True)))
    return (P**3).mean() + (P[-1] ** 2).mean()


def test_it_equals_simulate():
    run = cy.simulate(PARAMS, GRID, START, t_end=1.25, save_at=TIMES, stepper="etdrk4", dt=0.1)
    with jax.enable_x64(True):
        P = cy.traced.rollout(PARAMS, GRID, START, TIMES, 0.1)
    assert np.asarray(P) == pytest.approx(np.stack(run.frames), abs=1e-14)


@pytest.mark.slow
def test_gradients_equal_central_differences_and_forward_mode():
    begin = np.array([getattr(PARAMS, name) for name in NAMES])
    way = np.random.default_rng(0).normal(size=START.shape)
    with jax.enable_x64(True):
        value = jax.jit(total)
        by_values, by_start = jax.jit(jax.grad(total, (0, 1)))(jnp.asarray(begin), jnp.asarray(START))

        def slope(dv, dP, h):
            ends = [
                float(value(jnp.asarray(begin + s * h * dv), jnp.asarray(START + s * h * dP)))
                for s in (1, -1)
            ]
            return (ends[0] - ends[1]) / (2 * h)

        for k in range(len(NAMES)):
            found = slope(np.eye(len(NAMES))[k], 0 * way, 1e-5)
            assert float(by_values[k]) == pytest.approx(found, rel=1e-7, abs=1e-9), NAMES[k]
        assert float((by_start * way).sum()) == pytest.approx(slope(0 * begin, way, 1e-5), rel=1e-7)
        tangent = (jnp.ones(len(NAMES)), jnp.asarray(way))
        _, forward = jax.jvp(total, (jnp.asarray(begin), jnp.asarray(START)), tangent)
        assert float(forward) == pytest.approx(float(by_values.sum() + (by_start * way).sum()), rel=1e-12)


@pytest.mark.slow
def test_many_initial_states_at_once():
    with jax.enable_x64(True):
        both = jax.vmap(lambda P0: cy.traced.rollout(PARAMS, GRID, P0, [0.5]))(
            jnp.asarray([START, 0.5 * START])
        )
        one = cy.traced.rollout(PARAMS, GRID, 0.5 * START, [0.5])
    assert np.asarray(both[1]) == pytest.approx(np.asarray(one), abs=1e-14)


@pytest.mark.parametrize("times", [[1.0, 0.5], [-1.0], [], [[1.0]], [0.5, np.nan], "soon"])
def test_times_that_do_not_increase_are_refused(times):
    with pytest.raises(cy.InputError, match="times"):
        cy.traced.rollout(PARAMS, GRID, START, times, precision="float32")


def test_traced_times_and_steps_are_refused():
    with pytest.raises(cy.InputError, match="times"):
        jax.grad(lambda t: cy.traced.rollout(PARAMS, GRID, START, t, precision="float32").sum())(jnp.ones(1))
    with pytest.raises(cy.InputError, match="dt"):
        jax.grad(lambda h: cy.traced.rollout(PARAMS, GRID, START, [1.0], h, precision="float32").sum())(0.1)


def speed(x):
    return cy.simulate(cy.Parameters(alpha_p=x), GRID, START, t_end=0.1).final_state.sum()


@pytest.mark.parametrize(
    "function",
    [
        speed,
        lambda x: cy.flow(cy.Parameters(mu=x), GRID, START).sum(),
        lambda x: cy.stability.cyclosis(cy.Parameters(alpha_p=x)).u.max(),
        lambda x: cy.flow(PARAMS, GRID, x * jnp.asarray(START)).sum(),
        lambda x: cy.simulate(PARAMS, GRID, x * jnp.asarray(START), t_end=0.1).final_state.sum(),
        lambda x: cy.stability.growth_rates(cy.Parameters(kappa=x), "disorder", 1.0, 0.0)[0].real,
        lambda x: cy.initial.stripes(GRID, magnitude=x).sum(),
        lambda x: cy.Scales(radius_um=x).time_s,
    ],
)
@pytest.mark.parametrize("way", [jax.grad, jax.jit])
def test_a_gradient_is_never_lost(function, way):
    with pytest.raises(cy.InputError, match=r"cyclosis\.traced"):
        way(function)(0.5)
