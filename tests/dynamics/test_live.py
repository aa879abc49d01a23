"""A run integrated frame by frame equals bit for bit that of its protocol, whenever the steps were given."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dynamics.live import Live

GRID = cy.CylinderGrid(32, 24, 5.0)
PARAMS = cy.Parameters(d_s=0.05)
DISC = cy.regions.disc(theta=3.0, z=2.5, radius=1.0)


def begun(**changes):
    return Live(PARAMS.replace(**changes), GRID, cy.initial.disordered(GRID, seed=3), 0.25)


def forward(live, t):
    while live.t < t:
        live.forward()
        assert not live.failed


def do(live, *steps):
    live.do(cy.Protocol(*live.protocol, *steps, seed=live.protocol.seed))


SCRIPTS = {
    "nothing": {},
    "a slider": {1.0: [{"alpha_p": 0.3}], 1.25: [{"alpha_p": 0.2}], 2.0: [{"alpha_u": 0.0}]},
    "twice at one time": {1.0: [{"alpha_p": 0.3}, {"alpha_p": 0.7, "mu": 0.1}]},
    "at once": {0.0: [{"kappa": 0.1}]},
    "another force": {1.0: [{"force_exponent": 1.0}], 2.0: [{"force_exponent": 2.0}]},
    "a patch": {1.0: [cy.fragment(at=1.0, where=DISC)], 2.0: [cy.align(at=2.0, angle=1.0, where=DISC)]},
    "a stripped wall": {1.0: [cy.change(at=1.0, alpha_p=0.0, where=DISC)], 2.0: [cy.wash_out(at=2.0)]},
    "on a ramp": {
        1.0: [cy.change(at=1.0, over=1.1, alpha_p=0.1, mu=0.1, d_s=0.06)],
        1.5: [{"alpha_u": 0.1}, cy.fragment(at=1.5)],
        2.5: [cy.wash_out(at=2.5, over=0.2)],
    },
}


@pytest.mark.parametrize("script", SCRIPTS.values(), ids=SCRIPTS.keys())
def test_what_is_done_live_is_the_protocol_to_the_bit(script):
    live = begun()
    for t, steps in script.items():
        forward(live, t)
        for step in steps:
            do(live, cy.change(at=t, **step) if isinstance(step, dict) else step)
    forward(live, 4.0)
    run = cy.simulate(
        PARAMS,
        GRID,
        cy.initial.disordered(GRID, seed=3),
        4.0,
        0.25,
        protocol=live.protocol,
    )
    assert run.t_final == live.t == 4.0
    assert np.array_equal(run.final_state, live.state)
    assert live.params_now == run.params_at(4.0)
    assert float(live.record()["order"]) == run.records["order"][-1]


def test_a_state_just_acted_on_is_there_at_once():
    live = begun()
    forward(live, 1.0)
    before = live.state
    do(live, cy.depolymerise(at=1.0, where=DISC))
    mask = DISC.mask(GRID)
    assert np.all(live.state[:, mask] == 0)
    assert np.array_equal(live.state[:, ~mask], before[:, ~mask])


def test_the_past_stays_as_it_was():
    live = begun()
    forward(live, 1.0)
    state = live.state
    with pytest.raises(cy.InputError, match="the time reached"):
        do(live, cy.change(at=0.5, alpha_p=0.0))
    assert np.array_equal(live.state, state)
    assert len(live.protocol) == 0


def test_what_comes_later_changes_nothing_before():
    state = cy.initial.disordered(GRID, seed=3)
    steps = [cy.change(at=1.0, over=4.0, alpha_p=0.2), cy.fragment(at=2.0, where=DISC)]
    later = [
        cy.change(at=3.0, force_exponent=1.0, mu=0.2),
        cy.change(at=3.0, kappa=0.0, where=DISC),
        cy.wash_out(at=6.0, over=2.0),
    ]
    short = cy.simulate(PARAMS, GRID, state, 2.5, 0.5, protocol=steps)
    long = cy.simulate(PARAMS, GRID, state, 4.0, 0.5, protocol=[*steps, *later])
    assert all(np.array_equal(short.frames[k], long.frames[k]) for k in range(len(short.frames)))


def test_aligned_filaments_point_where_they_are_told():
    live = begun()
    do(live, cy.align(at=0.0, angle=np.pi / 2, magnitude=0.8, where=DISC))
    mask = DISC.mask(GRID)
    assert np.allclose(live.state[0, mask], 0, atol=1e-15)
    assert np.allclose(live.state[1, mask], 0.8)


@pytest.mark.parametrize("ramp", [{"alpha_p": 0.5, "mu": 1.0, "d_s": 0.06}, {"force_exponent": 0.0}])
def test_the_flow_on_a_ramp_is_that_of_the_parameters_in_force(ramp):
    live = begun()
    do(live, cy.change(at=0.0, over=2.0, **ramp))
    forward(live, 1.5)
    expected = cy.flow(live.params_now, GRID, live.state)
    np.testing.assert_allclose(live.flow(), expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_protocols_that_do_not_go_on_from_what_was_done_are_refused_for_what_is_wrong():
    live = begun()
    do(live, cy.change(at=0.0, kappa=0.1))
    forward(live, 0.5)
    with pytest.raises(cy.InputError, match="steps already done"):
        live.do(cy.Protocol())
    with pytest.raises(cy.InputError, match=r"at = 0\.25 cannot be used: it must be at least 0\.5"):
        do(live, cy.change(at=0.25, kappa=0.2))
    with pytest.raises(cy.InputError, match="save_every = -1"):
        Live(PARAMS, GRID, cy.initial.stripes(GRID), -1)


def test_a_copy_continues_apart_from_the_run():
    """As where the explorer compiles in advance what a cell will need."""
    live = begun()
    live.forward()
    before = live.t, live.state.copy(), live.frame
    other = live.copy()
    while not other.forward():
        pass
    other.do(cy.Protocol(cy.noise(at=other.t, size=0.1)))
    assert other.t > before[0]
    assert (live.t, live.frame) == (before[0], before[2])
    assert np.array_equal(live.state, before[1])
    assert not live.protocol
