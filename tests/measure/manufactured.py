"""A manufactured solution: P* is chosen, and a user's own term supplies exactly what P* needs to solve the
filament equation with all terms on. Space and time errors are then known at once."""

from __future__ import annotations

from functools import cache

import jax
import jax.numpy as jnp
import numpy as np

import cyclosis as cy
import oracle
from cyclosis.dynamics import multistep, steppers
from cyclosis.model.precision import double
from cyclosis.model.system import system

from . import Row

LENGTH = 4.0
PARAMS = cy.Parameters(
    alpha_p=0.8, alpha_u=0.6, epsilon=0.4, d_s=0.03, d_r=0.05, kappa=0.5, mu=0.06, repulsion_angle=0.7
)
SPEED = (0.7, -0.9)
POWERS = (1, 3, 4, 5, 6)
"""Powers of the amplitude a in the right-hand side of a S: u goes with a³, the projector brings a²."""
GEOMETRIC = 0.42
"""Ratio of successive Fourier coefficients of the smooth S; 0 makes an S of modes 0 and ±1 only."""


def _waves(x, b):
    """Return Σ bᵏ⁻¹ cos kx and Σ bᵏ⁻¹ sin kx (k >= 1), scaled to at most 1."""
    scale = (1 - b) / (1 - 2 * b * np.cos(x) + b**2)
    return scale * (np.cos(x) - b), scale * np.sin(x)


def amplitude(t, xp=np):
    """Return a(t) and da/dt."""
    return 0.8 + 0.2 * xp.sin(1.9 * t), 0.38 * xp.cos(1.9 * t)


def shape_function(t, shape, b):
    """Return S(theta - c_theta t, z - c_z t), |S| < 1."""
    theta = 2 * np.pi * np.arange(shape[0])[:, None] / shape[0] - SPEED[0] * t
    zeta = 2 * np.pi * (np.arange(shape[1])[None, :] / shape[1] - SPEED[1] * t / LENGTH)
    (c1, s1), (c2, s2), (c3, s3) = _waves(theta, b), _waves(zeta, b), _waves(theta + 1.0, b)
    return np.stack([
        0.2 + 0.3 * c1 * s2 + 0.15 * s1 + 0.1 * c2,
        0.1 + 0.4 * s3 * c2 + 0.15 * (s2 + 0.5 * c3 + 0.3 * c2),
    ])  # fmt: skip


def solution(t, shape, b):
    """Return P*(t) = a(t) S(x - c t)."""
    return amplitude(t)[0] * shape_function(t, shape, b)


@cache
def forcing(b, reference):
    """Return the user's term dP*/dt - (right-hand side of P*).

    The right-hand side is a polynomial in a, whose coefficients are fields that move with P*. The oracle
    gives them, from six amplitudes, on the grid `reference`, fine enough for products of six factors.
    """
    S = shape_function(0.0, reference, b)
    values = np.array([-1.0, -0.7, -0.4, 0.4, 0.7, 1.0])
    rates = np.stack([oracle.rate(PARAMS, LENGTH, a * S) for a in values])
    matrix = values[:, None] ** np.array(POWERS)
    parts = np.linalg.lstsq(matrix, rates.reshape(values.size, -1), rcond=None)[0].reshape(-1, *S.shape)
    slopes = [oracle.gradient(S[i], LENGTH) for i in (0, 1)]
    drift = np.stack([-SPEED[0] * along_theta - SPEED[1] * along_z for along_theta, along_z in slopes])

    @cache
    def spectra(shape):
        return np.stack([np.fft.fft2(oracle.both(field, shape)) for field in (S, drift, *parts)])

    def manufactured_forcing(t, P, u, params, grid):
        a, slope = amplitude(t, jnp)
        weights = jnp.stack([slope, a, *(-(a**power) for power in POWERS)])
        m, q = oracle.wavenumbers(grid.shape, LENGTH)
        moved = jnp.exp(-1j * (SPEED[0] * m + SPEED[1] * q) * t)
        return jnp.fft.ifft2(jnp.tensordot(weights, spectra(grid.shape), 1) * moved).real

    return manufactured_forcing


