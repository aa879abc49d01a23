import jax
import jax.numpy as jnp
import numpy as np
import pytest

import cyclosis as cy

GRID = cy.CylinderGrid(16, 12, 5.0)
PARAMS = cy.Parameters()
STATE = cy.interpolate(cy.initial.disordered(cy.CylinderGrid(8, 8, 5.0), 5), GRID.shape)


def test_traced_functions_equal_the_public_ones():
    with jax.enable_x64(True):
        ours = jax.jit(lambda P: cy.traced.rate_of_change(PARAMS, GRID, P))(jnp.asarray(STATE))
        flow = cy.traced.flow(PARAMS, GRID, jnp.asarray(STATE))
    assert np.asarray(ours) == pytest.approx(cy.rate_of_change(PARAMS, GRID, STATE), abs=1e-14)
    assert np.asarray(flow) == pytest.approx(cy.flow(PARAMS, GRID, STATE), abs=1e-15)


@pytest.mark.parametrize(
    "name", ["alpha_p", "alpha_u", "epsilon", "d_s", "kappa", "mu", "repulsion_angle", "force_exponent"]
)
def test_derivatives_with_respect_to_parameters(name):
    """Forward differentiation against a central difference of the public function."""
    h, value = 1e-5, getattr(PARAMS, name)

    def rate(x):
        return cy.traced.rate_of_change(PARAMS, GRID, jnp.asarray(STATE), **{name: x})

    with jax.enable_x64(True):
        _, tangent = jax.jvp(rate, (jnp.float64(value + 0.1),), (jnp.float64(1.0),))
    ends = [cy.rate_of_change(PARAMS.replace(**{name: value + 0.1 + s * h}), GRID, STATE) for s in (1, -1)]
    assert np.asarray(tangent) == pytest.approx((ends[0] - ends[1]) / (2 * h), abs=1e-8)


def test_many_values_at_once():
    with jax.enable_x64(True):
        many = jax.vmap(lambda a: cy.traced.rate_of_change(PARAMS, GRID, jnp.asarray(STATE), alpha_u=a))
        both = many(jnp.asarray([0.1, 0.9]))
    assert np.asarray(both[1]) == pytest.approx(
        cy.rate_of_change(PARAMS.replace(alpha_u=0.9), GRID, STATE), abs=1e-14
    )


def test_double_precision_is_refused_where_it_cannot_be_had():
    with pytest.raises(cy.InputError, match="jax_enable_x64"):
        cy.traced.flow(PARAMS, GRID, STATE)
    single = cy.traced.flow(PARAMS, GRID, jnp.asarray(STATE), precision="float32")
    assert single.dtype == jnp.float32
    with pytest.raises(cy.InputError, match="alpha_q"):
        cy.traced.flow(PARAMS, GRID, STATE, precision="float32", alpha_q=1)


def test_public_functions_leave_the_callers_settings_alone():
    cy.flow(PARAMS, GRID, STATE)
    assert jnp.zeros(1).dtype == jnp.float32


def test_settings_and_names_are_checked():
    grid = cy.CylinderGrid(16, 16)
    state = cy.initial.stripes(grid)
    with pytest.raises(cy.InputError, match="precision = 'double'"):
        cy.traced.flow(cy.Parameters(), grid, state, precision="double")
    with pytest.raises(cy.InputError, match="dealias = '3/2'"):
        cy.flow(cy.Parameters(), grid, state, dealias="3/2")
    with pytest.raises(cy.InputError, match="zero_theta_flux") as refused:
        cy.traced.flow(cy.Parameters(), grid, state, precision="float32", zero_theta_flux=True)
    assert "zero_theta_flux" not in refused.value.rule
