"""Measurements of known flows: exact values, wrong signs, wrong geometry, and what a comparison finds."""

import dataclasses
import warnings

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

import cyclosis as cy
from cyclosis.observations.noise import estimated_noise
from measured import LENGTH, at, errors, refused, run_of, truth

X, Y = np.arange(0.0, 640.0, 8.0), np.arange(0.0, 480.0, 8.0)


def seen(name="u_transient", noise=0.0, flip=(1.0, 1.0), **view):
    """An exact measurement of a run at the points of a grid of the image, in R/U and pixels."""
    camera = cy.observations.View(
        **{"radius_px": 100.0, "axis_deg": 17.0, "centre_px": (60.0, 320.0), "facing": np.pi} | view
    )
    xx, yy = np.meshgrid(X, Y)
    theta, z, _ = camera.to_surface(xx, yy)
    inside = np.isfinite(theta)
    u = at(truth(name), np.nan_to_num(theta), np.nan_to_num(z))
    vx, vy = camera.velocity_to_image(np.nan_to_num(theta), np.nan_to_num(z), *u)
    draw = np.random.default_rng(0).normal(size=(2, *xx.shape)) * noise
    frame = cy.observations.gridded(X, Y, flip[0] * vx + draw[0], flip[1] * vy + draw[1], inside)
    made = cy.observations.Observation((frame,), time_unit="s", noise_px=noise or None)
    return made.view(**dataclasses.asdict(camera))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("axis", "centre"), [(0.0, (60.0, 240.0)), (90.0, (320.0, 450.0)), (-130.0, (500.0, 60.0))]
)
@pytest.mark.parametrize("facing", [np.pi, 1.0, 0.0])
def test_exact_measurements_end_in_the_run(axis, centre, facing, mirrored):
    made = seen(axis_deg=axis, centre_px=centre, facing=facing, mirrored=mirrored)
    data = made.on_surface(scales=None)
    theta, z = np.meshgrid(data["theta"].values, data["z"].values, indexing="ij")
    off = np.abs(data["u"].values[0] - at(truth("u_transient"), theta, z))
    assert np.isfinite(off).mean() > 0.5
    assert np.nanmax(off[:, np.cos(theta - facing) > 0.5]) < 6e-3  # of a peak of 0.41: interpolated
    assert data.attrs["warnings"] == ""
    found = cy.observations.compare(data, run_of("u_ordered", "u_transient"), mirrored=False)
    assert found.time == 1.0
    assert found.rms_of_peak < 4e-3
    assert max(abs(found.rotation), abs(found.shift)) < 2e-3


def test_comparison_finds_rotation_shift_speed_and_noise():
    data = seen(noise=0.5).on_surface()
    moved = data.assign_coords(theta=data["theta"] + 0.7, z=data["z"] + 1.3)
    moved["u"] = (data["u"].dims, 0.02 * data["u"].values, {"units": "s-1"})
    moved["sigma"] = (data["sigma"].dims, 0.02 * data["sigma"].values)
    found = cy.observations.compare(moved, run_of("u_transient"))
    assert found.rotation == pytest.approx(0.7, abs=5e-3)
    assert found.shift == pytest.approx(1.3, abs=1e-2)
    assert found.speed == pytest.approx(0.02, rel=5e-3)
    assert 0.6 < found.rms < 1.1  # interpolation between samples averages some of their noise
    assert not found.mirrored


def test_several_frames_are_compared_with_time():
    """Frames between which the flow changes: the time of the first, and the pace of all."""
    import xarray

    run = run_of("u_transient", "u_ordered")
    middle = run.interp(time=[0.25, 0.5, 0.75])
    data = middle.assign_coords(time=10.0 * (middle["time"] - 0.25))  # ten seconds in R/U
    data["u"] = (0.1 * data["u"]).assign_attrs(units="s-1")
    fine = xarray.concat([run.interp(time=[t]) for t in np.linspace(0, 1, 21)], "time").assign_attrs(
        run.attrs
    )
    found = cy.observations.compare(data, fine, mirrored=False)
    assert found.time == pytest.approx(0.25)
    assert found.speed == pytest.approx(0.1, rel=3e-3)
    assert found.rms_of_peak < 5e-3


def test_speed_and_time_of_many_frames_far_apart_are_found_together():
    """Half a cell while it orders, in seconds. A wrong pace, too, is a fixed point of its correction by U."""
    params, grid = cy.Parameters(d_s=0.05), cy.CylinderGrid(24, 24)
    run = cy.simulate(params, grid, cy.initial.disordered(grid, seed=0), t_end=8.0, save_every=0.5)
    part = run.to_dataset()[["u"]].sel(time=np.arange(2.0, 8.1)).isel(theta=slice(7, 18))
    for U in (0.02, 0.2, 7.0):
        data = part.assign_coords(time=(part["time"] - 2.0) / U)
        data["u"] = (U * data["u"]).assign_attrs(units="s-1")
        found = cy.observations.compare(data, run)
        assert found.time == 2.0
        assert found.speed == pytest.approx(U, rel=1e-4)
        assert found.rms_of_peak < 1e-3
        assert not found.mirrored
        assert found.other_mirror > 100


def test_a_flipped_component_is_noticed():
    for flip, wrong in (((1.0, 1.0), False), ((1.0, -1.0), True), ((-1.0, 1.0), True)):
        made = seen(axis_deg=0.0, centre_px=(60.0, 240.0), flip=flip, noise=0.3)
        if wrong:
            with pytest.warns(UserWarning, match="wrong sign"):
                data = made.on_surface()
            assert "wrong sign" in data.attrs["warnings"]
        else:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                made.on_surface()


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_turned_axis_is_noticed(mirrored):
    made = seen("u_ordered", axis_deg=0.0, centre_px=(60.0, 240.0), mirrored=mirrored)
    turned = made.view(100.0, 3.0, (60.0, 240.0), mirrored=mirrored)
    with pytest.warns(UserWarning, match=r"axis is at (0\.\d|-0\.\d|359)"):
        turned.on_surface(outside="drop")


