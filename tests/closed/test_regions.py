"""Regions on closed cells: the same tables, with the arc length along the meridian in place of z."""

import json

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import regions
from cyclosis.model.region_tables import from_table

CAPSULE = cy.ClosedGrid(cy.Capsule(5.0, 0.4), k_max=8)
SPHERE = cy.ClosedGrid(cy.Sphere(), k_max=8, n_theta=240, n_s=240)
S = CAPSULE.surface.meridian_length


def area(region, grid=SPHERE):
    return float(np.sum(region.mask(grid) * grid.weights))


@pytest.mark.parametrize("s", [0.0, 0.4, 1.5, np.pi])
def test_a_disc_on_a_sphere_is_measured_through_space(s):
    """All points of a sphere within a chord c of one of them have the area π c², wherever it is.

    About a pole the points lie on rings, so that the edge is known to half their distance.
    """
    rel = (np.pi / SPHERE.n_s) / 0.7
    assert area(regions.disc(1.0, s, 0.7)) == pytest.approx(np.pi * 0.49, rel=rel)


def test_rings_of_a_sphere():
    """Between two latitudes the area is 2π times the difference in height."""
    assert area(regions.band("z", 1.0, 2.0)) == pytest.approx(
        2 * np.pi * (np.cos(1.0) - np.cos(2.0)), rel=0.02
    )
    assert area(regions.box(0.0, np.pi, 1.0, 2.0)) == pytest.approx(area(regions.band("z", 1.0, 2.0)) / 2)
    ends = regions.band("z", 2.5, 0.5).mask(SPHERE)
    assert np.array_equal(ends[0], (SPHERE.s >= 2.5) | (SPHERE.s < 0.5))


def test_regions_are_those_of_the_arc_length():
    theta, s = CAPSULE.theta[:, None], CAPSULE.s
    mask = regions.box(6.0, 1.0, 2.0, 4.0).mask(CAPSULE)
    assert np.array_equal(mask, ((theta >= 6.0) | (theta < 1.0)) & (s >= 2.0) & (s < 4.0))
    rings = regions.strips(2, 0.25, "z").mask(CAPSULE)
    assert np.array_equal(rings[0], (2 * s / S) % 1 < 0.25)
    centre = CAPSULE.position(0.5, 0.2)
    near = np.linalg.norm(CAPSULE.xyz - centre[:, None, None], axis=0) <= 1.0
    disc, band = regions.disc(0.5, 0.2, 1.0), regions.band("theta", 0.0, 3.0)
    assert np.array_equal(disc.mask(CAPSULE), near)
    assert near[CAPSULE.n_theta // 2].any()  # over the pole, on the other side
    both = (disc | ~band) & ~regions.band("z", 0.0, 0.3)
    own = (near | ~band.mask(CAPSULE)) & ~regions.band("z", 0.0, 0.3).mask(CAPSULE)
    assert np.array_equal(both.mask(CAPSULE), own)
    assert from_table(json.loads(json.dumps(both.as_table()))) == both


@pytest.mark.parametrize("surface", [cy.Sphere(), cy.Spheroid(0.5), cy.Spheroid(3.0), cy.Capsule(2.0)])
def test_positions(surface):
    grid = cy.ClosedGrid(surface, k_max=6)
    for i, j in ((0, 0), (3, 5), (7, -1)):
        np.testing.assert_allclose(grid.position(grid.theta[i], grid.s[j]), grid.xyz[:, i, j], atol=1e-13)
    ends = [grid.position(1.0, end) for end in (0.0, surface.meridian_length)]
    np.testing.assert_allclose(ends, [[0, 0, -surface.half_height], [0, 0, surface.half_height]], atol=1e-13)


@pytest.mark.parametrize(
    "region", [regions.disc(1.0, 8.1, 0.5), regions.band("z", 1.0, 9.0), ~regions.box(0.0, 1.0, 8.5, 1.0)]
)
def test_places_off_the_cell_are_refused(region):
    with pytest.raises(cy.InputError, match=r"on the cell, from 0 to the length of its meridian 8\.0122"):
        region.mask(CAPSULE)


def test_a_position_off_the_cell_is_refused():
    with pytest.raises(cy.InputError, match="from 0 to the length of the meridian 8"):
        CAPSULE.position(0.0, 8.2)


def test_a_region_without_points_is_refused():
    protocol = cy.Protocol(cy.fragment(at=1.0, where=regions.disc(0.03, 4.0, 0.001)))
    with pytest.raises(cy.InputError, match=f"{CAPSULE.n_theta} x {CAPSULE.n_s}"):
        cy.simulate(cy.Parameters(), CAPSULE, cy.closed.rotation(CAPSULE), t_end=2.0, protocol=protocol)
