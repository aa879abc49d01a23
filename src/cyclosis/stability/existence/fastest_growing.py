"""Which perturbation of two equal stripes grows fastest, in both components and at all wavenumbers.

Perturbations that do not vary along the cell fall into those of P_theta, which do not depend on P_z, and
the four families of P_z. Those with an axial wavenumber q mix the components, but

* the reflection about the middle of a stripe, (v_θ, v_z)(θ) → (-v_θ, v_z)(π - θ), splits them into two sets;
* half a turn of the surface, with v → v*, makes the matrix real on the waves sin mθ and i cos mθ.

So one complex matrix of 2n becomes two real ones of n. The reflection requires d along an axis.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg

from ...model.errors import InputError
from ...model.grid import Array, CylinderGrid
from ..profiles.reduced import reduced
from ..profiles.slowest import decays, most_waves, settled
from .equal import OWN, ROTATION, SHAPES, WIDTHS, Equal, EqualStripes

Vector = npt.NDArray[np.complex128]

LONGEST_CELL = 200.0
"""Longest cell whose waves are all examined, in radii."""


class Growth(NamedTuple):
    """A growth rate, its `cause` in words, and `axial_mode`, the number of its waves along the cell."""

    rate: float
    cause: str
    axial_mode: int = 0


CAUSES = {
    OWN: "a fold of the branch",
    WIDTHS: "stripes of unequal widths",
    ROTATION: "bending of zones",
    SHAPES: "a change of shape",
}
TILT = "a tilt of the filaments"


class Perturbations:
    """The growth rates of all perturbations of two equal stripes in a cell of a length, computed on demand.

    Raises `InputError` for a length that is not above 0 and at most 200.
    """

    def __init__(self, problem: EqualStripes, state: Equal, length: float) -> None:
        if not 0 < length <= LONGEST_CELL:
            rule = f"above 0 and at most {LONGEST_CELL:g}"
            raise InputError("length", length, rule, "choose another length")
        self.problem, self.state = problem, state
        params = problem.params.replace(alpha_u=state.alpha_u)
        self.most = most_waves(params, 2 * np.pi / length)
        self.mu = params.mu
        self.whole = reduced(params, CylinderGrid(problem.n, max(8, 2 * self.most + 2), length))
        self.y = np.concatenate([np.zeros(problem.n), state.P])

    def growths(self) -> Iterator[Growth]:
        """Yield the largest growth rate of each kind of perturbation, up to where all are certain to decay.

        First the families of P_z, without the neutral rotation, then P_theta, then waves along the cell.
        """
        for growth, parts in self._kinds():
            yield growth if parts is None else growth._replace(rate=_largest(parts))

    def growing(self, but: str = "") -> Growth | None:
        """Return a perturbation that grows, of any cause but one, or None."""
        for growth, parts in self._kinds():
            # Where energy decays no eigenvalues are needed.
            if parts is not None and not all(decays(part) for part in parts):
                growth = growth._replace(rate=_largest(parts))
            if growth.rate > 0 and growth.cause != but:
                return growth
        return None

    def rate(self, like: Growth) -> float:
        """Return the growth rate of the same kind of perturbation as another."""
        if like.axial_mode:
            return _largest(self._parts(like.axial_mode))
        if like.cause == TILT:
            return _largest(self._tilt())
        return self._family(next(family for family, cause in CAUSES.items() if cause == like.cause))

    def _family(self, family: str) -> float:
        rates = self.problem.rates(self.state, family)
        if family == ROTATION:
            rates = np.delete(rates, np.argmin(np.abs(rates)))
        return float(rates[0])

    def _tilt(self) -> list[Array]:
        n = self.problem.n
        return [self.whole.jacobian(self.y)[:n, :n]]

    def _kinds(self) -> Iterator[tuple[Growth, list[Array] | None]]:
        """Yield each kind with its rate, or with the matrices that have it as an eigenvalue."""
        for family, cause in CAUSES.items():
            yield Growth(self._family(family), cause), None
        yield Growth(-np.inf, TILT), self._tilt()
        for j in range(1, self.most + 1):
            parts = self._parts(j)
            yield Growth(-np.inf, waves_in_words(j), j), parts
            if all(settled(part, self.mu, j * self.whole.wavenumber) for part in parts):
                break

    def _parts(self, j: int) -> list[Array]:
        matrix = self.whole.waves(self.y, j)
        return [(basis.conj().T @ matrix @ basis).real for basis in reflections(self.problem.n)]


@lru_cache(maxsize=4)
def reflections(n: int) -> tuple[Vector, Vector]:
    """Return the bases (2n, size) of waves on (v_θ, v_z) that the two symmetries above separate."""
    theta = 2 * np.pi / n * np.arange(n)
    m = np.arange((n + 1) // 2)
    sines, cosines = np.sin(np.outer(theta, m)), np.cos(np.outer(theta, m))
    # About the middle of a stripe, at π/2: f(π - θ) = f(θ) and f(π - θ) = -f(θ).
    even = np.concatenate([sines[:, 1::2], 1j * cosines[:, ::2]], axis=1)
    odd = np.concatenate([sines[:, 2::2], 1j * cosines[:, 1::2]], axis=1)
    first, second = (
        scipy.linalg.block_diag(wave / np.linalg.norm(wave, axis=0), other / np.linalg.norm(other, axis=0))
        for wave, other in ((odd, even), (even, odd))
    )
    return first, second


def _largest(parts: list[Array]) -> float:
    return max(float(np.linalg.eigvals(part).real.max()) for part in parts)


def waves_in_words(j: int) -> str:
    """Return a number of axial waves in words."""
    return "one wave along the cell" if j == 1 else f"{j} waves along the cell"
