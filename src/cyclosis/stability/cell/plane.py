"""A whole cell on the cylinder. A vector is made of packed Fourier coefficients without Nyquist modes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...analysis.diagnostics import tail
from ...contract.model import Problem
from ...model.errors import InputError
from ...model.filaments import Term
from ...model.grid import Array
from ...model.precision import double
from ...model.system import system
from .linearised import WholeCell


@dataclass(frozen=True)
class Plane(WholeCell):
    """The filament equation of a cylinder; its motions are shifts along theta and z."""

    @property
    def shape(self) -> tuple[int, int]:
        """(n_theta, n_z)."""
        return self.system.space.shape

    @property
    def size(self) -> int:
        """The length of a vector."""
        return 2 * self.shape[0] * self.shape[1]

    def packed(self, vector: Array) -> Any:
        """Return the Fourier coefficients (n_theta, n_z) of a vector."""
        return np.ascontiguousarray(vector).view(np.complex128).reshape(self.shape) * (0.5 * self.size)

    def flat(self, packed: Any) -> Array:
        """Return the vector of Fourier coefficients."""
        return (np.asarray(packed) / (0.5 * self.size)).ravel().view(np.float64)

    def slopes(self, vector: Array) -> Array:
        """Return the derivatives along theta and z, (2, size)."""
        packed = self.packed(vector)
        return np.stack([self.flat(1j * k * packed) for k in (self.system.space.m, self.system.space.q)])

    def alike(self, one: Array, other: Array) -> float:
        """Return the scalar product of two vectors, maximised over shifts along free axes."""
        product = np.fft.ifft2(self.packed(one) * np.conj(self.packed(other))).real / (0.5 * self.size)
        shifts = tuple(slice(None) if free else slice(1) for free in self.free)
        return float(product[shifts].max())

    def tail(self, vector: Array) -> float:
        """Return the amplitude beyond two thirds of the resolved wavenumbers over that of all."""
        with double():
            return float(tail(self.system, np.abs(self.packed(vector)) ** 2))

    def variation(self, vector: Array) -> dict[str, float]:
        """Return the relative variation of a state along theta and along z."""
        P = self.state(vector)
        whole = max(float(np.sum(P**2)), 1e-300)
        along = {"theta": 1, "z": 2}
        return {
            name: float(np.sqrt(np.sum((P - P.mean(axis, keepdims=True)) ** 2) / whole))
            for name, axis in along.items()
        }

    def moving(self, drift: Array) -> Any:
        """Return i (c_theta m + c_z q)."""
        return 1j * (drift[0] * self.system.space.m + drift[1] * self.system.space.q)


def plane(problem: Problem) -> Plane:
    """Return the `Plane` of a problem of the polar model, always in double precision.

    Raises `InputError` for custom terms, which need not be autonomous.
    """
    refuse_custom(problem.terms)
    fields = [value for _, value in problem.params.items() if isinstance(value, np.ndarray)]
    free = tuple(all(np.ptp(field, axis=axis).max() == 0 for field in fields) for axis in (0, 1))
    return Plane(system(problem.params, problem.grid, problem.terms, problem.dealias), free)


def refuse_custom(terms: tuple[Term, ...]) -> None:
    """Raise `InputError` for custom terms, which need not be autonomous."""
    for term in terms:
        if term.kind == "custom":
            raise InputError("terms", term.name, "terms of the model, which do not depend on time", "omit it")
