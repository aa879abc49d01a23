"""Fits of films of a small cell: estimates, units, and the sentences that refuse."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.fitting.film import film_of
from cyclosis.fitting.geometry import Tilt, tilts
from cyclosis.fitting.noise import noise_of
from cyclosis.fitting.windows import Window, averaging

TRUTH = {
    "alpha_p": 1.0,
    "alpha_u": 0.5,
    "epsilon": 0.1,
    "d_s": 0.05,
    "d_r": 0.025,
    "kappa": 0.5,
    "mu": 0.1,
    "U": 1.0,
}


@pytest.fixture(scope="module")
def film():
    grid = cy.CylinderGrid(32, 32)
    params = cy.Parameters(**{name: value for name, value in TRUTH.items() if name != "U"})
    start = cy.initial.disordered(grid, seed=2, filaments_per_square=100.0)
    times = [1.0 + 0.25 * k for k in range(81)]
    run = cy.simulate(params, grid, start, t_end=21.0, save_at=times, rtol=1e-6)
    return run.to_dataset()[["P", "u"]]


def part(data, noise=0.0, seed=0):
    data = data.isel(theta=slice(2, 30)).copy(deep=True)
    rng = np.random.default_rng(seed)
    for name in data:
        data[name] = data[name] + noise * rng.normal(size=data[name].shape)
    return data


def test_exact_data_give_the_parameters(film):
    fit = cy.fit(part(film))
    assert fit.method == "equation"
    assert fit.refused is None
    for name, truth in TRUTH.items():
        assert fit.estimate[name] == pytest.approx(truth, rel=0.01), name


@pytest.mark.slow
def test_noisy_data_give_intervals_that_contain_the_truth(film):
    hits = []
    for seed in range(3):
        fit = cy.fit(part(film, 0.02, seed), seed=seed)
        assert fit.noise == pytest.approx({"P": 0.02, "u": 0.02}, rel=0.05)
        hits += [fit.interval[name][0] <= truth <= fit.interval[name][1] for name, truth in TRUTH.items()]
        assert 0.8 < fit.residual < 1.25
    assert np.mean(hits) > 0.8


@pytest.mark.slow
def test_order_of_dimensions_holes_and_units_do_not_matter(film):
    data = part(film, 0.02)
    fit = cy.fit(data)
    changed = data.transpose("z", "component", "time", "theta").isel(theta=slice(None, None, -1))
    assert cy.fit(changed).estimate == pytest.approx(fit.estimate, rel=1e-9)
    scales = cy.Scales(500.0, 80.0)
    physical = data.assign(u=data["u"] * 80.0).assign_coords(
        time=data["time"] * scales.time_s, z=data["z"] * 500.0, theta=np.degrees(data["theta"])
    )
    for name, unit in (("u", "um/s"), ("time", "s"), ("z", "um"), ("theta", "deg")):
        physical[name].attrs["units"] = unit
    again = cy.fit(physical, scales=scales)
    assert again.estimate == pytest.approx(fit.estimate, rel=1e-9)
    assert "per s" in repr(again)
    with pytest.raises(cy.InputError, match="scales"):
        cy.fit(physical)
    holes = data.copy(deep=True)
    bad = np.random.default_rng(1).random(holes["u"].shape) < 0.01
    holes["u"] = holes["u"].where(~bad)
    holes["P"][:, :, :2] = np.nan
    found = cy.fit(holes).estimate
    for name in ("alpha_p", "alpha_u", "kappa"):
        assert found[name] == pytest.approx(TRUTH[name], rel=0.1)


@pytest.mark.slow
def test_units_of_speed_are_found(film):
    """The same film, measured with a unit of speed that is too small by half and clocks to match."""
    fit, data = cy.fit(part(film)), part(film)
    other = data.assign(u=2.0 * data["u"]).assign_coords(time=data["time"] / 2.0)
    again = cy.fit(other).estimate
    assert again["U"] == pytest.approx(2 * fit.estimate["U"], rel=0.01)
    assert again["alpha_p"] == pytest.approx(1.0, rel=0.02)


def test_fixed_values_and_chosen_parameters(film):
    fit = cy.fit(part(film, 0.02), ["alpha_p", "U"], {"mu": 0.1, "epsilon": 0.1})
    assert list(fit.estimate) == ["alpha_p", "U"]
    assert fit.covariance.shape == (2, 2)
    assert fit.estimate["alpha_p"] == pytest.approx(1.0, rel=0.05)
    assert fit.fixed == {"mu": 0.1, "epsilon": 0.1}


@pytest.mark.slow
def test_an_uncertain_geometry_widens_the_intervals(film):
    data = film.isel(theta=slice(9, 24))
    sure, unsure = cy.fit(data), cy.fit(data, geometry={"axis_deg": 1.0, "radius": 0.02})
    assert unsure.estimate == sure.estimate
    widths = [np.ptp(each.interval["epsilon"]) for each in (sure, unsure)]
    assert widths[1] > 2 * widths[0]


def test_what_cannot_be_told_is_refused(film):
    few = cy.fit(part(film).isel(time=slice(0, 17)))
    assert "17 frames" in few.refused
    loud = cy.fit(part(film, 0.4))
    assert "noise" in loud.refused
    blind = cy.fit(part(film)[["P"]])
    assert "flow" in blind.refused
    still = film.isel(time=[-1] * 40).assign_coords(time=0.25 * np.arange(40))
    steady = cy.fit(part(still, 0.02))
    assert steady.refused is not None
    for fit in (few, loud, blind, steady):
        assert np.isnan(fit.estimate["alpha_p"])
        assert fit.interval["alpha_p"] == (0.0, np.inf)
        assert "efused" in repr(fit)


@pytest.mark.slow
def test_uneven_frames_and_holes_are_used_as_they_are(film):
    rng = np.random.default_rng(2)
    frames = np.sort(rng.choice(81, 66, replace=False))
    data = part(film, 0.01).isel(time=frames)
    data = data.where(rng.random((66, 28, 32))[:, None] > 0.1)
    data["u"][:, :, 10:14, 12:15] = np.nan
    fit = cy.fit(data)
    assert fit.refused is None
    for name in ("alpha_p", "alpha_u", "kappa", "d_s", "mu", "U"):
        low, high = fit.interval[name]
        assert low - 0.5 * (high - low) < TRUTH[name] < high + 0.5 * (high - low), name
        assert fit.estimate[name] == pytest.approx(TRUTH[name], rel=0.1), name
    gaps = cy.fit(part(film).isel(time=[k for k in range(81) if k % 20 < 5]))
    assert "enough frames" in gaps.refused


def test_few_points_are_refused(film):
    assert "too few points" in cy.fit(part(film).isel(z=slice(0, 6))).refused


def placed(film, theta, window=None):
    """Return the film at other angles, with u averaged over a window."""
    grid = cy.CylinderGrid(32, 32)
    along = np.exp(1j * np.outer(grid.z, grid.q))
    fields = {}
    for name, by in (("P", None), ("u", window)):
        operator = averaging(by, theta, np.pi, grid.m, grid.q)
        waves = np.fft.fft2(film[name].values, norm="forward")
        field = np.einsum("camn,tcmn,bn->tcab", operator, waves, along, optimize=True).real
        fields[name] = (film[name].dims, field)
    coords = {"time": film["time"], "component": ["theta", "z"], "theta": theta, "z": film["z"]}
    return xarray.Dataset(fields, coords, {"facing": np.pi})


@pytest.mark.slow
def test_windows_are_taken_out(film):
    """Averages over windows of 0.3 radii make μ too large by a twentieth, unless the window is known."""
    data = placed(film, np.pi + np.linspace(-1.0, 1.0, 33), Window(0.3))
    plain, known = cy.fit(data), cy.fit(data, window=0.3)
    assert plain.estimate["mu"] > 1.05 * TRUTH["mu"]
    assert known.estimate["mu"] == pytest.approx(TRUTH["mu"], rel=0.02)
    assert known.estimate["kappa"] == pytest.approx(TRUTH["kappa"], rel=0.01)
    measured = data.assign_attrs(measurement="velocity")
    assert "window_px" in cy.fit(measured).notes[0]
    told = cy.fit(measured.assign_attrs(window_px=30.0, radius_px=100.0))
    assert told.notes == ()
    assert told.estimate == known.estimate
    with pytest.raises(cy.InputError, match="window"):
        cy.fit(data, window=2.0)


@pytest.mark.slow
def test_noise_that_neighbours_share_is_added_again_as_it_is(film):
    hits, wide = [], []
    for seed in range(3):
        data, rng = part(film), np.random.default_rng(seed)
        for name in data:
            noise = rng.normal(size=data[name].shape)
            for axis in (2, 3):
                noise = (noise + np.roll(noise, 1, axis)) / np.sqrt(2)
            data[name] = data[name] + 0.02 * noise
        fit = cy.fit(data, seed=seed)
        hits += [fit.interval[name][0] <= truth <= fit.interval[name][1] for name, truth in TRUTH.items()]
        wide.append(np.ptp(fit.interval["alpha_p"]))
    assert np.mean(hits) > 0.8
    assert np.mean(wide) > 1.4 * np.ptp(cy.fit(part(film, 0.02)).interval["alpha_p"])


def test_weak_instruments_are_refused(film):
    """A film that ends before streams appear."""
    fit = cy.fit(part(film, 0.05).isel(time=slice(0, 24)))
    assert "strength of the instruments" in fit.refused
    assert fit.strength["mu"] < 10
    assert np.isnan(fit.estimate["mu"])


def test_another_model_is_refused(film):
    data = part(film, 0.01)
    mirrored = data.assign(u=data["u"] * xarray.DataArray([1.0, -1.0], dims="component"))
    assert cy.fit(mirrored).refused is not None


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"method": "best"}, "method"),
        ({"parameters": ["alpha"]}, "alpha"),
        ({"parameters": "mu"}, "parameters"),
        ({"fix": {"alpha_q": 1.0}}, "alpha_q"),
        ({"fix": {"mu": -1.0}}, "mu"),
        ({"parameters": ["mu"], "fix": {"mu": 1.0}}, "mu"),
        ({"geometry": {"angle": 1.0}}, "geometry"),
        ({"scales": 1.0}, "scales"),
        ({"draws": 1}, "draws"),
        ({"seed": -1}, "seed"),
    ],
)
def test_input_is_checked(film, arguments, match):
    with pytest.raises(cy.InputError, match=match):
        cy.fit(film, **arguments)


@pytest.mark.parametrize(
    "data", [None, np.zeros(3), xarray.Dataset(), xarray.Dataset({"u": ("theta", [1.0])})]
)
def test_what_is_no_measurement_is_refused(data):
    with pytest.raises(cy.InputError, match="data"):
        cy.fit(data)


def test_noise_is_found_by_component_and_angle(film):
    data = part(film)
    size = 0.05 * (1 + 0.5 * np.abs(np.linspace(-1, 1, 28)))
    rng = np.random.default_rng(0)
    data["u"] = data["u"] + rng.normal(size=data["u"].shape) * size[None, None, :, None]
    found = film_of(data, None)
    assert np.sqrt(noise_of(found.u, found.times, found.known)[:, :, 0]) == pytest.approx(
        np.stack([size, size]), rel=0.1
    )


def test_the_camera_geometry_is_a_rotation_where_it_should_be():
    theta, z = np.linspace(-1, 1, 9), np.linspace(0, 2, 7)
    same_theta, same_z, frame = Tilt().moved(theta, z, 0.0)
    assert same_theta == pytest.approx(np.repeat(theta[:, None], 7, 1))
    assert same_z == pytest.approx(np.repeat(z[None], 9, 0))
    assert frame == pytest.approx(np.broadcast_to(np.eye(2)[:, :, None, None], frame.shape))
    h = 1e-6
    moved = [Tilt(axis=s * h).moved(theta, z, 0.0) for s in (1, -1)]
    assert (moved[0][1] - moved[1][1])[4] / (2 * h) == pytest.approx(0.0, abs=1e-9)  # at φ = 0
    assert (moved[0][0] - moved[1][0])[4] / (2 * h) == pytest.approx(z - 1.0, abs=1e-6)
    assert len(tilts({"axis_deg": 1.0}, 8, np.random.default_rng(0))) == 8
    assert tilts({}, 8, np.random.default_rng(0)) == []


def test_vectors_of_another_geometry_are_those_of_the_moved_points():
    """The matrix for vectors is the derivative of the places: what moves with the surface stays with it."""
    theta, z, h = np.linspace(1.2, 2.8, 9), np.linspace(0, 2, 7), 1e-6
    tilt = Tilt(axis=0.15, radius=0.05, centre=-0.04)
    frame = tilt.moved(theta, z, 2.0)[2]
    around = np.subtract(tilt.moved(theta + h, z, 2.0)[:2], tilt.moved(theta - h, z, 2.0)[:2]) / (2 * h)
    wide = np.concatenate([[z[0]], z, [z[-1]]])  # the ends, which give the middle, stay
    moved = []
    for step in (h, -h):
        wide[1:-1] = z + step
        moved.append(np.array(tilt.moved(theta, wide, 2.0)[:2])[..., 1:-1])
    along = (moved[0] - moved[1]) / (2 * h)
    assert frame[:, 0] == pytest.approx(around, abs=1e-8)
    assert frame[:, 1] == pytest.approx(along, abs=1e-8)


def test_holes_are_filled_from_frames_of_their_own_half():
    """Noise of odd frames must not reach even ones, whose columns are instruments for them."""
    u = np.zeros((20, 2, 3, 4))
    u[1::2] = 1.0
    hidden = np.random.default_rng(0).random((20, 1, 3, 4)) < 0.2
    dims = ("time", "component", "theta", "z")
    places = {"time": np.arange(20.0), "theta": np.arange(3.0), "z": np.arange(4.0)}
    data = xarray.Dataset({"u": (dims, np.where(hidden, np.nan, u))}, places)
    found = film_of(data, None)
    assert found.u[:, :, found.seen] == pytest.approx(u[:, :, found.seen])
    assert (found.known == ~hidden[:, 0]).all()
