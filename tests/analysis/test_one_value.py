"""One quantity of a state has one value, whichever function reports it, also where Nyquist modes are strong.

The rule: a state counts without its Nyquist modes, as in the right-hand side.
"""

import json
import struct

import numpy as np
import pytest

import cyclosis as cy
from cyclosis.analysis.appearance import Look
from cyclosis.analysis.zones import zones_of
from cyclosis.dynamics.live import Live
from cyclosis.explorer.session import Session
from cyclosis.explorer.setup import from_tables
from cyclosis.figures.frames import facing_zone
from cyclosis.figures.ribbons import zone_ribbons
from cyclosis.model.grid import resolved
from cyclosis.report.run import summary

PARAMS = cy.Parameters(alpha_p=0.3, alpha_u=0.7, kappa=0.4, repulsion_angle=0.3)
SHAPES = ((16, 12), (15, 12), (16, 11), (9, 9))


def crests(n):
    return (-1.0) ** np.arange(n) * (n % 2 == 0)


def made(kind, shape, seed):
    """A grid and a state with |P| <= 1 whose Nyquist modes are strong."""
    rng = np.random.default_rng(seed)
    grid = cy.CylinderGrid(*shape, 5.0)
    around, along = crests(shape[0])[:, None], crests(shape[1])[None, :]
    waves = 0.2 * around * rng.normal(size=(2, 1, shape[1])) + 0.2 * along * rng.normal(size=(2, shape[0], 1))
    smooth = {
        "noise": rng.normal(size=(2, *shape)),
        "stripes": cy.initial.stripes(grid) + 0.1 * rng.normal(size=(2, *shape)),
        "circumferential": cy.initial.circumferential(grid) + 0.1 * rng.normal(size=(2, *shape)),
        "unidirectional": cy.initial.unidirectional(grid) + 0.02 * rng.normal(size=(2, *shape)),
        "faint": 0.03 * rng.normal(size=(2, *shape)),
        "crests": cy.initial.stripes(grid, magnitude=0.02),  # hardly anything else
    }[kind]
    state = smooth + waves
    return grid, 0.95 * state / max(1.0, np.hypot(*state).max())


KINDS = ("noise", "stripes", "circumferential", "unidirectional", "faint", "crests")
CASES = [(kind, shape, k) for k, (kind, shape) in enumerate((a, b) for a in KINDS for b in SHAPES)]
CLOSE = {"rel": 1e-11, "abs": 1e-14}


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]}-{case[1][0]}x{case[1][1]}")
def cell(request):
    return made(*request.param)


