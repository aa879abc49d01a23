"""The growth rates of small perturbations of a state that does not vary along one axis.

Perturbations that do not vary along that axis either obey the Jacobian of the one-dimensional equation;
those with a wavenumber q along it obey a matrix for each q. The shift of a state that varies is a neutral
mode: it is projected out, and the state is stable if all other modes decay.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from ...model.grid import Array
from .reduced import Reduced
from .slowest import settled
from .steady import Steady, rms

Vector = npt.NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Mode:
    """The slowest mode: its eigenvalue, right eigenvector (rms 1) and left one, with left · right = 1."""

    eigenvalue: complex
    right: Vector
    left: Vector


@dataclass(frozen=True, eq=False)
class GrowthRates:
    """Growth rates about a state, dimensionless.

    `along` (2n or 2n - 1,) are those of perturbations that keep it uniform along its axis, by decreasing
    real part, the neutral shift left out, and `slowest` the first mode among them; `across` (waves,) is the
    largest rate at each wavenumber 1, 2, ... of that axis, up to where all are certain to decay; it is empty
    where one of `along` already grows.
    """

    along: Vector
    across: Array
    slowest: Mode

    @property
    def growth(self) -> float:
        """The largest growth rate of all; the state is linearly stable where it is negative."""
        return float(max(self.along[0].real, *self.across, -np.inf))


def rates_about(problem: Reduced, state: Steady, waves: int) -> GrowthRates:
    """Return the `GrowthRates` about a state, with at most `waves` wavenumbers across."""
    values, mode = along(problem, state)
    rates = across(problem, state.y, waves) if values[0].real < 0 else np.empty(0)
    return GrowthRates(values, rates, mode)


def along(problem: Reduced, state: Steady) -> tuple[Vector, Mode]:
    """Return the eigenvalues of perturbations that keep a state uniform along its axis, and the slowest mode.

    The neutral shift of a state that varies is left out.
    """
    operator, basis = _without_shift(problem, state)
    values, left, right = scipy.linalg.eig(operator, left=True, right=True)
    order = np.argsort(-values.real, kind="stable")
    first = order[0]
    vector, dual = basis @ right[:, first], basis @ left[:, first].conj()
    vector = vector / rms(np.abs(vector))
    return values[order], Mode(complex(values[first]), vector, dual / (dual @ vector))


def growth_along(problem: Reduced, state: Steady) -> float:
    """Return the largest growth rate of those that `along` returns, computed without modes."""
    return float(np.linalg.eigvals(_without_shift(problem, state)[0]).real.max())


def _without_shift(problem: Reduced, state: Steady) -> tuple[Array, Array]:
    """Return the linearisation without the neutral shift, and the orthonormal basis (2n, any) it is in."""
    operator, basis = problem.jacobian(state.y), np.eye(state.y.size)
    if not state.uniform:
        operator = operator + state.drift * problem.derivative
        # An orthonormal basis of the complement of the null vector keeps all other eigenvalues.
        basis = np.linalg.qr(problem.slope(state.y)[:, None], mode="complete")[0][:, 1:]
    return basis.T @ operator @ basis, basis


def across(problem: Reduced, y: Array, waves: int) -> Array:
    """Return the largest growth rate at each wavenumber q = 1, 2, ... of the axis along which y is uniform.

    Stops early once all larger wavenumbers are `settled`. A common drift does not change these rates.
    """
    mu = float(problem.system.values.mu)
    spacing = problem.wavenumber
    rates = []
    for j in range(1, waves + 1):
        matrix = problem.waves(y, j)
        rates.append(float(np.linalg.eigvals(matrix).real.max()))
        if settled(matrix, mu, j * spacing):
            break
    return np.array(rates)
