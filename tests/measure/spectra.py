"""Eigenvalues and modes of stripes: known numbers, closed forms, convergence, and rates of simulations."""

from __future__ import annotations

import numpy as np

import cyclosis as cy
from cyclosis.stability import elliptic

from . import Row

FIGURE_4 = cy.Parameters(alpha_p=1.0, alpha_u=0.5)
KNOWN = (-0.06406947, -1.841276)
UNITS = (5e-9, 5e-7)


def known():
    """Figure 4: the rotation, and the known eigenvalues to their printed digits."""
    found = cy.stability.cyclosis(FIGURE_4).spectrum(6, components="z").eigenvalues
    law = "two stripes at alpha_p = 1, alpha_u = 0.5, n_theta = 256"
    rows = [Row(law, "zero mode of rotation", abs(found[0]), 1e-10)]
    for value, unit in zip(KNOWN, UNITS, strict=True):
        rows.append(Row(law, f"eigenvalue - ({value})", float(np.abs(found - value).min()), 1.01 * unit))
    return rows


def closed_forms():
    """Without flow: all eight rates that Lamé's equations give, of P_z and P_theta."""
    rows = []
    for alpha_p, printed, unit in ((0.1, 3.28547e-3, 5e-9), (0.2, 1.31966e-4, 5e-10), (1.0, None, None)):
        p = cy.Parameters(alpha_p=alpha_p, alpha_u=0.0)
        state = cy.stability.cyclosis(p)
        law = f"stripes without flow, alpha_p = {alpha_p:g}"
        exact = elliptic.elliptic_profile(p, state.theta)
        rows.append(Row(law, "P - sn, largest", float(np.abs(state.P - exact).max()), 1e-10))
        for component, values in zip(("z", "theta"), elliptic.elliptic_rates(p), strict=True):
            found = state.spectrum(20, components=component).eigenvalues
            apart = max(float(np.abs(found - value).min()) for value in values)
            rows.append(Row(law, f"rates of P_{component}, largest error of {values.size}", apart, 1e-10))
        growth = elliptic.elliptic_growth(p)
        rows.append(Row(law, "growth of unequal widths", growth))
        if printed:
            rows.append(Row(law, f"growth - {printed}", abs(growth - printed), 1.01 * unit))
    return rows


def convergence():
    """Eigenvalues by n_theta: errors fall exponentially."""
    best = cy.stability.cyclosis(FIGURE_4, 320).spectrum(4, components="z").eigenvalues
    rows, errors, sizes = [], [], (64, 96, 128, 160)
    law = "spectrum at alpha_p = 1, alpha_u = 0.5"
    for n in sizes:
        found = cy.stability.cyclosis(FIGURE_4, n).spectrum(4, components="z").eigenvalues
        zero, slow = float(np.abs(found).min()), float(np.abs(found - best[1]).min())
        errors.append((zero, slow))
        rows += [
            Row(law, f"zero mode, n_theta = {n}", zero),
            Row(law, f"error of -0.064, n_theta = {n}", slow),
        ]
    falls = -np.diff(np.log10(errors), axis=0)
    return [
        *rows,
        Row(law, "zero mode, least fall per 32 points, decades", float(falls[:, 0].min()), None, 1.2),
        Row(law, "error of -0.064, least fall per 32 points, decades", float(falls[:, 1].min()), None, 1.2),
    ]


CELL = cy.Parameters(alpha_p=0.5, alpha_u=0.3, epsilon=0.4)
MODES = ((0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 4), (2, 0), (2, 4))
"""Axial wavenumber and number of the mode within the spectrum."""


def simulated(t_end=3.0, size=1e-4):
    """Rates at which modes grow or decay in runs of the whole cell from states ± mode."""
    grid = cy.CylinderGrid(64, 12, 5.0)
    base = cy.stability.cyclosis(CELL, grid.n_theta)
    still = np.zeros((2, *grid.shape))
    still[1] = base.P[:, None]
    rows = []
    for j, number in MODES:
        found = base.spectrum(number + 2, axial_mode=j, length=grid.length)
        mode, value = found.modes[number], found.eigenvalues[number]
        wave = mode[:, :, None] * np.exp(1j * found.wavenumber * grid.z)
        answers = []
        # Real and imaginary part apart, and half the difference of ±, so that what is left is linear.
        for part in (wave.real, wave.imag) if np.abs(wave.imag).max() > 1e-9 else (wave.real,):
            ends = [
                cy.simulate(
                    CELL, grid, still + sign * size * part, t_end, save_at=(t_end,), stepper="etdrk4", dt=0.02
                ).final_state
                for sign in (1, -1)
            ]
            answers.append((ends[0] - ends[1]) / (2 * size))
        answer = answers[0] + (1j * answers[1] if len(answers) == 2 else 0)
        factor = np.sum(np.conj(wave) * answer) / np.sum(np.abs(wave) ** 2)
        turns = np.round((value * t_end - np.log(factor)).imag / (2 * np.pi))
        rate = (np.log(factor) + 2j * np.pi * turns) / t_end
        law = f"a mode in a run, axial_mode = {j}, eigenvalue {value:.5g}"
        rows.append(Row(law, "fitted rate, relative error", float(abs(rate - value) / abs(value)), 1e-5))
    return rows


def rows():
    """Return every row of this comparison."""
    return known() + closed_forms() + convergence() + simulated()
