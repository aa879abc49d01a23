"""Spectra of profiles: the paper's operator, and modes that are modes."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.stability.profiles.reduced import reduced

N = 96
CELL = cy.Parameters(alpha_p=0.3, alpha_u=0.4, epsilon=0.3, kappa=0.2)


@pytest.fixture(scope="module")
def state():
    return cy.stability.cyclosis(CELL, N)


def paper_s_operator(p, state):
    """The non-local Sturm-Liouville problem as it is written, by Fourier matrices."""
    m = np.fft.fftfreq(N, 1 / N)

    def filtered(symbol):
        return np.fft.ifft(symbol[:, None] * np.fft.fft(np.eye(N), axis=0), axis=0).real

    kernel = filtered(np.where(m == 0, 0.0, 1 / (1 + p.mu * m**2)))
    P, u = state.P, state.u
    local = -p.d_r + p.alpha_p * (1 - 3 * P**2) - 2 * p.alpha_u * P * u
    return filtered(-p.d_s * m**2) + np.diag(local) + 3 * p.alpha_u * (1 - P**2)[:, None] * kernel * P**2


def test_perturbations_of_P_z_obey_the_paper_s_operator(state):
    exact = np.linalg.eigvals(paper_s_operator(CELL, state))
    found = state.spectrum(12, components="z").eigenvalues
    assert max(np.abs(exact - value).min() for value in found) < 1e-10


@pytest.mark.parametrize("axial_mode", [0, 1, -1, 3])
def test_modes_are_modes(state, axial_mode):
    """J v = λ v on the real equations, seen as cos(qz) and sin(qz) parts of a whole cell."""
    found = state.spectrum(10, axial_mode=axial_mode)
    line = reduced(CELL, cy.CylinderGrid(N, 16, 5.0))
    y = np.concatenate([np.zeros(N), state.P])
    matrix = line.waves(y, axial_mode) if axial_mode else line.jacobian(y)
    for value, mode in zip(found.eigenvalues, found.modes, strict=True):
        assert np.abs(matrix @ mode.ravel() - value * mode.ravel()).max() < 1e-9
        assert np.mean(np.sum(np.abs(mode) ** 2, axis=0)) == pytest.approx(1)
        largest = mode.ravel()[np.argmax(np.abs(mode))]
        assert abs(largest.imag) < 1e-12 < largest.real
    assert found.wavenumber == pytest.approx(2 * np.pi * axial_mode / 5.0)
    assert np.all(np.diff(found.eigenvalues.real) < 1e-11)


def test_waves_up_and_down_the_cell_grow_alike(state):
    up, down = (state.spectrum(8, axial_mode=j).eigenvalues for j in (2, -2))
    assert max(np.abs(down - value).min() for value in up) < 1e-9


def test_components_are_the_two_halves_of_the_whole(state):
    whole = state.spectrum(12).eigenvalues
    parts = np.concatenate([state.spectrum(12, components=c).eigenvalues for c in ("z", "theta")])
    assert whole == pytest.approx(parts[np.argsort(-parts.real, kind="stable")][:12], abs=1e-10)
    assert np.abs(state.spectrum(4, components="z").modes[:, 0]).max() == 0


def test_the_rotation_is_the_slope_of_the_profile(state):
    found = state.spectrum(6, components="z")
    at = np.argmin(np.abs(found.eigenvalues))
    m = np.fft.fftfreq(N, 1 / N)
    slope = np.fft.ifft(1j * np.where(np.abs(m) < N / 2, m, 0) * np.fft.fft(state.P)).real
    mode = found.modes[at, 1].real
    assert abs(found.eigenvalues[at]) < 1e-9
    assert mode / mode[0] == pytest.approx(slope / slope[0], abs=1e-8)


def test_repulsion_takes_itself_off_the_rates_of_P_theta(state):
    without = cy.stability.cyclosis(CELL.replace(kappa=0.0), N).spectrum(4, components="theta").eigenvalues
    assert state.spectrum(4, components="theta").eigenvalues == pytest.approx(without - 0.2, abs=1e-10)


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"count": 0}, "count"),
        ({"count": N + 1, "components": "z"}, "count"),
        ({"axial_mode": 0.5}, "axial_mode"),
        ({"axial_mode": 1, "components": "z"}, "axial_mode"),
        ({"components": "x"}, "components"),
        ({"axial_mode": 1, "length": 0.0}, "length"),
    ],
)
def test_bad_settings_are_refused(state, arguments, field):
    with pytest.raises(cy.InputError, match=field):
        state.spectrum(**arguments)
