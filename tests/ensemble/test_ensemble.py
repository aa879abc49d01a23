"""Members in lanes: each on its own, each to its end or to its certain regime."""

from functools import partial

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.ensemble import OUTCOMES, EnsembleSettings, Member, follow
from cyclosis.ensemble.lanes import CHECK_STEPS, run_lanes

GRID = cy.CylinderGrid(32, 24, 5.0)


def member(seed=0, grid=GRID, N=1000, **values):
    return Member(cy.Parameters(**values), grid, partial(cy.initial.disordered, grid, N, seed))


def same(a, b):
    """Whether two outcomes are the same to the last bit, but for the seconds they took."""
    numbers = ("t_final", "t_order", "eigenvalue", "tail")
    return (
        (a.regime, a.status, a.reason, a.evaluations) == (b.regime, b.status, b.reason, b.evaluations)
        and all(np.array_equal(getattr(a, n), getattr(b, n), equal_nan=True) for n in numbers)
        and np.array_equal(a.state, b.state)
    )


@pytest.fixture
def widths(monkeypatch):
    """How many lanes each batch of steps was taken in."""
    seen = []

    def counted(systems, control, table, lanes, t_end, how):
        seen.append(lanes.t.size)
        return run_lanes(systems, control, table, lanes, t_end, how=how)

    monkeypatch.setattr("cyclosis.ensemble.run.run_lanes", counted)
    return seen


def various():
    points = ((0.3, 0.4), (0.2, 0.05), (0.025, 0.9), (0.2, 0.05), (0.13, 0.3))
    return [member(seed, alpha_p=p, alpha_u=u) for seed, (p, u) in enumerate(points)]


@pytest.mark.slow
@pytest.mark.parametrize("lanes", [1, 3])
def test_an_outcome_does_not_depend_on_company_order_or_lane(lanes):
    how = EnsembleSettings(lanes=lanes)
    members = various()
    together = follow(members, how)
    backward = follow(members[::-1], how)[::-1]
    alone = [follow([one], how)[0] for one in members]
    for a, b, c in zip(together, backward, alone, strict=True):
        assert same(a, b)
        assert same(a, c)


@pytest.mark.slow
def test_few_that_are_left_go_on_in_fewer_lanes(widths):
    grid = cy.CylinderGrid(16, 16, 5.0)
    members = [member(seed, grid, alpha_p=0.02 + 0.02 * seed) for seed in range(20)]
    many = follow(members, EnsembleSettings(lanes=128, t_end=100.0))
    assert widths == sorted(widths, reverse=True)
    assert set(widths) == {128, 64}
    few = follow(members, EnsembleSettings(lanes=64, t_end=100.0))
    assert all(same(a, b) for a, b in zip(many, few, strict=True))


def test_lanes_that_nobody_asked_for_are_no_more_than_members_need(monkeypatch, widths):
    monkeypatch.setattr("cyclosis.ensemble.run.default_lanes", lambda grid, precision: 4096)
    grid = cy.CylinderGrid(16, 16, 5.0)
    how = EnsembleSettings(t_end=1.0, finish="t_end")
    follow([member(seed, grid, alpha_p=0.05) for seed in range(5)], how)
    assert set(widths) == {8}


@pytest.mark.slow
def test_regimes_do_not_depend_on_the_number_of_lanes_or_the_precision():
    members = various()
    outcomes = [
        [o.regime for o in follow(members, EnsembleSettings(lanes=lanes, precision=precision))]
        for lanes, precision in ((1, "float64"), (3, "float64"), (3, "float32"))
    ]
    assert all(names == outcomes[0] for names in outcomes)
    assert set(outcomes[0]) == {"cyclosis", "unidirectional", "disordered"}


def test_followed_to_the_end_it_is_the_single_run():
    one = member(3, alpha_p=0.4, alpha_u=0.3)
    (outcome,) = follow([one], EnsembleSettings(t_end=33.3, finish="t_end", rtol=1e-7))
    run = cy.simulate(one.params, GRID, one.state(), 33.3, 33.3, rtol=1e-9)
    assert outcome.status == "completed"
    assert outcome.t_final == 33.3
    assert np.abs(outcome.state - run.final_state).max() < 1e-5
    assert outcome.regime == cy.regime(one.params, GRID, run.final_state).name


@pytest.mark.slow
def test_certain_regimes_are_those_of_brute_force():
    members = [*various(), member(7, alpha_p=0.4, alpha_u=0.1), member(8, alpha_p=0.08, alpha_u=0.1)]
    sure = follow(members, EnsembleSettings(t_end=1500.0))
    brute = follow(members, EnsembleSettings(t_end=1500.0, finish="t_end"))
    for a, b in zip(sure, brute, strict=True):
        assert a.status == "certified"
        assert b.status == "completed"
        assert a.regime == b.regime
        assert a.evaluations < b.evaluations
        if a.regime != "disordered":
            # The steady state that was certain is where brute force ends, up to a rotation.
            assert np.abs(spectrum(a.state) - spectrum(b.state)).max() < 2e-3
            assert a.eigenvalue < 0
            assert 0 < a.t_order <= a.t_final + 1e4


def spectrum(P):
    return np.abs(np.fft.fft2(P[1])) / P[1].size


