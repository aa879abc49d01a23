"""Fits of a film of u alone: small films of the model."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.fitting import matching, prepared
from cyclosis.fitting import search as searching
from cyclosis.fitting.geometry import Tilt, carried

NAMES = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu")
TRUTH = {
    "alpha_p": 1.3,
    "alpha_u": 0.8,
    "epsilon": 0.2,
    "d_s": 0.08,
    "d_r": 0.05,
    "kappa": 0.3,
    "mu": 0.1,
}


@pytest.fixture(scope="module")
def film():
    """A film of the flow of a small cell that the model's small grid resolves."""
    grid = cy.CylinderGrid(16, 16, 5.0)
    start = cy.interpolate(cy.initial.disordered(cy.CylinderGrid(8, 8, 5.0), 30.0, 5), grid.shape)
    run = cy.simulate(
        cy.Parameters(**TRUTH), grid, start, t_end=5.0, save_at=np.arange(1.5, 5.1, 0.25), rtol=1e-8
    )
    return run.to_dataset()[["P", "u"]]


def wrong(truth, by):
    """Return a start that is wrong by a factor in every parameter, up and down in turn."""
    signs = (1, -1, 1, -1, 1, -1, 1)
    return {"U": 1.0} | {name: truth[name] * by**sign for name, sign in zip(NAMES, signs, strict=True)}


@pytest.fixture
def small(monkeypatch):
    """A small model: 16 points either way and waves up to 6, beyond which the film has none.

    The search begins near the truth, because these tests are not about it.
    """
    monkeypatch.setattr(prepared, "START", wrong(TRUTH, 1.2))
    monkeypatch.setattr(prepared, "POINTS", 16)
    monkeypatch.setattr(prepared, "FINEST", 6.0)


def noisy(film, noise, seed=0):
    """Return the film of a window, with its attributes."""
    data, rng = film[["u"]].isel(theta=slice(2, 14)), np.random.default_rng(seed)
    return data.assign(u=data["u"] + noise * rng.normal(size=data["u"].shape))


KNOWN = {name: TRUTH[name] for name in ("epsilon", "d_r", "mu", "alpha_u")}
"""What is given where a test is to be quick."""


def near(fit, name, deviations=3.5):
    """Return whether the truth is within so many deviations: one draw in twenty lies outside an interval."""
    low, high = fit.interval[name]
    return abs(np.log(fit.estimate[name] / TRUTH[name])) < deviations * np.log(high / low) / (2 * 1.96)


@pytest.mark.slow
def test_an_exact_film_gives_the_parameters(film, small, monkeypatch):
    """From a start that is wrong by half."""
    monkeypatch.setattr(prepared, "START", wrong(TRUTH, 1.5))
    fit = cy.fit(film[["u"]].isel(theta=slice(2, 14)), method="film")
    assert fit.refused is None
    for name, truth in TRUTH.items():
        assert fit.estimate[name] == pytest.approx(truth, rel=0.003), name


@pytest.mark.slow
def test_some_parameters_of_a_small_film(film, small):
    data = noisy(film, 0.01)
    told = []
    fit = cy.fit(data, fix=KNOWN, method="film", progress=lambda done, total: told.append((done, total)))
    assert fit.refused is None
    for name in ("alpha_p", "d_s"):
        assert near(fit, name)
        assert fit.estimate[name] == pytest.approx(TRUTH[name], rel=0.1)
    assert 0.8 < fit.residual < 1.1
    assert all("begun" in note for note in fit.notes)
    assert told[-1][0] == told[-1][1]
    assert fit.predict()["u"].shape == data["u"].shape


@pytest.mark.slow
def test_intervals_of_a_noisy_film_contain_the_truth(film, small):
    hits = []
    for seed in range(2):
        fit = cy.fit(noisy(film, 0.01, seed), method="film")
        hits += [fit.interval[name][0] < TRUTH[name] < fit.interval[name][1] for name in NAMES]
    assert np.mean(hits) > 0.8


@pytest.mark.slow
def test_a_film_of_another_model_is_refused(film, small, monkeypatch):
    """The same flow, with the frames in reverse order in time. The search is cut short."""
    monkeypatch.setattr(searching, "MOST", 4)
    monkeypatch.setattr(searching, "EARLY", 4)
    monkeypatch.setattr(matching, "STARTS", 1)
    data = noisy(film, 0.002)
    fit = cy.fit(data.assign(u=data["u"].copy(data=data["u"].values[::-1])), fix=KNOWN, method="film")
    assert "chi²/N" in fit.refused
    assert all(np.isnan(value) for value in fit.estimate.values())
    assert fit.interval["alpha_p"] == (0.0, np.inf)


@pytest.mark.slow
def test_holes_and_uneven_frames_far_apart(film, small):
    """Differences between such frames are change; the noise is what the run leaves."""
    data = noisy(film, 0.003).isel(time=[0, 2, 4, 5, 7, 9, 11, 14])
    rng = np.random.default_rng(1)
    data = data.where(rng.random(data["u"].shape[:1] + data["u"].shape[2:])[:, None] > 0.1)
    data["u"][:, :, :2, 3:6] = np.nan
    fit = cy.fit(data, fix=KNOWN, method="film")
    assert fit.refused is None
    assert "far apart" in fit.notes[0]
    assert fit.residual == pytest.approx(1.0, abs=0.1)
    assert near(fit, "alpha_p")
    assert near(fit, "d_s")
    assert fit.estimate["d_s"] == pytest.approx(TRUTH["d_s"], rel=0.1)


def smooth(noise):
    """Return noise that each vector shares with its neighbours, of the same size."""
    for axis in (2, 3):
        noise = (noise + np.roll(noise, 1, axis)) / np.sqrt(2)
    return noise


