"""Velocities from films: those of the model come back, and films that tell nothing are refused."""

from pathlib import Path

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.observations import View, film, observe
from cyclosis.observations.films import light, reading, steady
from cyclosis.observations.microscope.files import WRITERS
from observed import RUN, velocity


def shot(folder, format, axis=17.0, mirrored=False, **options):
    view = View(60.0, axis, mirrored=mirrored)
    chosen = {"frames": 3, "start": 1.0, "size_px": (240, 200), "frame_s": 0.3} | options
    seen = observe(RUN, view, "film", pixel_um=500 / 60, **chosen)
    return seen, written(seen, folder, format)


def written(seen, folder, format):
    """Write the film alone, without the picture and the truth that come with it."""
    folder.mkdir(exist_ok=True)
    ((name, put),) = WRITERS["film", format](seen).items()
    put(folder / name)
    return folder / name


def error(seen, camera, start=1.0):
    """The rms error of both components on the surface, |φ| < 60°, in units of the peak speed there."""
    view, parts = camera.view, []
    unit = camera.scales.time_s
    for frame in seen.frames:
        theta, z, cos_phi = view.to_surface(frame.x, frame.y)
        good = frame.good & (cos_phi > 0.5)
        assert good.sum() > 100
        u = np.stack(view.velocity_to_surface(frame.x, frame.y, frame.vx, frame.vy)) * unit
        true = velocity(theta, z, start + frame.time / unit)
        parts.append(((u - true)[:, good] ** 2).mean(axis=1) / (true[:, good] ** 2).sum(axis=0).max())
    return np.sqrt(np.mean(parts, axis=0))


@pytest.mark.parametrize(
    ("axis", "mirrored", "format"), [(17.0, False, "avi"), (-63.0, True, "mp4"), (200.0, False, "mp4")]
)
@pytest.mark.slow
def test_films_of_the_model_come_back(axis, mirrored, format, tmp_path):
    pytest.importorskip("skimage")
    made, path = shot(tmp_path, format, axis, mirrored)
    told = []
    seen = film(path, frame_s=0.3, progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 2), (2, 2)]
    assert seen.time_unit == "s"
    assert len(seen.frames) == 2
    assert error(seen, made.camera).max() < 0.06


@pytest.mark.slow
def test_a_fading_lamp_changes_nothing(tmp_path):
    pytest.importorskip("skimage")
    made, _ = shot(tmp_path / "a", "avi", frames=4)
    frames = made.data["frames"].values
    faded = frames * np.array([1.0, 0.8, 0.65, 0.5])[:, None, None]
    made.data["frames"].values[:] = faded.astype(np.uint8)
    seen = film(written(made, tmp_path / "b", "avi"), frame_s=0.3)
    assert error(seen, made.camera).max() < 0.06
    assert seen.noise_px < 0.1


@pytest.mark.slow
def test_nothing_moves(tmp_path):
    pytest.importorskip("skimage")
    made, _ = shot(tmp_path / "a", "avi", frames=4)
    rng = np.random.default_rng(0)
    still = made.data["frames"].values[0] + 2 * rng.normal(size=made.data["frames"].shape)
    made.data["frames"].values[:] = np.clip(still, 0, 255).astype(np.uint8)
    with pytest.raises(cy.InputError, match="in which something moves"):
        film(written(made, tmp_path / "b", "avi"), frame_s=0.3)
    made.data["frames"].values[:] = made.data["frames"].values[:1]
    with pytest.raises(cy.InputError, match="in which something moves"):
        film(written(made, tmp_path / "c", "avi"), frame_s=0.3)


def test_videos_are_read_with_their_times(tmp_path):
    made, path = shot(tmp_path, "mp4", frames=6)
    read = reading.read(path, (0, None), 1, "luma")
    assert read.pictures.shape == made.data["frames"].shape
    np.testing.assert_allclose(read.times, 0.3 * np.arange(6), atol=2e-3)
    assert np.abs(read.pictures - made.data["frames"].values).mean() < 6
    some = reading.read(path, (1, 6), 2, "green")
    np.testing.assert_allclose(some.times, [0.3, 0.9, 1.5], atol=2e-3)
    with pytest.raises(cy.InputError, match="at least two frames"):
        reading.read(path, (5, None), 1, "luma")


