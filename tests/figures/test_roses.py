"""Roses: their area is the concentration, they point along P, and they are of the points that they name."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures.roses import roses


@pytest.fixture(scope="module")
def data():
    grid = cy.CylinderGrid(16, 1)
    state = cy.kinetic.dressed(cy.initial.stripes(grid, magnitude=0.6), modes=12)
    return cy.simulate(
        cy.Parameters(d_r=0.1), grid, state, t_end=2.0, save_every=1.0, model=cy.models.kinetic
    ).to_dataset()


def outlines(ax):
    return [patch.get_xy() for patch in ax.patches if hasattr(patch, "get_xy")]


def area(outline):
    x, y = outline.T
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_equal_numbers_of_filaments_have_equal_areas(data):
    figure = roses(data, times=[0.0, 2.0])
    areas = [area(outline) for ax in figure.axes for outline in outlines(ax)]
    assert len(areas) == 8 + 8 + 9
    assert np.ptp(areas) < 1e-3 * np.mean(areas)


def test_a_rose_points_along_P_at_its_place(data):
    figure = roses(data, times=[0.0])
    ax = figure.axes[0]
    P = data["P"].isel(time=0, z=0).values
    for place, outline in enumerate(outlines(ax)):
        middle = outline.mean(axis=0) - (place, 0.0)
        p = P[:, 2 * place]  # eight of 16 points
        if np.hypot(*p) > 0.2:
            assert middle @ p / np.hypot(*middle) / np.hypot(*p) > 0.999


def test_the_last_row_runs_across_a_zone(data):
    figure = roses(data, times=[2.0])
    lines = [line.get_xydata() for line in figure.axes[-1].lines]
    along = [line[1, 1] for line in lines]
    assert len(outlines(figure.axes[-1])) == 9
    assert along[0] * along[-1] < 0  # P_z on the two sides


def test_a_run_without_moments_is_refused():
    grid = cy.CylinderGrid(16, 16)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), 1.0)
    with pytest.raises(cy.InputError, match="run with --model kinetic"):
        roses(run.to_dataset())


def test_times_that_are_not_there_are_refused(data):
    with pytest.raises(cy.InputError, match="within the dataset"):
        roses(data, times=[5.0])
