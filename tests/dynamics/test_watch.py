"""Runs on too coarse a grid name one that is enough, and it is."""

import re

import pytest

import cyclosis as cy
from cyclosis.analysis.resolution import enough
from cyclosis.dynamics.settings import Settings
from cyclosis.dynamics.watch import Watch


@pytest.mark.parametrize(("n", "status"), [(16, "diverged"), (32, "underresolved")])
@pytest.mark.slow
def test_what_a_newcomer_tries_first_names_a_grid(n, status):
    grid = cy.CylinderGrid(n, n)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.disordered(grid), 20.0)
    assert run.status == status
    named = re.search(r"use more grid points: (\d+) x (\d+) should do", run.message)
    assert named is not None, run.message
    finer = cy.CylinderGrid(*map(int, named.groups()))
    better = cy.simulate(cy.Parameters(), finer, cy.initial.disordered(finer), 30.0)
    assert better.status == "completed", better.message


@pytest.mark.parametrize(
    ("name", "value"), [("alpha_p", 0.3), ("d_s", 0.1), ("epsilon", 1.0), ("alpha_u", 1.0)]
)
@pytest.mark.slow
def test_the_grid_that_is_named_is_enough(name, value):
    params = cy.Parameters(**{name: value})
    grid = cy.CylinderGrid(*enough(params, cy.CylinderGrid(8, 8)))
    run = cy.simulate(params, grid, cy.initial.disordered(grid, seed=1), 60.0, 1.0)
    assert run.status == "completed", run.message


def test_a_finer_grid_is_named_than_the_one_that_failed():
    for n in (8, 48, 64, 100):
        finer = enough(cy.Parameters(), cy.CylinderGrid(n, n))
        assert finer != (n, n)
        assert min(finer) >= n
    long = enough(cy.Parameters(), cy.CylinderGrid(16, 16, 50.0))
    assert long[0] == 48
    assert long[1] > 350


@pytest.mark.parametrize("values", [{"d_s": 0.0}, {"alpha_p": 0.0, "alpha_u": 0.0}, {"d_s": 1e-9}])
def test_where_nothing_is_known_no_grid_is_named(values):
    assert enough(cy.Parameters(**values), cy.CylinderGrid(16, 16)) is None


def test_a_tail_beside_its_limit_is_printed_as_it_is():
    problem = cy.models.polar.problem(cy.Parameters(), cy.CylinderGrid(16, 16))
    watch = Watch(problem, cy.models.polar.system(problem, True), Settings())
    watch.look(1e3, {"spectral_tail": 0.0100004}, 0.9)
    assert watch.sign == "the spectral tail is 0.0100004 (limit 0.01)"
