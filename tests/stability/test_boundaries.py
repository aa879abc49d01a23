"""Curves of existence, stability, tilting and rotation against exact values and other ways to have them."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.existence import boundaries
from cyclosis.stability.profiles import elliptic


@pytest.mark.slow
def test_limits_are_fold_pitchfork_and_threshold():
    params = cy.Parameters()
    found = boundaries.limits(params, [0.03, 0.05 + 1e-15, 0.1])
    assert found.exists[0] == pytest.approx(cy.stability.fold(params.replace(alpha_p=0.03)), rel=1e-14)
    assert found.exists[1] == pytest.approx(0.05 * 1.05, rel=1e-14)
    assert found.exists[2] == 0
    assert found.stable[2] == pytest.approx(cy.stability.threshold(params.replace(alpha_p=0.1)), rel=1e-14)
    assert found.front[2] == pytest.approx(elliptic.front_threshold(params.replace(alpha_p=0.1)), rel=1e-14)
    assert np.all(np.isnan(found.front[:2]))
    assert np.all(found.stable_error < 1e-11)


def test_limits_over_other_parameters_scale_as_the_equation_does():
    # Without flow in question only a/d_s matters for the zones: scaling all rates scales α_u*.
    params = cy.Parameters(alpha_p=0.2)
    one = boundaries.limits(params, [0.025], "d_s").stable[0]
    twice = boundaries.limits(params.replace(alpha_p=0.4, d_r=0.05), [0.05], "d_s").stable[0]
    assert twice == pytest.approx(2 * one, rel=1e-9)


@pytest.mark.parametrize("alpha_p", [0.03, 0.048, 0.06, 0.1, 0.5])
def test_quick_limits_are_good_enough_to_draw(alpha_p):
    params = cy.Parameters(alpha_p=alpha_p)
    exact = boundaries.limits(params, [alpha_p])
    exists, stable = boundaries.quick_limits(params)
    assert exists == pytest.approx(exact.exists[0], rel=1e-3)
    assert stable == pytest.approx(exact.stable[0], rel=1e-3)


def test_stripes_tilt_where_the_exact_rates_and_branches_say():
    assert boundaries.tilt_limit(cy.Parameters()) == pytest.approx(0.470696, abs=2e-5)
    still = cy.Parameters(alpha_u=0.0, kappa=0.0)
    assert boundaries.tilt_limit(still) == pytest.approx(elliptic.elliptic_rates(still)[1][0], abs=2e-5)
    assert np.isnan(boundaries.tilt_limit(cy.Parameters(alpha_p=0.0, alpha_u=0.1)))


def test_circumferential_order_gives_way_where_its_wave_grows():
    params = cy.Parameters()
    kappa = boundaries.rotating_limit(params)
    x = cy.stability.orders(params.replace(kappa=kappa), "circumferential")[0] ** 2
    # The wave m = 1 of P_z costs diffusion and gains by repulsion less what its flow takes: in closed form.
    assert kappa == pytest.approx(params.d_s + params.alpha_u * x * params.mu / (1 + params.mu), rel=1e-10)
    assert kappa == pytest.approx(0.0483970063, abs=1e-9)


def test_other_parameters_are_refused():
    with pytest.raises(cy.InputError, match="name"):
        boundaries.limits(cy.Parameters(), [0.1, 0.2], "kappa")
    with pytest.raises(cy.InputError, match="alpha_p"):
        boundaries.limits(cy.Parameters(), [-0.1])


def test_quick_limits_at_the_onset_are_the_pitchfork():
    params = cy.Parameters(alpha_p=0.05)
    assert boundaries.quick_limits(params)[0] == pytest.approx(0.05 * 1.05, rel=1e-12)


def test_an_oblique_direction_is_refused():
    with pytest.raises(cy.InputError):
        boundaries.rotating_limit(cy.Parameters(repulsion_angle=0.3))
