"""Steady circulation of a droplet about an axis, and the least size of one: the model in one dimension."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.special

from ..closed.grid import Array
from ..model.parameters import Parameters

USUAL = Parameters(alpha_p=1.0, alpha_u=0.5)


class Circulation(NamedTuple):
    """A steady circulation about one axis: order and speed, root mean square, 3/2 <x × u>, and peak speed."""

    order: float
    speed: float
    circulation: float
    peak: float


def of_size(size: float) -> Parameters:
    """Return the parameters of a droplet of a radius `size` R: those of the cell, in units of its radius."""
    p = USUAL
    return p.replace(
        mu=p.mu / size**2,
        d_s=p.d_s / size,
        **{name: getattr(p, name) * size for name in ("d_r", "alpha_p", "alpha_u")},
    )


def least_size(params: Parameters) -> float:
    """Return the radius x above which order grows in a droplet: (α_p - d_r) x = d_s/x, by its wave l = 1."""
    return float(np.sqrt(params.d_s / (params.alpha_p - params.d_r)))


class Sphere1D:
    """Fields f(τ) e_θ on a sphere that do not depend on θ, by the harmonics dY_l0/dτ, l odd, at n latitudes.

    -Lap_B of one is l (l + 1) - 1 times it, and -2 div D is l (l + 1) - 2 times it. Independent of
    `cyclosis.closed`.
    """

    def __init__(self, n: int = 64) -> None:
        self.x, self.weight = np.polynomial.legendre.leggauss(2 * n)
        self.l = np.arange(1, 2 * n, 2)
        self.r = np.sqrt(1 - self.x**2)
        self.size = np.ones(n)
        self.size = np.sqrt(self.at(self.x) ** 2 @ self.weight)
        self.values = self.at(self.x)

    def at(self, x: Array) -> Array:
        """Return the harmonics at x = cos τ, shape (n, ...)."""
        wave = self.l.reshape(-1, *np.ones(np.ndim(x), int))
        slope = scipy.special.eval_jacobi(wave - 1, 1, 1, x)
        return np.asarray(np.sqrt(1 - x**2) * slope / self.size.reshape(wave.shape))

    def modes(self, field: Array) -> Array:
        """Return the coefficients (n,) of a field (2 n,)."""
        return np.asarray(self.values @ (self.weight * field))

    def mean(self, field: Array) -> float:
        """Return the mean over the sphere."""
        return float(self.weight @ field / 2)

    def steady(self, params: Parameters) -> tuple[Array, Array]:
        """Return P and u (2 n,) of steady circulation, by Newton's method; zero where it dies out.

        0 = d_s Lap_B P - d_r P + (1 - P²)(α_p P + α_u u),  (1 + μ (l (l + 1) - 2)) u_l = (P³)_l
        """
        p, E, w = params, self.values, self.weight
        bend = np.diag(self.l * (self.l + 1) - 1.0)
        flowing = E.T @ np.diag(1 / (1 + p.mu * (self.l * (self.l + 1) - 2.0))) @ (E * w)

        def parts(c: Array) -> tuple[Array, Array]:
            P = E.T @ c
            u = flowing @ P**3
            push = p.alpha_p * P + p.alpha_u * u
            rate = -p.d_s * bend @ c - p.d_r * c + self.modes((1 - P**2) * push)
            answer = np.diag(p.alpha_p * (1 - P**2) - 2 * P * push)
            answer = answer + (p.alpha_u * (1 - P**2))[:, None] * flowing * (3 * P**2)
            return rate, -p.d_s * bend - p.d_r * np.eye(len(c)) + (E * w) @ answer @ E.T

        c = self.modes(0.9 * self.r)
        for h in 0.2 * 1.15 ** np.arange(60):  # linearly implicit steps, ever longer, end as Newton's
            rate, slope = parts(c)
            c = c + np.linalg.solve(np.eye(len(c)) / h - slope, rate)
        P = E.T @ c
        return P, flowing @ P**3

    def numbers(self, params: Parameters) -> Circulation:
        """Return the numbers of steady circulation."""
        P, u = self.steady(params)
        return Circulation(
            np.sqrt(self.mean(P**2)), np.sqrt(self.mean(u**2)), 1.5 * self.mean(self.r * u), float(u.max())
        )
