"""Steps in pieces: the run of one program, bit for bit the same however it is cut into stretches."""

import jax
import numpy as np
import pytest

import cyclosis as cy
from cyclosis.dynamics import stretch
from cyclosis.dynamics.advance import Control, start
from cyclosis.dynamics.steppers import METHODS
from cyclosis.model.precision import double
from cyclosis.model.system import system
from cyclosis.models.kinetic.model import kinetic_model

GRID = cy.CylinderGrid(20, 16, 4.0)
PARAMS = cy.Parameters(alpha_p=0.9, kappa=0.3, repulsion_angle=0.4, epsilon=0.3)
STATE = 0.9 * cy.initial.disordered(GRID, 100, seed=3)
MOMENTS = cy.kinetic.dressed(STATE, 6)
UNEVEN = cy.initial.with_concentration(STATE, 1 + 0.2 * np.sin(GRID.theta[:, None] + 0 * GRID.z))
PROTOCOL = cy.Protocol(
    cy.change(at=0.7, over=1.0, alpha_p=0.2, mu=0.07),
    cy.change(at=1.3, where=cy.regions.disc(3.1, 2.5, 1.0), kappa=0.0),
)


def relax(t, P, u, params, grid):
    """A term of a user: decay towards a field, whose Laplacian needs transforms of its own."""
    waves = jax.numpy.fft.rfft2(P) * np.exp(-(grid.m[:, None] ** 2))[..., : grid.n_z // 2 + 1]
    return -0.1 * params.alpha_p * (P - jax.numpy.fft.irfft2(waves, grid.shape))


CASES = {
    "adaptive": {},
    "multistep": {"stepper": "multistep"},
    "etdrk4": {"stepper": "etdrk4", "dt": 0.07},
    "rk4": {"stepper": "rk4", "dt": 0.03},
    "float32": {"precision": "float32"},
    "quadratic": {"dealias": "quadratic"},
    "full, multistep": {"dealias": "full", "stepper": "multistep"},
    "fields": {"params": PARAMS.replace(alpha_p=0.9 + 0 * GRID.theta[:, None] * GRID.z)},
    "force law": {"params": PARAMS.replace(force_exponent=1.5)},
    "kinetic": {"model": kinetic_model(6), "state": MOMENTS},
    "concentration": {"model": cy.models.polar_model(concentration=True), "state": UNEVEN},
    "closure": {"model": cy.models.polar_model(closure="von_mises")},
    "coupled": {"model": cy.models.coupled_model(0.3)},
    "term": {"terms": [*cy.TERMS, relax]},
    "protocol": {"protocol": PROTOCOL},
    "protocol, multistep": {"protocol": PROTOCOL, "stepper": "multistep"},
    "steady": {
        "state": cy.initial.unidirectional(GRID, 0.9),
        "params": cy.Parameters(alpha_u=0.2),
        "steady_rate": 0.5,
    },
    "one axial point": {
        "grid": cy.CylinderGrid(32, 1),
        "state": cy.initial.disordered(cy.CylinderGrid(32, 1), 100),
    },
}
QUICK = ("adaptive", "multistep", "term", "steady")
"""Cases that always run: most of the time is that of compiling two programs."""


def run(t_end=2.0, *, params=PARAMS, grid=GRID, state=STATE, **how):
    return cy.simulate(params, grid, state, t_end, 1.0, **how)


def cut(monkeypatch):
    """Let every cell count as large; the compiled loop must not be used."""
    monkeypatch.setattr(stretch, "LARGE", 0)
    monkeypatch.delattr(stretch, "advance")


@pytest.fixture
def large(monkeypatch):
    cut(monkeypatch)


@pytest.mark.parametrize(
    "case", [case if case in QUICK else pytest.param(case, marks=pytest.mark.slow) for case in CASES]
)
def test_the_run_is_that_of_one_program(case, monkeypatch):
    """The same steps, and states to rounding: `rtol` of the steps is far larger."""
    one = run(**CASES[case])
    cut(monkeypatch)
    pieces = run(**CASES[case])
    assert (pieces.status, pieces.t_final) == (one.status, one.t_final)
    counts = [
        (found.effort.accepted, found.effort.rejected, found.effort.evaluations) for found in (one, pieces)
    ]
    assert counts[0] == counts[1]
    rounding = 1e-5 if case == "float32" else 1e-12
    assert np.abs(pieces.frames[-1] - one.frames[-1]).max() < rounding
    assert pieces.times.tolist() == one.times.tolist()


@pytest.mark.parametrize(
    "case",
    [
        "adaptive",
        "multistep",
        *(pytest.param(case, marks=pytest.mark.slow) for case in ("etdrk4", "float32", "kinetic")),
        pytest.param("protocol, multistep", marks=pytest.mark.slow),
    ],
)
def test_a_run_goes_on_bit_for_bit(case, large):
    whole = run(3.0, **CASES[case])
    again = run(3.0, **CASES[case])
    resumed = cy.resume(run(2.0, **CASES[case]), 3.0)
    for found in (again, resumed):
        assert np.array_equal(found.final_state, whole.final_state)
        assert np.array_equal(found.frames[-1], whole.frames[-1])
        assert found.effort.accepted == whole.effort.accepted


@pytest.fixture
def cell():
    with double():
        yield jax.device_put(system(PARAMS, GRID))


def began(cell, stepper):
    method = METHODS[stepper]
    control = Control.of(1e-4, 1e-6, 1.5, dt=0.05)
    return method, control, start(cell, cell.spectrum(STATE), np.float64(0.0), method)


@pytest.mark.parametrize("stepper", METHODS)
def test_stretches_of_any_number_of_steps_make_the_same_bits(stepper, cell, large):
    """Nor does a state that was handed out change while the run goes on."""
    method, control, first = began(cell, stepper)
    at_once = stretch.Stretch(cell, method).to(control, first, np.float64(9.0), 12)
    steps, now, handed = stretch.Stretch(cell, method), first, []
    for most in (1, 4, 2, 5):
        now = steps.to(control, now, np.float64(9.0), most)
        handed.append((now, jax.tree.map(np.array, now)))
    jax.tree.map(np.testing.assert_array_equal, now, at_once)
    for state, copy in handed:
        jax.tree.map(np.testing.assert_array_equal, state, copy)


def test_nothing_is_kept_at_a_target(cell, large):
    """What is measured there has the memory to itself: coefficients and room are forgotten."""
    method, control, now = began(cell, "etdrk4")
    steps = stretch.Stretch(cell, method)
    before = len(jax.live_arrays())
    steps.to(control, now, np.float64(9.0), 2)
    assert len(jax.live_arrays()) > before
    now = steps.to(control, now, np.float64(0.5), 99)
    assert float(now.t) == 0.5
    assert len(jax.live_arrays()) <= before + len(jax.tree.leaves(now))


def test_the_memory_of_steps_is_used_again(cell, large):
    """No stretch leaves more arrays than the one before."""
    method, control, now = began(cell, "etdrk4")
    steps, left = stretch.Stretch(cell, method), []
    for _ in range(4):
        now = steps.to(control, now, np.float64(9.0), 3)
        left.append(len(jax.live_arrays()))
    assert left[1] == left[2] == left[3]


def test_small_cells_run_in_one_program(cell, monkeypatch):
    """A quarter of a million modes in double precision make a large one."""
    monkeypatch.delattr(stretch, "_step")
    method, control, now = began(cell, "adaptive")
    assert float(stretch.Stretch(cell, method).to(control, now, np.float64(0.1), 100).t) == 0.1
    assert np.zeros((512, 512), complex).nbytes == stretch.LARGE


def test_numbers_and_times_trace_nothing_anew(large, monkeypatch):
    traced, one_step = [], stretch._step.__wrapped__

    def counted(*arguments):
        traced.append(None)
        return one_step(*arguments)

    monkeypatch.setattr(stretch, "_step", stretch.transforms_apart(counted))
    run()
    run(3.3, params=PARAMS.replace(alpha_p=0.7, mu=0.2), state=0.5 * STATE, rtol=1e-5)
    assert len(traced) == 1
