"""The uniform steady states: disorder, and order along the cell or around it.

A uniform P = P0 e along an axis e of the cell drives the uniform flow u = A P, A = P0ⁿ for e = e_theta
and 0 for e = e_z or with `zero_theta_flux`. It is steady where

    d_r P0 = (1 - P0²) (β + α_u A) P0,    β = α_p - κ (e·d)²,    κ (e·d) (d - (e·d) e) = 0 .

The last condition requires d along an axis or κ = 0; otherwise repulsion rotates the state as a whole.
Along the cell P0² = 1 - d_r/β. Around it, with x = P0² and ν = n/2, P0 solves

    (1 - x) (β + α_u x^ν) = d_r,    for n = 2   x = [α_u - β ± ((α_u + β)² - 4 α_u d_r)^½] / (2 α_u) .

x^(ν-1) (1 - x)² has at most one maximum, so that β + α_u x^ν - d_r/(1 - x) has at most two extrema: there
are up to two roots for n <= 2 and up to three for n > 2. Circumferential order is sustained by the flow that
it drives, so that it exists even below α_p = d_r. Own derivation; all quantities are dimensionless.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from ...model.doors import door
from ...model.errors import InputError, choice, whole
from ...model.grid import Array
from ...model.parameters import Parameters

BASES = ("disorder", "unidirectional", "circumferential")
"""The uniform states by name: P = 0, P = P0 e_z and P = P0 e_theta."""
NEGLIGIBLE = 1e-12
"""Squares P0² no larger count as disorder."""
KNOWN = {
    *("alpha_p", "alpha_u", "epsilon", "d_s", "d_r", "kappa", "mu", "repulsion_angle"),
    *("zero_theta_flux", "force_exponent"),
}
"""The parameters that the closed forms include."""
OBLIQUE = 1e-12
"""Values of |sin φ_d| or |cos φ_d| no larger count as zero."""


@dataclass(frozen=True)
class Uniform:
    """A uniform steady state P = `order` e, e along `axis` (0: theta, 1: z), dimensionless.

    `swept` is A in u = A P, `along` and `across` are (d·e)² and the same of the other axis.
    """

    axis: int
    order: float
    swept: float
    along: float
    across: float


@door
def orders(params: Parameters, base: str) -> Array:
    """Return every P0 > 0 (roots,) of the uniform states of a kind, the largest first.

    `base` is one of `BASES`; disorder has the single root 0. Empty where there is no such state. Raises
    `InputError` for fields, and for an oblique d where it would rotate the state.

    Example:
        >>> import cyclosis as cy
        >>> params = cy.Parameters(alpha_p=0.5, d_r=0.025)
        >>> cy.stability.orders(params, "unidirectional").round(6)  # (1 - d_r/α_p)^½
        array([0.974679])
        >>> cy.stability.orders(params.replace(alpha_p=0.02), "unidirectional").size
        0
    """
    choice("base", base, BASES)
    check_numbers(params)
    if base == "disorder":
        return np.zeros(1)
    axis = _axis(base)
    beta = float(params.alpha_p) - float(params.kappa) * _shares(params)[axis]
    push = 0.0 if base == "unidirectional" or params.zero_theta_flux else float(params.alpha_u)
    squares = _squares(beta, push, params.d_r, 0.5 * params.force_exponent)
    return np.sqrt(np.array(sorted(squares, reverse=True), dtype=np.float64))


@door
def uniform(params: Parameters, base: str, root: int | None = None) -> Uniform:
    """Return a uniform steady state.

    `root` counts the solutions of `orders` from 0, the largest P0, which is the default. Raises `InputError`
    as `orders` does, where there is no such state, and for a root that does not exist.
    """
    found = orders(params, base)
    if found.size == 0:
        point = ", ".join(f"{name} = {getattr(params, name):g}" for name in ("alpha_p", "alpha_u", "kappa"))
        rule = f"where a {base} state exists (d_r = {params.d_r:g} outweighs what orders it)"
        raise InputError("the parameter point", point, rule, "raise alpha_p, or choose another base")
    last = found.size - 1
    chosen = whole("root", 0 if root is None else root, 0, last, f"there are {found.size}, largest first")
    order = float(found[chosen])
    axis = _axis(base)
    swept = order**params.force_exponent if axis == 0 and not params.zero_theta_flux else 0.0
    shares = _shares(params) if order > 0 else (0.0, 0.0)
    return Uniform(axis, order, swept, shares[axis], shares[1 - axis])


@door
def check_numbers(params: Parameters) -> None:
    """Raise `InputError` if a parameter is a field, or is not 0 and is not included in the closed forms."""
    for name, value in params.items():
        if name not in KNOWN and np.any(value):
            raise InputError(name, value, "0 for a closed form, which does not include it", "set it to 0")
        if isinstance(value, np.ndarray):
            raise InputError(name, value, "one number for a closed form", "choose a number")


def _axis(base: str) -> int:
    return 0 if base == "circumferential" else 1


def _shares(params: Parameters) -> tuple[float, float]:
    """Return (d·e_theta)² and (d·e_z)², or refuse an oblique d unless κ = 0."""
    angle = float(params.repulsion_angle)
    cosine, sine = abs(np.cos(angle)), abs(np.sin(angle))
    if params.kappa == 0:
        return 0.0, 0.0
    if min(cosine, sine) > OBLIQUE:
        rule = "a multiple of π/2, because an oblique repulsion rotates an ordered state as a whole"
        raise InputError("repulsion_angle", angle, rule, "change it or set kappa to 0")
    return (1.0, 0.0) if cosine > sine else (0.0, 1.0)


def _squares(beta: float, push: float, loss: float, power: float) -> list[float]:
    """Return the roots 0 < x <= 1 of (1 - x) (β + push x^ν) = loss, with ν = `power`."""

    def gain(x: float) -> float:
        return beta + push * x**power

    def excess(x: float) -> float:
        return (1 - x) * gain(x) - loss

    def steeper(x: float) -> float:
        """Return the slope of gain - loss/(1 - x), times (1 - x)²."""
        return push * power * x ** (power - 1) * (1 - x) ** 2 - loss

    least, below = float(np.finfo(np.float64).tiny), float(np.nextafter(1.0, 0.0))
    if loss == 0:  # (1 - x) is a factor: full order is a root
        return [*(x for x in _zeros(gain, (least, 1.0)) if x <= below), 1.0]
    turning = max((power - 1) / (power + 1), least)  # the maximum of x^(ν-1) (1 - x)²
    extrema = _zeros(steeper, (least, turning, 1.0)) if push * power > 0 else []
    extrema = [min(x, below) for x in extrema]  # a tiny loss would put one at 1, where (1 - x) gain is 0
    return [x for x in _zeros(excess, (least, *extrema, 1.0)) if x > NEGLIGIBLE]


def _zeros(function: Callable[[float], float], places: tuple[float, ...]) -> list[float]:
    """Return one zero between each two neighbouring places at which a function has opposite signs."""
    return [
        float(brentq(function, low, high, xtol=1e-18, rtol=1e-15, maxiter=500))
        for low, high in pairwise(places)
        if low < high and np.sign(function(low)) * np.sign(function(high)) < 0
    ]