def test_disorder_is_certain_by_theory_and_only_where_it_is():
    marginal, growing = follow(
        [member(alpha_p=0.025, alpha_u=1.0), member(alpha_p=0.0251, alpha_u=1.0)],
        EnsembleSettings(t_end=200.0),
    )
    assert (marginal.regime, marginal.status) == ("disordered", "certified")
    assert marginal.t_final < 30
    assert np.isnan(marginal.t_order)
    assert not marginal.state.any()
    assert growing.status == "completed"


def test_without_flow_stripes_are_never_certain():
    # On few points zones are pinned to the grid; the finer grid tells.
    stripes = Member(cy.Parameters(alpha_p=0.4, alpha_u=0.0), GRID, partial(cy.initial.stripes, GRID))
    (outcome,) = follow([stripes], EnsembleSettings(t_end=60.0))
    assert outcome.status == "completed"
    assert outcome.regime == "cyclosis"


@pytest.mark.parametrize(
    ("values", "regime"),
    [
        ({"kappa": 0.0}, "circumferential"),
        ({"kappa": 0.1}, "travelling"),
        ({"repulsion_angle": np.pi / 2}, None),
    ],
)
def test_other_regimes_are_certified_too(values, regime):
    outcomes = follow([member(seed, alpha_p=0.6, **values) for seed in (2, 3)])
    for outcome in outcomes:
        assert outcome.status == "certified"
        assert outcome.regime == (regime or "circumferential")


def test_a_member_that_diverges_is_a_result_and_the_others_go_on():
    wild = Member(cy.Parameters(epsilon=10.0), GRID, partial(cy.initial.disordered, GRID, 10, 0))
    calm = Member(cy.Parameters(alpha_p=0.025), GRID, partial(cy.initial.disordered, GRID))
    outcomes = follow([wild, calm], EnsembleSettings(t_end=60.0, lanes=3))
    assert [o.status for o in outcomes] == ["diverged", "certified"]
    assert outcomes[0].t_final < 60.0
    assert np.all(np.isfinite(outcomes[0].state))
    assert same(outcomes[1], follow([calm, calm], EnsembleSettings(t_end=60.0, lanes=3))[0])


@pytest.mark.slow
def test_a_coarse_grid_is_noticed():
    grid = cy.CylinderGrid(24, 20, 5.0)
    (outcome,) = follow([member(grid=grid)], EnsembleSettings(t_end=100.0))
    assert outcome.status == "underresolved"
    assert outcome.tail > 1e-2


@pytest.mark.slow
def test_members_may_differ_in_everything():
    other = cy.CylinderGrid(24, 20, 7.0)
    field = cy.Parameters(alpha_u=np.full(GRID.shape, 0.4), alpha_p=0.4)
    members = [
        member(alpha_p=0.4, alpha_u=0.4),
        member(grid=other, alpha_p=0.4),
        member(mu=0.1, alpha_p=0.4),
        member(d_s=0.05, alpha_p=0.4),
        Member(field, GRID, partial(cy.initial.disordered, GRID)),
        member(force_exponent=3.0, alpha_p=0.4),
    ]
    outcomes = follow(members, EnsembleSettings(t_end=80.0))
    assert all(o.status in OUTCOMES for o in outcomes)
    assert outcomes[1].state.shape == (2, 24, 20)
    # Couplings that vary over the surface allow no certificate, but the run is the same.
    assert outcomes[4].status == "completed"
    assert outcomes[4].regime == outcomes[0].regime == "cyclosis"


def test_time_of_order_is_when_the_regime_appears():
    one = member(2, alpha_p=0.4, alpha_u=0.4)
    (outcome,) = follow([one])
    run = cy.simulate(one.params, GRID, one.state(), outcome.t_final, 0.5)
    names = [cy.regime(one.params, GRID, frame).name for frame in run.frames]
    last = max(i for i, name in enumerate(names) if name != outcome.regime)
    # Looks are taken every few steps.
    assert run.times[last] - 0.5 <= outcome.t_order <= run.times[last] + CHECK_STEPS * 1.5


def test_bad_settings_and_states_are_refused_in_a_sentence():
    for values in (
        {"finish": "soon"},
        {"lanes": 0},
        {"t_end": -1.0},
        {"t_end": 0.0},
        {"precision": "float16"},
    ):
        with pytest.raises(cy.InputError):
            EnsembleSettings(**values)
    wrong = Member(cy.Parameters(), GRID, lambda: np.zeros((2, 8, 8)))
    with pytest.raises(cy.InputError, match="initial state"):
        follow([wrong])
    assert follow([]) == []


def test_a_member_that_fails_on_its_last_stretch_has_diverged():
    grid, state = cy.CylinderGrid(16, 16), np.zeros((2, 16, 16))
    state[1] = -((-1.0) ** np.arange(16))[:, None]
    state[1, 0] = 1.0  # without its Nyquist modes |P| is 1.875 there, and no step is taken
    settings = EnsembleSettings(t_end=0.05, finish="t_end")
    found = follow([Member(cy.Parameters(), grid, lambda: state)], settings)[0]
    assert (found.status, found.t_final) == ("diverged", 0.0)


def test_a_member_without_filaments_is_disordered():
    grid = cy.CylinderGrid(16, 16)
    found = follow(
        [Member(cy.Parameters(), grid, lambda: np.zeros((2, 16, 16)))], EnsembleSettings(t_end=2.0)
    )
    assert found[0].regime == "disordered"
