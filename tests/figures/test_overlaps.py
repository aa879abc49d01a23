"""No text of a figure lies on another or is cut off, at any width, dimensionless and in units."""

import matplotlib.figure
import pytest

import cyclosis as cy
from cyclosis.dataset import with_scales
from cyclosis.figures.compare import compare
from cyclosis.figures.emergence import emergence
from cyclosis.figures.history import history
from cyclosis.figures.snapshot import VIEWS, snapshot
from measure.overlaps import overlaps

COLUMNS = (89.0, 120.0, 183.0)
SCALES = {
    "dimensionless": None,
    "a cell of Chara": cy.Scales(500.0, 75.0),
    "a small cell": cy.Scales(5.0, 0.3),
}


@pytest.fixture(scope="module")
def run():
    grid = cy.CylinderGrid(16, 16)
    state = cy.initial.stripes(grid, magnitude=0.5)
    return cy.simulate(cy.Parameters(), grid, state, t_end=40.0, save_every=4.0).to_dataset()


@pytest.fixture(params=SCALES)
def data(run, request):
    scales = SCALES[request.param]
    return run if scales is None else with_scales(run, scales)


@pytest.mark.parametrize("width", [80.0, 89.0, 119.0, 120.0, 149.0, 150.0, 183.0])
def test_histories(data, width):
    assert overlaps(history(data, width)) == []


@pytest.mark.parametrize("width", [40.0, 60.0, *COLUMNS])
@pytest.mark.parametrize("view", VIEWS)
def test_moments(data, view, width):
    if view == "both" and width < 60.0:
        with pytest.raises(cy.InputError, match="another view"):
            snapshot(data, 20.0, view, width)
    else:
        assert overlaps(snapshot(data, 20.0, view, width)) == []


@pytest.mark.parametrize("width", COLUMNS)
def test_two_runs_side_by_side(data, width):
    assert overlaps(compare(data, data, width=width)) == []


@pytest.mark.parametrize("width", COLUMNS)
def test_several_moments(data, width):
    assert overlaps(emergence(data, times=[0, 8, 20, 40], map_times=[20, 40], width=width)) == []


def test_texts_that_do_overlap_are_found():
    figure = matplotlib.figure.Figure(figsize=(2.0, 1.0))
    figure.text(0.1, 0.5, "one")
    figure.text(0.12, 0.5, "other")
    figure.text(0.9, 0.9, "cut off at the edge")
    assert overlaps(figure) == [("one", "other"), ("cut off at the edge", None)]


@pytest.mark.slow
@pytest.mark.parametrize("shape", [cy.Spheroid(1.5), cy.Sphere()], ids=["spheroid", "sphere"])
@pytest.mark.parametrize("scales", SCALES.values(), ids=SCALES)
def test_closed_cells(shape, scales):
    grid = cy.ClosedGrid(shape, k_max=8)
    swirl = cy.closed.rotation(grid) if isinstance(shape, cy.Sphere) else cy.closed.swirl(grid, 0.5)
    data = cy.simulate(cy.Parameters(), grid, swirl, 1.0, save_every=0.25).to_dataset()
    data = data if scales is None else with_scales(data, scales)
    for width in COLUMNS:
        assert overlaps(history(data, width)) == []
        for view in VIEWS:
            assert overlaps(snapshot(data, 0.5, view, width)) == []
