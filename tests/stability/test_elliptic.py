"""Closed forms without flow: they solve the equations, and have the limits that they should."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.profiles import elliptic

THETA = 2 * np.pi / 192 * np.arange(192)


def cell(alpha_p, **other):
    return cy.Parameters(alpha_p=alpha_p, alpha_u=0.0).replace(**other)


@pytest.mark.parametrize(("alpha_p", "count"), [(0.051, 2), (0.1, 2), (0.5, 2), (0.3, 4), (0.6, 6)])
def test_the_profile_is_steady_in_the_whole_model(alpha_p, count):
    grid = cy.CylinderGrid(192, 8, 5.0)
    P = np.zeros((2, *grid.shape))
    P[1] = elliptic.elliptic_profile(cell(alpha_p), THETA, count)[:, None]
    assert cy.zones.zone_angles(P[1, :, 0]).size == count
    assert np.abs(cy.rate_of_change(cell(alpha_p), grid, P)).max() < 1e-9


def test_growth_far_below_the_smallest_eigenvalue_that_doubles_tell_from_zero():
    """96 a exp(-2π (a/2d_s)^½) for narrow zones, to a relative error that itself vanishes."""
    off = []
    for alpha_p in (0.5, 1.0, 4.0):
        a = alpha_p - 0.025
        limit = 96 * a * np.exp(-2 * np.pi * np.sqrt(a / 0.05))
        off.append(abs(elliptic.elliptic_growth(cell(alpha_p)) / limit - 1))
    assert off[0] < 1e-3
    assert off[2] < off[1] < off[0]
    assert elliptic.elliptic_growth(cell(4.0)) < 1e-20


@pytest.mark.parametrize("count", [2, 4])
def test_all_rates_are_eigenvalues(count):
    """Of P_z and P_theta; with four stripes all those that turn with the stripes are still among them."""
    p = cell(0.3)
    state = cy.stability.stripes(p, count)
    for component, values in zip(("z", "theta"), elliptic.elliptic_rates(p, count), strict=True):
        found = state.spectrum(60, components=component).eigenvalues
        assert max(np.abs(found - value).min() for value in values) < 1e-11
    assert elliptic.elliptic_rates(p, count)[0][0] == elliptic.elliptic_growth(p, count)


def test_the_growth_vanishes_where_stripes_do():
    rates = [elliptic.elliptic_growth(cell(0.05 + gap)) for gap in (1e-3, 1e-5, 1e-7)]
    # At the pitchfork it is that of the uniform mode of disorder, a = d_s.
    assert rates == pytest.approx([0.025] * 3, abs=2e-3)
    assert rates[2] == pytest.approx(0.025, abs=1e-6)


def test_the_front_formula_is_good_where_zones_are_narrow():
    off = []
    for alpha_p in (0.3, 0.4, 0.5):
        p = cell(alpha_p)
        off.append(abs(elliptic.front_threshold(p) / cy.stability.threshold(p) - 1))
    assert off[0] < 1e-3
    assert off[2] < off[1] < off[0]


@pytest.mark.parametrize(
    ("changes", "count", "field"),
    [
        ({"alpha_p": 0.05}, 2, "alpha_p"),
        ({"alpha_p": 0.1}, 4, "alpha_p"),
        ({"alpha_p": np.ones((8, 8))}, 2, "alpha_p"),
        ({}, 3, "count"),
        ({}, 0, "count"),
        ({"d_s": 1e-6}, 2, "d_s"),
        ({"d_s": 0.0}, 2, "d_s"),
    ],
)
def test_what_has_no_closed_form_is_refused(changes, count, field):
    p = cell(**{"alpha_p": 1.0} | changes)
    for sought in (elliptic.elliptic_growth, elliptic.elliptic_rates, elliptic.front_threshold):
        with pytest.raises(cy.InputError, match=field):
            sought(p, count)
    with pytest.raises(cy.InputError, match=field):
        elliptic.elliptic_profile(p, THETA, count)
