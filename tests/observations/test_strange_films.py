"""Films unlike those of the synthetic microscope, and the errors that are given for displacements."""

import importlib

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, shift

import cyclosis as cy
from cyclosis.observations import film
from cyclosis.observations.films import measuring, moving, steady, trial
from observed import RUN

pytest.importorskip("skimage")
strangers = importlib.import_module("strangers")
SMALL = {"shape": (150, 200), "radius": 60.0}


def texture(rng, shape=(96, 120), density=0.02, size=1.5):
    return gaussian_filter((rng.random(shape) < density) * 1.0, size) * 2 * np.pi * size**2


def moved(picture, right, down):
    return shift(picture, (down, right), order=5, mode="nearest").astype(np.float32)


@pytest.mark.parametrize(("noise", "radius"), [(0.05, 10), (0.2, 10), (0.2, 16)])
def test_errors_of_displacements_are_those_that_are_given(noise, radius):
    """A translation: the rms of what is off, and the rms of the errors that are given, agree."""
    off, given = [], []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        one = texture(rng)
        first, second = moved(one, -0.6, 0.35), moved(one, 0.6, -0.35)
        first, second = (each + noise * rng.normal(size=one.shape).astype("f4") for each in (first, second))
        flow = moving.between(first, second, radius)
        inside = np.s_[16:-16, 16:-16]
        off.append((flow.v - np.array([1.2, -0.7])[:, None, None])[(slice(None), *inside)])
        given.append(flow.error[inside])
        assert flow.consistent[inside].mean() > 0.95
    ratio = np.sqrt(np.mean(np.square(off)) / np.mean(np.square(given)))
    assert 0.75 < ratio < 1.35


def test_errors_grow_with_noise_and_fall_with_the_window():
    rng = np.random.default_rng(0)
    one = texture(rng).astype(np.float32)
    found = {}
    for noise in (0.05, 0.1):
        a, b = (one + noise * rng.normal(size=one.shape).astype("f4") for _ in range(2))
        for width in (4.0, 8.0):
            found[noise, width] = np.median(moving.standard_error(a, b, width)[20:-20, 20:-20])
    # The error goes as the noise, and as one by the width of the window.
    assert found[0.1, 4.0] / found[0.05, 4.0] == pytest.approx(2, rel=0.15)
    assert found[0.05, 4.0] / found[0.05, 8.0] == pytest.approx(2, rel=0.15)


def test_errors_do_not_depend_on_how_the_picture_is_turned():
    """Light that varies more across than along: the error of either direction turns with it."""
    rows, columns = np.indices((160, 160))
    found = []
    for angle in (0.0, np.pi / 4, 1.9):
        across = np.cos(angle) * columns + np.sin(angle) * rows
        along = np.cos(angle) * rows - np.sin(angle) * columns
        light = 3 * np.sin(0.7 * across) + np.sin(0.7 * along)
        noise = 0.05 * np.random.default_rng(0).normal(size=(2, 160, 160))
        error = moving.standard_error(*(light + noise).astype(np.float32), 6.0)
        found.append(np.median(error[30:-30, 30:-30]))
    assert found[1:] == pytest.approx([found[0]] * 2, rel=0.08)


def drawn(count, speed, seed=0, still=0.0, noise=0.05):
    """Frames of a texture that moves to the right, over one that stands still."""
    rng = np.random.default_rng(seed)
    wide = texture(rng, (96, 120 + 200))
    rest = still * gaussian_filter(rng.normal(size=(96, 120)), 2.0) * 5
    frames = [moved(wide, speed * k, 0.0)[:, 150:270] + rest for k in range(count)]
    return np.stack(frames).astype(np.float32) + noise * rng.normal(size=(count, 96, 120)).astype(np.float32)


def test_slow_films_are_compared_over_more_frames():
    frames = drawn(13, 0.4)
    live = np.ones(frames.shape[1:], dtype=bool)
    plan, fastest = trial.planned(frames, live, None, None, None)
    assert plan.gap > 2
    assert fastest == pytest.approx(0.4 * plan.gap, rel=0.1)
    assert trial.planned(frames, live, 12, 1, 1)[0] == trial.Plan(12, 1, 1)
    plan, fastest = trial.planned(drawn(5, 3.0), live, None, None, None)
    assert (plan.gap, plan.radius, plan.average) == (1, moving.RADIUS, 1)
    assert fastest == pytest.approx(3.0, rel=0.05)


