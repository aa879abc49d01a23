"""Whatever the parameters: a state that is verified, or one sentence, and never a warning on the way.

Found states are verified by the equations of the whole model, not by what they say of themselves.
"""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import cyclosis as cy

UNRESOLVED = 1e-2
"""Largest |dP/dt| between grid points of a state that is not refused."""


def spread(low, high):
    """Numbers over many decades, and 0."""
    return st.just(0.0) | st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


def cells(most=1.0):
    """Cells of any kind, with rates up to so many times those of the paper."""
    return st.builds(
        cy.Parameters,
        alpha_p=spread(1e-3, 2.0 * most),
        alpha_u=spread(1e-4, 2.0 * most),
        epsilon=spread(1e-2, 1.0),
        d_s=spread(3e-3 / most, 0.3),
        d_r=spread(1e-3, 0.3),
        kappa=spread(1e-2, 1.5 * most),
        mu=spread(1e-3, 2.0 * most),
        repulsion_angle=st.sampled_from([0.0, 0.0, 0.0, np.pi, 0.3]),
        zero_theta_flux=st.booleans(),
        force_exponent=st.sampled_from([2.0, 2.0, 2.0, 0.0, 1.0, 3.5]),
    )


TAME = st.builds(
    cy.Parameters,
    alpha_p=st.floats(0.0, 0.8),
    alpha_u=spread(1e-3, 1.0),
    epsilon=st.floats(0.0, 0.5),
    d_s=st.floats(0.01, 0.06),
    d_r=st.floats(0.0, 0.08),
    kappa=st.floats(0.0, 0.8),
    mu=st.floats(0.0, 0.3),
)
"""Cells in which most of what is asked for exists."""


def tried(call, *arguments, **options):
    """Return what a call returns, or None where it raises one sentence; warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            return call(*arguments, **options)
        except cy.InputError as error:
            sentence = str(error)
            assert sentence.replace("...", "").count(". ") == 0
            assert sentence.endswith(".")
            assert "nan" not in sentence.split()
            return None


def left(params, P, drift=0.0):
    """The largest |dP/dt + c P'| of a state P (2, n) between its points."""
    n = 2 * P.shape[1]
    grid = cy.CylinderGrid(n, 8, 5.0)
    fine = cy.interpolate(P[:, :, None], (n, 1))
    m = np.where(np.arange(n) == n // 2, 0, grid.m)[:, None]
    slope = np.fft.ifft(1j * m * np.fft.fft(fine, axis=1), axis=1).real
    rate = cy.rate_of_change(params, grid, np.broadcast_to(fine, (2, *grid.shape)))
    return float(np.hypot(*(rate[:, :, :1] + drift * slope)).max())


def assert_stripes(state, count):
    """A steady state P e_z of so many stripes, with finite numbers only."""
    assert state.theta.size == state.P.size == state.u.size
    assert cy.zones.zone_angles(state.P).size == count
    assert np.all(np.isfinite(state.u))
    found = left(state.params, np.stack([np.zeros_like(state.P), state.P]))
    assert found < UNRESOLVED * (1 + 1e-6)
    assert found == pytest.approx(state.residual, rel=1e-3, abs=1e-9)
    # An interpolant overshoots no farther than it is resolved.
    assert 1e-5 < np.abs(state.P).max() < 1 + 1e-9 + found


ANY = settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    phases=[Phase.generate],  # an example takes too long to be made simpler
    suppress_health_check=list(HealthCheck),
)
FEW = settings(ANY, max_examples=12)


@pytest.mark.slow
@ANY
@given(cells(100.0), st.integers(32, 100), st.sampled_from([2, 2, 4, 6]))
def test_stripes(params, n, count):
    state = tried(cy.stability.stripes, params, count, n)
    if state is not None:
        assert_stripes(state, count)
        modes = tried(state.spectrum, 4, axial_mode=n % 3)
        assert np.all(np.isfinite(modes.eigenvalues))


@pytest.mark.slow
@FEW
@given(TAME, st.sampled_from([64, 81]))
def test_unequal_stripes(params, n):
    state = tried(cy.stability.unequal, params, n)
    if state is not None:
        assert_stripes(state, 2)
        assert state.widths.min() < 0.5


@pytest.mark.slow
@FEW
@given(cells() | TAME, st.booleans())
def test_thresholds_and_folds(params, full):
    found = tried(cy.stability.threshold_with_error, params, full=full)
    below = params.replace(alpha_p=0.9 * min(params.d_r + params.d_s, 1.0))
    for value in (found, tried(cy.stability.fold_with_error, below)):
        if value is not None:
            assert 0 < value.alpha_u < 1e3
            assert 0 <= value.error < 0.1 * value.alpha_u
            assert value.cause


@pytest.mark.slow
@FEW
@given(cells() | TAME, st.sampled_from([48, 64, 65]), st.sampled_from(["left", "right"]))
def test_drifting_states(params, n, hand):
    state = tried(cy.stability.drifting, params, n, hand, 50.0)
    if state is not None:
        assert left(state.params, state.P, state.drift) < UNRESOLVED * (1 + 1e-6)
        assert np.ptp(state.P, axis=1).max() > 1e-6
        assert np.sqrt(np.mean(state.P[0] ** 2)) > 1e-7


NAMES = ("alpha_p", "alpha_u", "kappa", "d_s", "d_r", "mu", "epsilon", "force_exponent")


@pytest.mark.slow
@FEW
@given(TAME, st.sampled_from([48, 64]), st.sampled_from(NAMES))
def test_branches(params, n, name):
    start = tried(cy.stability.cyclosis, params, n)
    if start is None:
        return
    value = getattr(params, name)
    bounds = (max(0.0, value - 0.05), value + 0.05)
    branch = tried(cy.stability.continue_branch, start, name, bounds, None, most=3, longest=0.05)
    if branch is None:
        return
    assert np.all((branch.parameter >= bounds[0] - 1e-9) & (branch.parameter <= bounds[1] + 1e-9))
    assert np.all(np.isfinite(branch.eigenvalues[:, 0]))
    assert np.all(np.isfinite(branch.drift))
    for index in range(branch.parameter.size):
        state = branch.state(index)
        found = left(state.params, state.P, state.drift)
        assert found == pytest.approx(branch.residual[index], rel=1e-2, abs=1e-7)
    assert "nan" not in str(branch)


@pytest.mark.slow
@FEW
@given(TAME, st.sampled_from([16, 24, 25]), st.integers(0, 10**6))
def test_states_of_the_whole_cell(params, n, seed):
    grid = cy.CylinderGrid(n, 8, 5.0)
    guess = 0.02 * np.random.default_rng(seed).normal(size=(2, *grid.shape))
    guess[1] += 0.8 * np.tanh(2 * np.sin(grid.theta))[:, None]
    found = tried(cy.stability.steady_state, params, grid, guess)
    if found is not None:
        assert np.all(np.isfinite(found.state))
        assert found.residual < 1e-10
        assert np.ptp(found.state, axis=1).max() > 1e-3
        assert np.hypot(*found.state).max() < 1.02
