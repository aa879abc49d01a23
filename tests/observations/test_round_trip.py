"""A run, seen by the microscope, written, read, measured and compared with the run: the noise is left."""

import functools
import json
import warnings

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.fitting.film import film_of
from cyclosis.fitting.fit import _method
from cyclosis.observations import View, compare, observe, read
from cyclosis.observations.microscope.conventions import in_the_files, reading
from cyclosis.observations.microscope.files import WRITERS
from cyclosis.observations.microscope.observe import FORMATS
from observed import LENGTH, cell, helical

RADIUS = {"kymograph": 60.0, "orientation": 60.0}
PSI = 0.5
CAMERAS = [(17.0, False, np.pi), (90.0, True, 2.0), (-63.0, True, 0.4), (200.0, False, 5.0)]
"""Direction of the axis, whether the picture is mirrored, and the angle that faces the camera."""
OPTIONS = {
    "piv": {"window_px": 4, "step_px": 5, "times": [0.0, 1.0]},
    "tracks": {"frames": 4, "start": 1.0, "particles_per_px": 0.04},
    "kymograph": {"frames": 24, "start": 1.0, "frame_s": 0.2, "at": 40.0, "width_px": 1.0},
    "orientation": {"times": [1.0], "filaments_per_px": 0.012},
    "mrv": {"times": [1.0]},
}
NAMES = [(kind, name) for kind in OPTIONS for name in FORMATS[kind]]
NEEDS_TIFFFILE = {("kymograph", "tiff"), ("orientation", "tiff"), ("mrv", "tiff")}


def even(theta, z, t):
    """Streams that do not change along the cell, and are no mirror image of themselves."""
    along = 0.8 * np.sin(theta) + 0.3 * np.sin(2 * theta + 0.5) + 0 * z
    return np.stack([0 * along, along])


HELIX, EVEN = cell(flow=helical), cell(flow=even)
HELIX["P"][:, 0], HELIX["P"][:, 1] = 0.99 * np.sin(PSI), 0.99 * np.cos(PSI)


def run_for(kind):
    """A kymograph and a slice average along the cell; what changes there, their speeds cannot tell."""
    return EVEN if kind in ("kymograph", "mrv") else HELIX


@functools.cache
def recorded(kind, axis, mirrored, facing):
    radius = RADIUS.get(kind, 40.0)
    view = View(radius, axis, mirrored=mirrored, facing=facing)
    return observe(run_for(kind), view, kind, pixel_um=500 / radius, **OPTIONS[kind])


def checked(kind, said, files, view, shot):
    """Read files, put them on the surface and compare them with the run."""
    seen = read(files if len(files) > 1 else files[0], **said).view(**view)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a helix is no turned axis
        # Towards the rim a texture leans to the axis, in any camera: by 8 degrees at 55.
        data = seen.on_surface(max_angle_deg=40.0 if kind == "orientation" else 60.0)
    time_s = shot.camera.scales.time_s
    if kind == "orientation":
        off = np.degrees(np.arctan(np.tan(data["angle"].values - PSI)))
        assert np.isfinite(off).sum() > 60
        assert abs(np.nanmean(off)) < 2.0
        assert np.nanmedian(np.abs(off)) < 5.0  # filaments scatter
        return
    if kind == "kymograph":
        assert 4 <= data.sizes["z"] <= 5  # windows of at least 64 pixels
        speeds = data["u"].sel(component="z").values.ravel() * time_s
        true = even(data["theta"].values, 0.0, 0.0)[1]
        assert abs(true) > 0.2
        assert np.abs(speeds - true).max() * shot.camera.px_per_frame < 0.15
        return
    fit = compare(data, run_for(kind))
    assert not fit.mirrored
    assert fit.other_mirror > 5
    assert abs(fit.rotation) < 0.03
    assert fit.speed * time_s == pytest.approx(1.0, abs=0.02)
    print(f"left {fit.rms:.3f} of the noise")
    # Interpolated vectors are less noisy than those measured; averages over a cell hold a gradient.
    assert 0.6 < fit.rms < 1.2
    if kind != "mrv":
        assert abs(fit.shift) < 0.02
        assert fit.time == (1.0 if kind == "tracks" else 0.0)


