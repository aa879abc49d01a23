"""Growth of small disturbances against the dispersion relations of the two uniform states."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm, logm

import cyclosis as cy

from . import Row

GRID = cy.CylinderGrid(24, 16, 5.0)
TINY = 2.5e-6


def disorder_rates(p, grid):
    """Growth rates of P_theta and P_z about P = 0, each (n_theta, n_z): the flow drops out."""
    k2 = grid.m[:, None] ** 2 + grid.q[None, :] ** 2
    rate_z = p.alpha_p - p.d_r - p.d_s * k2
    return np.stack([rate_z - p.kappa, rate_z])


def unidirectional_matrix(p, m, q):
    """The matrix on (P_theta, P_z) of a disturbance exp(i(m theta + q z)) of P = P0 e_z, d = e_theta."""
    a = p.alpha_p - p.d_r
    square = 1 - p.d_r / p.alpha_p
    if m == 0 and q == 0:
        drive = 0.0 if p.zero_theta_flux else p.alpha_u * square
        return np.diag([-p.kappa + drive, -2 * a]).astype(complex)
    k2 = m**2 + q**2
    W = (p.alpha_u + 1j * p.epsilon * np.sqrt(square) * q) / (1 + p.mu * k2) * square / k2
    weak = p.d_r / p.alpha_p
    return np.array([
        [-p.d_s * k2 - p.kappa + W * q**2, -3 * m * q * W],
        [-weak * m * q * W, -p.d_s * k2 - 2 * a + 3 * weak * m**2 * W],
    ])  # fmt: skip


def resolved(grid):
    """Return index pairs of half of the modes below Nyquist (the others are their conjugates)."""
    highest = [(n - 1) // 2 for n in grid.shape]
    pairs = [(i, j) for i in range(highest[0] + 1) for j in range(-highest[1], highest[1] + 1)]
    return [(i, j) for i, j in pairs if i > 0 or j >= 0]


def evolved(p, base, noise, t_end):
    """Return spectra of a tiny disturbance at 0 and t_end; half the difference of ± cancels even orders."""
    found = []
    for sign in (1, -1):
        run = cy.simulate(
            p, GRID, base + sign * noise, t_end=t_end, save_at=(0.0, t_end), stepper="etdrk4", dt=0.01
        )
        assert run.t_final == t_end, run.message
        found.append([np.fft.fft2(frame, norm="forward") for frame in run.frames])
    return [(plus - minus) / 2 for plus, minus in zip(*found, strict=True)]


def tiny_noise(seed):
    return TINY * np.random.default_rng(seed).normal(size=(2, *GRID.shape))


DISORDERED = {
    "paper parameters": cy.Parameters(),
    "other parameters": cy.Parameters(
        alpha_p=0.3, alpha_u=0.9, epsilon=0.7, d_s=0.011, d_r=0.2, kappa=0.15, mu=0.3
    ),
}


def disorder(name, t_end=2.0):
    """Every resolved mode about disorder."""
    p = DISORDERED[name]
    begin, end = evolved(p, np.zeros((2, *GRID.shape)), tiny_noise(1), t_end)
    modes = resolved(GRID)
    rates = disorder_rates(p, GRID)
    growth = np.array(
        [[end[c][k] / begin[c][k] * np.exp(-rates[c][k] * t_end) for k in modes] for c in (0, 1)]
    )
    law = f"growth from disorder, {name}, {len(modes)} modes"
    return [
        Row(law, "amplitude of P_theta, largest relative error", float(np.abs(growth[0] - 1).max()), 1e-5),
        Row(law, "amplitude of P_z, largest relative error", float(np.abs(growth[1] - 1).max()), 1e-5),
        Row(law, "growth rates, largest error", float(np.abs(np.log(growth)).max() / t_end), 1e-5),
    ]


ORDERED = {
    "paper parameters": cy.Parameters(),
    "fast flow, weak order": cy.Parameters(
        alpha_p=0.12, alpha_u=0.8, epsilon=0.7, d_s=0.02, d_r=0.04, kappa=0.3, mu=0.2
    ),
    "no advection, zero mean u_theta": cy.Parameters(epsilon=0.0, alpha_u=0.7, d_r=0.3, zero_theta_flux=True),
}
SHOWN = ((0, 0), (1, 0), (0, 1), (1, 1), (2, -1), (3, 2))


def unidirectional(name, t_end=0.5):
    """Every resolved mode about P = P0 e_z: its 2 x 2 matrix, measured from two independent disturbances."""
    p = ORDERED[name]
    base = cy.initial.unidirectional(GRID, np.sqrt(1 - p.d_r / p.alpha_p))
    first, second = (evolved(p, base, tiny_noise(seed), t_end) for seed in (2, 3))
    law = f"growth from the unidirectional state, {name}"
    amplitude, matrices, modes = 0.0, {}, resolved(GRID)
    for m, j in modes:
        exact = unidirectional_matrix(p, m, 2 * np.pi * j / GRID.length)
        begin = np.stack([first[0][:, m, j], second[0][:, m, j]], axis=1)
        end = np.stack([first[1][:, m, j], second[1][:, m, j]], axis=1)
        expected = expm(exact * t_end) @ begin
        amplitude = max(amplitude, float((np.abs(end - expected) / np.linalg.norm(expected, axis=0)).max()))
        measured = logm(end @ np.linalg.inv(begin)) / t_end
        matrices[m, j] = float(np.abs(measured - exact).max() / np.abs(exact).max())
    rows = [Row(law, f"amplitudes of {len(modes)} modes, largest relative error", amplitude, 1e-5)]
    for m, j in SHOWN:
        rows.append(Row(law, f"2 x 2 matrix of mode ({m}, {j}), relative error", matrices[m, j], 1e-5))
    return [
        *rows,
        Row(law, "2 x 2 matrices of all modes, largest relative error", max(matrices.values()), 1e-5),
    ]


def uniform_state():
    """P0² = 1 - d_r/α_p is steady, is reached at rate -2 a, and needs Π₀ = P0³ to hold the fluid still."""
    p = cy.Parameters(alpha_p=0.6, d_r=0.2)
    P0 = np.sqrt(1 - p.d_r / p.alpha_p)
    still = cy.initial.unidirectional(GRID, P0)
    run = cy.simulate(
        p,
        GRID,
        cy.initial.unidirectional(GRID, 0.3),
        t_end=50.0,
        save_at=(20.0, 24.0, 50.0),
        stepper="etdrk4",
    )
    early, late, end = (float(frame[1].mean()) for frame in run.frames)
    rate = np.log((late - P0) / (early - P0)) / 4
    law = "uniform unidirectional state"
    return [
        Row(law, "largest |dP/dt| at P0", float(np.abs(cy.rate_of_change(p, GRID, still)).max()), 1e-14),
        Row(law, "P reached - P0", abs(end - P0), 1e-12),
        Row(law, "rate of approach / (-2 a) - 1", abs(rate / (-2 * (p.alpha_p - p.d_r)) - 1), 1e-5),
        Row(
            law,
            "pressure gradient - P0³",
            abs(cy.diagnose(p, GRID, still)["pressure_gradient"] - P0**3),
            1e-14,
        ),
        Row(law, "largest |u|", float(np.abs(cy.flow(p, GRID, still)).max()), 1e-14),
    ]


def thresholds():
    """Where the unidirectional state loses stability: growth measured on both sides of each threshold."""
    tilted = cy.Parameters(alpha_p=1.0, kappa=0.3)
    striped = cy.Parameters(alpha_p=0.1, kappa=0.5)
    a = striped.alpha_p - striped.d_r
    known = {
        "uniform tilt": (tilted, tilted.kappa / (1 - tilted.d_r / tilted.alpha_p), (0, 0, 0)),
        "stripes": (
            striped,
            striped.alpha_p**2 * (1 + striped.mu) * (2 * a + striped.d_s) / (3 * striped.d_r * a),
            (1, 1, 0),
        ),
    }
    rows = []
    for name, (p, alpha_u, mode) in known.items():
        base = cy.initial.unidirectional(GRID, np.sqrt(1 - p.d_r / p.alpha_p))
        rates = []
        for side in (0.98, 1.02):
            begin, end = evolved(p.replace(alpha_u=side * alpha_u), base, tiny_noise(4), 4.0)
            rates.append(float(np.log(np.abs(end[mode] / begin[mode])) / 4.0))
        # The rate is linear in alpha_u, so that two of them give the threshold.
        measured = 0.98 - 0.04 * rates[0] / (rates[1] - rates[0])
        rows += [
            Row(f"instability to {name}, alpha_u = {alpha_u:.4f}", "growth rate 2 % below", rates[0], 0.0),
            Row(
                f"instability to {name}, alpha_u = {alpha_u:.4f}",
                "growth rate 2 % above",
                rates[1],
                None,
                0.0,
            ),
            Row(
                f"instability to {name}, alpha_u = {alpha_u:.4f}",
                "threshold / formula - 1",
                abs(measured - 1),
                1e-5,
            ),
        ]
    return rows


def rows():
    """Return every row of this comparison."""
    out = [row for name in DISORDERED for row in disorder(name)]
    out += [row for name in ORDERED for row in unidirectional(name)]
    return out + uniform_state() + thresholds()
