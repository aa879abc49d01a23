import numpy as np
import pytest
import xarray

from cyclosis.analysis.regimes import REGIMES
from cyclosis.experiments import equal_stripes as done
from cyclosis.model import initial
from cyclosis.model.grid import CylinderGrid

CYCLOSIS, ONE_WAY, MANY = (REGIMES.index(name) for name in ("cyclosis", "unidirectional", "multistripe"))


def made_up(one_way=0, many=0, uneven=1e-12, seeds=40):
    """Return a dataset in which some cells of the first α_u and of all lengths end otherwise."""
    rng = np.random.default_rng(0)
    grid = CylinderGrid(16, 8, 5.0)
    P = np.stack([initial.stripes(grid)] * 2).astype(np.float32)
    dims = ("frame", "component", "theta", "z")
    data = xarray.Dataset({"P": (dims, P), "u": (dims, P)}, coords={"frame_time": ("frame", [0.0, 9.0])})
    data.attrs["length"] = 5.0
    for name, size in (("alpha_u", 2), ("cell_length", 3)):
        ended = np.full((size, seeds), CYCLOSIS)
        ended[0, :one_way] = ONE_WAY
        ended[-1, :many] = MANY
        stripes = np.select([ended == CYCLOSIS, ended == MANY], [2, 4], 0)
        data[f"ended_over_{name}"] = (name, "seed"), ended
        data[f"stripes_over_{name}"] = (name, "seed"), stripes
        data[f"uneven_over_{name}"] = (name, "seed"), np.where(stripes == 2, uneven, np.nan)
    times = np.array([10.0, 30.0, 60.0, 100.0])
    fall = np.exp(-np.array([0.01, 0.06])[:, None, None] * times)
    data["difference"] = (
        ("followed", "seed", "course_time"),
        0.04 * rng.uniform(0.1, 1.0, (2, seeds, 1)) * fall,
    )
    data["theory_rate"] = "followed", [0.01, 0.06]
    return data.assign_coords(
        alpha_u=[0.1, 0.5], cell_length=[2.5, 5.0, 10.0], followed=[0.1, 0.5], course_time=times
    )


def test_the_difference_of_widths_of_known_stripes():
    grid = CylinderGrid(48, 8, 5.0)
    state = initial.stripes(grid)
    assert done.difference(state) == pytest.approx(0, abs=1e-12)
    state[1] = 0.5 * np.sin(grid.theta)[:, None] + 0.25
    # P_z = 0 where sin = -1/2: the stripe that points down takes a third.
    assert done.difference(state) == pytest.approx(1 / 6, abs=1e-9)
    assert np.isnan(done.difference(initial.stripes(grid, 4)))
    assert np.isnan(done.difference(initial.unidirectional(grid)))


def test_rates_of_exponentials_are_theirs():
    times = np.linspace(0, 200, 9)
    differences = np.array([0.03, 0.2])[:, None] * np.exp(-np.array([0.02, 0.05])[:, None] * times)
    assert done.rates(times, differences) == pytest.approx([0.02, 0.05])
    assert done.rates(times, np.full((1, 9), np.nan)).size == 0


def test_the_theory_of_how_widths_become_equal_is_that_of_the_documentation():
    assert done.relaxation(0.5) == pytest.approx(0.0640695, abs=1e-6)


@pytest.mark.parametrize(
    ("given", "outcome", "says"),
    [
        ({}, "agrees", "0.0600"),
        ({"one_way": 20}, "in part", "20 of 40 unidirectional"),
        ({"many": 1}, "in part", "exactly two"),
        ({"many": 30}, "does not", "exactly two"),
        ({"uneven": 0.1}, "does not", "1e-01"),
    ],
)
def test_verdicts(given, outcome, says):
    found = done.verdict(made_up(**given))
    assert found.outcome == outcome
    assert says in found.measured


def test_cells_without_stripes_say_no():
    data = made_up()
    for name in ("alpha_u", "cell_length"):
        data[f"stripes_over_{name}"][:] = 0
    assert done.verdict(data).outcome == "does not"


@pytest.mark.parametrize("given", [{}, {"one_way": 20}, {"many": 30}])
def test_each_outcome_is_drawn(given):
    figure = done.draw(made_up(**given))
    assert len(figure.axes) == 5


def test_cells_of_two_sweeps_with_the_same_parameters_count_once():
    data = made_up(seeds=40)
    assert "of 160 final patterns" in done.verdict(data).measured  # two α_u, and two of three lengths
