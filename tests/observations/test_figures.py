"""Figures of measurements show the time at which most can be seen."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures.measured import comparison, measurement

GRID = cy.CylinderGrid(16, 16)


def film(speeds):
    """A measurement of one speed along the cell at each time."""
    frames = [
        cy.observations.gridded([0, 50, 100], [0, 50], [[speed] * 3] * 2, [[0.0] * 3] * 2, time=float(k))
        for k, speed in enumerate(speeds)
    ]
    seen = cy.observations.Observation(tuple(frames))
    return seen.view(100.0, 0.0, (0.0, 25.0), mirrored=False)


def test_a_measurement_is_drawn_where_it_is_fastest():
    seen = film([0.0, 5.0, -8.0, 2.0])
    data = seen.on_surface()
    for frame, time in ((None, 2), (1, 1), (-1, 3)):
        figure = measurement(seen, data, frame=frame)
        assert figure.axes[1].get_title() == f"on the surface, t = {time}"
        shown = figure.axes[1].collections[0].get_array()
        assert np.nanmax(np.abs(shown)) == pytest.approx(abs([0.0, 5.0, -8.0, 2.0][time]) / 100.0)
    with pytest.raises(cy.InputError, match="frame = 4"):
        measurement(seen, data, frame=4)


def test_a_comparison_is_drawn_where_it_is_fastest():
    run = cy.simulate(cy.Parameters(), GRID, cy.initial.stripes(GRID, magnitude=0.2), t_end=2.0)
    data = run.to_dataset().isel(time=[0, 2, 1])[["u"]].sortby("time")
    found = comparison(cy.observations.compare(data, run).dataset)
    assert found.axes[0].get_title() == f"measured, t = {float(data['time'][-1]):.4g}"
    assert found.axes[1].get_title() == "model"
