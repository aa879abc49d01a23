import numpy as np
import pytest
from scipy.spatial import cKDTree

import cyclosis as cy
from cyclosis.figures.streamlines import streamlines

GRID = cy.CylinderGrid(24, 24, 5.0)
THETA, Z = np.meshgrid(GRID.theta, GRID.z, indexing="ij")
PERIOD = np.array([2 * np.pi, GRID.length])
CELLS = np.stack([np.sin(2 * np.pi * Z / 5) * 2 * np.pi / 5, -np.sin(THETA)])


def test_lines_follow_a_uniform_flow_downstream():
    lines = streamlines(GRID, np.stack([0.6 + 0 * THETA, -0.8 + 0 * Z]))
    assert len(lines) > 20
    for line in lines:
        assert np.diff(line.theta) == pytest.approx(0.6 * line.arc_length / (line.theta.size - 1))
        assert np.diff(line.z) == pytest.approx(-0.8 * line.arc_length / (line.theta.size - 1))
        assert line.speed == pytest.approx(1.0)
        assert line.arc_length <= 1.25


def test_lines_close_around_a_vortex():
    """The stream function cos(theta) + cos(2πz/l), constant along every line, has a vortex at (0, 0)."""
    lines = streamlines(GRID, CELLS, separation=0.2, length=6.0)
    assert max(line.arc_length for line in lines) > 4
    for line in lines:
        along = np.cos(line.theta) + np.cos(2 * np.pi * line.z / 5)
        assert np.ptp(along) < 2e-3


@pytest.mark.parametrize("separation", [0.15, 0.3])
def test_lines_keep_their_distance_and_fill_the_surface(separation):
    lines = streamlines(GRID, CELLS, separation=separation)
    points = [np.mod(np.stack([line.theta, line.z], axis=1), PERIOD) for line in lines]
    trees = [cKDTree(p, boxsize=PERIOD) for p in points]
    nearest = [min(a.query(p)[0].min() for j, p in enumerate(points) if j != i) for i, a in enumerate(trees)]
    assert min(nearest) >= separation
    everywhere = cKDTree(np.concatenate(points), boxsize=PERIOD)
    gaps = everywhere.query(np.stack([THETA.ravel(), Z.ravel()], axis=1))[0]
    assert np.quantile(gaps, 0.9) < 2 * separation


def test_lines_cross_the_periodic_edges():
    for u in (np.stack([1 + 0 * THETA, 0 * Z]), np.stack([0 * THETA, 1 + 0 * Z])):
        lines = streamlines(GRID, u)
        low = min(min(line.theta.min(), line.z.min()) for line in lines)
        high = max(max((line.theta / PERIOD[0]).max(), (line.z / PERIOD[1]).max()) for line in lines)
        assert low < -0.1
        assert high > 1.02
        assert min(line.arc_length for line in lines) > 0.3


def test_lines_keep_out_of_slow_places_and_are_the_same_again():
    u = np.stack([0 * THETA, np.sin(THETA)])
    lines = streamlines(GRID, u, slowest=0.5)
    assert lines
    assert all(np.abs(np.sin(line.theta)).min() > 0.49 for line in lines)
    again = streamlines(GRID, u, slowest=0.5)
    assert all(np.array_equal(a.z, b.z) for a, b in zip(lines, again, strict=True))
    assert streamlines(GRID, 0 * u) == []


def test_bad_input_is_refused():
    with pytest.raises(cy.InputError, match="the flow"):
        streamlines(GRID, np.zeros((2, 8, 8)))
    with pytest.raises(cy.InputError, match="separation"):
        streamlines(GRID, CELLS, separation=0)
