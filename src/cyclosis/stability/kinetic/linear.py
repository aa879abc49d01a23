"""The linearisation about a state of `line` for waves e^{iqz} along the cell, and a direct solver for it.

A perturbation of the moments is δ_n(θ) e^{iqz + σt}; δ_n and δ_{-n}, of m_n and of m_n*, are independent. In
a frame that drifts at V, with H, S and w of the state (see `models.kinetic.system`) and d of what changes,

    σ δ_n = (T δ)_n + (n/2) [dH m_{n-1} - dH* m_{n+1} + dS m_{n-2} - dS* m_{n+2}]
            + (i n ε/2) dw m_n - ε ∇·(du m_n),
    (T δ)_n = [d_s (∂² - q²) - n² d_r + V ∂ - ε u·∇ + i n ε w/2] δ_n
              + (n/2) [H δ_{n-1} - H* δ_{n+1} + S δ_{n-2} - S* δ_{n+2}],      δ_0 = 0 .

What T leaves out, δ_{-1} in the equation of δ_1 included, comes from P alone: from δ_1 and δ_{-1}. So the
whole operator is T and its counterpart of negative n, two banded matrices, and 2p dense columns: a solution
takes two banded factors and a small dense system. T itself only decays: in the norm Σ |δ_n|²/n its couplings
are skew, so that all its eigenvalues have Re σ <= -d_r - d_s q², and both factors exist for every σ to the
right of that. Own derivation.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.linalg.lapack import zgbtrf, zgbtrs

from ...model.grid import Array
from .line import Complex, Line, mirrored


class Linearised:
    """The operator on pairs (2, N, p): amplitudes of δ_n, and of δ_{-n}, n = 1, ..., N, dimensionless.

    `line` and `a` (N, p) give the equation and the state, `drift` the frame's speed, `q` the wavenumber.
    """

    def __init__(self, line: Line, a: Complex, drift: float, q: float = 0.0) -> None:
        self.line, self.q, self.drift = line, q, drift
        params, none = line.params, np.zeros((2, line.n))
        self.m = np.concatenate([line.moments(a), none])
        self.p = self.m[1]
        self.u = line.flow(a)
        slope = line.waves @ (1j * line.k * (line.waves.conj().T @ self.u[1])) / line.n
        strain = 0.5 * params.epsilon * 1j * slope.real
        self.w = slope.real
        self.H = params.alpha_p * self.p + params.alpha_u * (self.u[0] + 1j * self.u[1])
        self.S = strain - 0.5 * params.kappa * np.exp(2j * params.repulsion_angle)
        self.count = np.arange(1.0, line.modes + 1)[:, None]
        self.columns = self._columns()

    def __call__(self, pair: Complex) -> Complex:
        """Return the operator's value (2, N, p) on a pair."""
        ends = pair[:, 0].ravel()
        chains = self._chain(pair[0], self.q), mirrored(self._chain(mirrored(pair[1]), -self.q))
        return np.stack(chains) + self.columns @ ends

    def factors(self, shift: complex) -> tuple[Factor, Factor]:
        """Return the factors of T - shift, and of its counterpart of negative n, mirrored."""
        first = Factor(self, self.q, shift)
        alike = self.q == 0 and np.imag(shift) == 0
        return first, first if alike else Factor(self, -self.q, np.conj(shift))

    def diagonal(self, q: float) -> Complex:
        """Return the diffusion and drift (N, p) of T."""
        params, k = self.line.params, self.line.k
        along = self.drift - params.epsilon * self.u[0].mean()
        return 1j * along * k - params.d_s * (k**2 + q**2) - params.d_r * self.count**2

    def _chain(self, x: Complex, q: float) -> Complex:
        """Return T x for amplitudes (N, p)."""
        line, n, none = self.line, self.count, np.zeros((2, self.line.n))
        field = np.concatenate([none, x @ line.waves.T, none])
        turned = self.H * field[1:-3] - np.conj(self.H) * field[3:-1]
        turned = turned + self.S * field[:-4] - np.conj(self.S) * field[4:]
        product = 0.5 * n * turned + self._local(q) * field[2:-2]
        return self.diagonal(q) * x + product @ line.waves.conj() / line.n

    def _local(self, q: float) -> Complex:
        """Return what multiplies δ_n in T at the points, (N, n): spin, and the flow along the cell."""
        eps = self.line.params.epsilon
        return eps * (0.5j * self.count * self.w - 1j * q * self.u[1])

    def _columns(self) -> Complex:
        """Return the effect (2, N, p, 2p) of δ_1 and δ_{-1} (2p,): through P and the flow, on each other."""
        line, params, q, k = self.line, self.line.params, self.q, self.line.k
        n, p = self.count[:, :, None], k.size
        square = np.abs(self.p) ** 2
        exponent = params.force_exponent
        safe = np.where(square > 0, square, 1.0)
        power = np.where(square > 0, safe ** (0.5 * exponent), float(exponent == 0))
        same = (1 + 0.5 * exponent) * power
        other = np.where(square > 0, 0.5 * exponent * safe ** (0.5 * exponent - 1), 0.0) * self.p**2
        one = np.eye(2 * p)
        first, last = one[:p], one[p:]

        def seen(field: Any) -> Any:
            return line.waves.conj().T @ field / line.n

        ends = line.waves @ first, line.waves @ last
        force = seen(same[:, None] * ends[0] + other[:, None] * ends[1])
        conjugate = seen(np.conj(other)[:, None] * ends[0] + same[:, None] * ends[1])
        u = self._driven(0.5 * (force + conjugate), -0.5j * (force - conjugate))
        column = k[:, None]
        strain = 1j * column * u[0], 0.5j * (q * u[0] + column * u[1])
        spin = line.waves @ (1j * (column * u[1] - q * u[0]))
        dH, dH_, dS, dS_ = (
            line.waves @ values
            for values in (
                params.alpha_p * first + params.alpha_u * (u[0] + 1j * u[1]),
                params.alpha_p * last + params.alpha_u * (u[0] - 1j * u[1]),
                params.epsilon * (strain[0] + 1j * strain[1]),
                params.epsilon * (strain[0] - 1j * strain[1]),
            )
        )
        found = np.empty((2, line.modes, p, 2 * p), dtype=np.complex128)
        for sign, part in ((1, 0), (-1, 1)):
            m = (self.m if sign > 0 else np.conj(self.m))[:, :, None]
            two_below = np.concatenate([np.conj(m[1:2]), m[:-4]])
            h, h_, s, s_ = (dH, dH_, dS, dS_) if sign > 0 else (dH_, dH, dS_, dS)
            torque = 0.5 * n * (m[:-3] * h - m[2:-1] * h_ + two_below * s - m[3:] * s_)
            torque = torque + 0.5j * sign * params.epsilon * n * m[1:-2] * spin
            carried = [seen(m[1:-2] * (line.waves @ part)) for part in u]
            flux = 1j * column * carried[0] + 1j * q * carried[1]
            found[part] = seen(torque) - params.epsilon * flux
            # m_{-1} in the equation of m_1.
            S, end = (self.S, ends[1]) if sign > 0 else (np.conj(self.S), ends[0])
            found[part, 0] += seen(0.5 * S[:, None] * end)
        return found

    def _driven(self, along: Any, across: Any) -> tuple[Any, Any]:
        """Return the flow's amplitudes of a force's, both along theta and z."""
        params, k, q = self.line.params, self.line.k[:, None], self.q
        k2 = k**2 + q**2
        still, safe = k2 == 0, np.where(k2 == 0, 1.0, k2)
        push = (k * along + q * across) / safe
        green = np.where(still, 0.0, 1 / (1 + params.mu * k2))
        mean = still * (0.0 if params.zero_theta_flux else 1.0)
        return green * (along - k * push) + mean * along, green * (across - q * push)


