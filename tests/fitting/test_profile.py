"""What a steady profile can tell, and that it never tells more."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.fitting import steady
from cyclosis.fitting.result import Fit, of_logarithms

ANGLES = np.radians(np.linspace(-70, 70, 40))
STATE = cy.stability.cyclosis(cy.Parameters(), n_theta=128)
P, FLOW = STATE.at(ANGLES, 0.3)


def measured(noise=0.05, seed=0, order=False, columns=200):
    rng = np.random.default_rng(seed)
    fields = {}
    for name, values in (("u", FLOW), ("P", P)):
        field = np.zeros((2, ANGLES.size, columns))
        field[1] = values[:, None] + noise * rng.normal(size=(ANGLES.size, columns))
        fields[name] = (("component", "theta", "z"), field)
    coords = {"component": ["theta", "z"], "theta": ANGLES, "z": 0.01 * np.arange(columns)}
    data = xarray.Dataset(fields, coords)
    return data if order else data[["u"]]


def test_slopes_equal_differences_of_steady_states():
    slopes, h = steady.slopes(STATE, 1.0, ANGLES, 0.3), 1e-4
    for k, name in enumerate(steady.NAMES[:5]):
        value = getattr(STATE.params, name)
        ends = [
            cy.stability.cyclosis(STATE.params.replace(**{name: value * np.exp(s * h)}), 128).at(ANGLES, 0.3)
            for s in (1, -1)
        ]
        for j, found in enumerate((slopes.P, slopes.u)):
            assert found[:, k] == pytest.approx((ends[0][j] - ends[1][j]) / (2 * h), abs=1e-8), name

    ends = [STATE.at(ANGLES, 0.3 + s * h) for s in (1, -1)]
    for j, found in enumerate((slopes.P, slopes.u)):
        assert found[:, 6] == pytest.approx((ends[0][j] - ends[1][j]) / (2 * h), abs=1e-6), "zone"
        assert found[:, 5] == pytest.approx([0 * P, FLOW][j], abs=1e-8), "U"


def test_the_null_vector_is_a_common_factor_of_four_parameters():
    fit = cy.fit(measured(), fix={"U": 1.0})
    null = fit.identifiable[-1]
    assert np.isinf(null.deviation)
    expected = {"alpha_p": 0.5, "alpha_u": 0.5, "d_s": 0.5, "d_r": 0.5, "mu": 0.0}
    assert null.shares == pytest.approx(expected, abs=1e-6)


def test_only_what_is_known_is_told():
    fit = cy.fit(measured(order=True))
    assert fit.method == "profile"
    known = {name for name, value in fit.estimate.items() if np.isfinite(value)}
    assert known == {"mu", "U"}
    for name, truth in (("mu", 0.05), ("U", 1.0)):
        low, high = fit.interval[name]
        assert low < truth < high
    assert "common factor" in fit.refused
    assert "epsilon and kappa do not enter" in fit.refused
    assert fit.interval["kappa"] == (0.0, np.inf)


def test_intervals_of_a_profile_contain_the_truth():
    hits = []
    for seed in range(6):
        fit = cy.fit(measured(seed=seed, order=True), fix={"alpha_p": 1.0, "U": 1.0})
        for name, truth in (("mu", 0.05), ("d_s", 0.025), ("d_r", 0.025)):
            low, high = fit.interval[name]
            hits.append(low < truth < high)
    assert np.mean(hits) >= 0.8


def test_the_angle_of_the_zone_is_one_unknown_more():
    """One side of a zone: covariances are those of the inverse information of all unknowns together."""
    side, noise, names = slice(0, 24), 0.005, ("alpha_u", "d_s", "d_r", "mu")
    fit = cy.fit(measured(noise, order=True).isel(theta=side), names, {"alpha_p": 1.0, "U": 1.0})
    found = steady.slopes(STATE, 1.0, ANGLES[side], 0.3)
    columns = [*(steady.NAMES.index(name) for name in names), 6]
    rows = np.vstack([found.P, found.u])[:, columns] * np.sqrt(200) / noise
    together, alone = (np.linalg.inv(r.T @ r) for r in (rows, rows[:, :-1]))
    size = np.outer(*[list(fit.estimate.values())] * 2)
    assert fit.covariance / size == pytest.approx(together[:-1, :-1], rel=0.2, abs=1e-6)
    assert alone[1, 1] < 0.5 * together[1, 1]  # as if the zone's angle were known


def test_intervals_of_logarithms_hold_95_of_100_draws():
    names, values, deviations = ("mu", "U"), {"mu": 0.05, "U": 2.0}, {"mu": 0.3, "U": 0.01}
    estimate, interval = of_logarithms(names, values, deviations, ())
    rng = np.random.default_rng(0)
    for name in names:
        draws = values[name] * np.exp(deviations[name] * rng.normal(size=200_000))
        assert np.mean(draws < interval[name][0]) == pytest.approx(0.025, abs=0.002)
        assert np.mean(draws > interval[name][1]) == pytest.approx(0.025, abs=0.002)
        assert estimate[name] == values[name]


def test_values_in_physical_units_are_those_of_the_scales():
    """What a fit prints, with a U of 0.8 times the unit of the data, against `Scales`."""
    params = cy.Parameters(kappa=0.3, mu=0.06)
    estimate = {name: getattr(params, name) for name in ("alpha_p", "alpha_u", "d_s", "d_r", "kappa", "mu")}
    given = cy.Scales(400.0, 90.0, 2e4)
    fit = Fit("film", estimate | {"U": 0.8}, dict.fromkeys([*estimate, "U"], (0.0, 1.0)), None, np.eye(7), (),
              1.0, 1.0, scales=given)  # fmt: skip
    told = {row.split()[0]: row.partition("(")[2].split() for row in repr(fit).splitlines() if "(" in row}
    cell = cy.Scales(400.0, 0.8 * 90.0, 2e4).to_physical(params)
    expected = {
        "alpha_p": (cell.bundling_per_s, "per s)"),
        "alpha_u": (cell.flow_alignment_per_um, "per µm)"),
        "d_s": (cell.spatial_diffusion_um2_per_s, "µm²/s)"),
        "d_r": (cell.rotational_diffusion_per_s, "per s)"),
        "kappa": (cell.repulsion_per_s, "per s)"),
        "mu": (cell.layer_viscosity_Pa_s_m, "Pa s m at this friction)"),
        "U": (0.8 * 90.0, "µm/s)"),
    }
    assert told.keys() == expected.keys()
    for name, (value, unit) in expected.items():
        assert float(told[name][0]) == pytest.approx(value, rel=1e-3), name
        assert " ".join(told[name][1:]) == unit


def test_a_profile_that_is_none_is_refused():
    data = measured(noise=0.0)
    bent = data.assign(u=data["u"] * 0 + np.cos(6 * data["theta"]))
    fit = cy.fit(bent, method="profile")
    assert fit.refused is not None
    assert all(np.isnan(value) for value in fit.estimate.values())
    with pytest.raises(cy.InputError, match="fit by film"):
        fit.predict()


def test_the_prediction_and_its_band():
    found = cy.fit(measured(), fix={"alpha_p": 1.0}).predict()
    assert np.abs(found["u"].values - FLOW).max() < 0.01
    assert 1e-4 < float(found["u_deviation"].max()) < 0.02
