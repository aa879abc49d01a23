import subprocess
import sys

import av
import numpy as np
import pytest
import xarray
from PIL import Image

import cyclosis as cy
from cyclosis.figures import clock, encode, scene
from cyclosis.figures.movie import movie
from cyclosis.figures.tracers import SEPARATION, Tracers

GRID = cy.CylinderGrid(24, 16, 4.0)
THETA = GRID.theta[:, None] + 0 * GRID.z
STRIPES = np.stack([0 * THETA, 0.9 * np.sin(THETA)])


@pytest.fixture(scope="module")
def run():
    times = np.array([0.0, 1.0, 3.0, 10.0])
    share = np.array([0.05, 0.5, 1.0, 1.0])[:, None, None, None]
    dims = ("time", "component", "theta", "z")
    coords = {"time": times, "component": ["theta", "z"], "theta": GRID.theta, "z": GRID.z}
    data = {"P": (dims, share * STRIPES), "u": (dims, share**3 * STRIPES)}
    return xarray.Dataset(data, coords, {"length": GRID.length})


def decoded(path):
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        return frames, container.duration / av.time_base, stream.codec_context


def shown(gif):
    """Return for how many seconds each picture of an open GIF stands, as its file says."""
    return [gif.info["duration"] / 1000 for k in range(gif.n_frames) if gif.seek(k) is None]


