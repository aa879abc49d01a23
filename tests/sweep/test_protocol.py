"""Sweeps whose members have a protocol."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.ensemble import follow
from cyclosis.sweep.store.block import compute

STEPS = [
    {
        "at": 6.0,
        "action": "noise",
        "size": 0.2,
        "where": {"shape": "band", "axis": "z", "start": 1.0, "stop": 3.0},
    },
    {"at": 8.0, "action": "change", "alpha_p": 0.25},
]
TABLES = {
    "parameters": {"d_s": 0.05},
    "grid": {"n_theta": 24, "n_z": 24},
    "axes": {"alpha_u": {"values": [0.3, 0.6]}},
    "ensemble": {"seeds": 3, "first_seed": 5},
    "run": {"t_end": 10.0},
    "record": {"fields": True, "quantities": ["budget"]},
    "protocol": STEPS,
}


def changed(**tables):
    return {name: table for name, table in (TABLES | tables).items() if table is not None}


def fields(sweep):
    blocks = [compute(sweep, index) for index in range(sweep.blocks)]
    return np.concatenate([block["P"] for block in blocks])


@pytest.fixture(scope="module")
def stored():
    return fields(cy.Sweep.from_tables(TABLES))


def test_a_sweep_with_a_protocol_finishes_by_time():
    sweep = cy.Sweep.from_tables(TABLES)
    assert sweep.tables["run"]["finish"] == "t_end"
    assert cy.Sweep.from_tables(sweep.tables) == sweep, "completing again changes nothing"
    assert [str(step) for step in sweep.protocol] == [
        "t = 6: add noise of size 0.2, in band (axis = z, start = 1, stop = 3)",
        "t = 8: alpha_p = 0.25",
    ]
    assert cy.Sweep.from_tables(changed(protocol=None)).tables["run"]["finish"] == "certified"


def test_the_protocol_decides_the_digest():
    sweep = cy.Sweep.from_tables(TABLES)
    spelled = [dict(reversed(STEPS[0].items())) | {"seed": 1}, STEPS[1] | {"over": 0.0}]
    assert cy.Sweep.from_tables(changed(protocol=spelled)) == sweep
    for steps in (STEPS[:1], [STEPS[0], STEPS[1] | {"alpha_p": 0.5}], [STEPS[0] | {"seed": 2}, STEPS[1]]):
        assert cy.Sweep.from_tables(changed(protocol=steps)) != sweep


def test_a_member_is_the_run_of_the_same_seed(stored):
    sweep = cy.Sweep.from_tables(TABLES)
    point, seed = sweep.member(4)
    assert (point, seed) == ({"alpha_u": 0.6}, 6)
    grid = cy.CylinderGrid(24, 24, 5.0)
    run = cy.simulate(
        cy.Parameters(d_s=0.05, alpha_u=0.6),
        grid,
        cy.initial.disordered(grid, seed=seed),
        10.0,
        10.0,
        protocol=cy.Protocol.from_tables(STEPS, seed=seed),
    )
    assert np.array_equal(stored[4], run.final_state)


@pytest.mark.parametrize(("block", "lanes"), [(1, None), (4, 3), (6, 2)])
@pytest.mark.slow
def test_results_do_not_depend_on_blocks_and_lanes(stored, block, lanes):
    tables = changed(ensemble=TABLES["ensemble"] | {"block": block}, run={"t_end": 10.0, "lanes": lanes})
    assert np.array_equal(fields(cy.Sweep.from_tables(tables)), stored)


@pytest.mark.slow
def test_results_do_not_depend_on_workers(stored, tmp_path):
    sweep = cy.Sweep.from_tables(changed(ensemble=TABLES["ensemble"] | {"block": 2}))
    summary = cy.run_sweep(sweep, tmp_path / "store", workers=1)
    assert summary.status == "complete"
    data = cy.open_sweep(tmp_path / "store")
    assert np.array_equal(data["P"].values.reshape(stored.shape), stored)
    steps = [STEPS[0], STEPS[1] | {"alpha_p": 0.5}]
    other = cy.Sweep.from_tables(changed(ensemble=TABLES["ensemble"] | {"block": 2}, protocol=steps))
    with pytest.raises(cy.InputError, match=r"protocol.2 is \{.*0.25.*\} there and \{.*0.5.*\} here"):
        cy.run_sweep(other, tmp_path / "store", workers=1)


def test_quantities_are_of_the_parameters_in_force_at_the_end():
    sweep = cy.Sweep.from_tables(TABLES)
    block = compute(sweep, 0)
    (outcome,) = follow([sweep.build(0)], sweep.settings)
    grid = cy.CylinderGrid(24, 24, 5.0)
    budget = cy.diagnose(cy.Parameters(d_s=0.05, alpha_u=0.3, alpha_p=0.25), grid, outcome.state)["budget"]
    assert block["budget"][0] == pytest.approx(list(budget.values()), rel=1e-12)


def test_noise_of_the_protocol_is_reason_enough_for_seeds():
    tables = changed(initial={"kind": "stripes"})
    found = fields(cy.Sweep.from_tables(tables))
    assert not np.any(found[0] == found[1])
    with pytest.raises(cy.InputError, match="noise to the protocol"):
        cy.Sweep.from_tables(changed(initial={"kind": "stripes"}, protocol=STEPS[1:]))


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"run": {"t_end": 10.0, "finish": "certified"}}, "t_end where there is a protocol"),
        ({"run": {"t_end": 7.0}}, "at of change = 8.0 .* at most t_end = 7 in a sweep"),
        ({"protocol": [{"at": 1.0}]}, "action in step 1 of the protocol"),
        ({"protocol": {"at": 1.0}}, r"write \[\[protocol\]\]"),
        (
            {"axes": {"length": {"values": [2.0, 5.0]}}, "grid": {"n_theta": 24, "n_z": 24}},
            "on the cell, from 0 to its length 2",
        ),
    ],
)
def test_mistakes_get_one_sentence(tables, words):
    with pytest.raises(cy.InputError, match=words):
        cy.Sweep.from_tables(changed(**tables))
