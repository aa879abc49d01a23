"""Branches: where they turn, meet and end, against exact values, closed forms and simulations."""

from __future__ import annotations

import time

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

import cyclosis as cy
from cyclosis.stability.uniform.dispersion import growth_rates

from . import Row

N = 128
FOLD = 0.227
THRESHOLDS = {0.1: 7.47e-3, 0.2: 4.17e-4}
TILTS, VANISHES = 0.4706964268, 0.0483970063
"""Where cyclosis begins to tilt and tilted stripes vanish, as κ falls, at α_p = 1, α_u = 0.5."""


def two_stripes(**values):
    return cy.stability.cyclosis(cy.Parameters(**values), N)


def ends():
    """Folds, branch points and amplitudes of two stripes at small α_p."""
    follow = cy.stability.continue_branch
    branch = follow(two_stripes(alpha_p=0.0, alpha_u=0.5), "alpha_u", (0.2, 0.5), length=None)
    (fold,) = branch.of("fold")
    rows = [Row("fold at alpha_p = 0", f"alpha_u - {FOLD}", abs(fold.value - FOLD), 5e-4)]
    branch = follow(two_stripes(alpha_p=0.05, alpha_u=0.2), "alpha_u", (0.0, 0.2), length=None)
    law = "pitchfork at alpha_p = d_r + d_s"
    rows.append(Row(law, "alpha_u / [alpha_p (1 + mu)] - 1", abs(branch.points[0].value / 0.0525 - 1), 1e-8))
    for alpha_p, known in THRESHOLDS.items():
        start = two_stripes(alpha_p=alpha_p, alpha_u=0.02)
        branch = follow(start, "alpha_u", (0.0, 0.02), length=None, longest=0.1)
        (point,) = branch.of("branch point")
        law = f"branch point along alpha_u, alpha_p = {alpha_p}"
        rows.append(Row(law, f"alpha_u / {known:g} - 1", abs(point.value / known - 1), 1e-3))
    branch = follow(two_stripes(alpha_p=0.2, alpha_u=0.0), "alpha_p", (0.0, 0.5), length=None)
    exact = np.array([elliptic(alpha_p) for alpha_p in branch.parameter[1:]])
    found = np.stack([branch.measures["max_P"], branch.eigenvalues[:, 0].real], axis=1)[1:]
    law = "two stripes along alpha_p without flow"
    order, growth = np.abs(found - exact).max(axis=0)
    return [
        *rows,
        Row(law, "alpha_p - (d_r + d_s) where they end", abs(branch.points[0].value - 0.05), 1e-8),
        Row(law, "max P - that of the elliptic function", order, 1e-8),
        Row(law, "growth rate - the closed form", growth, 1e-8),
    ]


def elliptic(alpha_p, d=0.025):
    """Return the exact amplitude and unstable eigenvalue of two stripes without flow."""
    a = alpha_p - d

    def turn(k2):
        return 4 * ellipk(k2) * np.sqrt(d * (1 + k2) / a) - 2 * np.pi

    k2 = 1 - brentq(lambda rest: turn(1 - rest), 1e-15, 1 - 1e-12, xtol=1e-18)
    return np.sqrt(2 * k2 / (1 + k2) * a / alpha_p), a * (2 * np.sqrt(1 - k2 + k2**2) - (1 + k2)) / (1 + k2)


def tilted():
    """Tilted stripes over κ: both ends, and their drift in simulations."""
    follow = cy.stability.continue_branch
    upright = follow(two_stripes(), "kappa", (0.2, 0.6), length=None, longest=0.1)
    tilt = upright.of("branch point")[-1].value
    branch = follow(cy.stability.drifting(cy.Parameters(kappa=0.2), N), "kappa", (0.0, 0.6))
    vanish, straight = branch.points[0], branch.points[-1]
    rate = growth_rates(branch.params.replace(kappa=vanish.value), "circumferential", 1, 0)[0]
    law = "tilted stripes over kappa, alpha_p = 1, alpha_u = 0.5"
    rows = [
        Row(law, f"kappa of the pitchfork, along cyclosis, - {TILTS}", abs(tilt - TILTS), 1e-9),
        Row(law, "the same along the tilted stripes", abs(straight.value - TILTS), 1e-8),
        Row(law, f"kappa of the Hopf point - {VANISHES}", abs(vanish.value - VANISHES), 1e-9),
        Row(law, "growth rate of the closed form there", abs(rate.real), 1e-9),
        Row(law, "its frequency - the drift", abs(abs(rate.imag) - abs(branch.drift[0])), 1e-9),
        Row(law, "states between them that are not stable", float((~branch.stable[1:-1]).sum()), 0.0),
    ]
    for kappa in (0.1, 0.15, 0.2):
        drift, simulated = cy.stability.drifting(cy.Parameters(kappa=kappa), 64).drift, simulated_drift(kappa)
        law = f"drift of tilted stripes, kappa = {kappa}: {simulated:.7g} in a simulation, 64 x 16"
        rows.append(Row(law, "drift / that - 1", abs(drift / simulated - 1), 1e-4))
    return rows


def simulated_drift(kappa, settle=300.0, watch=100.0):
    """Return the speed at which stripes turn once they have settled, from a rough guess and noise."""
    grid = cy.CylinderGrid(64, 16, 5.0)
    P = np.zeros((2, *grid.shape))
    P[0], P[1] = 0.5, 0.8 * np.tanh(3 * np.sin(grid.theta))[:, None]
    P += 1e-3 * np.random.default_rng(1).normal(size=P.shape)
    times = np.linspace(settle + watch / 2, settle + watch, 26)
    run = cy.simulate(cy.Parameters(kappa=kappa), grid, P, times[-1], save_at=tuple(times), rtol=1e-7)
    place = [np.angle(np.fft.fft(frame[1].mean(axis=1))[1]) for frame in run.frames]
    return float(-np.polyfit(times, np.unwrap(place), 1)[0])


def speed():
    """The time of a branch with its spectra, along and across, after compilation."""
    start = cy.stability.drifting(cy.Parameters(kappa=0.2), N)
    cy.stability.continue_branch(start, "kappa", (0.19, 0.21), most=2)
    begun = time.process_time()
    branch = cy.stability.continue_branch(start, "kappa", (0.05, 0.4), longest=0.0105)
    taken = (time.process_time() - begun) / branch.parameter.size
    law = f"a branch of {branch.parameter.size} points with spectra, {N} points around"
    return [Row(law, "seconds of one core for 200 points", 200 * taken, 60.0)]


def rows():
    """Return every row of this comparison."""
    return [*ends(), *tilted(), *speed()]