def painted(path, frames, seconds):
    """Write a movie of small pictures, all different, and return its path."""
    with encode.Output(path, frames, seconds) as output:
        for k in range(frames):
            picture = np.zeros((16, 64, 3), dtype=np.uint8)
            picture[k % 16, k // 16 % 64] = 255
            output.add(picture)
    return path


LASTING = [
    (30, 1.0),
    (60, 2.0),
    (144, 12.0),
    (144, 5.0),
    (25, 1.7),
    (7, 10.0),
    (2, 0.1),
    (24, 1.001),
    (91, 3.1415),
    (2, 1200.0),
    (500, 0.37),
]
"""Numbers of frames and seconds: usual rates, uneven ones, very slow ones, and faster than a GIF can be."""


@pytest.mark.parametrize(("frames", "seconds"), LASTING)
def test_an_mp4_lasts_the_seconds_asked_for(frames, seconds, tmp_path):
    path = painted(tmp_path / "a.mp4", frames, seconds)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        times = [frame.time for frame in container.decode(stream)]
        lasting = container.duration / av.time_base, float(stream.duration * stream.time_base)
    assert lasting == pytest.approx((seconds, seconds), abs=1e-3)
    assert times == pytest.approx(np.arange(frames) * seconds / frames, abs=1e-3)


@pytest.mark.parametrize(("frames", "seconds"), LASTING)
def test_a_gif_lasts_the_seconds_asked_for(frames, seconds, tmp_path):
    path = painted(tmp_path / "a.gif", frames, seconds)
    with Image.open(path) as gif:
        lasting = np.array(shown(gif))
        ends = [np.asarray(gif.convert("RGB")) for k in (0, gif.n_frames - 1) if gif.seek(k) is None]
    assert lasting.sum() == pytest.approx(seconds, abs=0.0051)
    assert lasting.size == min(frames, round(100 * seconds) // 2)
    assert np.ptp(lasting) <= 0.01 + 1e-9
    assert lasting.min() >= 0.02  # browsers slow down what is faster
    bright = [np.argwhere(picture[..., 0] > 128).tolist() for picture in ends]
    assert bright == [[[k % 16, k // 16 % 64]] for k in (0, frames - 1)]
    with av.open(str(path)) as container:  # another decoder says the same
        assert container.duration / av.time_base == pytest.approx(seconds, abs=0.0051)


def test_a_picture_that_stays_as_it_is_counts_as_well(tmp_path):
    with encode.Output(tmp_path / "a.gif", 30, 1.0) as output:
        for k in range(30):
            output.add(np.full((16, 64, 3), 255 * (k // 10 % 2), dtype=np.uint8))
    with Image.open(tmp_path / "a.gif") as gif:
        assert sum(shown(gif)) == pytest.approx(1.0)


def test_a_gif_of_too_few_frames_is_refused(run, tmp_path):
    with pytest.raises(cy.InputError, match=r"frames = 2 .* at least 6 for a GIF of 3600 seconds"):
        movie(run, [tmp_path / "a.mp4", tmp_path / "a.gif"], frames=2, seconds=3600)
    assert list(tmp_path.iterdir()) == []


def test_both_kinds_from_one_drawing_in_other_processes(run, tmp_path):
    seen = []
    paths = [tmp_path / "run.mp4", str(tmp_path / "run.GIF")]
    made = movie(
        run, paths, frames=9, seconds=1.5, height=180, workers=2, progress=lambda *now: seen.append(now)
    )
    assert [str(path) for path in made] == [str(path) for path in paths]
    assert seen == [(k, 9) for k in range(1, 10)]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.GIF", "run.mp4"]
    frames, duration, codec = decoded(paths[0])
    assert len(frames) == 9
    assert frames[0].shape == (180, 320, 3)
    assert duration == pytest.approx(1.5)
    assert (codec.name, codec.pix_fmt) == ("h264", "yuv420p")
    data = paths[0].read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")  # plays while it loads
    with Image.open(paths[1]) as gif:
        assert (gif.n_frames, gif.size) == (9, (320, 180))
        assert gif.info["loop"] == 0
        assert shown(gif) == pytest.approx([0.16, 0.17, 0.17] * 3)  # 1.5 s together
        assert gif.convert("RGB").getpixel((2, 2)) == (255, 255, 255)


def test_a_movie_shows_the_run_and_is_the_same_again(run, tmp_path):
    for name in ("a.mp4", "b.mp4"):
        movie(run, tmp_path / name, frames=4, height=180, workers=1)
    first, second = (decoded(tmp_path / name)[0] for name in ("a.mp4", "b.mp4"))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))
    # Where the map is, disorder is dark and order light.
    assert first[0][20:130, 120:240].mean() < 0.5 * first[-1][20:130, 120:240].mean()


def test_time_runs_on_and_lingers_where_much_happens():
    times = np.array([0.0, 1.0, 3.0, 10.0, 200.0])
    shown = clock.movie_times(times, np.array([0.0, 0.0, 1.0, 1.1, 1.1]), 121)
    assert shown[[0, -1]] == pytest.approx([0.0, 200.0])
    assert np.all(np.diff(shown) > 0)
    assert np.sum((shown >= 1) & (shown <= 3)) > 60
    still = clock.movie_times(times, np.zeros(5), 11)
    assert np.sqrt(still) == pytest.approx(np.sqrt(200) * np.linspace(0, 1, 11), abs=1e-3)
    later = clock.movie_times(times + 50, np.zeros(5), 11)
    assert later == pytest.approx(still + 50)


def test_lines_stream_and_do_not_jump():
    tracers = Tracers(GRID, fade=5)
    before = tracers.advance(STRIPES, 0.9, 0.06)
    assert len(before) > 20
    for _ in range(20):
        heads, shown = tracers.heads.copy(), tracers.shown.copy()
        ribbons = tracers.advance(STRIPES, 0.9, 0.06)
        assert len(ribbons) == tracers.shown.size == tracers.heads.shape[1]
        # Lines keep their order; those that live on have moved along the flow, as fast as it is there.
        expected = heads[1] + 0.06 * np.sin(heads[0])
        for k in np.flatnonzero(shown > 0.3):
            j = np.flatnonzero(np.abs(tracers.heads[0] - heads[0, k]) < 1e-9)
            assert np.abs(tracers.heads[1, j] - expected[k]).min() < 1e-3
        assert np.abs(np.sort(tracers.shown) - np.clip(np.sort(tracers.shown), 0, 1)).max() == 0
    assert tracers.advance(0 * STRIPES, 0.0, 0.06) == []


def test_lines_are_spread_over_the_whole_surface():
    tracers = Tracers(GRID, fade=2)
    uniform = np.stack([0 * THETA, 1 + 0 * THETA])
    for _ in range(10):
        tracers.advance(uniform, 1.0, 0.05)
    angles = np.sort(np.mod(tracers.heads[0], 2 * np.pi))
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < 3 * SEPARATION


@pytest.mark.parametrize("length", [0.3, 4.0, 40.0])
@pytest.mark.parametrize("height", [180, 270])
def test_frames_have_the_size_asked_for(length, height):
    grid = cy.CylinderGrid(16, 16, length)
    P = np.stack([np.zeros(grid.shape), np.sin(grid.theta)[:, None] + np.zeros(grid.shape)])
    stage = scene.SceneLayout(scene.Scene(grid, np.array([0.0, 9.0]), np.array([0.1, 0.9]), height))
    picture = stage.drawn(scene.Shot(P, P, [], 0.0, 4.0, 0.5))
    assert picture.shape == (height, height * 16 // 9, 3)
    again = stage.drawn(scene.Shot(P, P, [], 0.0, 4.0, 0.5))
    assert np.array_equal(picture, again)  # nothing of the frame before is left


def test_workers_load_little():
    code = "import cyclosis.figures.scene, sys; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"jax", "xarray", "pandas", "h5netcdf", "av"} & set(out.stdout.split())


@pytest.mark.parametrize(
    ("name", "arguments", "field"),
    [
        ("a.avi", {}, r"ends in \.mp4 or \.gif"),
        ("a", {}, r"ends in \.mp4 or \.gif"),
        ("missing/a.mp4", {}, "written to"),
        ("a.mp4", {"frames": 1}, "frames"),
        ("a.mp4", {"seconds": 0}, "seconds"),
        ("a.mp4", {"turns": np.nan}, "turns"),
        ("a.mp4", {"height": 100}, "height"),
        ("a.mp4", {"workers": 0}, "workers"),
    ],
)
def test_bad_arguments_are_refused(run, tmp_path, name, arguments, field):
    with pytest.raises(cy.InputError, match=field):
        movie(run, tmp_path / name, **arguments)
    assert list(tmp_path.iterdir()) == []


def test_other_bad_input_is_refused(run, tmp_path):
    with pytest.raises(cy.InputError, match="saved frames"):
        movie(run.isel(time=[0]), tmp_path / "a.mp4")
    with pytest.raises(cy.InputError, match="paths"):
        movie(run, [])
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(cy.InputError, match="file name"):
        movie(run, tmp_path / "folder.mp4")


def test_a_movie_that_fails_leaves_what_was_there(run, tmp_path):
    target = tmp_path / "a.mp4"
    target.write_bytes(b"before")

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        movie(run, target, frames=3, height=180, workers=1, progress=stop)
    assert target.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]


@pytest.mark.slow
def test_an_unguarded_script_is_told_so(run, tmp_path):
    run.to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    script = tmp_path / "script.py"
    script.write_text(
        "import xarray\n"
        "from cyclosis.figures import movie as figure\n"
        "class Output(figure.Output):\n"
        "    def __init__(self, *arguments):\n"
        "        print('opened', flush=True)\n"
        "        super().__init__(*arguments)\n"
        "figure.Output = Output\n"
        "data = xarray.open_dataset('run.nc', engine='h5netcdf')\n"
        "figure.movie(data, 'run.mp4', frames=3, workers=2)\n"
    )
    out = subprocess.run([sys.executable, script.name], cwd=tmp_path, capture_output=True, text=True)
    assert out.returncode == 1
    assert "give 1, or guard the script" in out.stderr
    # A process that runs the script again opens no file: it may be ended before it could remove it.
    assert out.stdout.split() == ["opened"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.nc", "script.py"]