def test_stacks_are_read(tmp_path):
    pytest.importorskip("tifffile")
    made, path = shot(tmp_path, "tiff")
    read = reading.read(path, (0, None), 1, "luma")
    np.testing.assert_array_equal(read.pictures, made.data["frames"].values)
    np.testing.assert_allclose(read.times, [0.0, 0.3, 0.6])
    assert read.pixel_um == pytest.approx(500 / 60, rel=1e-5)


@pytest.mark.parametrize("content", [b"", b"RIFF" + bytes(300), bytes(range(256)) * 20])
def test_files_that_are_no_films(content, tmp_path):
    path = tmp_path / "film.avi"
    path.write_bytes(content)
    with pytest.raises(cy.InputError, match="a film that can be read"):
        reading.read(path, (0, None), 1, "luma")
    with pytest.raises(cy.InputError, match="check the path"):
        reading.read(Path("nowhere.mp4"), (0, None), 1, "luma")


def test_a_film_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path):
    _, path = shot(tmp_path, "avi", frames=8)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    assert 2 <= len(reading.read(path, (0, None), 1, "luma").pictures) < 8


def test_large_pictures_are_averaged():
    kept = reading._Kept(Path("film"))
    picture = np.arange(1201 * 1602, dtype=np.float32).reshape(1201, 1602)
    kept.add(picture)
    assert kept.binned == 2
    np.testing.assert_allclose(kept.pictures[0][3, 5], picture[6:8, 10:12].mean())
    with pytest.raises(cy.InputError, match="same size"):
        kept.add(picture[:600])


def test_the_light_is_made_even():
    rng = np.random.default_rng(0)
    texture = rng.normal(size=(80, 90)).astype(np.float32)
    lamp = np.linspace(60, 140, 90)
    even = light.flattened(np.stack([lamp + 5 * texture, 0.6 * lamp + 3 * texture]).astype(np.float32))
    assert np.corrcoef(even[0].ravel(), even[1].ravel())[0, 1] > 1 - 1e-6
    # The square root bends this ramp: a Gaussian of 10 pixels leaves 0.03 of its contrast at the dark end.
    assert abs(even[:, :, 20:40].mean() - even[:, :, 50:70].mean()) < 0.025
    assert lamp[-1] > 2 * lamp[0]


@pytest.mark.slow
def test_the_stage_drifts():
    pytest.importorskip("skimage")
    from scipy.ndimage import gaussian_filter, shift

    rng = np.random.default_rng(1)
    still = 10 * gaussian_filter(rng.normal(size=(160, 200)), 2.0)
    film_ = []
    for k in range(40):
        moving_ = gaussian_filter((rng.random((160, 200)) < 0.01) * 8.0, 1.0)
        film_.append(shift(still, (0.2 * k, -0.1 * k), mode="nearest") + moving_)
    found = steady.drift(np.stack(film_).astype(np.float32))
    np.testing.assert_allclose(found[-1], [-3.9, 7.8], atol=0.6)
    back = steady.steadied(np.stack(film_[::13]).astype(np.float32), found[::13])
    assert np.corrcoef(back[0, 20:-20, 20:-20].ravel(), back[-1, 20:-20, 20:-20].ravel())[0, 1] > 0.9


def test_two_streams_are_no_drift():
    pytest.importorskip("skimage")
    rng = np.random.default_rng(2)
    up, down = rng.normal(size=(2, 80, 400))
    frames = [np.concatenate([np.roll(up, k, 1), np.roll(down, -k, 1)])[:, :200] for k in range(24)]
    assert not steady.drift(np.stack(frames).astype(np.float32)).any()


def test_what_is_missing_is_said(monkeypatch, tmp_path):
    import sys

    monkeypatch.setitem(sys.modules, "skimage", None)
    with pytest.raises(cy.InputError, match=r"pip install 'cyclosis\[film\]'"):
        film(tmp_path / "film.avi")