def test_noisy_films_get_larger_windows_and_means():
    frames = drawn(9, 2.0, noise=0.25)
    live = np.ones(frames.shape[1:], dtype=bool)
    plan, fastest = trial.planned(frames, live, None, None, None)
    assert plan.radius > moving.RADIUS
    film_ = measuring.Prepared(frames, np.arange(9.0), live, 1)
    errors = []
    for average in (1, 4):
        mean = measuring.mean_velocity(film_, 2, trial.Plan(15, 1, average), fastest)
        errors.append((mean.v[0] - 2.0)[mean.good].std())
        assert mean.good.mean() > 0.5
    # Noise of a frame cancels between two pairs that share it: the mean of four is that of the ends.
    assert errors[1] < errors[0] / 2


def test_what_stands_still_in_a_short_film():
    mixed, plain = drawn(12, 3.0, still=0.5), drawn(12, 3.0)
    clear = trial.without_still(mixed, None)
    flow = moving.between(clear[5], clear[6])
    inside = np.s_[:, 20:-20, 20:-20]
    biased = moving.between(mixed[5], mixed[6])
    assert abs(np.median(flow.v[inside][0]) - 3.0) < 0.15
    assert abs(np.median(biased.v[inside][0]) - 3.0) > 0.5
    assert trial.without_still(plain[:5], None) is not clear
    np.testing.assert_array_equal(trial.without_still(plain[:5], None), plain[:5])
    np.testing.assert_array_equal(trial.without_still(plain[:2], None), plain[:2])


def test_a_stage_that_drifts_under_a_stream():
    """Light at rest shows the drift, though a stream crosses most of the picture."""
    rng = np.random.default_rng(3)
    rest = 4 * gaussian_filter(rng.normal(size=(180, 240)), 2.5)
    wide = texture(rng, (180, 240 + 200))
    wide[:40] = wide[-20:] = 0
    frames = [
        moved(rest, 0.3 * k, -0.2 * k) + 0.5 * moved(wide, 2.5 * k, -0.2 * k)[:, 120:360] for k in range(40)
    ]
    found = steady.drift(np.stack(frames).astype(np.float32))
    np.testing.assert_allclose(found[-1], [11.7, -7.8], atol=0.8)


def test_the_stage_drifts_in_a_short_film():
    """Two parts of ten frames each: the drift is that of the frames, from the first to the last."""
    rest = 4 * gaussian_filter(np.random.default_rng(3).normal(size=(120, 140)), 2.5)
    found = steady.drift(np.stack([moved(rest, 0.3 * k, -0.2 * k) for k in range(20)]))
    np.testing.assert_allclose(found[[0, 10, 19]], [[0.0, 0.0], [3.0, -2.0], [5.7, -3.8]], atol=0.3)


CASES = {
    "few spots": {"density": 1 / 300},
    "large spots": {"size": 3.5, "density": 1 / 200},
    "noise": {"bright": 30.0, "read": 5.0, "photons": 1.0},
    "spots come and go": {"life": 6.0, "frames": 8},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_films_of_another_renderer_come_back(name, tmp_path):
    """Two streams and what lies between, on a small picture: within 6 % of the peak."""
    options = {"start": 1.0, "speed": 6.0, "frames": 5, **CASES[name], **SMALL}
    flow = strangers.Surface(RUN)
    frames, step = strangers.rendered(flow, **options)
    seen = film(strangers.written(tmp_path / "film.mp4", frames), frame_s=strangers.FRAME_S, pairs=4)
    median, around, along, share = strangers.errors(flow, seen, 1.0, step, **SMALL)
    assert max(median, around, along) < 0.06
    assert share > 0.3


def test_how_pairs_are_measured_is_checked(tmp_path):
    frames, _ = strangers.rendered(strangers.Surface(RUN), start=1.0, frames=3, density=1 / 400, **SMALL)
    path = strangers.written(tmp_path / "film.mp4", frames)
    for given in ({"gap": 0}, {"average": 1.5}, {"window_px": 1}, {"gap": 2, "average": 2}):
        with pytest.raises(cy.InputError):
            film(path, **given)
