"""Switching to the other branch at a point where two meet.

At a branch point the linearised equations at fixed parameter take a perturbation φ to zero. A state on the
other branch is sought at a given distance from the point along φ, measured at right angles to the first
branch, so that this one is not found again; state, drift and parameter are all unknown. Where a wave cos(mθ)
about a uniform state grows at the frequency ω, the new states rotate about the axis at the speed c = -ω/m.
"""

from __future__ import annotations

import numpy as np

from ...model.errors import InputError
from ...model.grid import Array
from ..profiles.steady import UNIFORM, rms
from .curve import Curve
from .events import uniform, varying

FARTHEST = 5.0
"""Distance that Newton's method may go, relative to the requested one."""


def other_branch(curve: Curve, X: Array, along: Array, hopf: bool, size: float) -> Array:
    """Return a point X of the branch that crosses another one at X, whose direction there is `along`."""
    if hopf:
        mode, drift = _wave(curve, X)
    else:
        mode, drift = curve.critical(X), float(X[-2])
        mode = mode - np.sum(curve.weights * mode * along) * along
    mode = mode / curve.length(mode)
    guess = X + size * mode
    guess[-2] += drift - X[-2]
    return _found(curve, guess, curve.weights * mode, size)


def symmetric_branch(curve: Curve, X: Array, size: float) -> Array:
    """Return a point of the branch of the more symmetric states in which another branch has ended at X."""
    guess = X.copy()
    guess[-1] += size
    if rms(varying(X)) <= UNIFORM * max(rms(X[:-2]), 1.0):
        guess[:-2], guess[-2] = uniform(X), 0.0
    return _found(curve, guess, np.append(np.zeros(X.size - 1), 1.0), size)


def _found(curve: Curve, guess: Array, row: Array, size: float) -> Array:
    varies = rms(varying(guess)) > UNIFORM * max(rms(guess[:-2]), 1.0)
    found = curve.like(varies).correct(guess, guess, row, FARTHEST * abs(size))
    if found is None:
        rule = "a distance at which Newton's method finds a state of the other branch"
        raise InputError("size", size, rule, "choose another, or change its sign")
    return found[0]


def _wave(curve: Curve, X: Array) -> tuple[Array, float]:
    """Return the wave (2n + 2,) that neither grows nor decays about a uniform state, and its speed."""
    values, vectors = np.linalg.eig(curve.operator(X))
    critical = int(np.argmin(np.abs(values.real) + (np.abs(values.imag) < 1e-9)))
    vector = vectors[:, critical]
    waves = np.fft.fft(vector.reshape(2, -1), axis=1)
    k = curve.problem(curve.value(X)).k
    m = k[int(np.argmax(np.sum(np.abs(waves) ** 2, axis=0)))]
    return np.append(vector.real, [0.0, 0.0]), float(-values[critical].imag / m)
