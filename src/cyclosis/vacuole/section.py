"""Advection and diffusion in a helical flow, reduced to the cross-section.

A helical flow depends on r and φ = θ - k z alone; k = 0 is straight. In it c = ĉ(r, φ) exp(i q z) keeps its
form,

    ĉ = Σ y_nk f_nk(r) exp(i n φ),

and mode n has the axial wavenumber κ_n = q - k n. The weak form of c_t + ∇·(v c) = ∇²c / Pe is then dy/dt = B
y - (λ_nk + κ_n²) y / Pe with the matrix B = <∇f* · v f>, whose row of the constant is 0: a wall that is
sealed keeps the amount exactly. Everything is dimensionless: lengths R, speeds U, times R/U, Pe = U R/D.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from ..model.errors import InputError
from ..model.grid import Array
from .flow import VacuoleFlow
from .radial import RadialBasis, radial_basis

HELICAL = 1e-8
"""Waves of the wall's velocity below this share of the largest do not count as a departure from a helix."""
NEGLIGIBLE = 1e-12
"""Waves of the flow below this share of the largest are left out."""


def turns(flow: VacuoleFlow) -> int:
    """Return how often the pattern of a helical flow winds about the axis in one period of the cell.

    Positive where lines of equal flow have θ increasing with z; 0 for a straight flow. Raises `InputError`
    for a flow that depends on θ and z in another way.

    Example:
        >>> import numpy as np
        >>> import cyclosis as cy
        >>> from cyclosis.vacuole.section import turns
        >>> grid = cy.CylinderGrid(16, 16)
        >>> speed = np.sin(grid.theta[:, None] - 2 * np.pi * grid.z / grid.length)
        >>> turns(cy.vacuole.flow(grid, np.stack([0 * speed, speed])))
        1
    """
    found = winding(flow)
    if found is None:
        rule = "straight, or helical with a whole number of turns along the cell"
        raise InputError("flow", flow, rule, "use cyclosis.vacuole.transport, which takes any flow")
    return found


