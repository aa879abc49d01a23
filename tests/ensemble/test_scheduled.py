"""Members with a protocol: each as the single run that it is, whoever is beside it."""

from functools import partial

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.ensemble import EnsembleSettings, Member, follow

GRID = cy.CylinderGrid(32, 24, 5.0)
PATCH = cy.regions.disc(theta=3.1, z=2.5, radius=1.0)
PROTOCOL = cy.Protocol(
    cy.noise(at=10.0, size=0.1),
    cy.change(at=12.0, over=3.0, alpha_p=0.5, mu=0.1, d_s=0.06),
    cy.change(at=13.0, where=PATCH, kappa=0.0),
    cy.wash_out(at=20.0),
)
HOW = EnsembleSettings(t_end=30.0, finish="t_end")


def member(seed, protocol=PROTOCOL, **values):
    params = cy.Parameters(**({"d_s": 0.05} | values))
    return Member(params, GRID, partial(cy.initial.disordered, GRID, 1000, seed), protocol.with_seed(seed))


def same(a, b):
    numbers = ("t_final", "t_order", "tail", "evaluations")
    return (
        (a.regime, a.status, a.reason) == (b.regime, b.status, b.reason)
        and all(np.array_equal(getattr(a, n), getattr(b, n), equal_nan=True) for n in numbers)
        and np.array_equal(a.state, b.state)
    )


def test_a_member_is_the_single_run():
    """Bit by bit: both land on the same times, and nothing else decides their steps."""
    one = member(3)
    (outcome,) = follow([one], HOW)
    run = cy.simulate(one.params, GRID, one.state(), 30.0, 30.0, protocol=one.protocol)
    assert np.array_equal(outcome.state, run.final_state)
    assert outcome.evaluations == run.effort.evaluations
    assert outcome.status == run.status == "completed"
    assert outcome.t_final == 30.0
    assert outcome.regime == cy.regime(one.params, GRID, run.final_state).name
    assert 0 < outcome.t_order <= 30.0


@pytest.mark.slow
def test_an_outcome_does_not_depend_on_company_order_or_lanes():
    members = [member(seed, alpha_u=0.3 + 0.1 * seed) for seed in range(3)]
    plain = Member(members[0].params, GRID, members[0].state)
    together = follow([*members, plain], HOW)
    how = EnsembleSettings(t_end=30.0, finish="t_end", lanes=3)
    backward = follow([plain, *members[::-1]], how)[::-1]
    assert all(same(a, b) for a, b in zip(together[:3], backward[:3], strict=True))
    assert all(same(a, follow([one], HOW)[0]) for a, one in zip(together, members, strict=False))
    assert same(together[3], follow([plain], HOW)[0]), "a neighbour with a protocol changes nothing"


@pytest.mark.slow
def test_lanes_are_refilled_and_members_of_other_programs_wait_for_them():
    """Ramps, fields and jumps have programs of their own, and every member reaches them at its own time."""
    members = []
    for seed, (at, over, radius) in enumerate(((3.0, 0.0, 0.6), (5.5, 2.0, 1.0), (1.0, 4.0, 0.6))):
        where = cy.regions.disc(theta=3.1, z=2.5, radius=radius)
        drug = cy.change(at=at, over=over, alpha_u=0.2 + 0.1 * seed)
        for steps in (
            [drug, cy.fragment(at=7.0, where=where)],
            [drug, cy.change(8.0, kappa=0.0, where=where)],
        ):
            members.append(member(seed, cy.Protocol(*steps, cy.wash_out(at=9.0 + seed)), alpha_p=0.8))
    alone, shared = (
        follow(members, EnsembleSettings(t_end=12.0, finish="t_end", lanes=lanes)) for lanes in (1, 2)
    )
    assert all(same(a, b) for a, b in zip(alone, shared, strict=True))


@pytest.mark.slow
def test_a_member_that_fails_in_a_lane_leaves_it_to_the_next():
    grid = cy.CylinderGrid(8, 8, 5.0)
    wild, calm = (
        Member(
            cy.Parameters(epsilon=10.0),
            grid,
            partial(cy.initial.disordered, grid, 10, 0),
            cy.Protocol(cy.change(at=5.0, alpha_u=strength, mu=0.0)),
        )
        for strength in (1000.0, 0.5)
    )
    how = EnsembleSettings(t_end=20.0, finish="t_end", lanes=2)
    found = follow([wild, calm, wild], how)
    assert [one.status for one in found] == [follow([each], how)[0].status for each in (wild, calm, wild)]
    assert found[0].status in ("diverged", "underresolved")
    assert same(found[0], found[2])


def test_every_seed_has_its_own_noise():
    start = partial(cy.initial.stripes, GRID)
    members = [
        Member(cy.Parameters(d_s=0.05), GRID, start, cy.Protocol(cy.noise(at=1.0, size=0.1)).with_seed(seed))
        for seed in (1, 2, 1)
    ]
    first, second, again = follow(members, EnsembleSettings(t_end=2.0, finish="t_end"))
    assert same(first, again)
    assert not np.any(first.state == second.state)


def test_an_event_at_the_end_is_done_and_one_beyond_is_not():
    steps = cy.Protocol(cy.depolymerise(at=2.0), cy.depolymerise(at=9.0))
    (outcome,) = follow([member(0, steps)], EnsembleSettings(t_end=2.0, finish="t_end"))
    assert not outcome.state.any()
    assert outcome.regime == "disordered"
    assert np.isnan(outcome.t_order)


def test_a_member_that_diverges_says_so():
    grid = cy.CylinderGrid(8, 8, 5.0)
    wild = Member(
        cy.Parameters(epsilon=10.0),
        grid,
        partial(cy.initial.disordered, grid, 10, 0),
        cy.Protocol(cy.change(at=5.0, alpha_u=1000.0, mu=0.0)),
    )
    (outcome,) = follow([wild], EnsembleSettings(t_end=60.0, finish="t_end"))
    assert outcome.status in ("diverged", "underresolved")
    assert np.all(np.isfinite(outcome.state))


def test_nothing_is_certified_under_a_protocol():
    with pytest.raises(cy.InputError, match="t_end where there is a protocol"):
        follow([member(0)], EnsembleSettings(t_end=30.0))
