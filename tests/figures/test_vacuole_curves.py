"""Curves against the Péclet number and sections of Poincaré show the numbers of the library."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.figures.vacuole_bands import PECLETS, mean_bands, wound
from cyclosis.figures.vacuole_dispersion import vacuole_dispersion
from cyclosis.figures.vacuole_poincare import vacuole_poincare
from cyclosis.figures.vacuole_uptake import vacuole_uptake
from cyclosis.stability import cyclosis

GRID = cy.CylinderGrid(32, 32, 5.0)
PHI = 2 * np.pi / 32 * np.arange(32)
PROFILE = np.sin(PHI) + 0.3 * np.cos(3 * PHI - 0.4)


def flow(profile, pitch, grid=GRID):
    return cy.vacuole.flow(grid, cy.vacuole.helical_bands(grid, profile, pitch))


@pytest.fixture(scope="module")
def straight():
    return flow(np.asarray(cyclosis(cy.Parameters()).u), np.inf, cy.CylinderGrid(48, 16, 5.0))


@pytest.mark.parametrize("pitch", [np.inf, 5.0, -5.0, 2.5])
def test_the_mean_bands_are_those_of_a_helix(pitch):
    found, own = mean_bands(flow(PROFILE, pitch))
    assert own == pytest.approx(pitch)
    np.testing.assert_allclose(found, PROFILE, rtol=0, atol=1e-12)
    found, own = mean_bands(wound(PROFILE, pitch))
    assert own == pytest.approx(pitch)
    waves, given = (np.fft.rfft(one, norm="forward")[:9] for one in (found, PROFILE))
    np.testing.assert_allclose(waves, given, rtol=0, atol=1e-12)


def test_the_mean_bands_leave_out_what_is_not_theirs():
    u = cy.vacuole.helical_bands(GRID, PROFILE, 5.0)
    other = 0.4 * cy.vacuole.helical_bands(GRID, np.sin, 2.5) + 0.2 * np.cos(2 * np.pi * GRID.z / 5.0)
    found, own = mean_bands(cy.vacuole.flow(GRID, u + other))
    assert own == pytest.approx(5.0)
    np.testing.assert_allclose(found, PROFILE, rtol=0, atol=1e-12)


def test_the_sherwood_numbers_are_those_known(straight):
    figure = vacuole_uptake(straight, peclets=[100.0, 1000.0])
    diffusion, plain, twisted = figure.axes[0].get_lines()
    for line in (diffusion, plain):
        assert line.get_ydata() == pytest.approx([5.783186] * 2, abs=1e-6)
    assert twisted.get_label() == "pitch 5 $R$"
    assert twisted.get_ydata() == pytest.approx([6.23998, 9.60405], abs=1e-5)


def test_the_ratios_of_dispersion_are_those_known(straight):
    figure = vacuole_dispersion(straight, pitch=-5.0, peclets=[100.0, 1000.0])
    _, plain, twisted = figure.axes[0].get_lines()
    square = np.array([1e4, 1e6])
    assert (plain.get_ydata() - 1) / square == pytest.approx(0.0948727009, abs=1e-9)
    assert (twisted.get_ydata() - 1) / square == pytest.approx([0.0259846, 0.0126736], abs=1e-7)


def test_the_bands_of_a_run_are_compared_with_their_own_pitch():
    figure = vacuole_uptake(flow(np.sin, 2.5), peclets=[1.0, 2.0])
    assert [line.get_label() for line in figure.axes[0].get_lines()][-1] == "pitch 2.5 $R$"
    assert PECLETS[0] == 1.0
    assert PECLETS[-1] == pytest.approx(1e4)


def crossings(figure):
    dots = figure.axes[0].collections[-1]
    return np.asarray(dots.get_offsets()), np.unique(dots.get_facecolors(), axis=0, return_inverse=True)[1]


def test_dots_of_a_helix_lie_on_lines_of_its_stream_function():
    helix = flow(np.sin, 5.0)
    figure = vacuole_poincare(helix, z=1.0, tracers=6, t_end=200.0)
    xy, tracer = crossings(figure)
    psi = cy.vacuole.stream_function(helix).at(
        np.stack([np.minimum(np.hypot(*xy.T), 1.0), np.arctan2(xy[:, 1], xy[:, 0]), np.ones(len(xy))], 1)
    )
    assert len(figure.axes[0].collections) == 2  # lines and dots
    assert len(xy) > 60
    for k in range(tracer.max() + 1):
        assert np.ptp(psi[tracer == k]) < 2e-5
        assert np.ptp(np.hypot(*xy[tracer == k].T)) > 1e-3  # but they move along the line


def test_dots_of_straight_streams_stay_where_they_are(straight):
    figure = vacuole_poincare(straight, tracers=5, t_end=60.0)
    xy, tracer = crossings(figure)
    assert len(figure.axes[0].collections) == 1
    for k in range(tracer.max() + 1):
        assert np.ptp(xy[tracer == k], axis=0) == pytest.approx(np.zeros(2), abs=1e-12)


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("flow = ", lambda one: vacuole_uptake("flow")),
        ("flow = ", lambda one: vacuole_poincare("flow")),
        ("flow = ", lambda one: vacuole_dispersion(cy.vacuole.flow(GRID, np.zeros((2, 32, 32))))),
        ("pitch = ", lambda one: vacuole_uptake(one, pitch=0.0)),
        ("pitch = ", lambda one: vacuole_uptake(one, pitch=np.inf)),
        ("peclets = ", lambda one: vacuole_uptake(one, peclets=[10.0])),
        ("peclets = ", lambda one: vacuole_dispersion(one, peclets=[10.0, 1.0])),
        ("tracers = ", lambda one: vacuole_poincare(one, tracers=0)),
        ("t_end = ", lambda one: vacuole_poincare(one, t_end=0.0)),
        ("z = ", lambda one: vacuole_poincare(one, z=np.nan)),
    ],
)
def test_what_cannot_be_drawn_is_refused(straight, message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong(straight)
    assert message in str(caught.value)
