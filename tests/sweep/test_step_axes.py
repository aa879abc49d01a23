"""Axes over the steps of a protocol: doses, times and wounds."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.sweep.plan.variables import along_axes
from cyclosis.sweep.store.block import compute

DISC = {"shape": "disc", "theta": 3.1, "z": 2.5}
STEPS = [
    {"name": "drug", "action": "change", "alpha_p": 0.2},
    {"name": "wound", "at": 2.0, "action": "fragment", "where": DISC},
    {"name": "wound", "at": 2.0, "action": "change", "kappa": 0.0, "where": DISC},
]
AXES = {
    "protocol.drug.at": {"values": [1.0, 3.0]},
    "protocol.wound.where.radius": {"start": 0.5, "stop": 1.5, "count": 2},
}
TABLES = {
    "parameters": {"d_s": 0.05},
    "grid": {"n_theta": 24, "n_z": 24},
    "axes": AXES,
    "ensemble": {"seeds": 2, "first_seed": 5},
    "run": {"t_end": 4.0},
    "record": {"fields": True},
    "protocol": STEPS,
}


def changed(**tables):
    return TABLES | tables


def by_hand(at, radius, seed):
    """The protocol of a member, written out as a user would."""
    where = cy.regions.disc(3.1, 2.5, radius)
    return cy.Protocol(
        cy.change(at=at, alpha_p=0.2),
        cy.fragment(at=2.0, where=where),
        cy.change(at=2.0, kappa=0.0, where=where),
        seed=seed,
    )


def nameless(protocol):
    return [{key: value for key, value in step.items() if key != "name"} for step in protocol.as_tables()]


def test_every_member_has_the_protocol_of_its_point():
    sweep = cy.Sweep.from_tables(TABLES)
    assert sweep.shape == (2, 2, 2)
    for number in range(sweep.members):
        point, seed = sweep.member(number)
        expected = by_hand(*point.values(), seed)
        own = sweep.build(number).protocol
        assert nameless(own) == nameless(expected)
        assert own.seed == seed
    assert "at" not in sweep.tables["protocol"][0]
    assert cy.Sweep.from_tables(sweep.tables) == sweep, "completing again changes nothing"
    assert cy.Sweep.from_tables(changed(protocol=[STEPS[0] | {"alpha_p": 0.3}, *STEPS[1:]])) != sweep


@pytest.mark.slow
@pytest.mark.parametrize("lanes", [1, 3])
def test_a_member_is_the_single_run_with_this_protocol(lanes):
    """Bit for bit, in lanes as alone; members in a batch have events at different times."""
    sweep = cy.Sweep.from_tables(changed(run={"t_end": 4.0, "lanes": lanes}))
    states = np.concatenate([compute(sweep, index)["P"] for index in range(sweep.blocks)])
    grid, params = cy.CylinderGrid(24, 24, 5.0), cy.Parameters(d_s=0.05)
    for number in (0, 3, 6):
        point, seed = sweep.member(number)
        start = cy.initial.disordered(grid, seed=seed)
        run = cy.simulate(params, grid, start, 4.0, 4.0, protocol=by_hand(*point.values(), seed))
        assert np.array_equal(states[number], run.final_state)


def test_random_numbers_follow_the_order_in_time_as_in_a_single_run():
    steps = [{"action": "noise", "size": 0.1}, {"at": 2.0, "action": "noise", "size": 0.1}]
    axis = {"protocol.1.at": {"values": [1.0, 3.0]}}
    sweep = cy.Sweep.from_tables(changed(axes=axis, protocol=steps))
    seeds = [[step.seed for step in sweep.build(number).protocol] for number in (0, 2)]
    assert seeds == [[1, 2], [1, 2]], "the first in time is the first to draw"


def test_axes_may_be_doses_durations_and_settings_of_actions():
    steps = [
        {"at": 1.0, "action": "change"},
        {"at": 2.0, "action": "depolymerise", "where": {"shape": "strips", "count": 4}},
        {"at": 3.0, "action": "wash_out"},
    ]
    axes = {
        "protocol.1.alpha_u": {"values": [0.0, 0.4]},
        "protocol.2.keep": {"values": [0.1, 0.9]},
        "protocol.2.where.share": {"values": [0.25, 0.75]},
        "protocol.3.over": {"values": [0.0, 0.5]},
    }
    sweep = cy.Sweep.from_tables(changed(axes=axes, protocol=steps, ensemble={"seeds": 1}))
    assert [str(step) for step in sweep.build(sweep.members - 1).protocol] == [
        "t = 1: alpha_u = 0.4",
        "t = 2: depolymerise to 0.9 of P, in strips (count = 4, share = 0.75, axis = theta, offset = 0)",
        "t = 3 to 3.5: wash out",
    ]
    placed = along_axes(sweep)["protocol.1.alpha_u"]
    assert placed.attributes["symbol"] == "α_u"
    assert placed.attributes["long_name"].endswith("in step 1 of the protocol")


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"axes": {"protocol.4.at": {"values": [1.0]}}}, "of a step of the protocol: 1, 2, 3, drug, wound"),
        ({"axes": {"protocol.0.at": {"values": [1.0]}}}, "of a step of the protocol"),
        ({"axes": {"protocol.drug": {"values": [1.0]}}}, "protocol.STEP.KEY"),
        ({"axes": {"protocol.wound.where.z.z": {"values": [1.0]}}}, "protocol.STEP.KEY"),
        ({"axes": {"protocol.drug.size": {"values": [1.0]}}}, "a key with a number, one of alpha_p"),
        ({"axes": {"protocol.drug.name": {"values": [1.0]}}}, "a key with a number"),
        ({"axes": {"protocol.wound.where.start": {"values": [1.0]}}}, "where.radius"),
        ({"axes": AXES | {"protocol.drug.alpha_p": {"values": [1.0]}}}, "either in .*protocol"),
        ({"axes": AXES | {"protocol.drug.at": {"values": [1.0, 9.0]}}}, "at most t_end = 4"),
        ({"axes": AXES | {"protocol.wound.where.radius": {"values": [-1.0]}}}, "radius"),
        ({"axes": {"alpha_u": {"values": [0.5]}}}, "at in step 1 of the protocol"),
        ({"axes": {"protocol.1.at": {"values": [1.0]}}, "protocol": []}, "left out without a protocol"),
        ({"axes": {"protocol.1.at": {"values": [1.0]}}, "protocol": 3}, r"write \[\[protocol\]\]"),
        ({"protocol": [STEPS[0] | {"name": "2"}, *STEPS[1:]]}, "drug|name"),
        (
            {
                "protocol": [
                    {"at": 1.0, "over": 2.0, "action": "change", "mu": 0.1},
                    {"action": "change", "mu": 0.2},
                ],
                "axes": {"protocol.2.at": {"values": [0.5, 2.0, 3.5]}},
            },
            "at protocol.2.at = 2.*the end of the ramp of mu",
        ),
    ],
)
def test_mistakes_get_one_sentence(tables, words):
    with pytest.raises(cy.InputError, match=words):
        cy.Sweep.from_tables(changed(**tables))
