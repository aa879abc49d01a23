import numpy as np
import pytest

import cyclosis as cy


def test_points_and_wavenumbers():
    grid = cy.CylinderGrid(16, 10, 5.0)
    assert grid.theta[1] == pytest.approx(2 * np.pi / 16)
    assert grid.z[-1] == pytest.approx(4.5)
    assert np.array_equal(grid.m[:4], [0, 1, 2, 3])
    assert grid.q[1] == pytest.approx(2 * np.pi / 5)


@pytest.mark.parametrize(
    ("shape", "target"), [((16, 20), (32, 48)), ((15, 21), (40, 25)), ((16, 16), (15, 9))]
)
def test_interpolation_is_exact_for_modes_that_both_grids_resolve(shape, target):
    def wave(grid):
        t, z = np.meshgrid(grid.theta, grid.z * 2 * np.pi / grid.length, indexing="ij")
        return np.stack([np.sin(3 * t - 2 * z) + 0.3, np.cos(2 * t + 4 * z)])

    a, b = cy.CylinderGrid(*shape, 3.0), cy.CylinderGrid(*target, 3.0)
    assert cy.interpolate(wave(a), target) == pytest.approx(wave(b), abs=1e-13)


def test_interpolation_up_and_down_returns_all_but_nyquist():
    rng = np.random.default_rng(1)
    field = cy.interpolate(rng.normal(size=(2, 31, 17)), (12, 10))
    up = cy.interpolate(field, (24, 30))
    spectrum = np.fft.fft2(field)
    spectrum[:, 6], spectrum[:, :, 5] = 0, 0
    assert cy.interpolate(up, (12, 10)) == pytest.approx(np.fft.ifft2(spectrum).real, abs=1e-13)


@pytest.mark.parametrize(
    "arguments",
    [(7, 64, 5.0), (64, 9000, 5.0), (64, 64, 0.0), (64.0, 64, 5.0), (64, 64, np.nan), ("a", 64, 5.0)],
)
def test_bad_grids_are_refused(arguments):
    with pytest.raises(cy.InputError):
        cy.CylinderGrid(*arguments)


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (np.zeros((2, 8, 9)), "shape"),
        (np.zeros((2, 8, 8), complex), "real numbers"),
        (np.full((2, 8, 8), np.nan), "finite"),
        ("text", "shape"),
        ([[1, 2], [3]], "shape"),
    ],
)
def test_bad_states_are_refused_in_a_sentence(state, words):
    with pytest.raises(cy.InputError, match=words):
        cy.CylinderGrid(8, 8, 5.0).check_state(state)
