"""Figures and movies of a cell with scales are in units; what they show is the same."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset import with_scales
from cyclosis.figures.emergence import emergence
from cyclosis.figures.history import history
from cyclosis.figures.scene import Scene, SceneLayout

CHARA = cy.Scales(radius_um=500.0, speed_um_per_s=75.0)
GRID = cy.CylinderGrid(16, 16)


@pytest.fixture(scope="module")
def data():
    run = cy.simulate(
        cy.Parameters(), GRID, cy.initial.stripes(GRID, magnitude=0.5), t_end=20.0, save_every=4.0
    )
    return run.to_dataset()


def values(line):
    return np.asarray(line.get_ydata(), dtype=float)


def texts(figure):
    figure.canvas.draw()
    found = [text.get_text() for text in figure.findobj(lambda part: hasattr(part, "get_text"))]
    return {text for text in found if text}


def test_history_is_in_minutes_and_micrometres_a_second(data):
    plain, scaled = history(data), history(with_scales(data, CHARA))
    assert "$t$ (square-root scale)" in texts(plain)
    told = texts(scaled)
    assert {"$t$ (min, square-root scale)", "speed (µm/s)"} <= told
    for before, after in zip(plain.axes, scaled.axes, strict=True):
        factor = 75.0 if after.get_ylabel() == "speed (µm/s)" else 1.0
        for one, other in zip(before.lines, after.lines, strict=True):
            assert np.allclose(factor * values(one), values(other), rtol=1e-13, equal_nan=True)
    ticks = scaled.axes[0].get_xticks() * CHARA.time_s / 60
    assert np.allclose(ticks, [float(label.get_text()) for label in scaled.axes[1].get_xticklabels()])


def test_cells_have_a_bar_of_its_true_length(data):
    figure = emergence(with_scales(data, CHARA), times=[0, 20], map_times=[20])
    assert {"500 µm", "$t$ = 2.22 min", "2.5\nmm"} <= texts(figure)
    (bar,) = figure.axes[0].lines
    assert np.ptp(bar.get_xdata()) == pytest.approx(1.0), "500 µm are one radius"
    assert not emergence(data, times=[0, 20], map_times=[20]).axes[0].lines


def test_movies_are_in_units(data):
    scene = Scene(GRID, data["time"].values, data["order"].values, 180, CHARA)
    told = texts(SceneLayout(scene).figure)
    assert {"500 µm", "$t$ min", "square-root scale", "2.5\nmm"} <= told
