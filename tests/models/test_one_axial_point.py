"""A cell of one axial point: what varies around the axis only, by both models and through files."""

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dataset.vtk import export_vtk
from cyclosis.figures.emergence import emergence

RING, SHORT = cy.CylinderGrid(48, 1), cy.CylinderGrid(48, 8)
PARAMS = cy.Parameters(alpha_p=0.9, alpha_u=0.6)


def start(grid):
    """Noise of long waves around the axis, the same at every z."""
    theta = grid.theta[:, None] * np.ones(grid.n_z)
    return 0.05 * np.stack([np.cos(theta + 0.3) + 0.2, np.sin(2 * theta) + np.cos(theta)])


def test_it_has_one_wavenumber_along_the_axis():
    assert RING.shape == (48, 1)
    assert RING.z.tolist() == RING.q.tolist() == [0.0]


@pytest.mark.slow
@pytest.mark.parametrize("model", [cy.models.polar, cy.models.kinetic], ids=str)
def test_its_cell_is_the_one_that_is_the_same_at_every_z(model):
    runs = []
    for grid in (RING, SHORT):
        P = start(grid)
        state = cy.kinetic.dressed(P, 24) if model is cy.models.kinetic else P
        runs.append(cy.simulate(PARAMS, grid, state, 12.0, stepper="etdrk4", dt=0.02, model=model))
    ring, whole = (run.final_state for run in runs)
    assert np.abs(whole - ring).max() < 1e-11
    for name, values in runs[0].records.items():
        if name not in ("spectral_tail", "rate_of_change"):  # rounding along z is in these
            assert np.abs(np.asarray(values) - np.asarray(runs[1].records[name])).max() < 1e-9, name
    assert runs[0].records["order"][-1] > 0.5


def test_its_regime_is_named():
    P = cy.initial.stripes(RING)
    assert cy.regime(PARAMS, RING, P).name == "cyclosis"
    assert cy.regime(PARAMS, RING, cy.initial.unidirectional(RING)).name == "unidirectional"


def test_its_flow_is_that_of_the_closed_form():
    """<u_z> = 0, and a wave e^{imθ} of force along z drives e^{imθ}/(1 + μ m²)."""
    P = cy.initial.stripes(RING, magnitude=0.8)
    force = np.fft.fft(P[1, :, 0] ** 3)
    m = RING.m
    expected = np.fft.ifft(np.where(m == 0, 0, force / (1 + PARAMS.mu * m**2))).real
    assert np.abs(cy.flow(PARAMS, RING, P)[1, :, 0] - expected).max() < 1e-14


@pytest.mark.slow
def test_its_file_is_resumed_drawn_exported_and_a_start(tmp_path):
    file = tmp_path / "ring.nc"
    whole = cy.simulate(PARAMS, RING, start(RING), 6.0, save_every=1.0)
    cy.write(cy.simulate(PARAMS, RING, start(RING), 4.0, save_every=1.0), file)
    again = cy.resume_file(file, t_end=6.0)
    assert np.array_equal(again.final_state, whole.final_state)
    with cy.open_dataset(file) as data:
        assert len(emergence(data).axes) > 8
        assert export_vtk(data, tmp_path / "surface").exists()
    assert np.array_equal(cy.initial.from_file(file, RING), whole.final_state)
    longer = cy.initial.from_file(file, cy.CylinderGrid(48, 16))
    assert np.abs(longer - whole.final_state).max() < 1e-13


def test_noise_may_be_the_same_along_the_axis():
    grid = cy.CylinderGrid(32, 16)
    P = cy.initial.disordered(grid, seed=1, noise_grid=(32, 1))
    assert np.abs(P - P[:, :, :1]).max() < 1e-15
    assert np.abs(P).max() > 0.01


@pytest.mark.parametrize("n_z", [0, 2, 7])
def test_other_small_numbers_are_refused(n_z):
    with pytest.raises(cy.InputError, match=r"from 8 to 8192, or 1"):
        cy.CylinderGrid(48, n_z)


@pytest.mark.slow
def test_too_few_points_around_are_noticed_and_more_of_them_named():
    coarse = cy.CylinderGrid(16, 1)
    run = cy.simulate(cy.Parameters(), coarse, cy.initial.disordered(coarse, seed=0), 30.0)
    assert run.status == "underresolved"
    assert "48 x 1 should do" in run.message
    assert np.max(run.records["spectral_tail"]) > 1e-2  # it was 0 / 0 along the axis


def test_noise_has_time_to_decay_before_a_grid_is_judged():
    run = cy.simulate(cy.Parameters(), RING, cy.initial.disordered(RING, seed=0), 30.0)
    assert run.status == "completed", run.message
    assert run.records["spectral_tail"][0] > 1e-2  # white noise