class Factor:
    """The banded factors of T - shift at an axial wavenumber q."""

    def __init__(self, operator: Linearised, q: float, shift: complex) -> None:
        line, n = operator.line, operator.count
        self.p = line.k.size
        self.width = 3 * self.p - 1
        size = line.modes * self.p

        def product(field: Array | Complex) -> Complex:
            return (line.waves.conj().T * field) @ line.waves / line.n

        self.band = np.zeros((3 * self.width + 1, size), dtype=np.complex128)
        half, H, S = 0.5 * n[:, :, None], product(operator.H), product(operator.S)
        spin, flow = product(operator.w), product(operator.u[1])
        eps = line.params.epsilon
        middle = eps * (1j * half * spin - 1j * q * flow)
        at = np.arange(self.p)
        middle[:, at, at] += operator.diagonal(q) - shift
        self._place(middle, 0)
        for field, offset in ((H, 1), (S, 2)):
            self._place(half[offset:] * field, -offset)
            self._place(-half[:-offset] * field.conj().T, offset)
        self.band, self.pivots, failed = zgbtrf(self.band, self.width, self.width, overwrite_ab=1)
        if failed:
            raise np.linalg.LinAlgError("singular")

    def _place(self, blocks: Complex, offset: int) -> None:
        """Put blocks (many, p, p) beside the diagonal: block i in row i + max(0, -offset)."""
        row, column = np.indices((self.p, self.p))
        first = (np.arange(len(blocks)) + max(0, offset))[:, None, None] * self.p
        self.band[2 * self.width + row - column - offset * self.p, first + column] = blocks

    def solve(self, right: Complex) -> Complex:
        """Return the solution (N p, many) for right-hand sides (N p, many)."""
        return np.asarray(zgbtrs(self.band, self.width, self.width, right, self.pivots)[0])


