"""The synthetic microscope: where things are in the picture, what is measured, and the files."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from scipy.ndimage import maximum_filter

import cyclosis as cy
from cyclosis.observations import View, observe
from cyclosis.observations.microscope import tracers
from cyclosis.observations.microscope.body import body_of
from cyclosis.observations.microscope.camera import Camera, framing
from cyclosis.observations.microscope.observe import FORMATS
from cyclosis.observations.microscope.orientation import _directions, structure
from measure.commandline import said
from observed import LENGTH, RUN, velocity

CAMERAS = [(17.0, False, np.pi), (-63.0, True, 0.4), (90.0, False, 2.0), (200.0, True, np.pi)]
each = pytest.mark.parametrize(("axis", "mirrored", "facing"), CAMERAS)


def shown(kind, axis=17.0, mirrored=False, facing=np.pi, radius=50.0, **options):
    view = View(radius, axis, mirrored=mirrored, facing=facing)
    return observe(RUN, view, kind, pixel_um=500.0 / radius, **options)


@each
def test_the_camera_sees_what_the_view_says(axis, mirrored, facing):
    body = body_of(RUN)
    view, size = framing(body, View(50.0, axis, mirrored=mirrored, facing=facing), None, None)
    camera = Camera(view, size)
    x, y = np.random.default_rng(0).uniform(0, 1, (2, 200)) * np.array(size)[:, None]
    xyz, cos_phi = camera.near(body, x, y)
    theta, z, cosine = view.to_surface(x, y)
    np.testing.assert_array_equal(np.isnan(cos_phi), np.isnan(theta))
    ok = ~np.isnan(theta)
    assert 50 < ok.sum() < 200
    np.testing.assert_allclose(cos_phi[ok], cosine[ok], atol=1e-12)
    np.testing.assert_allclose(np.cos(theta[ok]), xyz[0, ok], atol=1e-12)
    back = camera.seen(body, xyz[:, ok])
    np.testing.assert_allclose(back[:2], (x[ok], y[ok]), atol=1e-9)
    v = camera.moved(body.velocity(xyz[:, ok], 1.0))
    expected = velocity(theta[ok], z[ok], 1.0)
    np.testing.assert_allclose(view.velocity_to_surface(x[ok], y[ok], *v), expected, atol=2e-4)


@each
def test_vectors_are_the_flow_averaged_over_windows(axis, mirrored, facing):
    """With small windows and no noise the vectors are those of the run, back on the surface."""
    seen = shown("piv", axis, mirrored, facing, noise_px=0.0, window_px=4, step_px=9)
    view = seen.camera.view
    x, y = np.meshgrid(seen.data["x"], seen.data["y"])
    theta, z, cos_phi = view.to_surface(x, y)
    near = cos_phi > 0.6
    for k, t in enumerate((0.0, 1.0, 2.0)):
        u = view.velocity_to_surface(x, y, seen.data["vx"][k].values, seen.data["vy"][k].values)
        scale = seen.camera.step
        expected = velocity(theta, z, t)
        np.testing.assert_allclose(np.stack(u)[:, near] / scale, expected[:, near], atol=6e-3)


def test_the_noise_and_the_wrong_vectors_are_those_asked_for():
    quiet, loud = (shown("piv", noise_px=noise, step_px=4) for noise in (0.0, 0.2))
    for name in ("vx", "vy"):
        change = (loud.data[name] - quiet.data[name]).values
        good = np.isfinite(change)
        assert change[good].std() == pytest.approx(0.2, rel=0.05)
        assert abs(change[good].mean()) < 0.02
    wrong = shown("piv", outliers=0.1, step_px=4).data
    seen = np.broadcast_to(~wrong["mask"].values, wrong["flag"].shape)
    assert wrong["flag"].values[seen].mean() == pytest.approx(0.1, abs=0.02)
    assert not wrong["flag"].values[~seen].any()


def test_only_what_is_in_focus_is_measured():
    whole, cap = (shown("piv", depth_um=depth, window_px=8, step_px=4) for depth in (None, 100.0))
    x, y = np.meshgrid(cap.data["x"], cap.data["y"])
    sharp = cap.camera.view.sharp(10.0)[1]
    theta = cap.camera.view.to_surface(x, y)[0]
    angle = np.abs(cap.camera.view.phi(np.where(np.isnan(theta), 0.0, theta)))
    measured = ~cap.data["mask"].values
    assert angle[measured].max() < sharp + 0.1
    assert measured.sum() < 0.75 * (~whole.data["mask"].values).sum()


@each
def test_tracks_follow_the_flow(axis, mirrored, facing):
    seen = shown(
        "tracks",
        axis,
        mirrored,
        facing,
        noise_px=0.0,
        missed=0.1,
        frames=6,
        start=1.0,
        particles_per_px=0.004,
    )
    data, view = seen.data, seen.camera.view
    track, frame = data["track"].values, data["frame"].values
    after = (np.diff(track) == 0) & (np.diff(frame) == 1)
    x, y = (0.5 * (data[n].values[1:] + data[n].values[:-1])[after] for n in ("x", "y"))
    v = [np.diff(data[n].values)[after] for n in ("x", "y")]
    theta, z, cos_phi = view.to_surface(x, y)
    near = cos_phi > 0.5
    t = 1.0 + seen.camera.step * (frame[:-1][after] + 0.5)
    u = np.stack(view.velocity_to_surface(x, y, *v)) / seen.camera.step
    assert near.sum() > 200
    np.testing.assert_allclose(u[:, near], velocity(theta, z, t)[:, near], atol=0.01)
    assert (np.diff(frame)[np.diff(track) == 0] > 1).any()  # gaps
    assert np.diff(frame)[np.diff(track) == 0].max() <= 3


def test_spots_of_a_film_move_with_the_flow():
    """The brightest spot of a sparse film lies where a particle carried from frame to frame lies."""
    seen = shown("film", frames=2, particles_per_px=3e-4, start=0.5)
    frames = seen.data["frames"].values.astype(float)
    assert frames.dtype == float
    row, column = np.unravel_index(frames[0].argmax(), frames[0].shape)

    def centre(picture, row, column):
        part = picture[row - 4 : row + 5, column - 4 : column + 5] - np.median(picture)
        part = np.maximum(part - 0.2 * part.max(), 0)
        down, right = np.indices(part.shape) - 4
        return column + (part * right).sum() / part.sum(), row + (part * down).sum() / part.sum()

    x, y = centre(frames[0], row, column)
    view = seen.camera.view
    theta, z, _ = view.to_surface(x, y)
    moved = view.velocity_to_image(theta, z, *velocity(theta, z, 0.5 + 0.5 * seen.camera.step))
    ahead = np.array([x, y]) + seen.camera.step * np.array(moved)
    found = centre(frames[1], *np.rint(ahead[::-1]).astype(int))
    np.testing.assert_allclose(found, ahead, atol=0.25)


@pytest.mark.parametrize(("axis", "mirrored"), [(17.0, False), (90.0, True)])
def test_streaks_of_a_kymograph_have_the_speed_of_the_flow(axis, mirrored):
    seen = shown("kymograph", axis, mirrored, frame_s=0.05, frames=24, start=0.2, at=40.0, width_px=3.0)
    image = seen.data["image"].values.astype(float)
    image -= image.mean(axis=0)
    spectra = np.fft.rfft(image, axis=1)
    curve = np.fft.irfft((spectra[1:] * spectra[:-1].conj()).sum(axis=0), image.shape[1])
    shifts = np.fft.fftfreq(image.shape[1], 1 / image.shape[1])
    near = np.abs(shifts) < 4
    best = int(np.flatnonzero(near)[curve[near].argmax()])
    left, top, right = curve[best - 1], curve[best], curve[(best + 1) % curve.size]
    found = shifts[best] + 0.5 * (left - right) / (left - 2 * top + right)
    theta = seen.camera.view.facing + seen.data["phi"].values
    mean = velocity(theta, seen.data["z"].values, 0.3)[1].mean() * seen.camera.px_per_frame
    assert found == pytest.approx(mean, abs=0.12 * abs(mean) + 0.05)


def test_the_texture_lies_along_the_filaments():
    seen = shown("orientation", 30.0, radius=60.0, filaments_per_px=0.02)
    angle = seen.data["angle"].values[0]
    x, y = np.meshgrid(*(np.arange(0.0, n, 6) for n in seen.camera.size_px))
    cos_phi = seen.camera.near(body_of(RUN), x, y)[1]
    theta = seen.camera.view.to_surface(x, y)[0]
    inside = (cos_phi > 0.5) & (np.abs(np.sin(theta)) > 0.5)
    off = np.radians(angle[::6, ::6][inside] - 30.0)
    turned = np.degrees(np.arctan(np.tan(off)))
    assert abs(turned.mean()) < 1.0
    assert np.median(np.abs(turned)) < 5.0  # filaments themselves scatter by 25 degrees at |P| = 0.9


def test_the_mean_of_the_filaments_is_P():
    """Their directions lie on the surface and have unit length."""
    body, rng = body_of(RUN), np.random.default_rng(0)
    xyz = body.scattered(4000, rng)
    for share in (1.0, 0.3):
        less = SimpleNamespace(normal=body.normal, filaments=lambda at, t: share * body.filaments(at, t))  # noqa: B023
        drawn = _directions(less, xyz, 0.0, rng)
        assert np.abs(np.linalg.norm(drawn, axis=0) - 1).max() < 1e-12
        assert np.abs((drawn * body.normal(xyz)).sum(axis=0)).max() < 1e-12
        P = less.filaments(xyz, 0.0)
        along, size = drawn[2] * np.sign(P[2]), np.abs(P[2])
        even = np.abs(size - share * 0.9) < 0.02 * share
        assert even.sum() > 500
        error = along[even].std() / np.sqrt(even.sum())
        assert along[even].mean() == pytest.approx(share * 0.9, abs=4 * error)


@pytest.mark.parametrize("bright", [True, False])
def test_rims_of_bright_and_of_dark_cells_are_blurred_the_other_way(bright):
    """Spots lie inside a bright cell and outside a dark one, and reach half their size across the edge."""
    rows, _ = np.indices((200, 300))
    spots = np.random.default_rng(0).random(rows.shape) < 0.05
    spots &= (np.abs(rows - 95) <= 60) == bright
    found = cy.observations.rim(maximum_filter(1.0 * spots, 9), kernel_px=9.0)
    assert found.radius_px == pytest.approx(60.5, abs=2.2)


def test_angles_of_stripes_are_counter_clockwise_as_seen():
    y, x = np.indices((80, 80))
    for degrees in (0.0, 30.0, 75.0, -40.0, 90.0):
        a = np.radians(degrees)
        stripes = np.sin(0.9 * (x * np.sin(a) + y * np.cos(a)))  # constant along (cos a, -sin a), y down
        angle, coherency, _ = structure(stripes)
        off = np.radians(angle[20:60, 20:60] - degrees)
        assert np.degrees(np.abs(np.arctan(np.tan(off)))).max() < 0.5
        assert coherency[20:60, 20:60].min() > 0.98
        assert angle.max() <= 90.0
        assert angle.min() > -90.0


@pytest.mark.parametrize(("mirrored", "facing"), [(False, np.pi), (True, 0.7)])
def test_a_slice_is_the_flow_inside(mirrored, facing):
    options = {"slice_um": 0.0, "slice_z": 1.3, "noise_mm_per_s": 0.0, "points": 40, "times": [1.0]}
    seen = shown("mrv", mirrored=mirrored, facing=facing, **options)
    flow = cy.vacuole.flow(RUN, t=1.0)
    side = 1.1 * (2 * (np.arange(40) + 0.5) / 40 - 1)
    right, up = np.meshgrid(side, side[::-1])
    r = np.hypot(right, up)
    inside = r < 0.9
    theta = facing + np.where(mirrored, -1, 1) * np.arctan2(up, right)
    points = np.stack([r[inside], theta[inside], np.full(inside.sum(), 1.3)], -1)
    speed = seen.data["speed"].values[0]
    np.testing.assert_allclose(speed[inside] / 0.1, flow.at(points)[:, 2], atol=4e-3)
    outside = speed[r > 1.05]
    assert outside.std() > 0.08  # noise up to the velocity at which the phase wraps, 0.2 mm/s
    assert np.abs(outside).max() <= 0.2 + 1e-6


def test_fast_water_wraps_and_thick_slices_average():
    plain, wrapped = (
        shown("mrv", noise_mm_per_s=0.0, venc_mm_per_s=v).data["speed"].values[0] for v in (1, 0.05)
    )
    inside = shown("mrv").data["inside"].values
    np.testing.assert_allclose(np.mod(plain[inside] + 0.05, 0.1) - 0.05, wrapped[inside], atol=1e-6)
    assert np.abs(plain[inside]).max() > 0.06
    period = 1000 * LENGTH * 0.5
    thick = shown("mrv", noise_mm_per_s=0.0, slice_um=period).data["speed"].values[0]
    rows = np.where(inside, thick, np.nan)
    assert np.nanmax(np.abs(rows - rows[:, ::-1])) < 2e-3  # the wave along z is gone; sin θ is symmetric


def test_half_a_period_leaves_two_over_pi_of_its_wave():
    """The mean of cos q z over half of its period is 2/π of its peak."""
    period = 1000 * LENGTH * 0.5
    options = {"noise_mm_per_s": 0.0, "slice_z": 0.7, "points": 24}
    thin, half, whole = (
        shown("mrv", slice_um=share * period, **options).data["speed"].values[0] for share in (0.0, 0.5, 1.0)
    )
    wave = (thin - whole)[8:16, 8:16]
    assert np.abs(wave).max() > 0.003
    np.testing.assert_allclose((half - whole)[8:16, 8:16], 2 / np.pi * wave, atol=1e-6)


def test_particles_are_carried_by_a_method_of_fourth_order(monkeypatch):
    """In u = (1 + t) e_z x r a particle turns by t + t²/2."""
    body = SimpleNamespace(
        times=[0.0, 1.0],
        velocity=lambda at, t: (1 + t) * np.stack([-at[1], at[0], 0 * at[2]]),
        held=lambda at: at,
    )
    off = []
    for longest in (0.2, 0.1):
        monkeypatch.setattr(tracers, "FARTHEST", longest)
        end = tracers.carried(body, np.array([[1.0], [0.0], [0.3]]), 0.0, 2.0)
        off.append(np.abs(end[:, 0] - [np.cos(4.0), np.sin(4.0), 0.3]).max())
    assert off[1] < 1e-3
    assert np.log2(off[0] / off[1]) == pytest.approx(4.0, abs=0.4)


def table(path, skip, delimiter=None):
    return np.genfromtxt(path, skip_header=skip, delimiter=delimiter)


def test_files_of_vectors(tmp_path):
    seen = shown("piv", noise_px=0.1, outliers=0.05, size_px=(180, 150))
    data = seen.data
    masked = data["mask"].values.ravel()
    vx, vy = (data[name].values[1].ravel() for name in ("vx", "vy"))
    x, y = (part.ravel() for part in np.meshgrid(data["x"], data["y"]))
    paths = seen.write(tmp_path / "raw", "openpiv")
    assert [p.name for p in paths] == ["piv_0001.txt", "piv_0002.txt", "piv_0003.txt", "view.json", "piv.png"]
    assert paths[0].read_text().startswith("# x\ty\tu\tv\tflags\tmask\n")
    rows = table(paths[1], 1)
    np.testing.assert_allclose(rows[:, :2], np.stack([x, y], -1), rtol=1e-4)
    np.testing.assert_allclose(rows[~masked, 2:4], np.stack([vx, vy], -1)[~masked], rtol=2e-4)
    np.testing.assert_array_equal(rows[masked, 2:4], 0.0)
    np.testing.assert_array_equal(rows[:, 5], masked)
    np.testing.assert_array_equal(rows[:, 4], data["flag"].values[1].ravel())
    up = table(seen.write(tmp_path / "up", "openpiv-um")[1], 1)
    factor = seen.camera.pixel_um
    np.testing.assert_allclose(up[:, 1], factor * (y.max() + y.min() - y), rtol=1e-4)
    np.testing.assert_allclose(up[~masked, 3], -factor / 0.3 * vy[~masked], rtol=2e-4)
    text = seen.write(tmp_path / "pivlab", "pivlab")[1]
    assert b"\r\n" in text.read_bytes()
    lab = table(text, 3, ",")
    order = np.lexsort((lab[:, 0], lab[:, 1]))
    np.testing.assert_array_equal(lab[: len(data["y"]), 0], x[0])  # columns first
    np.testing.assert_allclose(lab[order, 2], np.where(masked, np.nan, vx), rtol=1e-6)
    np.testing.assert_array_equal(lab[order, 4] == 0, masked)
    from scipy.io import loadmat

    session = loadmat(seen.write(tmp_path / "mat", "pivlab-mat")[0])
    assert session["u_original"].shape == (3, 1)
    np.testing.assert_allclose(session["v_original"][1, 0].ravel(), vy)
    flow = np.load(seen.write(tmp_path / "npy", "npy")[1])
    np.testing.assert_allclose(flow.reshape(2, -1), [vy, vx], rtol=1e-6)  # down first
    truth = json.loads((tmp_path / "raw" / "view.json").read_text())
    assert View.from_dict(truth["view"]) == seen.camera.view
    assert truth["times"] == [0.0, 1.0, 2.0]
    assert (truth["read"]["y"], truth["read"]["speed"]) == ("down", "px/frame")


def test_files_of_tracks(tmp_path):
    seen = shown("tracks", frames=5)
    data, um = seen.data, seen.camera.pixel_um
    lines = seen.write(tmp_path / "mate")[0].read_text().splitlines()
    assert lines[0].startswith("LABEL,ID,TRACK_ID,QUALITY,POSITION_X")
    assert "(micron)" in lines[3]
    rows = [line.split(",") for line in lines[4:]]
    assert all(len(row) == len(lines[0].split(",")) for row in rows)
    np.testing.assert_allclose([float(row[5]) for row in rows], um * data["y"].values, atol=1e-4)
    xml = seen.write(tmp_path / "xml", "trackmate-xml")[0].read_text()
    assert len(re.findall("<detection", xml)) == data.sizes["spot"]
    assert f'nTracks="{len(np.unique(data["track"]))}"' in xml
    head, *rest = seen.write(tmp_path / "py", "trackpy")[0].read_text().splitlines()
    assert head.startswith(",y,x,mass")
    frames = [int(line.split(",")[9]) for line in rest]
    assert frames == sorted(frames)


@pytest.mark.slow
def test_files_of_pictures(tmp_path):
    from PIL import Image

    line = shown("kymograph", frames=20)
    picture = Image.open(line.write(tmp_path / "line")[0])
    np.testing.assert_array_equal(np.asarray(picture), line.data["image"].values)
    assert "finterval=0.3" in picture.tag_v2[270]
    assert float(picture.tag_v2[282]) == pytest.approx(1 / line.camera.pixel_um, rel=1e-5)
    shot = shown("film", frames=3)
    stack = Image.open(shot.write(tmp_path / "stack", "tiff")[0])
    assert stack.n_frames == 3
    stack.seek(2)
    np.testing.assert_array_equal(np.asarray(stack), shot.data["frames"].values[2])
    water = shown("mrv")
    np.testing.assert_array_equal(
        np.asarray(Image.open(water.write(tmp_path / "mrv")[0])), water.data["speed"].values[0]
    )
    import av

    for format, close in (("avi", 6.0), ("mp4", 6.0)):
        with av.open(str(shot.write(tmp_path / format, format)[0])) as film:
            frames = [frame.to_ndarray(format="gray").astype(float) for frame in film.decode(video=0)]
            assert float(film.streams.video[0].average_rate) == pytest.approx(1 / 0.3, rel=1e-3)
        assert len(frames) == 3
        assert np.abs(frames[1] - shot.data["frames"].values[1]).mean() < close
    angles = shown("orientation", radius=40.0)
    names = [path.name for path in angles.write(tmp_path / "angles")]
    assert names == ["orientationj_0001.csv", "filaments_0001.tif", "view.json", "orientation.png"]
    rows = table(tmp_path / "angles" / names[0], 1, ",")
    np.testing.assert_allclose(np.degrees(np.arctan2(rows[:, 5], -rows[:, 4])), rows[:, 6], atol=0.02)
    column, row = rows[:, 1].astype(int), rows[:, 2].astype(int)
    np.testing.assert_allclose(angles.data["angle"].values[0][row, column], rows[:, 6], atol=1e-3)


def test_a_closed_cell_is_seen_from_the_side():
    grid = cy.ClosedGrid(cy.Capsule(), k_max=12)
    turning = np.stack([grid.r * np.ones(grid.shape), np.zeros(grid.shape)])  # rigidly about the axis
    dims = ("time", "component", "theta", "s")
    coords = {"time": [0.0], "component": ["theta", "s"], "theta": grid.theta, "s": grid.s}
    data = xarray.Dataset({"P": (dims, turning[None]), "u": (dims, turning[None])}, coords)
    data = data.assign(
        r=("s", grid.r),
        z=(("theta", "s"), np.broadcast_to(grid.z, grid.shape)),
        area_weight=(("theta", "s"), grid.weights),
    )
    body = body_of(data)
    assert body.area == pytest.approx(grid.area, rel=1e-4)
    xyz = body.scattered(200, np.random.default_rng(0))
    np.testing.assert_allclose(body.velocity(xyz, 0.0), np.cross([0, 0, 1], xyz.T).T, atol=2e-3)
    seen = observe(data, View(50.0, 90.0), "piv", pixel_um=10.0, noise_px=0.0, window_px=6, step_px=6)
    camera = seen.camera
    x, y = np.meshgrid(seen.data["x"], seen.data["y"])
    xyz, _ = camera.near(body, x, y)
    good = ~seen.data["mask"].values
    assert 0.3 < good.mean() < 0.8
    # With +z up, the near side moves to the right, by its distance from the plane of the rim.
    ahead = camera.out @ xyz[:, good]
    # A window averages over the curved surface, with weights 1/cos φ: that lowers cos φ by the square of its
    # width (4 pixels: 0.0024 instead of 0.0054 at 0.7), whatever k_max is.
    for least, share in ((0.9, 0.002), (0.7, 0.006), (0.5, 0.025)):
        deep = ahead > least
        expected = ahead[deep] * camera.px_per_frame
        np.testing.assert_allclose(seen.data["vx"].values[0][good][deep], expected, rtol=share)
    np.testing.assert_allclose(seen.data["vy"].values[0][good], 0.0, atol=1e-12)
    assert observe(data, View(30.0), "film", frames=2).data.sizes["time"] == 2
    with pytest.raises(cy.InputError, match="vacuole of a closed cell"):
        observe(data, View(30.0), "mrv")


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("piv", {"frames": 3}, "frames = 3 .* an option of piv"),
        ("piv", {"times": [5.0]}, "times = 5"),
        ("piv", {"window_px": 5000}, "window_px"),
        ("film", {"frames": 1}, "frames = 1"),
        ("film", {"frames": 500, "start": 1.0}, "frames = 500 .* at most"),
        ("film", {"start": 9.0}, "start = 9"),
        ("kymograph", {"at": 85.0}, "at = 85"),
        ("kymograph", {"line": "around"}, "line = 'around'"),
        ("movie", {}, "as_ = 'movie'"),
        ("mrv", {"venc_mm_per_s": 0.0}, "venc_mm_per_s"),
        ("piv", {"depth_um": -1.0}, "depth_um"),
        ("piv", {"pixel_um": 0.0}, "pixel_um"),
        ("piv", {"size_px": 3}, "size_px = 3"),
    ],
)
def test_what_cannot_be_used_is_refused(kind, options, message):
    with pytest.raises(cy.InputError, match=message):
        observe(RUN, View(40.0), kind, **options)


def test_seeds_repeat_and_differ():
    one, same, other = (shown("piv", seed=seed).data["vx"].values for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other, equal_nan=True)


@pytest.mark.slow
def test_the_command(tmp_path):
    grid = cy.CylinderGrid(16, 16)
    run = cy.simulate(cy.Parameters(), grid, cy.initial.stripes(grid), t_end=2.0)
    file = cy.write(run, tmp_path / "run.nc")
    words = ["observe", str(file), "--radius-px", "40", "--pixel-um", "12.5", "--axis", "17", "--out"]
    code, out, err = said(*words, str(tmp_path / "seen"), "--as", "piv", "--format", "pivlab")
    assert (code, err) == (0, "")
    assert "PIVlab_0003.txt" in out
    assert (tmp_path / "seen" / "piv.png").stat().st_size > 10_000
    code, _, err = said(*words, str(tmp_path / "seen"), "--format", "pivlab")
    assert code == 2
    assert "exists" in err or "--force" in err
    code, out, _ = said(*words, str(tmp_path / "both"), "--as", "piv+mrv", "--times", "1")
    assert code == 0
    assert (tmp_path / "both" / "mrv" / "view.json").is_file()
    code, _, err = said(*words, str(tmp_path / "x"), "--as", "film", "--format", "pivlab")
    assert code == 2
    assert "format = 'pivlab'" in err


def test_every_kind_has_formats_and_a_writer():
    from cyclosis.observations.microscope.files import WRITERS

    assert set(WRITERS) == {(kind, name) for kind, names in FORMATS.items() for name in names}