def forcing_defect():
    """The user's term plus the oracle's right-hand side against dP*/dt by a complex step, at some times."""
    worst = 0.0
    for b, reference in ((0.0, SMALL), (GEOMETRIC, REFERENCE)):
        term, grid = forcing(b, reference), cy.CylinderGrid(*reference, LENGTH)
        for t in (0.0, 0.37, 2.9):
            P = solution(t, reference, b)
            slope = solution(t + 1e-30j, reference, b).imag / 1e-30
            with double():
                forced = np.asarray(
                    jax.jit(lambda t, term=term, grid=grid: term(t, None, None, None, grid))(t)
                )
            exact = slope - oracle.rate(PARAMS, LENGTH, P)
            worst = max(worst, float(np.abs(forced - exact).max() / np.abs(exact).max()))
    largest = max(
        np.hypot(*solution(t, REFERENCE, b)).max() for b in (0.0, GEOMETRIC) for t in np.arange(0, 4, 0.1)
    )
    law = "manufactured solution"
    return [
        Row(law, "forcing against dP*/dt - rate(P*)", worst, 1e-11),
        Row(law, "max |P*|", float(largest), 1.0),
    ]


def run(shape, b, reference, t_end=1.0, **settings):
    """Integrate from P*(0) and return the largest error at `t_end` and the run."""
    grid = cy.CylinderGrid(*shape, LENGTH)
    terms = [*oracle.TERMS, forcing(b, reference)]
    begin, end = solution(0.0, shape, b), solution(t_end, shape, b)
    out = cy.simulate(PARAMS, grid, begin, t_end=t_end, save_at=(t_end,), terms=terms, **settings)
    assert out.t_final == t_end, out.message
    return float(np.abs(out.final_state - end).max()), out


SIZES = ((12, 12), (20, 20), (32, 32), (48, 48), (64, 64))
REFERENCE = (128, 128)
BRIEF, SHORT = 0.2, 0.005


def spectral(sizes=SIZES):
    """The error falls geometrically with n down to what the time step leaves."""
    errors = [run(shape, GEOMETRIC, REFERENCE, BRIEF, stepper="etdrk4", dt=SHORT)[0] for shape in sizes]
    law = "manufactured solution, all terms on, etdrk4"
    rows = [
        Row(law, f"max |P - P*|, {n} x {k}", e) for (n, k), e in zip(sizes[:-1], errors[:-1], strict=True)
    ]
    rows.append(Row(law, f"max |P - P*|, {sizes[-1][0]} x {sizes[-1][1]}", errors[-1], 1e-10))
    for (n, _), (k, _), a, b in zip(sizes, sizes[1:], errors, errors[1:], strict=False):
        bound = None if (k, k) == sizes[-1] else 0.5
        rows.append(
            Row(law, f"decay of that error per mode, n = {n} to {k}", (b / a) ** (2 / (k - n)), bound)
        )
    return rows


SMALL = (16, 16)
"""Six times the one mode of P* fit: on this grid P* with b = 0 has no error in space."""


def fixed_steps(stepper, steps=(0.05, 0.025, 0.0125, 0.00625)):
    """Order in time of a fixed-step method, from successive halvings, against the one that it claims."""
    order = steppers.METHODS[stepper].order
    errors = [run(SMALL, 0.0, SMALL, stepper=stepper, dt=dt)[0] for dt in steps]
    law = f"order in time, {stepper}"
    rows = [Row(law, f"max |P - P*|, dt = {dt:g}", e) for dt, e in zip(steps, errors, strict=True)]
    for a, b, dt in zip(errors, errors[1:], steps[1:], strict=False):
        rows.append(
            Row(law, f"order, dt = {2 * dt:g} to {dt:g}", float(np.log2(a / b)), order + 0.2, order - 0.2)
        )
    return rows


def adaptive(stepper="adaptive", tolerances=(1e-5, 1e-6, 1e-7, 1e-8, 1e-9)):
    """Order of an adaptive stepper: of its solution against the number of steps.

    Of multistep without the largest tolerance, at which the first short steps are a third of all.
    """
    tolerances = tolerances[1:] if stepper == "multistep" else tolerances
    found = [run(SMALL, 0.0, SMALL, stepper=stepper, rtol=rtol, atol=1e-14) for rtol in tolerances]
    law = f"order in time, {stepper}"
    rows = [
        Row(law, f"max |P - P*|, rtol = {rtol:g}, {out.effort.accepted} steps", error)
        for rtol, (error, out) in zip(tolerances, found, strict=True)
    ]
    steps = np.log([out.effort.accepted for _, out in found])
    slope = -np.polyfit(steps, np.log([error for error, _ in found]), 1)[0]
    return [*rows, Row(law, "order, error against number of steps", float(slope), 4.2, 3.8)]