def test_a_wrong_centre_is_refused():
    made = seen("u_ordered")
    with refused("outside the cell", "correct radius_px"):
        made.view(100.0, 17.0, (60.0, 400.0), mirrored=False).on_surface()
    with refused("good samples"):
        made.view(100.0, 17.0, (60.0, 4000.0), mirrored=False).on_surface(outside="drop")


def test_noise_and_its_growth_towards_the_rim():
    data = seen(noise=1.0).on_surface()
    assert data.attrs["noise_is"] == "given"
    assert np.allclose(data["sigma"].sel(component="z"), 0.01)
    assert np.allclose(data["sigma"].sel(component="theta") * data["cos_phi"], 0.01)
    estimated = dataclasses.replace(seen("u_ordered", noise=1.0), noise_px=None).on_surface()
    assert estimated.attrs["noise_is"] == "estimated"
    assert estimated.attrs["noise_px"] == pytest.approx(1.0, rel=0.25)


def test_noise_of_a_film_is_told_by_its_frames():
    """From frame to frame, though neighbours share all of their noise; what moves steadily is no noise."""
    rng = np.random.default_rng(0)
    still = np.ones((12, 16))
    frames = []
    for k in range(24):
        vx, vy = 2.0 + 0.3 * k + 0.4 * rng.normal(size=(2, 1, 1)) * still
        frames.append(cy.observations.gridded(np.arange(16.0), np.arange(12.0), vx, vy, time=0.5 * k))
    film = cy.observations.Observation(tuple(frames), time_unit="s", frame_s=0.5)
    assert estimated_noise(film) == pytest.approx(0.4 * 0.5, rel=0.4)
    drawn = 0.4 * rng.normal(size=(24, 2, 12, 16))
    frames = [cy.observations.gridded(np.arange(16.0), np.arange(12.0), *(2.0 + each)) for each in drawn]
    assert estimated_noise(cy.observations.Observation(tuple(frames))) == pytest.approx(0.4, rel=0.05)


def test_bad_vectors_leave_no_trace():
    """A fifth of the vectors is wild and flagged."""
    made = seen("u_ordered")
    frame = made.frames[0]
    bad = np.random.default_rng(1).random(frame.x.size) < 0.05
    wild = np.where(bad, 1e6, frame.vx)
    flagged = dataclasses.replace(made, frames=(dataclasses.replace(frame, vx=wild, good=frame.good & ~bad),))
    across, along = errors(flagged.on_surface(), "u_ordered")
    assert np.quantile(along, 0.99) < 0.02
    assert along.max() < 0.1
    assert along.size > 0.9 * errors(made.on_surface(), "u_ordered")[1].size
    assert across.max() < 0.1


def test_the_grid_of_the_surface_can_be_chosen():
    made = seen()
    data = made.on_surface(theta=[2.0, 3.0, 4.0], z=[1.0, 2.0])
    assert data["u"].shape == (1, 2, 3, 2)
    assert made.on_surface(7, 5)["u"].shape == (1, 2, 7, 5)
    for wrong in ({"theta": [2.0, 1.0]}, {"n_z": 0}, {"max_angle_deg": 95.0}, {"outside": "keep"}):
        with refused("cannot be used"):
            made.on_surface(**wrong)
    assert made.on_surface(max_angle_deg=40.0)["cos_phi"].min() >= np.cos(np.radians(40.5))
    assert LENGTH == 5.0


def test_speeds_that_alias_are_refused():
    with refused("shifted by one distance"):
        cy.observations.line_speeds(np.random.default_rng(0).normal(size=(100, 200)))
    x = np.arange(300)
    periodic = np.sin(2 * np.pi * (x[None] - 4 * np.arange(50)[:, None]) / 10)
    with refused("ambiguous"):
        cy.observations.line_speeds(periodic)
    with refused("rows"):
        cy.observations.line_speeds(np.ones((1, 300)))
    with refused("two parallel edges"):
        cy.observations.rim(np.random.default_rng(0).random((100, 100)))


def test_short_windows_do_not_slow_a_kymograph():
    """Shifted rows share less of a window: their correlation is that per point which they share."""
    pattern = gaussian_filter1d(np.random.default_rng(0).normal(size=4000), 2.0, mode="wrap")
    picture = np.stack([np.roll(pattern, 8 * row) for row in range(60)])
    found = cy.observations.line_speeds(picture, columns=100)  # of 40 pixels
    assert found.mean == pytest.approx(8.0, abs=0.05)
    assert np.isfinite(found.speed).all()


@pytest.mark.parametrize(
    ("speed", "window", "far"), [(6.0, 16.0, True), (5.0, 16.0, False), (6.0, 32.0, False)]
)
def test_displacements_beyond_a_third_of_a_window_are_noted(tmp_path, speed, window, far):
    file = tmp_path / "vectors.txt"
    file.write_text("\n".join(f"{x} {y} {speed} 0.0" for y in (0, 8, 16) for x in (0, 8, 16)))
    given = {"columns": {"x": 0, "y": 1, "u": 2, "v": 3}, "y": "down", "speed": "px/frame", "frame_s": 0.5}
    seen = cy.observations.read(file, window_px=window, **given)
    assert any("a third of a window" in note for note in seen.notes) == far
    assert seen.window_px == window
    assert not any("a third" in note for note in cy.observations.read(file, **given).notes)
    cell = seen.view(20.0, 0.0, (8.0, 8.0), mirrored=False)
    assert cell.on_surface().attrs["window_px"] == window