@pytest.mark.slow
def test_noise_that_neighbours_share_widens_the_intervals(film, small):
    data = film[["u"]].isel(theta=slice(2, 14))
    fits = []
    for change in (lambda noise: noise, smooth):
        noise = change(np.random.default_rng(4).normal(size=data["u"].shape))
        fits.append(cy.fit(data.assign(u=data["u"] + 0.01 * noise), fix=KNOWN, method="film"))
    plain, shared = fits
    assert "neighbouring vectors" in shared.notes[0]
    assert shared.residual == pytest.approx(1.0, abs=0.1)
    for name in ("alpha_p", "d_s"):
        assert near(shared, name)
        wider = np.ptp(shared.interval[name]) / np.ptp(plain.interval[name])
        assert 1.3 < wider < 2.6  # each of four vectors counts as one: twice as wide


def angles(P):
    """Return the angles of filaments from +z, without polarity."""
    return np.arctan(P.sel(component="theta") / P.sel(component="z"))


@pytest.mark.slow
def test_angles_tell_what_the_flow_does_not(film, small):
    data, rng = noisy(film, 0.02), np.random.default_rng(7)
    order = film.isel(theta=slice(2, 14))["P"]
    seen = angles(order) + 0.1 * rng.normal(size=order.isel(component=0).shape)
    flow, both = (cy.fit(each, fix=KNOWN, method="film") for each in (data, data.assign(angle=seen % np.pi)))
    assert both.refused is None
    for name in ("alpha_p", "kappa", "d_s"):
        assert near(both, name)
    assert np.ptp(both.interval["kappa"]) < 0.8 * np.ptp(flow.interval["kappa"])
    with pytest.raises(cy.InputError, match="angles do not tell"):
        cy.fit(data.assign(angle=seen), method="equation")


def through(film, data, tilt):
    """Return u of a window as a camera shows it whose geometry is off."""
    theta, z, frame = tilt.moved(data["theta"].values, data["z"].values, data.attrs["facing"])
    waves = np.fft.fft2(film["u"].values, norm="forward")
    m, q = np.fft.fftfreq(16, 1 / 16), 2 * np.pi / 5.0 * np.fft.fftfreq(16, 1 / 16)
    around, along = np.exp(1j * theta[..., None] * m), np.exp(1j * z[..., None] * q)
    u = np.einsum("abm,tcmn,abn->tcab", around, waves, along, optimize=True).real
    back = np.moveaxis(np.linalg.inv(np.moveaxis(frame, (0, 1), (-2, -1))), (-2, -1), (0, 1))
    return carried(u, back)


@pytest.mark.slow
def test_a_geometry_that_is_off_moves_the_estimates_as_was_foreseen(film, small, monkeypatch):
    """A film through a camera whose axis or radius is off. Both searches end within 0.05 deviations."""
    monkeypatch.setattr(matching, "STARTS", 1)
    monkeypatch.setattr(prepared, "START", {**TRUTH, "U": 1.0})
    data = film[["u"]].isel(theta=slice(5, 12))
    data = data.assign_attrs(facing=float(data["theta"].mean()))
    sizes = {"axis_deg": 0.3, "radius": 0.01}
    noise = 0.01 * np.random.default_rng(3).normal(size=data["u"].shape)
    known = {name: value for name, value in TRUTH.items() if name not in ("alpha_p", "d_s")}

    def fitted(field, geometry=None):
        given = data.assign(u=data["u"].copy(data=field + noise))
        return cy.fit(given, fix=known, method="film", geometry=geometry)

    right = fitted(data["u"].values)
    for name, size in sizes.items():
        off = Tilt(axis=np.radians(size)) if name == "axis_deg" else Tilt(radius=size)
        moved = fitted(through(film, data, off))
        wide = fitted(data["u"].values, {name: size})
        foreseen = np.sqrt(np.diag(wide.covariance - right.covariance)) / list(right.estimate.values())
        change = np.log(list(moved.estimate.values())) - np.log(list(right.estimate.values()))
        blurred = 0.1 * np.sqrt(np.diag(right.covariance)) / list(right.estimate.values())
        assert np.all(np.abs(np.abs(change) - foreseen) < 0.2 * foreseen + blurred), name


@pytest.mark.slow
def test_a_search_from_a_start_that_is_wrong_by_half_ends_near_the_truth(monkeypatch):
    """A cell at 32 x 32 points, of which one start ends with no repulsion, short waves, and 5 % more left."""
    grid, seed = cy.CylinderGrid(32, 32), 7
    start = cy.initial.disordered(grid, seed=seed)
    run = cy.simulate(cy.Parameters(), grid, start, t_end=10.0, save_at=np.arange(4.0, 10.1, 0.5), rtol=1e-7)
    data = run.to_dataset()[["u"]].isel(theta=slice(10, 23))
    rng = np.random.default_rng(1000 + seed)
    data = data.assign(u=data["u"] + 0.02 * rng.normal(size=data["u"].shape))
    truth = {name: float(value) for name, value in cy.Parameters().items() if name in NAMES}
    monkeypatch.setattr(prepared, "START", wrong(truth, 1.5))
    fit = cy.fit(data, method="film", length=grid.length)
    assert fit.refused is None
    for name, true in truth.items():
        low, high = fit.interval[name]
        assert abs(np.log(fit.estimate[name] / true)) < 3.5 * np.log(high / low) / (2 * 1.96), name
    for name in ("alpha_p", "d_s", "kappa", "mu"):
        assert fit.estimate[name] == pytest.approx(truth[name], rel=0.25), name
