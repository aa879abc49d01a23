"""The curve of steady and steadily drifting states over one parameter, as equations for a point on it.

A point is X = (y, c, v): the state y (2n,), its drift c, and v = λ/Λ with λ the parameter and Λ the range
of interest. It obeys dy/dt + c y' = 0 and, where y varies, the condition <y_ref' · (y - y_ref)> = 0 that
it has not moved from a nearby reference point; where y is uniform, c = 0. Lengths are measured by

    |X|² = <|P|²> + c² + v²

so that a step of length s changes |P| by no more than s, root mean square.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from ...model.definitions import definition
from ...model.grid import Array, CylinderGrid
from ...model.parameters import Parameters
from ..profiles.reduced import Reduced, reduced
from ..profiles.steady import UNIFORM, rms
from ..profiles.travelling import between

TOLERANCE = 1e-11
"""Root mean square residual of the equations below which a point counts as found."""
ITERATIONS = 8
DIFFERENCE = 1e-5
"""Half the interval of the parameter, relative to Λ, over which its effect is differenced."""
FITS = 4
"""Rotations tried for each grid point, to align one state with another."""
IN_VALUES = ("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa")
"""Parameters that are not built into the flow's operator, so that changing them is cheap."""


class Curve:
    """The equations of states over one parameter. States vary along theta or are uniform.

    `params` gives the other parameters, `name` the one that changes, `span` its Λ; `varies` says that the
    states are not uniform.
    """

    def __init__(self, params: Parameters, name: str, grid: CylinderGrid, span: float, varies: bool) -> None:
        self.params, self.name, self.grid, self.span, self.varies = params, name, grid, span, varies
        allowed = definition("parameters", name)
        self.allowed = (allowed.minimum, allowed.maximum)
        self.problem = lru_cache(maxsize=8)(self._problem)
        self.n = grid.n_theta
        self._latest: tuple[Array, Array] | None = None

    def like(self, varies: bool) -> Curve:
        """Return the curve of the same parameter for states that vary, or are uniform."""
        return Curve(self.params, self.name, self.grid, self.span, varies)

    def at(self, value: float) -> Parameters:
        """Return the parameters at a value of the one that changes."""
        return self.params.replace(**{self.name: value})

    @cached_property
    def weights(self) -> Array:
        """The weights (2n + 2,) of the scalar product whose square is |X|²."""
        return np.append(np.full(2 * self.n, 1 / self.n), [1.0, 1.0])

    def length(self, X: Array) -> float:
        """Return |X|."""
        return float(np.sqrt(np.sum(self.weights * X**2)))

    def apart(self, X: Array, other: Array) -> float:
        """Return |X - other|, with the other state rotated about the axis to where it fits best."""
        mine, its = (self._here.packed(point[:-2]) for point in (X, other))
        product = np.zeros(FITS * self.n, dtype=np.complex128)
        product[np.rint(self._here.k).astype(int)] = np.conj(mine) * its
        fit = float(np.fft.fft(product).real.max()) / self.n**2
        square = float(np.sum(self.weights * (X**2 + other**2)) - 2 * fit - 2 * (X[-2:] @ other[-2:]))
        return max(square, 0.0) ** 0.5

    def point(self, y: Array, drift: float, value: float) -> Array:
        """Return X."""
        return np.append(y, [drift, value / self.span])

    def value(self, X: Array) -> float:
        """Return the parameter's value, clipped to its allowed range."""
        return float(np.clip(X[-1] * self.span, *self.allowed))

    @cached_property
    def derivative(self) -> Array:
        """The matrix (2n, 2n) of d/dtheta."""
        return self._here.derivative

    def slope(self, y: Array) -> Array:
        """Return y' (2n,)."""
        return self._here.slope(y)

    def operator(self, X: Array) -> Array:
        """Return the linearisation (2n, 2n) of dy/dt + c y'."""
        if self._latest is None or self._latest[0] is not X:
            jacobian = self.problem(self.value(X)).jacobian(X[:-2])
            self._latest = (X, jacobian + X[-2] * self.derivative if self.varies else jacobian)
        return self._latest[1]

    def push(self, X: Array) -> Array:
        """Return the derivative (2n,) of dy/dt with respect to v, by differences of the right-hand side."""
        value, step = self.value(X), DIFFERENCE * self.span
        low, high = (float(np.clip(value + way * step, *self.allowed)) for way in (-1, 1))
        change = self.problem(high).rate(X[:-2]) - self.problem(low).rate(X[:-2])
        return np.asarray(change * (self.span / (high - low)))

    def residual(self, X: Array, reference: Array) -> Array:
        """Return the residual of the equations (2n + 1,)."""
        y, drift = X[:-2], X[-2]
        rate = self.problem(self.value(X)).rate(y)
        if not self.varies:
            return np.append(rate, drift)
        moved = self._direction(reference) @ (y - reference[:-2]) / self.n
        return np.append(rate + drift * self.slope(y), moved)

    def matrix(self, X: Array, reference: Array) -> Array:
        """Return the derivative (2n + 1, 2n + 2) of `residual`."""
        size = 2 * self.n
        found = np.zeros((size + 1, size + 2))
        found[:size, :size] = self.operator(X)
        found[:size, -1] = self.push(X)
        if self.varies:
            found[:size, -2] = self.slope(X[:-2])
            found[size, :size] = self._direction(reference) / self.n
        else:
            found[size, -2] = 1.0
        return found

    def tangent(self, X: Array, like: Array | None = None) -> Array:
        """Return the unit tangent at a point, pointing along `like`, or towards growing parameter values."""
        matrix = self.matrix(X, X)
        if like is None:
            along = np.linalg.svd(matrix)[2][-1]
            along = along if along[-1] >= 0 else -along
        else:
            last = np.append(np.zeros(X.size - 1), 1.0)
            bordered = np.vstack([matrix, self.weights * like])
            try:
                along = np.linalg.solve(bordered, last)
            except np.linalg.LinAlgError:  # exactly on a branch point, where there is more than one tangent
                along = np.linalg.lstsq(bordered, last)[0]
        return np.asarray(along / self.length(along))

    def correct(
        self, guess: Array, reference: Array, row: Array, farthest: float, polish: bool = False
    ) -> tuple[Array, int] | None:
        """Return the point of the curve with row · (X - guess) = 0, and how many iterations it took.

        With `polish` one more iteration follows, down to rounding. None where Newton's method finds no point
        within a length `farthest` of the guess.
        """
        X, last = guess, False
        for iteration in range(ITERATIONS):
            residual = self.residual(X, reference)
            if last or rms(residual) < TOLERANCE:
                if last or not polish:
                    return X, iteration
                last = True
            right = np.append(residual, row @ (X - guess))
            try:
                X = X - np.linalg.solve(np.vstack([self.matrix(X, reference), row]), right)
            except np.linalg.LinAlgError:
                return (X, iteration) if last else None
            if not self.length(X - guess) <= farthest or not self._inside(X):
                return None
        return None

    def critical(self, X: Array) -> Array:
        """Return the unit vector (2n + 2,), at fixed parameter, that the linearised equations shrink most."""
        found = np.append(np.linalg.svd(self.matrix(X, X)[:, :-1])[2][-1], 0.0)
        return np.asarray(found / self.length(found))

    def between(self, X: Array) -> float:
        """Return the largest |dP/dt + c P'| of the interpolant of a state on twice as many points."""
        return between(self._finer.problem(self.value(X)), X[:-2], float(X[-2]))

    @cached_property
    def _finer(self) -> Curve:
        grid = self.grid.resized(2 * self.n, 8)
        return Curve(self.params, self.name, grid, self.span, self.varies)

    @cached_property
    def _here(self) -> Reduced:
        return self.problem(float(getattr(self.params, self.name)))

    def _problem(self, value: float) -> Reduced:
        if value == getattr(self.params, self.name) or self.name not in IN_VALUES:
            return reduced(self.at(value), self.grid)
        here = self._here
        values = here.system.values._replace(**{self.name: np.asarray(value)})
        angle = np.exp(2j * values.repulsion_angle)
        values = values._replace(kappa_mirror=np.asarray(values.kappa * angle))
        return replace(here, system=here.system.with_values(values), line=here.line.with_values(values))

    def _direction(self, reference: Array) -> Array:
        slope = self.slope(reference[:-2])
        return slope / max(rms(slope), UNIFORM)

    def _inside(self, X: Array) -> bool:
        margin = 1e-3 * self.span
        return bool(self.allowed[0] - margin <= X[-1] * self.span <= self.allowed[1] + margin)
