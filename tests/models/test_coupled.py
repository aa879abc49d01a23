"""The polar model with the drag of the vacuole: the operator, the budget, files, and β = 0."""

import json

import numpy as np
import pytest

import cyclosis as cy
from cyclosis import config
from measure import band_limited

GRID = cy.CylinderGrid(24, 20, 4.0)
PARAMS = cy.Parameters(mu=0.07)
BETA = 0.3
COUPLED = cy.models.coupled_model(BETA)


def run(model=COUPLED, t_end=2.0, **more):
    state = band_limited(3, GRID.shape, (6, 5), 0.6)
    return cy.simulate(PARAMS, GRID, state, t_end, model=model, save_every=1.0, **more)


def test_the_flow_is_resisted_by_the_vacuole():
    """Against plain transforms: (1 + μ k²) u_k = (I - kk/k²)·(F_k - β τ_k), with the stress τ on the wall."""
    found = run()
    P = found.frames[-1]
    u = cy.vacuole.flow(found, t=found.t_final)
    force = np.sum(P**2, axis=0) * P
    F, waves = np.fft.fft2(force), np.fft.fft2(u.surface)
    m, q = GRID.m[:, None], GRID.q[None, :]
    k2 = m**2 + q**2

    def solenoidal(field):
        along = (m * field[0] + q * field[1]) / np.where(k2 > 0, k2, 1.0)
        return field - np.stack([m * along, q * along])

    driven, drag = solenoidal(F), solenoidal(np.fft.fft2(u.wall_traction))
    kept = np.ones(GRID.shape, bool)
    kept[GRID.n_theta // 2], kept[:, GRID.n_z // 2], kept[0, 0] = False, False, False
    left = (1 + PARAMS.mu * k2) * waves + BETA * drag
    scale = np.abs(driven).max()
    np.testing.assert_allclose(left[:, kept] / scale, driven[:, kept] / scale, rtol=0, atol=1e-13)
    assert waves[0, 0, 0] == pytest.approx(F[0, 0, 0], rel=1e-12)  # the fluid turns with the wall


def test_the_budget_of_power_is_complete():
    found = run()
    parts = [found.records[f"{name}_dissipation"] for name in ("viscous", "friction", "vacuole")]
    np.testing.assert_allclose(sum(parts), found.records["power_input"], rtol=1e-12)
    area = 2 * np.pi * GRID.length
    for t, spent in zip(found.record_times, parts[2], strict=True):
        inside = cy.vacuole.flow(found, t=float(t)).dissipation / area
        assert spent == pytest.approx(BETA * inside, rel=1e-11)
        assert spent > 0.01 * found.records["power_input"][0]


def test_without_drag_it_is_the_polar_model():
    plain, none = run(cy.models.polar), run(cy.models.coupled_model(0.0))
    np.testing.assert_array_equal(none.final_state, plain.final_state)
    np.testing.assert_array_equal(none.records["power_input"], plain.records["power_input"])
    assert not none.records["vacuole_dissipation"].any()
    assert np.abs(run().final_state - plain.final_state).max() > 1e-4


@pytest.mark.slow
def test_a_ramp_of_the_viscosity_keeps_the_drag():
    ramp = cy.Protocol(cy.change(at=0.5, over=1.0, mu=0.5))
    slow = run(protocol=ramp, rtol=1e-9)
    assert cy.vacuole.flow(slow, t=2.0).dissipation > 0
    parts = [slow.records[f"{name}_dissipation"] for name in ("viscous", "friction", "vacuole")]
    np.testing.assert_allclose(sum(parts), slow.records["power_input"], rtol=1e-12)


def test_files_keep_it_and_runs_resume(tmp_path):
    whole = run(t_end=2.0)
    path = cy.write(run(t_end=1.0), tmp_path / "run.nc")
    again = cy.load(path)
    assert again.model.options == {"vacuole_drag": BETA}
    np.testing.assert_array_equal(cy.resume(again, 2.0).final_state, whole.final_state)
    with cy.open_dataset(path) as data:
        assert json.loads(data.attrs["configuration"])["model"] == {"kind": "coupled", "vacuole_drag": BETA}
        np.testing.assert_array_equal(cy.vacuole.flow(data.drop_vars("u"), t=1.0).surface.shape, (2, 24, 20))
        recomputed = cy.vacuole.flow(data.drop_vars("u"), t=1.0).surface
        np.testing.assert_allclose(recomputed, data["u"].values[-1], rtol=0, atol=1e-14)


def test_configurations_choose_it(tmp_path):
    (tmp_path / "run.toml").write_text('[model]\nkind = "coupled"\nvacuole_drag = 0.02\n')
    made = cy.models.of_tables({"model": {"kind": "coupled", "vacuole_drag": 0.02}})
    assert made is cy.models.coupled_model(0.02)
    tables, _ = config.read(tmp_path / "run.toml")
    assert cy.models.of_tables(tables) is made


@pytest.mark.slow
def test_its_regime_is_that_of_its_own_rate():
    found = cy.simulate(
        cy.Parameters(), GRID, cy.initial.stripes(GRID), 300.0, model=COUPLED, save_every=300.0
    )
    problem = COUPLED.problem(cy.Parameters(), GRID)
    steady = COUPLED.regime(problem, found.final_state)
    polar = cy.regime(cy.Parameters(), GRID, found.final_state)
    assert steady.rate < 1e-5 < polar.rate


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("vacuole_drag = -0.1", lambda: cy.models.coupled_model(-0.1)),
        (
            "vacuole_drag = 0.1",
            lambda: cy.models.of_tables({"model": {"kind": "polar", "vacuole_drag": 0.1}}),
        ),
        (
            "vacuole_drag = 0.1",
            lambda: cy.models.of_tables({"model": {"kind": "kinetic", "vacuole_drag": 0.1}}),
        ),
        ("modes = 12", lambda: cy.models.of_tables({"model": {"kind": "coupled", "modes": 12}})),
        ("model = 'couple'", lambda: cy.models.of_tables({"model": {"kind": "couple"}})),
    ],
)
def test_what_it_does_not_have_is_refused(message, wrong):
    with pytest.raises(cy.InputError) as caught:
        wrong()
    assert message in str(caught.value)
