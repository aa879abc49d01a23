"""Existence and stability of two stripes: thresholds, folds, and how far they can be trusted."""

from __future__ import annotations

import time

import numpy as np

import cyclosis as cy
from cyclosis.stability.existence import crossings, equal, onset, thresholds
from cyclosis.stability.profiles import elliptic

from . import Row, extended

STABLE = (0.055, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 1.0)
ENDS = (0.0, 0.01, 0.02, 0.025, 0.03, 0.04, 0.045)
PRINTED = {0.1: (7.47e-3, 5e-6), 0.2: (4.17e-4, 5e-7)}


def params(alpha_p, **other):
    return cy.Parameters(alpha_p=alpha_p).replace(**other)


def stability():
    """The threshold at each α_p with its error bar, relative, and over the front formula."""
    rows = []
    for alpha_p in STABLE:
        found = thresholds.threshold_with_error(params(alpha_p))
        front = elliptic.front_threshold(params(alpha_p))
        law = f"threshold of stability, alpha_p = {alpha_p:g}"
        rows += [
            Row(law, "alpha_u*", found.alpha_u),
            Row(law, "relative error bar", found.error / found.alpha_u, 1e-9),
            Row(law, "alpha_u* / front formula", found.alpha_u / front),
        ]
        if alpha_p in PRINTED:
            value, digits = PRINTED[alpha_p]
            rows.append(
                Row(law, "alpha_u* against the known digits", found.alpha_u, value + digits, value - digits)
            )
    return rows


TINY = ((0.4, 192, 40), (0.5, 192, 40), (1.0, 256, 56))
"""α_p at which the rate without flow is near 1e-6 or below, points around, and on a quarter in 40 digits."""


def small_rates(alpha_p, n, points):
    """Where rates drown in rounding as eigenvalues: continued, as an eigenvalue, and in 40 digits."""
    problem = equal.EqualStripes(params(alpha_p), 2, n)
    good, direct = crossings.continued(problem), crossings.directly(problem)
    there = problem.sloping(good.state, "widths")
    exact = float(extended.growth(str(alpha_p), good.alpha_u, points))
    rounding = direct.rounding / good.alpha_u
    law = f"threshold at alpha_p = {alpha_p:g}, lambda(0) = {elliptic.elliptic_growth(params(alpha_p)):.3g}"
    return [
        Row(law, "its error by 40 digits, relative", abs(exact / there.slope / good.alpha_u), 1e-12),
        Row(law, "as an eigenvalue, its error from rounding, relative", rounding),
        Row(law, "as an eigenvalue / that - 1", abs(direct.alpha_u / good.alpha_u - 1), rounding),
    ]


def existence():
    """Folds below d_r + d_s, and the pitchfork at it."""
    rows = []
    for alpha_p in ENDS:
        found = thresholds.fold_with_error(params(alpha_p))
        law = f"fold, alpha_p = {alpha_p:g}"
        rows += [Row(law, "alpha_u", found.alpha_u), Row(law, "error bar", found.error, 1e-11)]
        held = thresholds.threshold(params(alpha_p))
        rows.append(Row(law, "threshold of stability - fold", abs(held - found.alpha_u), 1e-11))
    rows.append(Row("fold, alpha_p = 0", "alpha_u against 0.227", rows[0].value, 0.2275, 0.2265))
    near = thresholds.fold(params(0.05 - 1e-9))
    law = "pitchfork at alpha_p = d_r + d_s"
    rows.append(Row(law, "alpha_u - 0.0525", abs(thresholds.fold(params(0.05)) - 0.0525), 1e-15))
    rows.append(Row(law, "fold 1e-9 below it - 0.0525", near - 0.0525, 1e-4, 0.0))
    linear = params(0.0, force_exponent=0, alpha_u=0.0525)
    rates = cy.stability.growth_rates(linear, "disorder", np.arange(1, 9), 0.0).real
    rows.append(Row("linear force, alpha_p = 0, alpha_u = 0.0525", "largest growth", abs(rates.max()), 1e-15))
    alpha_p, alpha_u = onset.corner(params(0.05))
    law = "corner of existence and stability"
    return [*rows, Row(law, "alpha_p", alpha_p, 0.05, 0.045), Row(law, "alpha_u", alpha_u)]


def speed():
    """Processor time of a threshold on 128 points (and on 192, for its error), once compiled."""
    rows = []
    for alpha_p in (0.055, 0.1, 0.5):
        thresholds.threshold(params(alpha_p), n_theta=128)
        began = time.process_time()
        thresholds.threshold(params(alpha_p), n_theta=128)
        law = f"speed of a threshold, alpha_p = {alpha_p:g}"
        rows.append(Row(law, "processor seconds, n_theta = 128", time.process_time() - began, 5.0))
    return rows


def convergence():
    """A threshold by n_theta: the error falls by a factor for every 16 points."""
    best = thresholds.threshold(params(0.3), n_theta=192)
    sizes = (48, 64, 80)
    errors = []
    for n in sizes:
        problem = equal.EqualStripes(params(0.3), 2, n)
        errors.append(abs(crossings.stable_from(problem).alpha_u / best - 1))
    falls = -np.diff(np.log10(errors))
    rows = [
        Row("threshold, alpha_p = 0.3", f"relative error, n_theta = {n}", e)
        for n, e in zip(sizes, errors, strict=True)
    ]
    return [
        *rows,
        Row("threshold, alpha_p = 0.3", "least fall per 16 points, decades", float(falls.min()), None, 1.0),
    ]


def rows():
    """Return every row of this comparison."""
    tiny = [row for case in TINY for row in small_rates(*case)]
    return [*stability(), *tiny, *existence(), *convergence(), *speed()]
