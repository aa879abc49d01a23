import numpy as np
import pytest
import xarray

from cyclosis.analysis.zones import indifferent_zones
from cyclosis.experiments import twist as done
from cyclosis.experiments import twist as helices
from cyclosis.model.grid import CylinderGrid


def made_up(short=0, long=0, persist=1.0, seeds=40):
    """Return a dataset in which so many of the short and of the long cells are helical."""
    grid = CylinderGrid(16, 16, 10.0)
    P = np.stack([helices.wound(grid, turns) for turns in (0, 1, 1, 1)]).astype(np.float32)
    dims = ("frame", "component", "theta", "z")
    data = xarray.Dataset({"P": (dims, P), "u": (dims, P)})
    data = data.assign_coords(frame_time=("frame", [250.0, 10.0, 30.0, 250.0]))
    data["shown_length"] = "frame", [5.0, 10.0, 10.0, 10.0]
    data["tilt"] = "case", [0.2, done.TILT, done.TILT, 0.0]
    data["cell_length"] = "case", [5.0, 5.0, 10.0, 10.0]
    turns = np.zeros((4, seeds))
    turns[1, :short] = 1
    turns[2, :long] = 1
    turns[2, -1] = np.nan
    data["winding"] = ("case", "seed"), turns
    data["filaments"] = ("case", "seed"), np.repeat([[0.1], [0.2], [0.25], [0.0]], seeds, axis=1)
    data["peak_speed"] = ("case", "seed"), np.full((4, seeds), 0.96)
    data["lean_tilt"], data["lean_theory"] = ("lean", [0.2, 0.4]), ("lean", [0.108, 0.216])
    data["helix_tilt"] = "helix", [0.2, 0.4]
    data["helix_winding"] = "helix", [persist, persist]
    data["helix_filaments"] = "helix", [0.2, 0.4]
    data["helix_speed"], data["helix_theory"] = ("helix", [0.95, 0.96]), ("helix", [0.95, 0.96])
    return data


@pytest.mark.parametrize("turns", [-2, -1, 0, 1, 2])
def test_windings_and_tilts_of_prepared_stripes(turns):
    grid = CylinderGrid(48, 48, 12.0)
    state = helices.wound(grid, turns)
    assert helices.winding(zone.winding for zone in indifferent_zones(grid, state)) == turns
    assert helices.filament_tilt(state) == pytest.approx(np.arctan(2 * np.pi * turns / 12))


@pytest.mark.parametrize("zones", [[], [(1, 0), (-1, 0)], [(0, 1)], [(0, 1), (1, -1)], [(0, 1)] * 4])
def test_what_is_no_pair_of_zones_has_no_winding(zones):
    assert np.isnan(helices.winding(zones))


def test_closed_loops_do_not_count():
    assert helices.winding([(1, -1), (0, 0), (-1, 1)]) == 1


def test_speeds_along_the_easy_direction_begin_with_those_of_upright_stripes():
    assert helices.speed_along(0.0) == pytest.approx(0.9714276568, abs=1e-8)
    assert helices.speed_along(0.5) < helices.speed_along(0.2) < helices.speed_along(0.0)


@pytest.mark.parametrize(
    ("given", "outcome", "says"),
    [
        ({"persist": 0.0}, "agrees", "0 persist"),
        ({}, "in part", "2 persist"),
        ({"persist": 0.0, "long": 20}, "in part", "50.0 %"),
        ({"short": 10}, "does not", "25.0 %"),
    ],
)
def test_verdicts(given, outcome, says):
    found = done.verdict(made_up(**given))
    assert found.outcome == outcome
    assert says in found.measured


@pytest.mark.parametrize("given", [{}, {"persist": 0.0}, {"short": 10}])
def test_each_outcome_is_drawn(given):
    assert len(done.draw(made_up(**given)).axes) == 7
