"""Eigenvalues and modes of stripes: known numbers, closed forms, convergence, and rates of simulations."""

from __future__ import annotations

import numpy as np

import cyclosis as cy
from cyclosis.stability.profiles import elliptic

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
    """Eigenvalues by n_theta: errors fall exponentially, until rounding is reached at some 128 points."""
    best = cy.stability.cyclosis(FIGURE_4, 256).spectrum(4, components="z").eigenvalues
    rows, errors, sizes = [], [], (64, 80, 96, 112)
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
        Row(law, "zero mode, least fall per 16 points, decades", float(falls[:, 0].min()), None, 1.5),
        Row(law, "error of -0.064, least fall per 16 points, decades", float(falls[:, 1].min()), None, 1.5),
    ]


CELL = cy.Parameters(alpha_p=0.3, alpha_u=0.3, epsilon=0.8, kappa=0.2)
GRID = cy.CylinderGrid(64, 8, 2.5)
MODES = ((0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2), (1, 4))
"""Axial wavenumber and number of the mode within the spectrum of `CELL`; the last two are complex."""
COUNT = 23
"""Leading modes of the whole cell that hold them all."""


def three_ways():
    """The same eigenvalues from the profile, from the whole cell, and from runs from states ± mode."""
    base = cy.stability.cyclosis(CELL, GRID.n_theta)
    still = np.zeros((2, *GRID.shape))
    still[1] = base.P[:, None]
    whole = cy.stability.leading_modes(CELL, GRID, still, COUNT).eigenvalues
    rows = []
    for j, number in MODES:
        found = base.spectrum(number + 2, axial_mode=j, length=GRID.length)
        value = found.eigenvalues[number]
        wave = found.modes[number][:, :, None] * np.exp(1j * found.wavenumber * GRID.z)
        rate = simulated(still, wave, value)
        shown = f"{value.real:.5f}" + (f" + {value.imag:.5f}i" if abs(value.imag) > 1e-9 else "")
        law = f"mode {shown}, axial_mode = {j}"
        rows += [
            Row(law, "leading_modes / spectrum - 1", float(np.abs(whole / value - 1).min()), 1e-9),
            Row(law, "rate in a run / spectrum - 1", float(abs(rate / value - 1)), 1e-5),
        ]
    return rows


def simulated(still, wave, value, t_end=3.0, size=1e-4):
    """Return the complex rate of a mode in runs; `value` only says how often it turns."""
    answers = []
    # Real and imaginary part apart, and half the difference of ±, so that what is left is linear.
    for part in (wave.real, wave.imag) if np.abs(wave.imag).max() > 1e-9 else (wave.real,):
        ends = []
        for sign in (1, -1):
            start = still + sign * size * part
            run = cy.simulate(CELL, GRID, start, t_end, save_at=(t_end,), stepper="etdrk4", dt=0.02)
            assert run.ok, run.message
            ends.append(run.final_state)
        answers.append((ends[0] - ends[1]) / (2 * size))
    answer = answers[0] + (1j * answers[1] if len(answers) == 2 else 0)
    factor = np.sum(np.conj(wave) * answer) / np.sum(np.abs(wave) ** 2)
    turns = np.round((value * t_end - np.log(factor)).imag / (2 * np.pi))
    return (np.log(factor) + 2j * np.pi * turns) / t_end


def rows():
    """Return every row of this comparison."""
    return known() + closed_forms() + convergence() + three_ways()