@pytest.mark.parametrize(("kind", "name"), NAMES, ids=map("-".join, NAMES))
def test_files_of_the_microscope_end_in_the_run(kind, name, tmp_path):
    if (kind, name) in NEEDS_TIFFFILE:
        pytest.importorskip("tifffile")
    shot = recorded(kind, -63.0, True, 0.4)
    files = []
    for file, put in WRITERS[kind, name](shot).items():
        if not file.startswith("filaments"):
            put(tmp_path / file)
            files.append(tmp_path / file)
    checked(kind, reading(shot, name), files, in_the_files(shot).to_dict(), shot)


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "mirrored", "facing"), CAMERAS)
@pytest.mark.parametrize(("kind", "name"), NAMES, ids=map("-".join, NAMES))
def test_every_camera_and_every_format(kind, name, axis, mirrored, facing, tmp_path):
    """With what view.json says, and nothing else."""
    if (kind, name) in NEEDS_TIFFFILE:
        pytest.importorskip("tifffile")
    shot = recorded(kind, axis, mirrored, facing)
    shot.write(tmp_path / "seen", name)
    told = json.loads((tmp_path / "seen" / "view.json").read_text())
    files = [tmp_path / "seen" / file for file in told["files"]]
    checked(kind, told["read"], files, told["view"], shot)


def vectors(tmp_path, name="openpiv"):
    shot = recorded("piv", -63.0, True, 0.4)
    content = WRITERS["piv", name](shot)
    for file, put in content.items():
        put(tmp_path / file)
    return shot, [tmp_path / file for file in content]


def test_a_wrong_direction_of_y_is_the_other_hand(tmp_path):
    shot, files = vectors(tmp_path)
    said = reading(shot, "openpiv") | {"y": "up", "origin_px": (0.0, shot.camera.size_px[1] - 1.0)}
    view = shot.camera.view
    x, y = view.centre_px
    there = view.to_dict() | {"centre_px": (x, shot.camera.size_px[1] - 1.0 - y), "axis_deg": -view.axis_deg}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        data = read(files, **said).view(**there).on_surface(max_angle_deg=60.0)
    fit = compare(data, HELIX)
    assert fit.mirrored
    assert 0.6 < fit.rms < 1.2


def test_z_counts_modulo_the_length_of_the_cell(tmp_path):
    shot, files = vectors(tmp_path)
    seen = read(files, **reading(shot, "openpiv")).view(**in_the_files(shot).to_dict())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        data = seen.on_surface(max_angle_deg=60.0)
    one, far = (compare(data.assign_coords(z=data["z"] + k * LENGTH), HELIX) for k in (0, -3))
    assert far.shift == pytest.approx(one.shift, abs=1e-6)
    assert far.rms == pytest.approx(one.rms, abs=1e-9)


def test_the_mirror_image_of_a_run_lies_where_it_is_said_to_lie():
    """The measured point (θ, z) is the point (rotation - θ, z - shift) of the run, with the other u_θ."""
    theta, z = np.linspace(2.0, 4.5, 20), np.linspace(0.5, 3.5, 18)
    u = helical(0.7 - theta[:, None], z - 0.4, 1.0) * np.array([-1.0, 1.0])[:, None, None]
    places = {"time": [0.0], "theta": theta, "z": z}
    found = compare(xarray.Dataset({"u": (("time", "component", "theta", "z"), u[None])}, places), HELIX)
    assert found.mirrored
    assert found.time == 1.0
    assert (found.rotation, found.shift) == pytest.approx((0.7, 0.4), abs=1e-5)
    assert found.rms_of_peak < 1e-6


def test_a_measured_film_can_be_fitted_in_its_own_units():
    """Radii per second and seconds, as a measurement has them, are those of the model by `Scales`."""
    data = HELIX.isel(theta=slice(4, 20))[["u"]]
    seconds = data.assign_coords(time=("time", 5.0 * data["time"].values, {"units": "s"}))
    seconds["u"] = (seconds["u"] / 5.0).assign_attrs(units="s-1")
    scales = cy.Scales(500.0, 100.0)
    one, other = film_of(data, None), film_of(seconds, scales)
    np.testing.assert_allclose(other.times, one.times)
    np.testing.assert_allclose(other.u, one.u)
    with pytest.raises(cy.InputError, match=r"scales=cyclosis\.Scales"):
        film_of(seconds, None)


def test_noise_does_not_make_a_steady_film_move():
    rng = np.random.default_rng(0)
    for run, method in ((cell(np.arange(12.0), flow=even), "profile"), (cell(np.arange(12.0)), "film")):
        for noise in (0.0, 0.02, 0.1):
            u = run["u"] + noise * rng.normal(size=run["u"].shape)
            assert _method(film_of(u.to_dataset(name="u"), None)) == method
