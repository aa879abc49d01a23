"""Parameters under a long protocol: the same in any order of times, and few of them in memory."""

import tracemalloc

import numpy as np

import cyclosis as cy
from cyclosis.dynamics.schedule import KEPT, Schedule

GRID = cy.CylinderGrid(32, 24, 5.0)
DISC = cy.regions.disc(theta=3.1, z=2.5, radius=1.0)


def many(steps):
    """Return a protocol of changes in a region and everywhere, ramps, and a wash-out halfway."""
    made = []
    for k in range(steps):
        at, value = 1.0 + k, 0.1 + 0.01 * k
        made.append(cy.change(at=at, alpha_u=value, where=DISC))
        made.append(cy.change(at=at, over=0.5 if k % 3 else 0.0, alpha_p=value))
        if k == steps // 2:
            made.append(cy.wash_out(at=at + 0.75, over=0.125))
    return cy.Protocol(*made)


def test_parameters_do_not_depend_on_the_order_in_which_times_are_asked_for():
    schedule = Schedule(cy.Parameters(), GRID, many(3 * KEPT))
    times = np.linspace(0.0, 3 * KEPT + 2.0, 101)
    expected = [Schedule(cy.Parameters(), GRID, many(3 * KEPT)).params_at(t) for t in times]
    for k in np.random.default_rng(1).permutation(len(times)):
        assert schedule.params_at(times[k]) == expected[k]
    assert len({hash(params) for params in expected}) > 3 * KEPT


def test_what_a_step_leaves_as_it_was_is_shared():
    steps = [cy.change(at=t, kappa=0.1 * t, where=DISC) for t in (1.0, 2.0)]
    schedule = Schedule(cy.Parameters(), GRID, cy.Protocol(*steps, cy.change(at=3.0, d_s=0.1)))
    assert schedule.params_at(3.0).kappa is schedule.params_at(2.0).kappa
    assert schedule.params_at(2.0).kappa is not schedule.params_at(1.0).kappa


def test_a_long_protocol_of_fields_takes_the_memory_of_a_few():
    grid = cy.CylinderGrid(128, 128, 5.0)
    steps = [cy.change(at=1.0 + k, alpha_p=0.01 * k, alpha_u=0.01 * k, where=DISC) for k in range(60)]
    tracemalloc.start()
    schedule = Schedule(cy.Parameters(), grid, cy.Protocol(*steps))
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    masks = sum(mask.nbytes for _, mask in schedule.steps)
    fields = 2 * np.zeros(grid.shape).nbytes
    assert held < masks + (KEPT + 2) * fields < masks + len(steps) * fields


def test_a_region_keeps_what_an_earlier_step_did_outside_it():
    left, both = cy.regions.band("z", 0.0, 2.0), cy.regions.band("z", 1.0, 3.0)
    steps = cy.change(at=1.0, kappa=0.1, where=left), cy.change(at=2.0, kappa=0.2, where=both)
    found = Schedule(cy.Parameters(kappa=0.5), GRID, cy.Protocol(*steps)).params_at(2.0).kappa
    expected = np.select([both.mask(GRID), left.mask(GRID)], [0.2, 0.1], 0.5)
    assert np.array_equal(found, expected)


def test_a_ramp_is_over_at_its_end():
    schedule = Schedule(cy.Parameters(), GRID, cy.Protocol(cy.change(at=1.0, over=2.0, d_s=0.1)))
    assert schedule.stage(2.9).moving == {"d_s": (1.0, 3.0)}
    assert schedule.stage(3.0).moving == {}
    assert schedule.params_at(3.0).d_s == 0.1