def test_nyquist_modes_are_left_out_and_nothing_else(cell):
    grid, P = cell
    left = resolved(P)
    spectrum = np.fft.fft2(left)
    for axis, n in enumerate(grid.shape):
        if n % 2 == 0:
            assert np.abs(np.take(spectrum, n // 2, axis + 1)).max() < 1e-12
    kept = np.ones(grid.shape)
    for axis, n in enumerate(grid.shape):
        if n % 2 == 0:
            kept[(n // 2,) if axis == 0 else (slice(None), n // 2)] = 0
    assert left == pytest.approx(np.fft.ifft2(np.fft.fft2(P) * kept).real, abs=1e-13)
    assert resolved(left) == pytest.approx(left, abs=1e-15)


@pytest.mark.parametrize("shape", SHAPES)
def test_states_without_nyquist_modes_are_left_as_they_are_to_the_last_bit(shape):
    grid = cy.CylinderGrid(*shape, 5.0)
    odd = cy.interpolate(cy.initial.noise(cy.CylinderGrid(8, 8, 5.0)), shape)
    run = cy.simulate(PARAMS, grid, cy.initial.disordered(grid), t_end=2.0)
    for state in (cy.initial.stripes(grid), odd, *run.frames):
        assert np.array_equal(resolved(state), state)


def test_order_mean_and_rate_are_the_same_everywhere(cell):
    grid, P = cell
    found, now = cy.diagnose(PARAMS, grid, P), cy.regime(PARAMS, grid, P)
    spread = cy.spectra(grid, P)
    live = Live(PARAMS, grid, P, every=1.0).record()
    run = cy.simulate(PARAMS, grid, P, t_end=0.01, save_every=0.01)
    stored = run.to_dataset().isel(time=0)
    frame = run.frames[0]
    for order in (
        *(now.order, live["order"], run.records["order"][0], float(stored["order"])),
        *(np.sqrt(spread["azimuthal"].sum()), np.sqrt(spread["axial"].sum())),
        np.sqrt(np.mean(np.sum(frame**2, axis=0))),
    ):
        assert order == pytest.approx(found["order"], **CLOSE)
    for mean in (now.mean_P, live["mean_P"], run.records["mean_P"][0], frame.mean(axis=(1, 2))):
        assert np.asarray(mean) == pytest.approx(found["mean_P"], **CLOSE)
    change = cy.rate_of_change(PARAMS, grid, P)
    rate = np.sqrt(np.mean(np.sum(change**2, axis=0)))
    for same in (found, live, {"rate_of_change": stored["rate_of_change"]}):
        assert float(same["rate_of_change"]) == pytest.approx(rate, **CLOSE)
    assert now.rate == pytest.approx(rate / max(now.order, 1e-300), rel=1e-10)
    assert found["max_P"] == pytest.approx(np.hypot(*frame).max(), **CLOSE)


def test_flow_and_power_are_the_same_everywhere(cell):
    grid, P = cell
    u, found = cy.flow(PARAMS, grid, P), cy.diagnose(PARAMS, grid, P)
    live = Live(PARAMS, grid, P, every=1.0)
    run = cy.simulate(PARAMS, grid, P, t_end=0.01, save_every=0.01)
    stored = run.to_dataset().isel(time=0)
    assert live.flow() == pytest.approx(u, abs=1e-14)
    assert stored["u"].values == pytest.approx(u, abs=1e-14)
    for record in (found, live.record(), {name: run.records[name][0] for name in run.records}, stored):
        assert float(record["peak_speed"]) == pytest.approx(np.hypot(*u).max(), **CLOSE)
        assert float(record["rms_speed"]) == pytest.approx(np.sqrt(np.mean(np.sum(u**2, axis=0))), **CLOSE)
        for name in ("power_input", "viscous_dissipation", "friction_dissipation", "spectral_tail"):
            assert float(record[name]) == pytest.approx(found[name], **CLOSE)


def test_regime_and_zones_are_those_of_the_state_that_is_integrated(cell):
    grid, P = cell
    run = cy.simulate(PARAMS, grid, P, t_end=0.01, save_every=0.01)
    frame, stored = run.frames[0], run.to_dataset().isel(time=0)
    given, integrated = cy.regime(PARAMS, grid, P), cy.regime(PARAMS, grid, frame)
    assert (given.name, given.settled) == (integrated.name, integrated.settled)
    assert given.zones == pytest.approx(integrated.zones, abs=1e-10)
    assert given.drift == pytest.approx(integrated.drift, abs=1e-8)
    listed = stored["zone_angle"].values
    assert listed[np.isfinite(listed)] == pytest.approx(given.zones, abs=1e-10)
    assert int(stored["zone_count"]) == given.zones.size
    assert zones_of(P) == pytest.approx(given.zones, abs=1e-10)
    assert np.array_equal(cy.zones.crossings(P), cy.zones.crossings(frame))
    assert Look.of_state(P) == Look.of_state(frame)
    lines, same = (cy.zones.indifferent_zones(grid, state) for state in (P, frame))
    assert [line.arc_length for line in lines] == pytest.approx([line.arc_length for line in same], abs=1e-8)
    assert facing_zone(P) == pytest.approx(facing_zone(frame), abs=1e-9)
    window = (0.0, 2 * np.pi)
    assert len(zone_ribbons(grid, P, window)) == len(zone_ribbons(grid, frame, window))


@pytest.mark.parametrize("dealias", ["none", "quadratic", "full"])
def test_dealiasing_changes_no_value_from_one_function_to_the_other(dealias):
    grid, P = made("noise", (16, 12), 3)
    run = cy.simulate(PARAMS, grid, P, t_end=0.02, save_every=0.02, dealias=dealias)
    for index in (0, -1):
        frame = run.frames[index]
        found = cy.diagnose(PARAMS, grid, frame, dealias=dealias)
        for name, values in run.records.items():
            expected = list(found[name].values()) if name == "budget" else found[name]
            assert np.asarray(values[index]) == pytest.approx(expected, rel=1e-9, abs=1e-12), name
        now = cy.regime(PARAMS, grid, frame, dealias=dealias)
        assert now.rate * now.order == pytest.approx(found["rate_of_change"], rel=1e-10)
        u = cy.flow(PARAMS, grid, frame, dealias)
        assert run.to_dataset()["u"].values[index] == pytest.approx(u, abs=1e-13)
    assert f"{run.records['order'][-1]:.4f}\n" in summary(run)
    assert f"{run.records['peak_speed'][-1]:.4f} U\n" in summary(run)


def test_members_of_an_ensemble_are_judged_as_runs_are():
    grid, P = made("stripes", (16, 12), 5)
    how = cy.ensemble.EnsembleSettings(t_end=0.5, finish="t_end", dealias="full")
    for protocol in (cy.Protocol(), cy.Protocol(cy.change(at=0.25, alpha_p=0.3))):
        [found] = cy.ensemble.follow([cy.ensemble.Member(PARAMS, grid, lambda: P, protocol)], how)
        now = cy.regime(PARAMS, grid, found.state, dealias="full")
        assert found.regime == now.name
        assert f"{now.rate:.1e}" in found.reason


def test_the_explorer_shows_what_the_functions_say():
    tables = {"grid": {"n_theta": 16, "n_z": 16}, "initial": {"kind": "disordered", "seed": 3}}
    session = Session(from_tables(tables))
    live = session.live
    picture = session.picture()
    length = struct.unpack("<I", picture[:4])[0]
    header = json.loads(picture[8 : 8 + length])
    now = cy.regime(live.params_now, live.grid, live.state)
    assert header["regime"]["name"] == now.name
    assert header["regime"]["zones"] == now.zones.tolist()
    found = cy.diagnose(live.params_now, live.grid, live.state)
    assert header["peak_speed"] == pytest.approx(found["peak_speed"], rel=1e-10)
    for name in ("order", "power_input", "rate_of_change", "max_P"):
        assert float(live.record()[name]) == pytest.approx(found[name], rel=1e-10)


def test_states_after_an_intervention_count_without_what_its_sharp_edges_left():
    """A frame keeps them until they have diffused away; the numbers do not hold them."""
    grid = cy.CylinderGrid(16, 16, 5.0)
    disc = cy.regions.disc(3.0, 2.5, 0.3)
    cut = cy.Protocol(cy.depolymerise(at=0.0, where=disc), cy.depolymerise(at=0.2, where=disc))
    start = cy.initial.stripes(grid, 6)
    run = cy.simulate(PARAMS, grid, start, t_end=0.4, save_every=0.1, protocol=cut)
    live = Live(PARAMS, grid, start, every=0.1, protocol=cut)
    stored = run.to_dataset()
    for index, frame in enumerate(run.frames):
        assert np.abs(resolved(frame) - frame).max() > 1e-4, "this state has Nyquist modes"
        found, seen = cy.diagnose(PARAMS, grid, frame), live.record()
        for name in ("order", "max_P", "peak_speed", "power_input", "rate_of_change", "spectral_tail"):
            assert run.records[name][index] == pytest.approx(found[name], rel=1e-10), name
            assert float(seen[name]) == pytest.approx(found[name], rel=1e-8), name
        assert cy.regime(PARAMS, grid, frame).order == pytest.approx(found["order"], rel=1e-12)
        assert np.sqrt(cy.spectra(grid, frame)["axial"].sum()) == pytest.approx(found["order"], rel=1e-12)
        u = cy.flow(PARAMS, grid, frame)
        assert stored["u"].values[index] == pytest.approx(u, abs=1e-14)
        assert live.flow() == pytest.approx(u, abs=1e-8)
        while not live.forward():
            pass
