"""Regions mean the same on every grid, go round both ways, and say what is wrong with them."""

import itertools
import json
from functools import reduce

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import cyclosis as cy
from cyclosis import regions
from cyclosis.model.region_tables import from_table
from cyclosis.model.regions import LARGEST_TEXT, Region

GRID = cy.CylinderGrid(32, 24, 5.0)
CASES = {
    "box": regions.box(1.0, 2.0, 1.0, 3.0),
    "round box": regions.box(6.0, 1.0, 4.5, 0.5),
    "disc": regions.disc(theta=3.1, z=2.5, radius=0.7),
    "disc at a corner": regions.disc(theta=0.0, z=0.0, radius=0.7),
    "band": regions.band("z", 1.0, 2.0),
    "band round": regions.band("theta", -0.5, 0.5),
    "strips": regions.strips(4),
    "rings": regions.strips(3, 0.25, "z", 0.1),
    "complement": ~regions.disc(3.0, 2.0, 1.0),
    "union": regions.band("z", 0.0, 1.0) | regions.strips(2),
    "intersection": regions.band("z", 0.0, 1.0) & ~regions.strips(2),
}


def picture(path, light, mode="L"):
    Image.fromarray(np.where(light, 255, 0).astype(np.uint8)).convert(mode).save(path)
    return str(path)


@pytest.mark.parametrize("region", CASES.values(), ids=CASES)
def test_a_mask_is_of_the_grid_and_the_same_on_a_finer_one(region):
    """Points that two grids share are in the region on both or on neither."""
    mask, fine = region.mask(GRID), region.mask(GRID.resized(96, 72))
    assert mask.shape == GRID.shape
    assert mask.dtype == bool
    assert 0 < mask.sum() < mask.size
    assert np.array_equal(mask, fine[::3, ::3])


@pytest.mark.parametrize("region", CASES.values(), ids=CASES)
def test_a_table_makes_the_region_again(region):
    table = json.loads(json.dumps(region.as_table()))
    assert from_table(table) == region
    assert str(region)


@pytest.mark.parametrize("region", CASES.values(), ids=CASES)
def test_complement_union_and_intersection(region):
    mask, other = region.mask(GRID), regions.disc(3.0, 2.0, 1.5)
    assert np.array_equal((~region).mask(GRID), ~mask)
    assert ~~region == region
    assert np.array_equal((region | other).mask(GRID), mask | other.mask(GRID))
    assert np.array_equal((region & other).mask(GRID), mask & other.mask(GRID))


def test_areas():
    """The share of a fine grid's points in a region is its share of the surface."""
    fine, whole = cy.CylinderGrid(500, 400, 5.0), 2 * np.pi * 5.0
    for region, area in (
        (regions.box(1.0, 2.0, 1.0, 3.0), 2.0),
        (regions.box(6.0, 1.0, 4.5, 0.5), (2 * np.pi - 5.0) * 1.0),
        (regions.disc(0.1, 4.9, 0.8), np.pi * 0.64),
        (regions.band("theta", -0.5, 0.5), 5.0),
        (regions.strips(7, 0.3), 0.3 * whole),
        (regions.strips(3, 0.25, "z", 0.1), 0.25 * whole),
    ):
        assert region.mask(fine).mean() * whole == pytest.approx(area, rel=0.02), str(region)


@given(start=st.floats(0, 6.28), width=st.floats(0.01, 6.2), z=st.floats(0, 5), radius=st.floats(0.1, 3))
@settings(max_examples=50, deadline=None)
def test_bands_that_meet_cover_all_once_and_discs_are_the_same_all_around(start, width, z, radius):
    first = regions.band("theta", start, (start + width) % (2 * np.pi))
    assert np.array_equal(first.mask(GRID), first.inside(GRID.theta[:, None] + 2 * np.pi, GRID.z, 5.0))
    count = regions.disc(0.0, z, radius).mask(GRID).sum()
    assert regions.disc(float(GRID.theta[5]), z, radius).mask(GRID).sum() == count


def test_quarters_tile_the_surface():
    ends = np.linspace(0, 2 * np.pi, 5)
    quarters = [regions.band("theta", float(a), float(b % (2 * np.pi))) for a, b in itertools.pairwise(ends)]
    assert np.array_equal(sum(region.mask(GRID).astype(int) for region in quarters), np.ones(GRID.shape, int))
    assert reduce(Region.__or__, quarters).mask(GRID).all()


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "1", "P"])
def test_an_image_lies_on_the_unwrapped_surface_theta_to_the_right_and_z_up(tmp_path, mode):
    light = np.zeros((24, 32), bool)
    light[:6, 8:16] = True  # high up, and left of the middle
    region = regions.image(picture(tmp_path / "mask.png", light, mode))
    mask = region.mask(GRID)
    assert np.array_equal(mask, light[::-1].T)
    assert np.array_equal(mask, (regions.box(np.pi / 2, np.pi, 3.75, 5.0)).mask(GRID))
    assert np.array_equal(region.mask(GRID.resized(96, 72))[::3, ::3], mask)
    (tmp_path / "mask.png").unlink()
    again = from_table(json.loads(json.dumps(region.as_table())))
    assert again == region, "the region holds the pixels"
    assert "path" not in region.as_table()