def estimate(steps=(0.1, 0.05, 0.025, 0.0125)):
    """One step: the error estimate is that of a third-order method, so h⁴; the error itself is h⁵."""
    t0, grid = 0.3, cy.CylinderGrid(*SMALL, LENGTH)
    cell = system(PARAMS, grid, [*oracle.TERMS, forcing(0.0, SMALL)])
    estimates, errors = [], []

    @jax.jit
    def one(cell, Z, h):
        begin = cell.nonlinear(cell.at(Z, t0))
        taken = steppers.step(cell, steppers.tableau(cell.linear(), h), t0, h, Z, begin)
        return taken.spectrum, taken.error

    with double():
        Z = cell.spectrum(solution(t0, SMALL, 0.0))
        for h in steps:
            new, error = one(cell, Z, h)
            estimates.append(float(np.sqrt(np.mean(cell.state(error) ** 2))))
            errors.append(float(np.sqrt(np.mean((cell.state(new) - solution(t0 + h, SMALL, 0.0)) ** 2))))
    rows = []
    for name, values, order in (("error estimate", estimates, 4), ("error", errors, 5)):
        for a, b, h in zip(values, values[1:], steps[1:], strict=False):
            measured = float(np.log2(a / b))
            last = h == steps[-1]
            rows.append(
                Row("one step of the adaptive pair", f"order of its {name}, h = {2 * h:g} to {h:g}", measured,
                    order + 0.2 if last else None, order - 0.2 if last else None)
            )  # fmt: skip
    return rows


def one_multistep(steps=(0.1, 0.05, 0.025, 0.0125)):
    """One multistep step from exact states, uneven in time: error estimate h⁴, error h⁵, N' - N(P') h⁴.

    N' is that of a derivative of fourth order, and D that of the state before, as in a run.
    """
    t0, grid, gaps = 0.3, cy.CylinderGrid(*SMALL, LENGTH), np.array([0.0, 1.2, 2.1, 3.5])
    cell = system(PARAMS, grid, [*oracle.TERMS, forcing(0.0, SMALL)])
    found = {"error estimate": [], "error": [], "error of N": []}

    @jax.jit
    def one(cell, states, h):
        t = t0 - h * gaps
        moments = [cell.at(Z, time) for Z, time in zip(states, t, strict=True)]
        rest = [cell.nonlinear(now) for now in moments]
        modes = jnp.stack([*states[1:], *rest[1:3]])
        past = multistep.Past(t[1:], modes, cell.local(moments[0]))
        taken = steppers.multistep(cell, cell.linear(), t0, h, states[0], rest[0], past)
        return taken, cell.nonlinear(cell.at(taken.spectrum, t0 + h))

    with double():
        for h in steps:
            states = [cell.spectrum(solution(t0 - h * gap, SMALL, 0.0)) for gap in gaps]
            taken, rest = one(cell, states, h)
            assert taken.evaluations == 1
            exact = cell.spectrum(solution(t0 + h, SMALL, 0.0))
            errors = taken.error, taken.spectrum - exact, taken.nonlinear - rest
            for values, error in zip(found.values(), errors, strict=True):
                values.append(float(cell.size(error)))
    rows, law = [], "one step of multistep"
    for (name, values), order in zip(found.items(), (4, 5, 4), strict=True):
        for a, b, h in zip(values, values[1:], steps[1:], strict=False):
            last = h == steps[-1]
            low, high = (order - 0.2, order + 0.2) if last else (None, None)
            rows.append(
                Row(law, f"order of its {name}, h = {2 * h:g} to {h:g}", float(np.log2(a / b)), high, low)
            )
    return rows


def rows():
    """Return every row of this comparison."""
    return [
        *forcing_defect(),
        *spectral(),
        *fixed_steps("rk4"),
        *fixed_steps("etdrk4"),
        *adaptive(),
        *estimate(),
        *adaptive("multistep"),
        *one_multistep(),
    ]
