"""Taylor dispersion against closed forms, stored values found in another way, and random walks."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.vacuole.steady import cell_problem
from cyclosis.vacuole.taylor import series
from measure.vacuole_flows import bands, stripes_profile, twisted


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_one_wave_around_the_wall(n):
    expected = (3 * n + 4) / (8 * n * (n + 1) ** 2 * (n + 2))
    found = cy.vacuole.dispersion(bands(lambda phi: np.sin(n * phi), n=32))
    assert found.coefficient == pytest.approx(expected, rel=1e-13)
    assert found.peclet is None


def test_series_is_the_solution_of_the_cell_problem():
    flow = bands(lambda phi: np.sin(phi) + 0.3 * np.cos(2 * phi) - 0.2 * np.sin(4 * phi), n=32, n_z=8)
    assert cell_problem(flow, 7.0, n_r=12) == pytest.approx(
        cy.vacuole.dispersion(flow).coefficient, rel=1e-12
    )


def test_two_bands():
    n = np.arange(1, 200_001)
    amplitudes = np.where(n % 2, 4 / (np.pi * n), 0.0)
    zeta3 = 1.2020569031595942
    exact = 2 / np.pi**2 * (7 / 4 * zeta3 - 23 * np.pi**2 / 48 + 5 * np.log(2) - 0.25)
    assert exact == pytest.approx(0.119589401390, abs=1e-12)
    assert series(amplitudes) == pytest.approx(exact, abs=1e-12)


def test_cyclosis():
    flow = bands(stripes_profile(), n=256, n_z=8)
    assert cy.vacuole.dispersion(flow).coefficient == pytest.approx(0.094872700924, abs=2e-12)


@pytest.mark.parametrize(
    ("q", "peclet", "stored"),
    # By finite volumes and Richardson's extrapolation, which share nothing with this solver.
    [
        (2.0, 1000.0, 0.00430),
        (0.4 * np.pi, 1000.0, 0.01267),
        (0.4 * np.pi, 100.0, 0.02598),
        (0.5, 1e4, 0.02529),
    ],
)
def test_twisted(q, peclet, stored):
    assert cy.vacuole.dispersion(twisted(q), peclet).coefficient == pytest.approx(stored, abs=6e-6)


def test_a_slight_twist_is_no_twist():
    straight = cy.vacuole.dispersion(twisted(0.0)).coefficient
    slight = [cy.vacuole.dispersion(twisted(q), 10.0).coefficient for q in (0.02, 0.04)]
    assert slight == pytest.approx([straight] * 2, rel=1e-2)
    assert (straight - slight[1]) / (straight - slight[0]) == pytest.approx(4.0, rel=0.01)


def test_the_whole_vacuole_gives_what_its_section_gives():
    flow = twisted(0.4 * np.pi, n=32)
    expected = cy.vacuole.dispersion(flow, 10.0).coefficient
    assert cell_problem(flow, 10.0, n_r=16) == pytest.approx(expected, rel=1e-6)


def test_handedness_and_turning_change_nothing():
    one = cy.vacuole.dispersion(bands(np.sin, 1.0, n=16), 100.0).coefficient
    for other in (bands(np.sin, -1.0, n=16), bands(np.cos, 1.0, n=16)):
        assert cy.vacuole.dispersion(other, 100.0).coefficient == pytest.approx(one, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("q", [0.0, 0.4 * np.pi])
def test_random_walks_spread_as_fast(q):
    flow, peclet = bands(np.sin, q, n=16, n_z=8), 20.0
    rng = np.random.default_rng(1)
    count = 4000
    starts = np.stack([np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count), 5 * rng.random(count)], 1)
    times = [30.0, 60.0]
    paths = cy.vacuole.trace(flow, starts, 60.0, times, dt=0.05, peclet=peclet, seed=2, order=3, n_s=32)
    z = paths.xyz[..., 2] - starts[:, 2]
    spread = z.var(axis=1)
    found = (spread[1] - spread[0]) / 30.0 * peclet / 2
    error = np.sqrt(2 / count) * np.hypot(*spread) / 30.0 * peclet / 2
    expected = cy.vacuole.dispersion(flow, peclet).ratio
    assert abs(found - expected) < 4 * error
    assert error < 0.15 * expected


def test_other_flows_and_numbers_are_refused():
    with pytest.raises(cy.InputError, match="peclet"):
        cy.vacuole.dispersion(twisted(1.0, n=16))
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(cy.InputError, match="peclet"):
            cy.vacuole.dispersion(twisted(1.0, n=16), bad)
    with pytest.raises(cy.InputError, match="peclet"):
        _ = cy.vacuole.dispersion(bands(np.sin)).ratio
    with pytest.raises(cy.InputError, match="flow"):
        cy.vacuole.dispersion(np.zeros((2, 8, 8)))