def test_transparent_and_sixteen_bit_images(tmp_path):
    pixels = np.full((8, 8, 2), 255, np.uint8)
    pixels[:4, :, 1] = 0
    Image.fromarray(pixels, "LA").save(tmp_path / "alpha.png")
    assert regions.image(str(tmp_path / "alpha.png")).mask(GRID).mean() == 0.5
    deep = np.zeros((8, 8), np.uint16)
    deep[:, :2] = 60000
    Image.fromarray(deep).save(tmp_path / "deep.png")
    assert regions.image(str(tmp_path / "deep.png")).mask(GRID).mean() == 0.25


BAD = {
    "no table": (3, "a table with a shape"),
    "no shape": ({}, "one of box, disc"),
    "unknown shape": ({"shape": "square"}, "one of box, disc"),
    "unknown key": ({"shape": "disc", "radios": 1.0}, "did you mean radius"),
    "missing": ({"shape": "disc", "theta": 1.0, "z": 1.0}, "add radius"),
    "number": ({"shape": "disc", "theta": "x", "z": 1.0, "radius": 1.0}, "one number"),
    "no width": ({"shape": "band", "start": 1.0, "stop": 1.0}, "different from the first end"),
    "no angle": ({"shape": "band", "start": 1.0, "stop": 7.0}, "an angle"),
    "axis": ({"shape": "band", "axis": "x", "start": 1.0, "stop": 2.0}, "theta, z"),
    "share": ({"shape": "strips", "count": 3, "share": 2.0}, "from 1e-06 to 1"),
    "invert": ({"shape": "strips", "count": 3, "invert": "yes"}, "true or false"),
    "no parts": ({"shape": "union", "parts": []}, "a list of regions"),
    "no file": ({"shape": "image", "path": "nowhere.png"}, "check the file"),
    "pixels": ({"shape": "image", "width": 8, "height": 8, "pixels": "####"}, "packed pixels"),
    "few pixels": ({"shape": "image", "width": 8, "height": 8, "pixels": "eJwDAAAAAAE="}, "packed pixels"),
    "sides": ({"shape": "image", "width": "a", "height": None, "pixels": ""}, "packed pixels"),
    "no sides": ({"shape": "image", "pixels": "eJwDAAAAAAE="}, "packed pixels"),
}


@pytest.mark.parametrize(("table", "words"), BAD.values(), ids=BAD)
def test_mistakes_get_one_sentence(table, words):
    with pytest.raises(cy.InputError, match=words):
        from_table(table)


def test_regions_must_lie_on_the_cell():
    for region in (
        regions.disc(1.0, 5.1, 1.0),
        regions.box(0.0, 1.0, 4.0, 6.0),
        regions.band("z", 4.0, 6.0),
        regions.band("z", -1.0, 2.0),
        ~regions.band("z", 4.0, 6.0),
        regions.strips(2) | regions.disc(1.0, 5.1, 1.0),
    ):
        with pytest.raises(cy.InputError, match="on the cell, from 0 to its length 5"):
            region.mask(GRID)


def test_deep_nesting_is_refused():
    table = {"shape": "strips", "count": 2}
    for _ in range(20):
        table = {"shape": "union", "parts": [table]}
    with pytest.raises(cy.InputError, match="nested at most"):
        from_table(table)


def test_files_that_are_no_image_or_too_intricate(tmp_path):
    (tmp_path / "text.png").write_text("no image")
    noise = np.random.default_rng(0).random((1024, 1024)) < 0.5
    cut = (tmp_path / "cut.png").write_bytes  # a truncated image
    whole = picture(tmp_path / "noise.png", noise)
    cut((tmp_path / "noise.png").read_bytes()[:5000])
    for path, words in (
        (tmp_path / "text.png", "check the file"),
        (tmp_path, "check the file"),
        (tmp_path / "cut.png", "check the file"),
        (whole, f"at most {LARGEST_TEXT} characters"),
        (picture(tmp_path / "wide.png", np.ones((2, 5000), bool)), "make it smaller"),
    ):
        with pytest.raises(cy.InputError, match=words):
            regions.image(str(path))
