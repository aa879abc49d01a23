"""Pictures of the flow in the vacuole show the numbers of the flow."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures.vacuole_cutaway import LONG, STEPS, spread_streamlines, vacuole_cutaway, velocity_in
from cyclosis.figures.vacuole_pitch import vacuole_pitch
from cyclosis.figures.vacuole_section import vacuole_section

GRID = cy.CylinderGrid(32, 32, 5.0)


@pytest.fixture(scope="module")
def helix():
    return cy.vacuole.flow(GRID, cy.vacuole.helical_bands(GRID, np.sin, 5.0))


def test_the_profile_is_the_flow_along_the_diameter(helix):
    figure = vacuole_section(helix, z=1.0, angle=0.8)
    _, curve = figure.axes[-1].get_lines()[-2:]
    x, drawn = curve.get_xdata(), curve.get_ydata()
    points = [[abs(r), 0.8 + (np.pi if r < 0 else 0.0), 1.0] for r in x]
    np.testing.assert_allclose(drawn, helix.at(points)[:, 2], rtol=0, atol=1e-14)
    assert len(figure.axes[0].collections) >= 3  # section, wall, zones


def test_straight_streaming_has_no_arrows():
    u = cy.vacuole.helical_bands(GRID, np.sin, np.inf)
    straight, winding = (vacuole_section(cy.vacuole.flow(GRID, wall)) for wall in (u, u[::-1]))
    titles = [figure.axes[0].get_title(loc="right") for figure in (straight, winding)]
    assert titles[0] == ""
    assert titles[1].startswith("arrows")


def test_streamlines_follow_the_flow_and_keep_its_stream_function(helix):
    paths, speed = spread_streamlines(helix, 12)
    assert paths.shape == (12, STEPS + 1, 3)
    lengths = np.linalg.norm(np.diff(paths, axis=1), axis=2).sum(axis=1)
    assert lengths.max() <= LONG * (1 + 1e-12)
    assert np.median(lengths) > 0.99 * LONG  # less where a line turns sharply, near a place without flow
    x, y, z = paths.reshape(-1, 3).T
    points = np.stack([np.minimum(np.hypot(x, y), 1.0), np.arctan2(y, x), z], axis=1)
    psi = cy.vacuole.stream_function(helix).at(points).reshape(paths.shape[:2])
    assert np.ptp(psi, axis=1).max() < 0.02 * np.abs(psi).max()
    exact = np.linalg.norm(helix.at(points), axis=1).reshape(speed.shape)
    np.testing.assert_allclose(speed, exact, rtol=0, atol=2e-3)


def test_the_velocity_to_draw_is_close_to_the_flow(helix):
    points = np.random.default_rng(0).uniform([0, 0, 0], [1, 6, 5], (50, 3))
    r, theta, z = points.T
    found = velocity_in(helix)(np.stack([r * np.cos(theta), r * np.sin(theta), z]))
    np.testing.assert_allclose(found.T, helix.cartesian_at(points), rtol=0, atol=2e-3)


def test_the_cut_cell_shows_the_far_wall(helix):
    P = np.zeros((2, *GRID.shape))
    P[1] = np.where(np.cos(GRID.theta) > 0, 0.8, -0.8)[:, None]
    middle = []
    for view in (0.0, np.pi):
        image = vacuole_cutaway(helix, P, view_angle=view, lines=0).axes[0].images[0].get_array()
        middle.append(image[image.shape[0] // 2, image.shape[1] // 2])
    green, purple = middle  # the meridian opposite to the viewer
    assert green[1] > green[2]
    assert purple[2] > purple[1]


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("flow = ", lambda flow: vacuole_cutaway("flow", np.zeros((2, 32, 32)))),
        ("P = ", lambda flow: vacuole_cutaway(flow, np.zeros((2, 8, 8)))),
        ("lines = ", lambda flow: vacuole_cutaway(flow, np.zeros((2, 32, 32)), lines=-1)),
        ("pitches = ", lambda flow: vacuole_pitch((1.0, 2.0))),
        ("z = ", lambda flow: vacuole_section(flow, z=np.nan)),
    ],
)
def test_what_cannot_be_drawn_is_refused(helix, message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong(helix)
    assert message in str(caught.value)
