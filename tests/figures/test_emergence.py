import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.figures import frames, style
from cyclosis.figures.emergence import emergence

GRID = cy.CylinderGrid(24, 24, 5.0)


@pytest.fixture(scope="module")
def run():
    """From noise to two stripes by t = 12, and then next to no change until t = 30."""
    times = np.arange(0.0, 31.0, 2.0)
    share = np.minimum(times / 12, 1.0)[:, None, None, None]
    stripes = np.stack(np.broadcast_arrays(0.0, 0.9 * np.sin(GRID.theta[:, None] + 0 * GRID.z)))
    P = share * stripes + (1 - share) * cy.initial.disordered(GRID, seed=0)
    u = share**3 * P
    dims = ("time", "component", "theta", "z")
    data = {"P": (dims, P), "u": (dims, u), "peak_speed": ("time", np.sqrt((u**2).sum(1)).max((1, 2)))}
    coords = {"time": times, "component": ["theta", "z"], "theta": GRID.theta, "z": GRID.z}
    return xarray.Dataset(data, coords, {"length": GRID.length})


def labels(figure):
    return [ax.get_title() for ax in figure.axes if "t$" in ax.get_title()]


def maps(figure):
    return [ax for ax in figure.axes if ax.get_xlabel()]


def test_six_cylinders_and_three_maps(run):
    figure = emergence(run)
    assert len(labels(figure)) == 6
    assert len(maps(figure)) == 3
    assert len(figure.axes) == 10  # and the key
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(style.WIDTH)


def test_labels_are_the_times_of_the_frames_drawn(run):
    figure = emergence(run, times=[0, 4.2, 10, 30], map_times=[10], view_angle=1.0, width=120)
    assert labels(figure) == ["$t$ = 0", "$t$ = 4", "$t$ = 10", "$t$ = 30"]
    assert len(maps(figure)) == 1


def test_the_story_runs_from_disorder_to_the_end_of_change(run):
    chosen = frames.story(run, 6)
    assert chosen == sorted(set(chosen))
    assert chosen[0] == 0
    assert chosen[-1] == 6  # t = 12: nothing happens after it


@pytest.mark.parametrize("count", [1, 3, 6])
def test_a_story_without_change_still_has_its_frames(run, count):
    same = run.isel(time=[0] * 6).assign_coords(time=np.arange(6.0))
    chosen = frames.story(same, count)
    assert len(set(chosen)) == count
    assert max(chosen) < 6


def test_the_default_view_shows_a_zone():
    theta = GRID.theta[:, None] + 0 * GRID.z
    view = frames.facing_zone(np.stack([0 * theta, np.sin(theta - 2.0)]), beside=0.25)
    assert view == pytest.approx(2.25)
    assert frames.facing_zone(np.stack([0 * theta, 1 + 0.5 * np.cos(theta)])) == 0.0


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"times": [0, 4, 31]}, "times"),
        ({"times": [4, 2]}, "times"),
        ({"times": [4, 4.1]}, "times"),
        ({"times": [4]}, "number of times"),
        ({"times": []}, "times"),
        ({"times": ["a", "b"]}, "times"),
        ({"times": [0, np.nan]}, "times"),
        ({"times": range(0, 20, 2)}, "number of times"),
        ({"times": [0, 4], "map_times": [6]}, "map_times"),
        ({"times": [0, 4], "map_times": [0, 4]}, "number of map_times"),
        ({"view_angle": np.inf}, "view_angle"),
        ({"tilt": 3.0}, "tilt"),
        ({"width": 5}, "width"),
    ],
)
def test_bad_arguments_are_refused(run, arguments, field):
    with pytest.raises(cy.InputError, match=field):
        emergence(run, **arguments)


def test_bad_datasets_are_refused(run):
    with pytest.raises(cy.InputError, match="saved frames"):
        emergence(run.isel(time=slice(0, 5)))
    with pytest.raises(cy.InputError, match="variables"):
        emergence(run.drop_vars("u"))
    with pytest.raises(cy.InputError, match="length"):
        emergence(run.assign_attrs(length="long"))
    with pytest.raises(cy.InputError, match=r"z in the dataset .* the whole cell"):
        emergence(run.isel(z=slice(0, 12)))
    with pytest.raises(cy.InputError, match=r"z in the dataset .* the whole cell"):
        emergence(run.assign_attrs(length=2 * run.length))
    with pytest.raises(cy.InputError, match="dataset"):
        emergence(run["P"])


def test_saving(tmp_path):
    figure = style.blank(20, 10)
    assert style.save(figure, tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert style.save(figure, str(tmp_path / "a.PDF")).read_bytes()[:4] == b"%PDF"
    for name in ("a.jpg", "a"):
        with pytest.raises(cy.InputError, match=r"ends in \.png, \.pdf, \.svg or \.eps"):
            style.save(figure, tmp_path / name)
    with pytest.raises(cy.InputError, match="folder"):
        style.save(figure, tmp_path / "missing" / "a.png")
