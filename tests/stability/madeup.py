"""Curves whose points are known exactly, to follow and to find their folds, branch and Hopf points."""

import numpy as np

import cyclosis as cy
from cyclosis.stability.branches.curve import Curve
from cyclosis.stability.branches.points import Linearisation

POINTS = 8
NAME = "alpha_u"


class Problem:
    """dy/dt = rate(y, λ) on the first two of 2n numbers; the others decay."""

    n = POINTS
    k = np.rint(POINTS * np.fft.fftfreq(POINTS))
    derivative = np.zeros((2 * POINTS, 2 * POINTS))

    def __init__(self, rate, value):
        self.of, self.value = rate, value

    def rate(self, y):
        return np.append(self.of(y[:2], self.value), -y[2:])

    def jacobian(self, y, step=1e-6):
        units = step * np.eye(y.size)
        return np.stack([(self.rate(y + u) - self.rate(y - u)) / (2 * step) for u in units], axis=1)

    def slope(self, y):
        return np.zeros_like(y)

    def packed(self, y):
        return np.fft.fft(y[: self.n] + 1j * y[self.n :])


class MadeUp(Curve):
    """The curve rate(y, λ) = 0."""

    def __init__(self, rate):
        self.of = rate
        super().__init__(cy.Parameters(alpha_u=2.0), NAME, cy.CylinderGrid(POINTS, 8), 4.0, False)

    def _problem(self, value):
        return Problem(self.of, value)

    def like(self, varies):
        return self

    def between(self, X):
        return 0.0

    def begin(self, y, value):
        """Return the linearisation and the node next to (y, λ)."""
        guess = self.point(np.append(y, np.zeros(2 * POINTS - 2)), 0.0, value)
        found = self.correct(guess, guess, np.append(np.zeros(guess.size - 1), 1.0), 1.0)
        linear = Linearisation(self, False)
        return linear, linear.node(found[0], None)