class Inverse:
    """Solutions of (L - shift) x + columns y = f, rows x + square y = g, for L on pairs (2, N, p).

    `columns` and `rows` (many, 2, N, p) border the operator, so that it may be singular; `square`
    (many, many) is zero if left out.
    """

    def __init__(
        self,
        operator: Linearised,
        shift: complex = 0.0,
        columns: Any = (),
        rows: Any = (),
        square: Any = 0.0,
    ) -> None:
        self.operator, self.shape = operator, operator.columns.shape[:3]
        self.plus, self.minus = operator.factors(shift)
        p, dense = self.shape[2], operator.columns.reshape(-1, 2 * operator.line.k.size)
        size = dense.shape[0]
        self.rows = np.asarray(rows, dtype=np.complex128).reshape(len(rows), size)
        border = np.asarray(columns, dtype=np.complex128).reshape(len(columns), size).T
        self.answers = self._decoupled(np.concatenate([dense, border], axis=1))
        self.ends = np.concatenate([np.arange(p), dense.shape[0] // 2 + np.arange(p)])
        size = 2 * p + len(rows)
        corner = np.zeros((size, size), dtype=np.complex128)
        corner[: 2 * p] = self.answers[self.ends]
        corner[np.arange(2 * p), np.arange(2 * p)] += 1
        corner[2 * p :] = self.rows @ self.answers
        corner[2 * p :, 2 * p :] -= square
        self.corner = lu_factor(corner)

    def __call__(self, f: Complex, g: Any = ()) -> tuple[Complex, Complex]:
        """Return x (2, N, p) and y (many,)."""
        free = self._decoupled(f.reshape(-1, 1))[:, 0]
        right = np.concatenate([free[self.ends], self.rows @ free - np.asarray(g)])
        border = lu_solve(self.corner, right)
        return (free - self.answers @ border).reshape(self.shape), border[2 * self.shape[2] :]

    def _decoupled(self, right: Complex) -> Complex:
        """Return what the two chains alone answer to right-hand sides (2 N p, many)."""
        half = right.shape[0] // 2
        below = self._turned(right[half:])
        return np.concatenate([self.plus.solve(right[:half]), self._turned(self.minus.solve(below))])

    def _turned(self, values: Complex) -> Complex:
        shaped = values.reshape(self.shape[1], self.shape[2], -1)
        return np.conj(shaped[:, ::-1]).reshape(values.shape)
