"""Branches of the equation itself, against exact results and numbers known to several digits."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk

import cyclosis as cy
from cyclosis.stability.branches.continuation import continue_branch
from cyclosis.stability.profiles.reduced import reduced
from cyclosis.stability.profiles.steady import rms
from cyclosis.stability.profiles.travelling import drifting
from cyclosis.stability.uniform.dispersion import growth_rates

N = 96
"""Points around, which resolve all of these states to 1e-7 or better; one number, compiled once."""


def start(**values):
    return cy.stability.cyclosis(cy.Parameters(**values), N)


def circumferential(**values):
    """The uniform circumferential state next to full order, by a fixed point of its balance."""
    params = cy.Parameters(**values)
    order = brentq(
        lambda p: (1 - p**2) * (params.alpha_p - params.kappa + params.alpha_u * p**2) - 0.025, 0.7, 1
    )
    theta = 2 * np.pi / N * np.arange(N)
    return SimpleNamespace(theta=theta, P=np.stack([np.full(N, order), np.zeros(N)]), params=params)


@pytest.fixture(scope="module")
def tilted():
    """The tilted stripes from where they straighten to where they vanish."""
    return continue_branch(drifting(cy.Parameters(kappa=0.2), N), "kappa", (0.0, 0.6), None, longest=0.05)


@pytest.fixture(scope="module")
def upright():
    """Cyclosis where its filaments begin to tilt."""
    return continue_branch(start(), "kappa", (0.3, 0.6), None, longest=0.1)


def test_the_fold_without_bundling():
    branch = continue_branch(start(alpha_p=0.0, alpha_u=0.3), "alpha_u", (0.2, 0.3), None)
    (fold,) = branch.of("fold")
    assert fold.value == pytest.approx(cy.stability.fold(cy.Parameters(alpha_p=0.0)), abs=1e-12)
    assert fold.value == pytest.approx(0.2267245, abs=1e-7)
    assert branch.parameter[fold.index] == fold.value == branch.parameter.min()
    assert [point.kind for point in branch.points] == ["end", "fold", "end"]
    assert branch.parameter[[0, -1]] == pytest.approx([0.3, 0.3], abs=1e-14)
    # The strongly ordered half is stable along the circumference, the other never.
    order = branch.measures["max_P"]
    side = order > order[fold.index]
    elsewhere = np.arange(order.size) != fold.index
    assert np.array_equal(branch.stable[elsewhere], side[elsewhere])
    assert set(branch.unstable[~side & elsewhere]) == {1}


def test_at_the_codimension_two_point_stripes_end_in_a_pitchfork():
    branch = continue_branch(start(alpha_p=0.05, alpha_u=0.1), "alpha_u", (0.0, 0.15), None, longest=0.05)
    first = branch.points[0]
    assert first.kind == "branch point"
    assert first.ends
    assert first.value == pytest.approx(0.05 * (1 + 0.05), abs=1e-8)
    assert np.abs(branch.states[0]).max() < 1e-6
    assert "disorder" in first.sentence


def test_flow_stabilises_cyclosis_at_a_branch_point():
    branch = continue_branch(start(alpha_p=0.1, alpha_u=0.02), "alpha_u", (0.0, 0.02), None, longest=0.2)
    (point,) = branch.of("branch point")
    assert point.value == pytest.approx(cy.stability.threshold(cy.Parameters(alpha_p=0.1)), rel=1e-8)
    assert "the mean of P_z" in point.sentence
    below = branch.parameter < point.value
    assert not np.any(branch.stable[below])
    assert np.all(branch.stable[branch.parameter > point.value])
    # On the other branch stripes are unequal, one way or the other.
    for size in (0.05, -0.05):
        unequal = branch.switch(point, size)
        assert size * branch.switch(point, 0.05).P[1].mean() * unequal.P[1].mean() > 0
        assert unequal.residual < 1e-6
        assert abs(unequal.drift) < 1e-9


def test_without_flow_amplitude_and_growth_are_the_exact_ones():
    branch = continue_branch(start(alpha_p=0.1, alpha_u=0.0), "alpha_p", (0.0, 0.15), None, longest=0.05)
    first = branch.points[0]
    assert first.ends
    assert first.value == pytest.approx(0.05, abs=1e-8)
    for alpha_p, order, growth in zip(
        branch.parameter[1:], branch.measures["max_P"][1:], branch.eigenvalues[1:, 0], strict=True
    ):
        a = alpha_p - 0.025

        def turn(k2, a=a):
            return 4 * ellipk(k2) * np.sqrt(0.025 * (1 + k2) / a) - 2 * np.pi

        k2 = brentq(turn, 1e-12, 1 - 1e-13, xtol=1e-15)
        # Newton's method ends at 1e-11, and what pulls back to the branch goes with the square of the order.
        close = max(1e-8, 2e-11 / order**2)
        assert order == pytest.approx(np.sqrt(2 * k2 / (1 + k2) * a / alpha_p), abs=close)
        assert growth == pytest.approx(a * (2 * np.sqrt(1 - k2 + k2**2) - (1 + k2)) / (1 + k2), abs=1e-8)


def test_cyclosis_tilts_at_a_pitchfork(upright, tilted):
    points = upright.of("branch point")
    assert [point.value for point in points] == pytest.approx([0.36121373, 0.47069643], abs=1e-8)
    assert "the mean of P_theta" in points[1].sentence
    # κ takes itself off the growth rates of P_theta, and leaves all else as it is.
    y = upright.states[upright.start].ravel()
    problem = reduced(upright.params, cy.CylinderGrid(N, 8))
    rates = np.linalg.eigvals(problem.jacobian(y)[:N, :N])
    rates = np.sort(rates.real)[::-1] + upright.params.kappa
    assert [points[1].value, points[0].value] == pytest.approx(rates[:2], abs=1e-8)
    state = upright.switch(points[1], 0.05)
    assert state.drift * state.P[0].mean() < 0
    assert state.params.kappa < points[1].value
    # The very states that the tilted stripes at small κ continue to.
    last = tilted.points[-1]
    assert last.kind == "branch point"
    assert last.ends
    assert last.value == pytest.approx(points[1].value, abs=1e-7)
    where = np.argsort(tilted.parameter)
    # Its square goes in proportion near the pitchfork.
    square = tilted.measures["mean_P_theta"][where] ** 2
    tilt = np.sqrt(np.interp(state.params.kappa, tilted.parameter[where], square))
    assert abs(state.P[0].mean()) == pytest.approx(tilt, rel=0.01)


def test_tilted_stripes_are_stable_and_vanish_in_circumferential_streaming(tilted):
    first = tilted.points[0]
    assert len(tilted.points) == 2
    assert first.kind == "Hopf point"
    assert first.ends
    assert first.value == pytest.approx(0.0483970063, abs=1e-9)
    assert np.all(tilted.stable[1:-1])
    rate = growth_rates(tilted.params.replace(kappa=first.value), "circumferential", 1, 0)[0]
    assert rate.real == pytest.approx(0, abs=1e-9)
    assert abs(rate.imag) == pytest.approx(abs(tilted.drift[0]), abs=1e-9)
    # On the way the drift changes its direction.
    assert tilted.drift[1] > 0 > tilted.drift[-2]
    assert np.ptp(tilted.states[0], axis=1) == pytest.approx(0, abs=1e-9)


def test_a_rotating_wave_is_switched_to_from_circumferential_streaming(tilted):
    branch = continue_branch(circumferential(kappa=0.03), "kappa", (0.0, 0.1), None, longest=0.2)
    (point,) = branch.of("Hopf point")
    assert point.value == pytest.approx(tilted.points[0].value, abs=1e-7)
    assert not np.any(branch.stable[branch.parameter > point.value])
    state = branch.switch(point, 0.05)
    assert state.drift == pytest.approx(tilted.drift[0], rel=0.05)
    assert state.params.kappa > point.value
    assert state.residual < 1e-9
    with pytest.raises(cy.InputError, match="branch point"):
        branch.switch(branch.of("end")[0])


def test_where_a_branch_ends_the_symmetric_states_go_on(tilted):
    streaming = tilted.switch(tilted.points[0])
    assert np.ptp(streaming.P, axis=1) == pytest.approx(0, abs=1e-14)
    assert streaming.P[0, 0] > 0.99
    standing = tilted.switch(tilted.points[-1])
    assert np.abs(standing.P[0]).max() < 1e-9
    assert abs(standing.drift) < 1e-9


def test_cyclosis_bends_at_large_epsilon():
    branch = continue_branch(start(), "epsilon", (0.1, 0.45), longest=0.2)
    (point,) = branch.of("branch point")
    assert point.axial_mode == 1
    assert point.value == pytest.approx(0.384472, abs=1e-6)
    assert branch.across.shape[1] >= 4
    index = branch.start
    problem = reduced(branch.params, cy.CylinderGrid(N, 8))
    rate = np.linalg.eigvals(problem.waves(branch.states[index].ravel(), 1)).real.max()
    assert branch.across[index, 0].real == pytest.approx(rate, abs=1e-8)
    assert np.array_equal(branch.stable, branch.parameter < point.value)
    with pytest.raises(cy.InputError, match="along the cell"):
        branch.switch(point)


@pytest.mark.parametrize(
    ("name", "bounds"),
    [
        ("mu", (0.0, 0.3)),
        ("d_s", (0.02, 0.04)),
        ("d_r", (0.0, 0.1)),
        ("force_exponent", (1.5, 2.5)),
        ("repulsion_angle", (0.0, 0.3)),
    ],
)
def test_any_number_can_be_varied(name, bounds):
    branch = continue_branch(start(), name, bounds, None, longest=0.5)
    ends = sorted(branch.parameter[[0, -1]])
    assert ends == pytest.approx(bounds)
    for index in (0, branch.parameter.size // 2, -1):
        state = branch.state(index)
        problem = reduced(state.params, cy.CylinderGrid(N, 8))
        y = state.P.ravel()
        assert rms(problem.rate(y) + state.drift * problem.slope(y)) < 1e-10
        assert getattr(state.params, name) == branch.parameter[index]


def test_a_branch_as_a_dataset(tilted):
    data = tilted.to_dataset()
    assert data.P.dims == ("point", "component", "theta")
    assert float(data.kappa[0]) == tilted.parameter[0]
    assert list(data.special_kind.values) == ["Hopf point", "branch point"]
    assert data.attrs["alpha_u"] == 0.5
    assert data.growth.shape == data.frequency.shape == (tilted.parameter.size, 8)
    assert str(tilted).count("\n") == 2


def test_as_many_points_as_asked_for():
    branch = continue_branch(start(), "alpha_u", (0.0, 1.0), None, most=3)
    assert branch.parameter.size == 7
    assert branch.start == 3
    assert all("the limit of 3 points is reached" in point.sentence for point in branch.points)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"start": None}, "start"),
        ({"start": SimpleNamespace(theta=np.zeros(N), P=np.zeros(3), params=cy.Parameters())}, "start"),
        ({"parameter": "zero_theta_flux"}, "parameter"),
        ({"parameter": 3}, "parameter"),
        ({"bounds": (0.6, 1.0)}, "bounds"),
        ({"bounds": (0.5, 0.5)}, "bounds"),
        ({"bounds": (-1.0, 1.0)}, "bounds"),
        ({"bounds": 1.0}, "bounds"),
        ({"length": -1.0}, "length"),
        ({"longest": 0.0}, "longest"),
        ({"count": 0}, "count"),
        ({"most": 0}, "most"),
    ],
)
def test_bad_input_is_refused(changes, field):
    arguments = {"start": start(), "parameter": "alpha_u", "bounds": (0.0, 1.0)} | changes
    with pytest.raises(cy.InputError, match=field):
        continue_branch(**arguments)


def test_what_is_not_steady_is_refused():
    far = start()
    moved = SimpleNamespace(theta=far.theta, P=0.5 * far.P, params=far.params)
    with pytest.raises(cy.InputError, match="steady"):
        continue_branch(moved, "alpha_u", (0.0, 1.0))
    fields = SimpleNamespace(theta=far.theta, P=far.P, params=cy.Parameters(alpha_u=np.ones((8, 8))))
    with pytest.raises(cy.InputError, match="one number"):
        continue_branch(fields, "alpha_u", (0.0, 1.0))