def winding(flow: VacuoleFlow) -> int | None:
    """Return the `turns` of a flow, or None if it is neither straight nor helical."""
    if not isinstance(flow, VacuoleFlow):
        raise InputError("flow", flow, "a steady flow in the vacuole", "make one with cyclosis.vacuole.flow")
    size = np.abs(flow.modes).max(axis=0)
    rows, columns = np.nonzero(size > HELICAL * size.max())
    m = np.where(rows > size.shape[0] // 2, rows - size.shape[0], rows)
    if np.any((m == 0) & (columns > 0)):
        return None
    found = {-j / n for n, j in zip(m.tolist(), columns.tolist(), strict=True) if n}
    one = found.pop() if found else 0.0
    return int(one) if not found and one == round(one) else None


def wave(values: npt.NDArray[Any], n: int) -> npt.NDArray[Any]:
    """Return wave n of waves (..., d) in transform order; those that d points do not resolve are 0."""
    if 2 * abs(n) < values.shape[-1]:
        return np.asarray(values[..., n])
    return np.zeros_like(values[..., 0])


@dataclass(frozen=True)
class Section:
    """The problem of a helical flow at one axial wavenumber `q` (relative to the pattern), for one wall.

    `velocity` (3, n_r, d) are the waves of (u_r, u_θ, u_z) around φ at the radii of `functions`, in transform
    order; `pitch` is k, `highest` the largest |n|.
    """

    velocity: npt.NDArray[np.complex128]
    functions: RadialBasis
    pitch: float
    q: float
    highest: int

    @cached_property
    def n(self) -> npt.NDArray[np.int64]:
        """The wave of each mode around φ, ascending, shape (modes,)."""
        count = self.functions.count
        return np.concatenate([np.full(count[abs(n)], n) for n in range(-self.highest, self.highest + 1)])

    @cached_property
    def rates(self) -> Array:
        """λ + κ² of each mode, shape (modes,)."""
        count, rates = self.functions.count, self.functions.rates
        radial_part = [rates[abs(n), : count[abs(n)]] for n in range(-self.highest, self.highest + 1)]
        return np.concatenate(radial_part) + (self.q - self.pitch * self.n) ** 2

    def project(self, values: npt.NDArray[Any]) -> npt.NDArray[np.complex128]:
        """Return <f* g>, shape (modes,), of waves g (n_r, d) around φ at the radii."""
        f = self.functions
        parts = [
            (f.value[abs(n), :, : f.count[abs(n)]] * f.weights[:, None]).T @ wave(values, n)
            for n in range(-self.highest, self.highest + 1)
        ]
        return np.concatenate(parts).astype(complex)

    def weak(self, flux: npt.NDArray[Any]) -> npt.NDArray[np.complex128]:
        """Return <∇f* · F>, shape (modes,), of waves F (3, n_r, d) around φ at the radii."""
        f, out = self.functions, []
        for n in range(-self.highest, self.highest + 1):
            k = f.count[abs(n)]
            value, slope = f.value[abs(n), :, :k], f.slope[abs(n), :, :k]
            F = wave(flux, n)
            along = -1j * (n * F[1] / f.r + (self.q - self.pitch * n) * F[2])
            out.append((slope * f.weights[:, None]).T @ F[0] + (value * f.weights[:, None]).T @ along)
        return np.concatenate(out)

    @cached_property
    def advection(self) -> npt.NDArray[np.complex128]:
        """The matrix B, shape (modes, modes)."""
        f, size = self.functions, self.n.size
        largest = np.abs(self.velocity).max()
        start = np.searchsorted(self.n, np.arange(-self.highest, self.highest + 2))
        out = np.zeros((size, size), complex)
        for a in range(-self.highest, self.highest + 1):
            k = f.count[abs(a)]
            rows = slice(*start[[a + self.highest, a + self.highest + 1]])
            value = (f.value[abs(a), :, :k] * f.weights[:, None]).T
            slope = (f.slope[abs(a), :, :k] * f.weights[:, None]).T
            for b in range(-self.highest, self.highest + 1):
                u = wave(self.velocity, a - b)
                if np.abs(u).max() <= NEGLIGIBLE * largest:
                    continue
                columns = slice(*start[[b + self.highest, b + self.highest + 1]])
                along = -1j * (a * u[1] / f.r + (self.q - self.pitch * a) * u[2])
                out[rows, columns] = (slope * u[0] + value * along) @ f.value[abs(b), :, : f.count[abs(b)]]
        return out

    def decay(self, peclet: float) -> npt.NDArray[np.complex128]:
        """Return the matrix M of Pe dy/dt = -M y: diffusion minus Pe times advection."""
        return np.diag(self.rates).astype(complex) - peclet * self.advection

    def real(self, modes: npt.NDArray[Any]) -> Array:
        """Return a vector or a matrix of modes in cosines and sines of φ, for q = 0, where c is real."""
        found = self._real_basis.conj().T @ modes
        return np.asarray((found if modes.ndim == 1 else found @ self._real_basis).real)

    @cached_property
    def _real_basis(self) -> Any:
        """The unitary sparse matrix from cosines and sines of φ to the modes (q = 0, where c is real)."""
        from scipy.sparse import csr_matrix

        size, half = self.n.size, np.sqrt(0.5)
        plus, mirror = np.flatnonzero(self.n > 0), []
        start = np.searchsorted(self.n, np.arange(-self.highest, self.highest + 1))
        for i in plus:
            n = self.n[i]
            mirror.append(start[self.highest - n] + i - start[self.highest + n])
        minus, still = np.array(mirror, dtype=int), np.flatnonzero(self.n == 0)
        rows = np.concatenate([still, plus, minus, plus, minus])
        columns = np.concatenate([still, plus, plus, minus, minus])
        ones = np.ones(plus.size)
        entries = np.concatenate(
            [np.ones(still.size), half * ones, half * ones, -1j * half * ones, 1j * half * ones]
        )
        return csr_matrix((entries, (rows, columns)), shape=(size, size))


def section(
    flow: VacuoleFlow, highest: int, degree: int, biot: float, q: float = 0.0, n_r: int | None = None
) -> Section:
    """Return the problem of a helical flow with waves |n| <= highest and radial degree `degree`.

    Raises `InputError` for a flow that is not helical.
    """
    pitch = 2 * np.pi * turns(flow) / flow.grid.length
    functions = radial_basis(highest, degree, n_r or degree + 8, biot)
    velocity = flow.volume(functions.r)[..., 0]
    return Section(np.fft.fft(velocity, axis=-1, norm="forward"), functions, pitch, q, highest)
