"""The kinetic model against an independent program, an oracle on a grid of angles, and closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from scipy.special import iv

import cyclosis as cy
import kinetic_oracle
from cyclosis.model.precision import double
from cyclosis.models.kinetic.theory import _modes

from . import Row, kinetic_states

KINETIC = cy.models.kinetic
REFERENCE = Path(__file__).parents[1] / "reference" / "kinetic.npz"
GRID = cy.CylinderGrid(16, 12, 4.0)
GENERAL = cy.Parameters(
    alpha_p=0.7, alpha_u=0.6, kappa=0.3, epsilon=0.2, d_s=0.03, d_r=0.08, mu=0.07, repulsion_angle=0.4
)
MODES = 20


def smooth(grid=GRID, modes=MODES, sharp=1.0):
    """Return moments of a smooth density that varies along both axes."""
    theta, z = grid.theta[:, None, None], 2 * np.pi * grid.z[None, :, None] / grid.length
    phi = 2 * np.pi / 128 * np.arange(128)
    exponent = (0.8 + 0.4 * np.cos(theta + 0.3) + 0.3 * np.sin(z)) * np.cos(phi - 0.5 * np.cos(theta - z))
    psi = np.exp(sharp * exponent + 0.3 * np.cos(2 * phi - 0.5))
    return cy.kinetic.moments(psi / (2 * np.pi * psi.mean(axis=2, keepdims=True)), modes)


def run(state, t_end, params=GENERAL, grid=GRID, save_every=None, **settings):
    """Return a run of the kinetic model."""
    return cy.simulate(params, grid, state, t_end, save_every or t_end, model=KINETIC, **settings)


def right_hand_side(params, grid, m):
    """Return dm/dt of a state, shape (N + 1, n_theta, n_z)."""
    problem = KINETIC.problem(params, grid, shape=m.shape)
    system = KINETIC.system(problem, True)
    with double():
        return np.fft.ifft2(np.asarray(system.rate(system.at(KINETIC.modes(system, m)))))


def reference(n, modes, times):
    """The largest errors of P and of the moments against the file, at each time."""
    with np.load(REFERENCE) as file:
        known = json.loads(str(file["parameters"]))
        grid, psi = _reference_start(known, n)
        names = {"epsilon": "eps", "d_s": "d_s", "d_r": "d_r", "alpha_p": "a_p", "alpha_u": "a_u"}
        names |= {"kappa": "k", "mu": "mu", "repulsion_angle": "beta"}
        params = cy.Parameters(**{name: known[key] for name, key in names.items()})
        state = cy.kinetic.moments(psi, modes)
        found = run(state, times[-1], params, grid, rtol=1e-8, atol=1e-12, save_at=times)
        every, rows = n // 16, []
        for t, m in zip(found.times, found.frames, strict=True):
            P, own = cy.kinetic.order(m)[:, ::every, ::every], m[:21, ::every, ::every]
            law = f"kinetic reference, {n} x {n} points, {modes} modes, t = {t:g}"
            rows += [
                Row(law, "max |P - P_ref|", float(np.abs(P - file[f"P_{t:g}"]).max()), 1e-7),
                Row(law, "max |m_n - m_ref|", float(np.abs(own - file[f"moments_{t:g}"]).max()), 1e-6),
            ]
        return rows


def _reference_start(known, n):
    grid = cy.CylinderGrid(n, n, known["ell"])
    one, two, three, four = known["init_phases"]
    theta, z = grid.theta[:, None, None], (2 * np.pi * grid.z / grid.length)[None, :, None]
    phi = 2 * np.pi / 256 * np.arange(256)
    a = 0.9 + 0.5 * np.cos(theta + one) + 0.4 * np.sin(z + two)
    b = 0.3 + 0.6 * np.cos(theta - z + three) + 0.3 * np.sin(2 * theta + four)
    psi = np.exp(a * np.cos(phi) + b * np.sin(phi) + 0.35 * np.cos(z - theta) * np.cos(2 * phi - 0.5))
    return grid, psi / (2 * np.pi * psi.mean(axis=2, keepdims=True))


CASES = ("numbers", "no flux around", "another force", "fields")


def against_the_oracle(name):
    """One right-hand side; the oracle holds Ψ on angles and ω as a vector expression: no moments."""
    grid = cy.CylinderGrid(32, 32, 4.0)
    shape = 0.2 * np.cos(grid.theta)[:, None] * np.sin(2 * np.pi * grid.z / grid.length)
    values = {
        "numbers": {},
        "no flux around": {"zero_theta_flux": True},
        "another force": {"force_exponent": 1.0},
        "fields": {"alpha_p": 0.7 + shape, "alpha_u": 0.6 - shape, "kappa": 0.3 + shape},
    }[name]
    params, m = GENERAL.replace(**values), smooth(grid, 31, 0.3)
    rate = kinetic_oracle.rate(cy.kinetic.density(m, 64), dict(params.items()), grid.length)
    error = np.abs(right_hand_side(params, grid, m)[:25] - kinetic_oracle.moments(rate, 24)).max()
    return [Row(f"one kinetic right-hand side, {name}", "max error of dm_n/dt, n <= 24", float(error), 1e-10)]


WAVES = [
    *(("nematic", 0, 0), ("nematic", 1, 0), ("nematic", 1, 1)),
    *(("z", 0, 0), ("z", 1, 0), ("z", 0, 1), ("z", 1, 1), ("z", 2, -1)),
    ("theta", 1, 1),
]
"""Uniform states, and waves (m, j) about them with q = 2π j/length."""


def wave(direction, m, j):
    """The fastest growing wave about a uniform state in a run, against its eigenvector and growth rate."""
    params, t = GENERAL.replace(repulsion_angle=0.0), 1.0
    base = cy.kinetic.uniform_state(params, direction, 30)
    q = 2 * np.pi * j / GRID.length
    values, vectors = _modes(params, base, m, q)
    factor, delta = np.exp(values[0] * t), vectors[:, 0]
    plus, minus = np.append(0.0, delta[30:]), np.append(0.0, delta[:30][::-1])
    shape = np.exp(1j * (m * GRID.theta[:, None] + q * GRID.z[None, :]))
    size = 1e-7 / np.abs(delta).max()
    disturbed = plus[:, None, None] * shape + np.conj(minus[:, None, None] * shape)
    still = np.broadcast_to(base[:, None, None], disturbed.shape)
    # Exponential steps keep a steady state exactly: their errors are those of the wave alone.
    found = run(still + size * disturbed, t, params, stepper="etdrk4", dt=0.02)
    changed = (found.final_state - still)[1:] / size
    if m == j == 0:
        expected = factor * plus[1:] + np.conj(factor * minus[1:])
        measured = changed.mean(axis=(1, 2))
    else:
        expected, measured = factor * plus[1:], (changed * np.conj(shape)).mean(axis=(1, 2))
    error = np.abs(measured - expected).max() / np.abs(expected).max()
    law = f"kinetic wave ({m}, {j}) about the {direction} state, growth rate {values[0]:.6f}"
    return [Row(law, "relative error of all moments at t = 1", float(error), 1e-6)]


def thresholds():
    """Bundling rates where polarity grows from the nematic state, and the growth rate there."""
    found = cy.kinetic.thresholds(cy.Parameters(kappa=0.5, d_r=0.025))
    rows = []
    for name, value, known, half in (
        ("across", found.across, 0.0264078, 5e-8),
        ("along", found.along, 0.468969, 5e-7),
    ):
        params = cy.Parameters(alpha_p=value)
        rates = cy.kinetic.growth_rates(params, cy.kinetic.uniform_state(params, "nematic", 60), 0, 0.0)
        law = f"kinetic threshold of polarity {name} d"
        rows += [
            Row(law, "alpha_p", float(value), known + half, known - half),
            Row(law, "smallest |growth rate| there", float(np.abs(rates).min()), 1e-9),
        ]
    return rows


def uniform_orders():
    """Uniform order without repulsion, by the self-consistency and by a run, against I_1/I_0."""
    rows = []
    for alpha_p, d_r in ((0.5, 0.05), (0.3, 0.1)):
        params = cy.Parameters(alpha_p=alpha_p, d_r=d_r, kappa=0.0, epsilon=0.0)
        found = abs(cy.kinetic.uniform_state(params)[1])
        x = alpha_p * found / d_r
        state = cy.kinetic.dressed(cy.initial.unidirectional(GRID, 0.5), 40)
        end = cy.kinetic.order(run(state, 400.0, params, rtol=1e-9).final_state)[1].mean()
        law = f"kinetic uniform order, alpha_p = {alpha_p}, d_r = {d_r}"
        rows += [
            Row(
                law,
                "|P| - I_1(x)/I_0(x), x = alpha_p |P|/d_r",
                float(abs(iv(1, x) / iv(0, x) - found)),
                1e-12,
            ),
            Row(law, "|P| of a run at t = 400 less that", float(abs(end - found)), 1e-8),
        ]
    return rows


def conserved():
    """The concentration: even where it was even, of constant mean otherwise."""
    even = run(smooth(), 4.0, stepper="etdrk4", dt=0.02).final_state[0]
    uneven = run(
        smooth() * (1 + 0.3 * np.cos(GRID.theta)[:, None]), 4.0, stepper="etdrk4", dt=0.02, save_every=1.0
    )
    means = np.array([m[0].mean() for m in uneven.frames])
    return [
        Row(
            "kinetic concentration, even at first",
            "max |c - 1| at t = 4",
            float(np.abs(even - 1).max()),
            1e-12,
        ),
        Row(
            "kinetic concentration, uneven",
            "change of its mean",
            float(np.abs(means - means[0]).max()),
            1e-13,
        ),
    ]


def order_in_time(stepper):
    """The order of a stepper of fixed steps."""

    def end(stepper, dt):
        return run(smooth(modes=12), 1.0, stepper=stepper, dt=dt).final_state

    exact = end("etdrk4", 0.0025)
    coarse, fine = (np.abs(end(stepper, dt) - exact).max() for dt in (0.04, 0.02))
    return [
        Row(
            f"kinetic order in time, {stepper}", "log2 of two errors", float(np.log2(coarse / fine)), 4.2, 3.8
        )
    ]


def rows():
    """Return every row of this section."""
    return [
        *reference(48, 32, (0.5, 2.0, 6.0)),
        *(row for name in CASES for row in against_the_oracle(name)),
        *(row for case in WAVES for row in wave(*case)),
        *thresholds(),
        *uniform_orders(),
        *conserved(),
        *(row for stepper in ("etdrk4", "rk4") for row in order_in_time(stepper)),
        *kinetic_states.rows(),
    ]
