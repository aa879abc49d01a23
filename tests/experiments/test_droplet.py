"""Droplets: steady circulation against a solver of its own, and verdicts on made-up ends."""

import numpy as np
import pytest
import xarray

import cyclosis as cy
from cyclosis.experiments import closed_views
from cyclosis.experiments import droplet as subject
from cyclosis.model.errors import InputError

SOLVER = subject.Sphere1D(24)
GRID = cy.ClosedGrid(cy.Sphere(), k_max=8)


def test_harmonics_are_orthonormal_and_those_of_a_rotation_are_first():
    np.testing.assert_allclose([SOLVER.modes(field) for field in SOLVER.values], np.eye(24), atol=1e-12)
    first = SOLVER.modes(SOLVER.r)
    assert abs(first[0]) == pytest.approx(np.sqrt(4 / 3))
    assert np.abs(first[1:]).max() < 1e-13


def test_steady_circulation_is_steady_on_the_surface_too():
    P, u = SOLVER.steady(subject.USUAL.replace(d_s=0.7))
    fields = [SOLVER.modes(field) @ SOLVER.at(GRID.z) * np.ones(GRID.shape) for field in (P, u)]
    state = np.stack([fields[0], 0 * fields[0]])
    params = subject.USUAL.replace(d_s=0.7)
    np.testing.assert_allclose(cy.flow(params, GRID, state)[0], fields[1], atol=1e-5)
    found = cy.models.closed.regime(cy.models.closed.problem(params, GRID), state)
    assert found.name == "circulation"
    assert found.rate < 1e-4


def test_numbers_of_figure_4():
    found = SOLVER.numbers(subject.USUAL)
    assert found == pytest.approx((0.966793, 0.915540, 1.114358, 1.0135), abs=1e-4)


def test_droplets_smaller_than_a_wave_have_no_order():
    least = subject.least_size(subject.USUAL)
    at = subject.of_size(least)
    assert at.alpha_p - at.d_r == pytest.approx(at.d_s)  # l = 1 neither grows nor decays
    assert SOLVER.numbers(subject.of_size(0.95 * least)).order < 1e-3
    assert SOLVER.numbers(subject.of_size(1.2 * least)).order > 0.3


def test_a_size_is_a_change_of_units():
    scales, half = cy.Scales(radius_um=500.0, speed_um_per_s=100.0), cy.Scales(250.0, 100.0)
    one, other = scales.to_physical(subject.of_size(1.0)), half.to_physical(subject.of_size(0.5))
    for name in ("bundling_per_s", "flow_alignment_per_um", "spatial_diffusion_um2_per_s"):
        assert getattr(other, name) == pytest.approx(getattr(one, name))
    assert other.layer_viscosity_Pa_s_m == pytest.approx(one.layer_viscosity_Pa_s_m)


def test_the_time_of_a_half_is_between_frames():
    assert subject.since_half([0.0, 1.0, 2.0, 3.0], np.array([0.0, 0.2, 0.7, 1.0])) == pytest.approx(1.6)


def test_turning_is_the_angular_velocity_of_a_rotation():
    axis = np.array([0.2, -0.5, 0.7])
    field = cy.closed.from_vectors(GRID, np.cross(axis, GRID.xyz, axisa=0, axisb=0, axisc=0))
    np.testing.assert_allclose(subject.turning(GRID, field), axis, atol=1e-13)


def test_uniform_axes_pass_as_often_as_they_should_and_others_do_not():
    axis = np.random.default_rng(1).normal(size=(300, 40, 3))
    axis /= np.linalg.norm(axis, axis=2, keepdims=True)
    p = np.array([subject.uniform(each) for each in axis])
    assert np.all(np.abs((p < 0.2).mean(axis=0) - 0.2) < 3 * np.sqrt(0.16 / 300))
    assert subject.uniform(np.abs(axis[0]))[0] < 1e-6
    flat = axis[0] * [1, 1, 0.03]
    assert subject.uniform(flat / np.linalg.norm(flat, axis=1, keepdims=True))[1] < 1e-6


def made(circulating=20, spread=0.0, aligned=False, rate=1e-6):
    """Return data of 20 droplets."""
    rng = np.random.default_rng(3)
    axis = rng.normal(size=(20, 3))
    axis = np.abs(axis) if aligned else axis
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    end = np.zeros((20, len(subject.End._fields)))
    end[:, 0] = np.arange(20) < circulating
    end[:, 1:4] = (0.9668, 0.9155, 1.0137)
    end[:, 1] += spread * np.arange(20) / 20
    end[:, 4:7], end[:, 10:13] = 1.1144 * axis, 1e-3 * axis
    end[:, 7:10] = (rate, 6.0, 8.0)
    time = np.linspace(0, 60, 31)
    over = np.stack([0.97 / (1 + np.exp(6 - time)), 1.1 / (1 + np.exp(8 - time))]) * np.ones((20, 1, 1))
    picture = closed_views.seen(GRID, cy.closed.rotation(GRID), cy.closed.rotation(GRID), 0.0, upright=True)
    sizes = [0.15, 0.5, 1.0]
    curve = np.linspace(0.1, 4.0, 5)
    return xarray.Dataset(
        {
            "end": (("seed", "number"), end),
            "over_time": (("seed", "quantity", "time"), over),
            "fine": (("fine_seed", "number"), end[:2]),
            "sized": (("size", "size_seed", "number"), np.stack([0 * end[:2], end[:2], end[:2]])),
            "curve": (("curve_size", "theory"), np.ones((5, 4))),
            "theory": ("theory", [0.9668, 0.9155, 1.1144, 1.0135]),
            "growth": (("state", "m"), [[-0.4, -1e-6], [0.47, 0.14]]),
            "least_size": 0.16,
            "picture": (("frame", "field", "across", "up"), np.stack([picture] * 4)),
        },
        {
            "number": list(subject.End._fields),
            "quantity": ["order", "circulation"],
            "time": time,
            "size": sizes,
            "curve_size": curve,
            "state": ["circulation", "source to sink"],
            "m": [0, 1],
        },
    )


@pytest.mark.parametrize(
    ("data", "outcome"),
    [
        (made(), "agrees"),
        (made(circulating=17), "in part"),
        (made(spread=0.05), "in part"),
        (made(aligned=True), "in part"),
        (made(rate=0.1), "in part"),
        (made(circulating=5), "does not"),
    ],
    ids=["all", "some", "more than one state", "one direction", "unsteady", "few"],
)
def test_the_verdict_follows_from_the_data(data, outcome):
    found = subject.verdict(data)
    assert found.outcome == outcome
    assert "0.14" in found.measured


def test_the_figure_and_the_number_follow_from_the_data():
    assert len(subject.draw(made()).axes) == 4 + 3
    assert subject.decisive(made()).startswith("100.0 %")
    assert subject.remembered(made()["end"]) == pytest.approx(0.0, abs=1e-5)


def test_unknown_sizes_are_refused():
    with pytest.raises(InputError):
        subject.of_size(-1.0)
