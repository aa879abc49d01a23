import numpy as np
import pytest
import scipy.integrate
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments import coalescence as done
from cyclosis.experiments import fronts as fronts_of
from cyclosis.model.grid import CylinderGrid
from cyclosis.model.parameters import Parameters


def made_up(slow=1.0, survivor=False, shifted=1.0, seeds=40):
    """Return a dataset in which fronts obey the law times `slow`, and flow acts from `shifted` on."""
    grid = CylinderGrid(16, 8, 5.0)
    P = np.stack([fronts_of.fronts(Parameters(alpha_p=0.1), grid, 2.0)] * 5).astype(np.float32)
    dims = ("frame", "component", "theta", "z")
    data = xarray.Dataset({"P": (dims, P), "u": (dims, P)})
    data = data.assign_coords(frame_time=("frame", [0.0, 1.0, 2.0, 0.0, 2.0]))
    data.attrs |= {"length": 5.0, "threshold": 0.00747, "life": 1e8}
    each = [Parameters(alpha_p=value, alpha_u=0.0) for value in (0.2, 1.0)]
    distance = np.array([np.array([4.5, 5.0]) * fronts_of.front(params)[0] for params in each])
    law = np.array([[fronts_of.closing(p, d) for d in row] for p, row in zip(each, distance, strict=True)])
    for name, values in (("distance", distance), ("speed", slow * law), ("law", law)):
        data[name] = ("alpha_p", "pair"), values
    multiple = np.array([0.0, 0.5, 2.0, 10.0])
    first = np.tile([0.1, 0.3, 0.45], (4, 1))
    edge = np.array([0.5, 0.5, 0.4, 0.2])[:, None]
    last = np.where(first > edge, 0.5, 0.0)
    if survivor:
        last[0, -1] = 0.45
    data["first_width"] = ("multiple", "start"), first
    data["last_width"] = ("multiple", "start"), last
    near = np.array([0.5, 0.8, 1.25, 2.0])
    data["growth"] = "near", 0.003 * (shifted - near)
    data["saddle_multiple"] = "saddle", [1.0, 2.0, 10.0]
    data["saddle_width"] = "saddle", [0.5, 0.4, 0.2]
    ended = np.full((3, seeds), REGIMES.index("unidirectional"))
    ended[-1] = REGIMES.index("cyclosis")
    data["ended"] = ("flow", "seed"), ended
    return data.assign_coords(alpha_p=[0.2, 1.0], near=near, multiple=multiple, flow=[0.0, 3.0, 30.0])


def test_fronts_are_as_far_apart_as_they_were_put():
    params, grid = Parameters(alpha_p=0.5), CylinderGrid(192, 8, 5.0)
    assert fronts_of.apart(fronts_of.fronts(params, grid, 2.0)) == pytest.approx(2.0, abs=1e-3)
    assert fronts_of.apart(np.stack([np.zeros(grid.shape), np.full(grid.shape, 0.5)])) == 0


def test_a_life_is_the_law_integrated():
    params = Parameters(alpha_p=0.2, alpha_u=0.0)
    distance = np.concatenate([np.linspace(0.8 * np.pi, 1e-3, 20001)])
    pace = np.array([fronts_of.closing(params, one) for one in distance])
    assert scipy.integrate.trapezoid(1 / pace, -distance) == pytest.approx(fronts_of.life(0.2, 0.4), rel=1e-4)


def test_a_crossing_lies_where_a_straight_line_has_its_zero():
    near = np.array([0.5, 0.8, 1.25, 2.0])
    assert done.crossing(near, 0.3 * (0.97 - near)) == pytest.approx(0.97)
    assert np.isnan(done.crossing(near, -near))


@pytest.mark.slow
def test_fronts_creep_as_the_law_has_it():
    distance, speed, law = fronts_of.creep(0.2, 4.0)
    assert 3.8 < distance / fronts_of.front(Parameters(alpha_p=0.2))[0] < 4
    assert speed == pytest.approx(law, rel=0.02)
    assert np.isnan(fronts_of.creep(0.1, 6.0)).all()


def test_fates_are_foreseen():
    assert done.foreseen(made_up()).all()
    assert np.sum(~done.foreseen(made_up(survivor=True))) == 1


@pytest.mark.parametrize(
    ("given", "outcome", "says"),
    [
        ({}, "agrees", "12 of 12 fates as predicted"),
        ({"slow": 0.8}, "in part", "within 20.0 % of the law"),
        ({"survivor": True}, "does not", "without flow 2 of 3 pairs"),
        ({"shifted": 1.5}, "does not", "1.500 of the predicted threshold"),
    ],
)
def test_verdicts(given, outcome, says):
    found = done.verdict(made_up(**given))
    assert found.outcome == outcome
    assert says in found.measured


@pytest.mark.parametrize("given", [{}, {"slow": 0.8}, {"survivor": True}])
def test_each_outcome_is_drawn(given):
    assert len(done.draw(made_up(**given)).axes) == 8
